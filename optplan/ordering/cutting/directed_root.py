"""The cut loop: solve, price, separate, until nothing is violated."""

from __future__ import annotations

import math
from collections.abc import Callable
from dataclasses import dataclass, field

import numpy as np

from optplan.domain.arrays import FloatArray, IntArray
from optplan.ordering.cutting.directed_graph import Bools, RootedTour, granularity
from optplan.ordering.cutting.directed_lp import ArcProgramme
from optplan.ordering.cutting.directed_separation import Separator

NEAREST = 6
"""Arcs out of and into each node to begin with."""
CUTS = 100
"""Most cuts added in a round."""
AGE = 5
"""Solves after which a slack cut is dropped."""
PATIENCE = 8
"""Rounds without progress after which the loop ends."""
PROGRESS = 0.01
"""Share of the gap that has to be closed to count as progress."""
EQUAL = 1e-7
"""Costs that differ relatively by less are equal."""


@dataclass
class CutLoop:
    """What is known of a rooted tour: incumbent, bound, and which arcs can still be in a better solution.

    Parameters
    ----------
    tour : what is to be solved
    ended : whether to stop, asked often
    proved, found : told each better bound, and each better tour (m,) of nodes from the root
    best : (m,) nodes of the best tour known, from the root; empty when there is none
    upper, bound : its cost, and the best bound
    base, reduced : a bound, and reduced costs (n, n) that may be added to it: see `ArcProgramme.priced`
    nodes : of the tree looked at
    """

    tour: RootedTour
    ended: Callable[[], bool]
    proved: Callable[[float], None] = field(default=lambda _: None)
    found: Callable[[IntArray], object] = field(default=lambda _: None)
    seed: int = 0
    best: IntArray = field(default_factory=lambda: np.zeros(0, dtype=np.int64))
    upper: float = math.inf
    bound: float = -math.inf
    base: float = -math.inf
    nodes: int = 0
    reduced: FloatArray = field(init=False)
    programme: ArcProgramme = field(init=False)
    separator: Separator = field(init=False)

    def __post_init__(self) -> None:
        self.programme = ArcProgramme(self.tour, self.seed)
        self.separator = Separator(self.tour, self.ended)
        self.grain = granularity(self.tour.costs)
        self.reduced = np.where(np.isfinite(self.tour.costs), 0.0, math.inf)

    @property
    def cutoff(self) -> float:
        """No solution that costs this or more is better than the incumbent in a way that counts."""
        if math.isinf(self.upper):
            return math.inf
        return self.upper - max(self.grain * (1.0 - 1e-6), EQUAL * abs(self.upper))

    @property
    def closed(self) -> bool:
        """Whether the incumbent is proved."""
        return self.bound >= self.cutoff

    def learn(self, nodes: IntArray) -> bool:
        """A tour (m,) of nodes from the root, perhaps better than the best; whether it is."""
        tour = self.tour
        clusters = tour.cluster[nodes]
        inner = tour.order[np.ix_(clusters, clusters)]
        if len(np.unique(clusters)) < tour.clusters or np.tril(inner).any():
            raise ValueError("this is no tour")
        cost = float(tour.costs[nodes, np.roll(nodes, -1)].sum())
        if not cost < self.upper:
            return False
        self.best, self.upper = nodes, cost
        self._include(nodes, np.roll(nodes, -1))
        self.found(nodes)
        return True

    def prove(self, bound: float) -> None:
        """No solution costs less than this, or less than the incumbent."""
        if bound > self.bound:
            self.bound = bound
            # every cost is a multiple of the grain
            if self.grain and math.isfinite(bound):
                self.bound = max(bound, self.grain * math.ceil(bound / self.grain - 1e-6))
            self.proved(min(self.bound, self.upper))

    def start(self) -> None:
        """The first arcs: the nearest of each node under costs less the least of each row and column."""
        costs, count = self.tour.costs, self.tour.nodes
        pick = np.isfinite(costs)
        if len(self.best):
            out = np.where(pick, costs, math.inf)
            with np.errstate(invalid="ignore"):
                out = out - out.min(axis=1, keepdims=True)
                out = out - out.min(axis=0)
            near = np.zeros_like(pick)
            kept = min(NEAREST, count)
            near[np.arange(count)[:, None], np.argpartition(out, kept - 1, axis=1)[:, :kept]] = True
            near[np.argpartition(out, kept - 1, axis=0)[:kept], np.arange(count)] = True
            pick &= near
        # without a known tour a part of the arcs could hold none, and the first programme be infeasible
        self._include(*np.nonzero(pick))

    def run(self) -> str:
        """Raise the bound until nothing is violated ("done"), it is proved ("proved"), or "ended"."""
        stale, reached = 0, -math.inf
        while not self.ended():
            status = self.programme.solve(self.ended)
            if status == "Infeasible":
                # the incumbent's arcs always have columns; without it, all arcs have
                self.base = math.inf
                self.prove(math.inf)
                return "proved"
            if status != "Optimal":
                return "ended"
            added = self.price()
            if self.closed:
                return "proved"
            lp = self.programme
            gap = self.cutoff - self.base if math.isfinite(self.cutoff) else abs(self.base)
            if self.base > reached + PROGRESS * gap:
                stale, reached = 0, self.base
            else:
                stale += 1
            marks = self.separator.violated(lp.tails, lp.heads, lp.primal, CUTS, deep=stale > 0)
            if (stale and not added and not len(marks)) or stale > PATIENCE:
                return "done"
            lp.purge(AGE)
            lp.add_cuts(marks)
        return "ended"

    def price(self) -> int:
        """Bound and reduced costs of all arcs; some are out then, others get a column: how many."""
        bound, reduced = self.programme.priced()
        if bound > self.base:
            self.base, self.reduced = bound, reduced
        self.prove(bound)
        out = self.programme.out
        out |= bound + reduced >= self.cutoff
        return self.add_priced(reduced, out, 4 * self.tour.nodes)

    def add_priced(self, reduced: FloatArray, out: Bools, most: int) -> int:
        """Give columns to arcs, not `out` (n, n), that would improve the programme's point, at most so many."""
        lp, tour = self.programme, self.tour
        # the least of a cluster has gone into the bound: that of the columns is what the programme thinks is 0
        least = np.full(tour.clusters, math.inf)
        np.minimum.at(least, tour.cluster[lp.heads], reduced[lp.tails, lp.heads])
        least[~np.isfinite(least)] = 0.0
        lacking = np.where(out, math.inf, reduced - least[tour.cluster])
        lacking[lp.tails, lp.heads] = math.inf
        values = lacking.ravel()
        new = np.flatnonzero(values < -1e-9 * max(abs(self.bound), abs(self.base)))
        if len(new) > most:
            new = new[np.argpartition(values[new], most)[:most]]
        tails, heads = np.divmod(new, tour.nodes)
        lp.add_arcs(tails, heads)
        return len(new)

    def shrink(self) -> None:
        """Drop the columns of arcs that are out, except those of the incumbent."""
        lp = self.programme
        out = lp.out.copy()
        if len(self.best):
            out[self.best, np.roll(self.best, -1)] = False
        lp.drop_arcs(np.flatnonzero(out[lp.tails, lp.heads]))

    def _include(self, tails: IntArray, heads: IntArray) -> None:
        lp = self.programme
        present = np.zeros(self.tour.costs.shape, dtype=np.bool_)
        present[lp.tails, lp.heads] = True
        new = ~present[tails, heads]
        lp.add_arcs(tails[new], heads[new])
