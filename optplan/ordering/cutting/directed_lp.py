"""The linear programme of a rooted tour: degree rows, cuts and some of the arcs; its bound holds for all of them."""

from __future__ import annotations

import math
from collections.abc import Callable
from dataclasses import dataclass, field

import numpy as np

from optplan.domain.arrays import FloatArray, IntArray
from optplan.ordering.cutting.directed_graph import Bools, RootedTour
from optplan.ordering.cutting.lp import Programme, Solution, Sparse

SLICE = 0.2
"""Seconds of one solve before somebody asks whether to go on."""
SAFETY = 1e-11
"""Relative amount taken off a bound for the rounding of its sums."""
TYPICAL = 100.0
"""Size to which costs are brought for HiGHS, whose tolerances are absolute."""


@dataclass
class ArcProgramme:
    """min costs x over degree rows and cuts.

    Rows: each cluster is entered once (m), left once (m), each node of a larger cluster is left as it is entered;
    then the cuts, as marks (c, n + 1) of `optplan.ordering._kernels.separate`.

    Parameters
    ----------
    tour : what is to be solved
    out : (n, n) arcs that no solution that is looked for has
    tails, heads : (k,) the arcs that have a column
    """

    tour: RootedTour
    seed: int = 0
    out: Bools = field(init=False)
    tails: IntArray = field(init=False)
    heads: IntArray = field(init=False)
    marks: np.ndarray[tuple[int, int], np.dtype[np.uint8]] = field(init=False)
    ages: IntArray = field(init=False)
    solution: Solution | None = field(init=False, default=None)

    def __post_init__(self) -> None:
        tour = self.tour
        self.out = ~np.isfinite(tour.costs)
        finite = np.abs(tour.costs[~self.out])
        typical = float(np.median(finite[finite > 0])) if (finite > 0).any() else 1.0
        # a power of two, so that nothing is rounded
        self.scale = 2.0 ** round(math.log2(TYPICAL / typical))
        self.tails = self.heads = np.zeros(0, dtype=np.int64)
        self.marks = np.zeros((0, tour.nodes + 1), dtype=np.uint8)
        self.ages = np.zeros(0, dtype=np.int64)
        sizes = np.bincount(tour.cluster, minlength=tour.clusters)
        self._balance = np.full(tour.nodes, -1, dtype=np.int64)
        shared = np.flatnonzero(sizes[tour.cluster] > 1)
        self._balance[shared] = 2 * tour.clusters + np.arange(len(shared))
        self.fixed_rows = 2 * tour.clusters + len(shared)
        self.programme = Programme(np.zeros(0), np.zeros(0), np.zeros(0), self.seed)
        ones = np.ones(self.fixed_rows)
        ones[2 * tour.clusters :] = 0.0
        nothing = Sparse(np.zeros(self.fixed_rows + 1, dtype=np.int64), np.zeros(0, dtype=np.int64), np.zeros(0))
        self.programme.add_rows(ones, ones, nothing)

    def add_arcs(self, tails: IntArray, heads: IntArray) -> None:
        """Give arcs a column each."""
        from optplan.ordering._kernels.separate import rows_of

        tour, count = self.tour, len(tails)
        one = np.arange(count)
        rows = [tour.cluster[heads], tour.clusters + tour.cluster[tails]]
        columns, values = [one, one], [np.ones(count), np.ones(count)]
        for ends, sign in ((heads, 1.0), (tails, -1.0)):
            balanced = np.flatnonzero(self._balance[ends] >= 0)
            rows.append(self._balance[ends[balanced]])
            columns.append(balanced)
            values.append(np.full(len(balanced), sign))
        starts, places = rows_of(self.marks, tails, tour.ends(heads))
        rows.append(self.fixed_rows + np.repeat(np.arange(len(self.marks)), np.diff(starts)))
        columns.append(places)
        values.append(np.ones(len(places)))
        row, column, value = (np.concatenate(parts) for parts in (rows, columns, values))
        order = np.lexsort((row, column))
        begin = np.concatenate([[0], np.cumsum(np.bincount(column, minlength=count))])
        self.programme.add_columns(
            tour.costs[tails, heads] * self.scale,
            np.zeros(count),
            np.ones(count),
            Sparse(begin, row[order], value[order]),
        )
        self.tails, self.heads = np.concatenate([self.tails, tails]), np.concatenate([self.heads, heads])

    def add_cuts(self, marks: np.ndarray[tuple[int, int], np.dtype[np.uint8]]) -> None:
        """Add the cuts (c, n + 1)."""
        from optplan.ordering._kernels.separate import rows_of

        starts, places = rows_of(marks, self.tails, self.tour.ends(self.heads))
        rows = Sparse(starts, places, np.ones(len(places)))
        self.programme.add_rows(np.ones(len(marks)), np.full(len(marks), math.inf), rows)
        self.marks = np.concatenate([self.marks, marks])
        self.ages = np.concatenate([self.ages, np.zeros(len(marks), dtype=np.int64)])

    def purge(self, age: int) -> None:
        """Drop cuts that have been slack in that many solves."""
        slack = self.programme.slack()[self.fixed_rows :]
        self.ages = np.where(slack, self.ages + 1, 0)
        old = np.flatnonzero(self.ages >= age)
        if len(old) > len(self.ages) // 10:
            self.programme.drop_rows(self.fixed_rows + old)
            self.marks, self.ages = np.delete(self.marks, old, axis=0), np.delete(self.ages, old)

    def drop_arcs(self, columns: IntArray) -> None:
        """Drop columns."""
        self.programme.drop_columns(columns)
        self.tails, self.heads = np.delete(self.tails, columns), np.delete(self.heads, columns)

    def solve(self, ended: Callable[[], bool]) -> str:
        """Solve it; "Optimal", "Infeasible", or another word of HiGHS; "TimeLimit" when `ended` said so."""
        while True:
            answer = self.programme.solve(SLICE)
            if isinstance(answer, Solution):
                self.solution = answer
                return "Optimal"
            if answer != "TimeLimit" or ended():
                return answer

    @property
    def primal(self) -> FloatArray:
        """(k,) the point."""
        assert self.solution is not None
        return self.solution.primal

    def priced(self, out: Bools | None = None) -> tuple[float, FloatArray]:
        """A bound and reduced costs (n, n) >= 0 of all arcs, from the last duals whatever their accuracy.

        For every tour: cost >= bound + sum of the reduced costs of its arcs. Each cluster's least reduced cost of
        entering it has gone into the bound, so that nothing depends on HiGHS's tolerances. Arcs that are `out` (n, n)
        do not count: by default those that no solution that is looked for has.
        """
        from optplan.ordering._kernels.separate import subtract_cuts

        assert self.solution is not None
        tour, duals = self.tour, self.solution.duals / self.scale
        enter, leave = duals[: tour.clusters], duals[tour.clusters : 2 * tour.clusters]
        node = np.where(self._balance >= 0, duals[self._balance], 0.0)
        weights = np.maximum(duals[self.fixed_rows :], 0.0)
        reduced = tour.costs - (leave[tour.cluster] - node)[:, None] - (enter[tour.cluster] + node)
        reduced[self.out if out is None else out] = math.inf
        subtract_cuts(reduced, self.marks, weights, tour.in_root)
        first = np.searchsorted(tour.cluster, np.arange(tour.clusters))
        least = np.minimum.reduceat(reduced.min(axis=0), first)
        if not np.isfinite(least).all():
            return math.inf, reduced
        reduced -= least[tour.cluster]
        terms = np.concatenate([enter, leave, weights, least])
        size = np.abs(terms).sum() + np.abs(node).sum()
        return float(terms.sum() - SAFETY * size), reduced
