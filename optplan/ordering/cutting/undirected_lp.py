"""The linear programme of generalised subtour cuts over an undirected form.

Columns are edges. That none is used twice follows from the cuts: there are no upper bounds that pricing would have to
mind. How far a point is chosen is half of its links and needs no column of its own. Rows: every cluster has two links,
both ends of a fixed edge have the same number of them, and the cut of a set S of points that holds a whole cluster, and
both ends of each fixed edge or none, and leaves another cluster outside,

    x(delta(S)) >= 2,

written as  sum_e (|e in S| - h_u - h_v) x_e <= right  with h = 1/2 on some points of S: on all of them (the same cut,
halved), or only on clusters that S splits (then it counts edges inside S). The sparser of the two is taken. Besides,
blossoms

    x(delta(S)) >= 1 - t + 2 x(teeth)

for any set S of points. A tooth is a pair of clusters, and x(teeth) counts the edges between them that cross S. S may
split a stroke that has no option but its fixed edge, as a tour crosses S there for certain; t teeth and the strokes
split are an odd number. A tour crosses S an even number of times, and each tooth at most once.
"""

from __future__ import annotations

import math
from dataclasses import dataclass, field
from typing import NamedTuple

import numpy as np
import numpy.typing as npt

from optplan.domain.arrays import FloatArray, IntArray
from optplan.ordering.cutting.lp import Programme, Solution, Sparse
from optplan.ordering.cutting.undirected import Undirected

Bools = npt.NDArray[np.bool_]
SAFETY = 1e-9
"""Relative amount taken off a bound for rounding."""
NO_TEETH = np.zeros(0, dtype=np.int64)
PURGE = 20
"""Rows are dropped when at least so many are old."""


class Cut(NamedTuple):
    """Points `members` of S, those with h = 1/2 (`halves`), the right-hand side, and the teeth of a blossom.

    teeth (t,) : pairs of clusters as numbers (`pair_numbers`); edges between them that cross S have one more in the row
    """

    members: IntArray
    halves: IntArray
    right: float
    teeth: IntArray


class Dual(NamedTuple):
    """Duals as prices: an edge u, v costs `prices[u] + prices[v]` less, and `cuts[k]` more where S_k holds both ends.

    prices (n,), cuts (k,) >= 0, of blossoms also for edges of their teeth; value: of the dual solution while no
    reduced cost is negative; size: of the numbers that were summed up in it.
    """

    prices: FloatArray
    cuts: FloatArray
    value: float
    size: float


class Priced(NamedTuple):
    """Edges (k, 2) of the complete graph below a limit, their reduced costs (k,), and a bound for the whole problem."""

    edges: IntArray
    reduced: FloatArray
    bound: float


