"""The cut loop at the root: cuts, pricing and a bound for the complete graph."""

from __future__ import annotations

import math
import time
from collections.abc import Callable
from dataclasses import dataclass, field

import numpy as np

from optplan.domain.arrays import FloatArray, IntArray
from optplan.ordering.cutting.lp import Solution
from optplan.ordering.cutting.undirected import Undirected
from optplan.ordering.cutting.undirected_cuts import UNLIMITED, violated_blossoms, violated_sets
from optplan.ordering.cutting.undirected_lp import CutProgramme, Priced

NEAREST = 3
"""Edges to begin with at each point; the others are priced in."""
LOOKED_AT = 32
"""Points among which the nearest of other clusters are."""
ALL_POINTS = 400
"""Without a known tour all edges are there from the beginning, up to this many points."""
PRICE_EVERY = 3
"""Solves between two looks at the complete graph."""
PRICE_MOST = 2000
PRICE_EACH = 3
"""Edges added at a time, in all and at each point."""
KEEP = 0.5
"""Edges of a larger reduced cost are dropped for the time being; in lengths of an average edge of the tour."""
AGE = 3
STALL_ROUNDS = 15
STALL = 0.002
"""The loop ends when so many rounds close less than this part of the gap."""
MIX = 0.5
"""Cuts are looked for half-way between the point and the known tour, where those found are deeper."""
MANY_CLUSTERS, COVER = 200, 4
"""Of more clusters, each takes part in so many of a round's subtour cuts: the programme stays sparse and fast, in more
rounds than there is time for anyway."""
ROUNDING = 1e-7
TINY = 1e-9


@dataclass
class Root:
    """The programme, the best known tour (edges (m, 2)) and its cost, the best bound, and its time limit.

    deadline : of time.monotonic; proved : told each better bound
    """

    programme: CutProgramme
    tour: IntArray
    cost: float
    deadline: float
    proved: Callable[[float], None]
    bound: float = -math.inf
    inner: FloatArray = field(default_factory=lambda: np.zeros(0))

    @property
    def remaining(self) -> float:
        """Seconds left."""
        return self.deadline - time.monotonic()

    @property
    def cutoff(self) -> float:
        """A tour that costs no less is no better than the best known, but for rounding."""
        if not len(self.tour):
            return math.inf
        size = np.abs(self.programme.form.edge_costs(*self.tour.T)).sum()
        return self.cost - ROUNDING * abs(self.cost) - TINY * float(size)

    def closed(self) -> bool:
        """Whether nothing is left to prove."""
        return self.bound >= self.cutoff

    def raise_bound(self, bound: float) -> None:
        """Take over a bound of the whole problem."""
        if bound > self.bound:
            self.bound = bound
            self.proved(bound)

    def tighten(self) -> Solution | None:
        """Cut and price until nothing is left to add, or it no longer pays; the last solution, None without one.

        The last solution is priced out: `self.bound` is its bound. None: time is over, or there is no tour (then the
        bound is infinite).
        """
        programme = self.programme
        history: list[float] = []
        tour = programme.columns_of(self.tour)
        rounds = 0
        while self.remaining > 0:
            solution = programme.programme.solve(self.remaining)
            if isinstance(solution, str):
                if solution == "Infeasible" and not len(self.tour):
                    self.raise_bound(math.inf)
                return None
            rounds += 1
            sets = self._sets(solution, tour)
            handles, teeth = violated_blossoms(programme.form, programme.edges, solution.primal)
            history.append(solution.objective)
            last = not (sets or handles) or self._stalls(history)
            if last or rounds % PRICE_EVERY == 0:
                priced = programme.price(solution, -ROUNDING, 100 * PRICE_MOST)
                self.raise_bound(priced.bound)
                if self.closed():
                    return None
                added = programme.add_edges(_best_of_each(programme.form, priced))
                if last and not added:
                    return solution
                dropped = self._drop(solution) if not last else 0
                if added or dropped:
                    tour = programme.columns_of(self.tour)
            programme.purge(AGE)
            programme.add_cuts(sets)
            programme.add_cuts(handles, teeth)
        return None

    def _sets(self, solution: Solution, tour: FloatArray) -> list[IntArray]:
        form, edges = self.programme.form, self.programme.edges
        most = COVER if form.clusters > MANY_CLUSTERS else UNLIMITED
        sets: list[IntArray] = []
        if len(self.tour):
            sets = violated_sets(form, edges, MIX * solution.primal + (1.0 - MIX) * tour, most)
        return sets or violated_sets(form, edges, solution.primal, most)

    def _stalls(self, history: list[float]) -> bool:
        if len(history) <= STALL_ROUNDS:
            return False
        before, now = history[-STALL_ROUNDS - 1], history[-1]
        # new columns lower the objective: that is no stall
        return math.isfinite(self.cost) and 0 <= now - before < STALL * (self.cost - now)

    def _drop(self, solution: Solution) -> int:
        """Drop edges far from being used; pricing brings them back."""
        if not len(self.tour):
            return 0
        programme = self.programme
        count = len(solution.reduced)
        far = (solution.reduced > KEEP * self.cost / len(self.tour)) & (solution.primal <= 0)
        far &= programme.columns_of(self.tour)[:count] == 0
        if far.sum() < 0.1 * count:
            return 0
        programme.drop_edges(np.flatnonzero(far))
        return int(far.sum())


def first_edges(form: Undirected, tour: IntArray) -> IntArray:
    """(k, 2) the nearest edges of each point, and those of the tour; all edges where no tour is known."""
    if not len(tour):
        return np.argwhere(form.cluster[:, None] < form.cluster).astype(np.int64)
    tails = np.repeat(np.arange(form.nodes), min(LOOKED_AT, form.nodes))
    if len(form.matrix):
        outside = np.where(form.cluster[: form.nodes, None] == form.cluster[: form.nodes], math.inf, form.matrix)
        heads = np.argsort(outside, axis=1, kind="stable")[:, :LOOKED_AT].ravel()
    else:
        from scipy.spatial import cKDTree

        heads = cKDTree(form.places).query(form.places, k=min(LOOKED_AT, form.nodes))[1].ravel()
    other = form.cluster[tails] != form.cluster[heads]
    tails, heads = tails[other], heads[other]
    # the first few of each point: they come nearest first
    rank = np.arange(len(tails)) - np.searchsorted(tails, tails)
    return np.concatenate([tour, np.column_stack([tails, heads])[rank < NEAREST]])


def _best_of_each(form: Undirected, priced: Priced) -> IntArray:
    """The best edges of each point, not too many in all."""
    order = np.argsort(priced.reduced, kind="stable")
    edges = priced.edges[order]
    ends = edges.ravel()
    # how many better edges each end has seen
    by_point = np.argsort(ends, kind="stable")
    rank = np.empty(len(ends), dtype=np.int64)
    first = np.searchsorted(ends[by_point], np.arange(form.points))
    rank[by_point] = np.arange(len(ends)) - first[ends[by_point]]
    best: IntArray = edges[rank.reshape(-1, 2).min(axis=1) < PRICE_EACH][:PRICE_MOST]
    return best