@dataclass
class CutProgramme:
    """The programme over some of the edges (k, 2), and cuts that are slack in `age` solves.

    form : of the problem; edges : to begin with; seed : of HiGHS
    """

    form: Undirected
    edges: IntArray
    seed: int = 0
    cuts: list[Cut] = field(default_factory=list)
    ages: IntArray = field(default_factory=lambda: np.zeros(0, dtype=np.int64))

    def __post_init__(self) -> None:
        form = self.form
        edges = np.unique(np.sort(self.edges, axis=1), axis=0)
        self.edges = edges[np.isfinite(form.edge_costs(edges[:, 0], edges[:, 1]))]
        costs = form.edge_costs(self.edges[:, 0], self.edges[:, 1])
        self.programme = Programme(costs, np.zeros(len(costs)), np.full(len(costs), math.inf), self.seed)
        self._tied = np.flatnonzero(form.mate > np.arange(form.points))
        self._sizes = np.bincount(form.cluster)
        # marks that are set and taken back for one cut at a time
        self._inside = np.zeros(form.points, dtype=np.bool_)
        self._half = np.zeros(form.points)
        self._tooth = np.zeros(form.clusters**2, dtype=np.bool_)
        links = np.concatenate([np.full(form.clusters, 2.0), np.zeros(len(self._tied))])
        self.programme.add_rows(links, links, _transposed(self._fixed_entries(self.edges), len(links)))

    @property
    def fixed_rows(self) -> int:
        """Rows that are no cuts."""
        return self.form.clusters + len(self._tied)

    def add_cuts(self, sets: list[IntArray], teeth: list[IntArray] | None = None) -> None:
        """Add the cuts of these sets of points; with teeth (pairs of clusters, or none), blossoms."""
        if not sets:
            return
        u, v = self.edges[:, 0], self.edges[:, 1]
        numbers = pair_numbers(self.form, u, v)
        rows: list[FloatArray] = []
        for members, pairs in zip(sets, teeth or [NO_TEETH] * len(sets), strict=True):
            inside = np.zeros(self.form.points, dtype=np.bool_)
            inside[members] = True
            held = np.bincount(self.form.cluster[members], minlength=self.form.clusters) == self._sizes
            split = inside & ~held[self.form.cluster]
            # with teeth, x(delta(S)) + t >= 1 + 2 x(teeth) instead of x(delta(S)) >= 2
            less = 1.0 if teeth is None else 0.5 * (1.0 - len(pairs))
            forms = [
                Cut(members, np.flatnonzero(split), held.sum() - less, pairs),
                Cut(members, members, -less, pairs),
            ]
            counted = self._counted(forms[0], u, v, numbers)
            entries = [self._entries(cut, counted, u, v) for cut in forms]
            best = int(np.argmin([np.count_nonzero(row) for row in entries]))
            self.cuts.append(forms[best])
            rows.append(entries[best])
        used = [np.flatnonzero(row) for row in rows]
        starts = np.cumsum([0, *(len(places) for places in used)])
        values = np.concatenate([row[places] for row, places in zip(rows, used, strict=True)])
        right = np.array([cut.right for cut in self.cuts[-len(sets) :]])
        self.programme.add_rows(np.full(len(sets), -math.inf), right, Sparse(starts, np.concatenate(used), values))
        self.ages = np.append(self.ages, np.zeros(len(sets), dtype=np.int64))

    def add_edges(self, edges: IntArray) -> int:
        """Add the edges (k, 2) that are not there yet; how many."""
        key = self.form.points
        low, high = np.sort(edges, axis=1).T
        new = np.unique((low * key + high)[~np.isin(low * key + high, self.edges[:, 0] * key + self.edges[:, 1])])
        edges = np.column_stack([new // key, new % key])
        if not len(edges):
            return 0
        fixed = self._fixed_entries(edges)
        parts = [(np.repeat(np.arange(len(edges)), np.diff(fixed.starts)), fixed.places, fixed.values)]
        numbers = pair_numbers(self.form, edges[:, 0], edges[:, 1])
        for k, cut in enumerate(self.cuts):
            counted = self._counted(cut, edges[:, 0], edges[:, 1], numbers)
            entries = self._entries(cut, counted, edges[:, 0], edges[:, 1])
            used = np.flatnonzero(entries)
            parts.append((used, np.full(len(used), self.fixed_rows + k), entries[used]))
        columns, places, values = (np.concatenate(part) for part in zip(*parts, strict=True))
        order = np.argsort(columns, kind="stable")
        starts = np.searchsorted(columns[order], np.arange(len(edges) + 1))
        costs = self.form.edge_costs(edges[:, 0], edges[:, 1])
        vectors = Sparse(starts, places[order], values[order])
        self.programme.add_columns(costs, np.zeros(len(edges)), np.full(len(edges), math.inf), vectors)
        self.edges = np.concatenate([self.edges, edges])
        return len(edges)

    def drop_edges(self, columns: IntArray) -> None:
        """Drop edges by column; only nonbasic ones leave the basis as it is."""
        self.programme.drop_columns(columns)
        self.edges = np.delete(self.edges, columns, axis=0)

    def purge(self, age: int) -> None:
        """Drop cuts that were slack in so many solves, this one included."""
        self.ages = np.where(self.programme.slack()[self.fixed_rows :], self.ages + 1, 0)
        old = self.ages >= age
        if old.sum() >= PURGE:
            self.programme.drop_rows(self.fixed_rows + np.flatnonzero(old))
            self.cuts = [cut for cut, gone in zip(self.cuts, old.tolist(), strict=True) if not gone]
            self.ages = self.ages[~old]

    def columns_of(self, edges: IntArray) -> FloatArray:
        """(columns,) 1 for these edges, 0 for others."""
        key = self.form.points
        low, high = np.sort(edges, axis=1).T
        return np.isin(self.edges[:, 0] * key + self.edges[:, 1], low * key + high).astype(np.float64)

    def dual(self, solution: Solution) -> Dual:
        """The duals as prices; those of cuts with a wrong sign, which are rounding, become 0."""
        form = self.form
        ends = solution.duals[: form.clusters]
        ties = solution.duals[form.clusters : self.fixed_rows]
        cuts = np.maximum(0.0, -solution.duals[self.fixed_rows :])
        prices = ends[form.cluster]
        prices[self._tied] += ties
        prices[form.mate[self._tied]] -= ties
        for k in np.flatnonzero(cuts).tolist():
            prices[self.cuts[k].halves] += 0.5 * cuts[k]
        right = np.array([cut.right for cut in self.cuts])
        value = 2.0 * float(ends.sum()) - float(cuts @ right)
        size = 2.0 * float(np.abs(prices).sum()) + float(cuts @ np.abs(right))
        return Dual(prices, cuts, value, size)

    def price(self, solution: Solution, limit: float, most: int) -> Priced:
        """Edges of the complete graph with a reduced cost below `limit` (at most `most`), and a bound.

        Every cluster has two links, each of which ends at two clusters: whatever the reduced costs r are,

            cost >= value + sum_e r_e x_e >= value + sum over clusters of min(0, least r at the cluster).
        """
        from optplan.ordering._kernels.mincut import cheap_edges

        form, dual = self.form, self.dual(solution)
        active = np.flatnonzero(dual.cuts).tolist()
        nothing = np.zeros(0, dtype=np.int64)
        who = np.concatenate([nothing, *(self.cuts[k].members for k in active)])
        which = np.repeat(np.array(active, dtype=np.int64), [len(self.cuts[k].members) for k in active])
        order = np.argsort(who, kind="stable")
        first = np.searchsorted(who[order], np.arange(form.points + 1))
        first_tooth = np.cumsum([0, *(len(cut.teeth) for cut in self.cuts)])
        teeth = np.concatenate([nothing, *(cut.teeth for cut in self.cuts)])
        least = np.full(form.points, math.inf)
        prices = dual.prices - 0.5 * form.node_costs
        edges, reduced = cheap_edges(
            form.matrix,
            form.places,
            form.depot,
            form.cluster,
            prices,
            first,
            which[order],
            dual.cuts,
            first_tooth,
            teeth,
            limit,
            0,
            form.points,
            least,
            most,
        )
        starts = np.searchsorted(form.cluster, np.arange(form.clusters))
        missing = np.minimum(np.minimum.reduceat(least, starts), 0.0).sum()
        return Priced(edges, reduced, dual.value + float(missing) - SAFETY * dual.size)

    def reduced_costs(self, dual: Dual, edges: IntArray, exact_below: float = math.inf) -> FloatArray:
        """(k,) reduced costs of edges (k, 2); those from `exact_below` on may be too low, but not below it."""
        u, v = edges.T
        reduced: FloatArray = self.form.edge_costs(u, v) - dual.prices[u] - dual.prices[v]
        low = np.flatnonzero(reduced < exact_below)
        u, v = u[low], v[low]
        pairs = pair_numbers(self.form, u, v)
        for k in np.flatnonzero(dual.cuts).tolist():
            reduced[low] += dual.cuts[k] * self._counted(self.cuts[k], u, v, pairs)
        return reduced

    def _counted(self, cut: Cut, u: IntArray, v: IntArray, pairs: IntArray) -> Bools:
        """(k,) which edges u[i], v[i] have both ends in S, or are in a tooth; pairs : their `pair_numbers`."""
        inside, tooth = self._inside, self._tooth
        inside[cut.members] = True
        first, second = inside[u], inside[v]
        counted: Bools = first & second
        if len(cut.teeth):
            tooth[cut.teeth] = True
            counted |= (first != second) & tooth[pairs]
            tooth[cut.teeth] = False
        inside[cut.members] = False
        return counted

    def _entries(self, cut: Cut, counted: Bools, u: IntArray, v: IntArray) -> FloatArray:
        """Entries of the edges u[i], v[i] in the row of a cut; counted : `_counted` of these edges."""
        half = self._half
        half[cut.halves] = 0.5
        entries: FloatArray = counted - half[u] - half[v]
        half[cut.halves] = 0.0
        return entries

    def _fixed_entries(self, edges: IntArray) -> Sparse:
        """Columns of edges in the rows of clusters and fixed edges."""
        form = self.form
        sign, row = np.zeros(form.points), np.zeros(form.points, dtype=np.int64)
        row[self._tied] = row[form.mate[self._tied]] = form.clusters + np.arange(len(self._tied))
        sign[self._tied], sign[form.mate[self._tied]] = 1.0, -1.0
        places = np.column_stack([form.cluster[edges], row[edges]])
        values = np.column_stack([np.ones(edges.shape), sign[edges]])
        used = values != 0
        return Sparse(np.concatenate([[0], np.cumsum(used.sum(axis=1))]), places[used], values[used])


def pair_numbers(form: Undirected, u: IntArray, v: IntArray) -> IntArray:
    """(k,) a number for the pair of clusters that each edge u[i], v[i] joins."""
    a, b = form.cluster[u], form.cluster[v]
    return np.minimum(a, b) * form.clusters + np.maximum(a, b)


def _transposed(columns: Sparse, rows: int) -> Sparse:
    """Vectors of columns as vectors of rows."""
    column = np.repeat(np.arange(len(columns.starts) - 1), np.diff(columns.starts))
    order = np.argsort(columns.places, kind="stable")
    starts = np.searchsorted(columns.places[order], np.arange(rows + 1))
    return Sparse(starts, column[order], columns.values[order])
