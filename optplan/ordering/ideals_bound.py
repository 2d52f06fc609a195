"""A bound of every path from walks through the places of a path, and of every beginning of one: what guides a beam."""

from __future__ import annotations

import math
from dataclasses import dataclass, field
from typing import TYPE_CHECKING

import numpy as np

from optplan.domain.arrays import BoolArray, FloatArray
from optplan.domain.ordering import OrderingProblem
from optplan.ordering.ideals_network import MAX_NODES, Reduced, Side, sides
from optplan.ordering.method import Run

if TYPE_CHECKING:
    from optplan.ordering._kernels.ideals import Guide
    from optplan.ordering._kernels.ideals_bound import Links, Walks

MAX_TABLE = 600_000
"""Most places x nodes: beyond, setting up the tables and one step of the ascent take too long to be called off."""
WALK_SLICE = 20_000_000
"""Arcs looked at between two looks at the stop rule: some 0.03 s."""
CELL_WORK = 5
"""A place in a table takes as long as this many arcs."""
PATIENCE, SHORTER = 3, 0.75
"""Steps without gain after which they are made shorter, and by how much."""
FRESH_STEP, LEAST_STEP = 0.1, 0.01
"""An ascent that is taken up again begins with steps at least this long: the best value known may be better now; it
ends when they are shorter than the other."""
STEP, MOMENTUM = 0.25, 0.7
SAFETY = 1e-12
"""Rounding errors of a bound, relative to the numbers summed up in it."""


def refuse_large_tables(problem: OrderingProblem) -> str | None:
    """Why the tables of the bound do not fit."""
    if problem.nodes > MAX_NODES:
        return f"{problem.nodes} nodes; at most {MAX_NODES}, because all arcs are written out"
    if problem.clusters * problem.nodes > MAX_TABLE:
        return f"{problem.clusters} clusters with {problem.nodes} nodes; clusters x nodes must be at most {MAX_TABLE}"
    return None


@dataclass
class Relaxation:
    """Paths relaxed to walks: one cluster at each place, in its window, perhaps twice, perhaps never.

    Weights on clusters, found by subgradient ascent, make walks visit each cluster once (N. Christofides, A. Mingozzi
    and P. Toth, "State-space relaxation procedures for the computation of bounds to routing problems", 1981; time
    windows become windows of places, as precedence gives them). The least walk bounds all paths; walks from a node at a
    place bound what a path that got there still has to pay.

    bound : the best so far, valid for paths that cost less than the cutoff given to `eliminate`
    weights : (m,) that gave it
    work : of filling a table of walks, in arcs looked at
    """

    problem: OrderingProblem
    reduced: Reduced | None = None
    bound: float = -math.inf
    sides: tuple[Side, Side] = field(init=False)
    weights: FloatArray = field(init=False)
    alive: BoolArray = field(init=False)
    work: int = 0
    _arcs: tuple[Links, Links] = field(init=False)
    _step: float = 1.0
    _stalled: int = 0
    _direction: FloatArray = field(init=False)

    def __post_init__(self) -> None:
        count, cluster = self.problem.clusters, self.problem.cluster
        self.sides = sides(self.problem, self.reduced)
        places = np.arange(count)[:, None]
        self.alive = (places >= self.sides[0].ahead[cluster]) & (places < count - self.sides[1].ahead[cluster])
        self.weights, self._direction = np.zeros(count), np.zeros(count)
        self._keep(np.isfinite(self.sides[0].reduced.arcs))

    @property
    def rounding(self) -> float:
        """More than the rounding errors of any bound."""
        numbers = abs(self.sides[0].reduced.bound) + 2.0 * float(np.abs(self.weights).sum())
        return SAFETY * (numbers + (abs(self.bound) if math.isfinite(self.bound) else 0.0))

    def ascend(self, run: Run, rounds: int) -> None:
        """Improve the weights by that many steps, fewer when the run is stopped."""
        from optplan.ordering._kernels.ideals_bound import visits

        side, cluster = self.sides[0], self.problem.cluster
        weights, self._step = self.weights, max(self._step, FRESH_STEP)
        for _ in range(rounds):
            links = self._links(0, weights)
            walks = self._walks(0, links, run)
            if walks is None:
                return
            total = side.reduced.start - weights[cluster] + walks.best[0]
            first = int(total.argmin())
            bound = side.reduced.bound + float(weights.sum() + total[first])
            if bound > self.bound:
                self.bound, self.weights, self._stalled = bound, weights, 0
            else:
                self._stalled += 1
                if self._stalled % PATIENCE == 0:
                    self._step *= SHORTER
                if self._step < LEAST_STEP:
                    return
            if math.isinf(bound):
                return
            counts = np.zeros(self.problem.clusters, dtype=np.int64)
            visits(links, cluster, side.never, walks, first, counts)
            lack = 1.0 - counts
            if not lack.any():
                return
            # a step as long as the distance to the best value known; B. Polyak (1969)
            target = run.cost if math.isfinite(run.cost) else bound + 0.1 * abs(bound)
            self._direction = lack + MOMENTUM * self._direction
            weights = weights + STEP * self._step * max(target - bound, 0.0) / float(lack @ lack) * self._direction

    def guide(self, side: int, run: Run) -> Guide | None:
        """What bounds the states of a dynamic programme from that side; None when the run is stopped before."""
        from optplan.ordering._kernels.ideals import Guide

        links = self._links(side, self.weights)
        walks = self._walks(side, links, run)
        if walks is None:
            return None
        reduced = self.sides[side].reduced
        weights = self.weights[self.problem.cluster]
        arcs = np.full(reduced.arcs.shape, np.inf)
        tails = np.repeat(np.arange(len(arcs)), np.diff(links.first))
        arcs[tails, links.head] = links.cost
        return Guide(reduced.bound + float(self.weights.sum()), arcs, reduced.start - weights, *walks)

    def eliminate(self, run: Run, cutoff: float) -> None:
        """Forget arcs, and nodes at places, over which no path costs less than the cutoff."""
        from optplan.ordering._kernels.ideals_bound import through

        links = self._links(0, self.weights)
        after, before = self._walks(0, links, run), self._walks(1, self._links(1, self.weights), run)
        if after is None or before is None or not math.isfinite(cutoff):
            return
        limit = cutoff - self.sides[0].reduced.bound - float(self.weights.sum())
        coming = before.best[::-1] - self.weights[self.problem.cluster]
        self.alive &= coming + after.best < limit
        coming = np.where(self.alive, coming, np.inf)
        cheapest = np.full(len(links.head), np.inf)
        for high, low in self._slices(self.problem.clusters - 2):
            if run.stop():
                return
            through(links, cheapest, coming, after.best, high, low)
        kept = np.zeros((self.problem.nodes, self.problem.nodes), dtype=np.bool_)
        tails = np.repeat(np.arange(len(kept)), np.diff(links.first))
        kept[tails, links.head] = cheapest < limit
        self._keep(kept)

    def _keep(self, links: BoolArray) -> None:
        """Go on with these arcs (n, n) only."""
        from optplan.ordering._kernels.ideals_bound import Links

        arcs = []
        for side, mask in zip(self.sides, (links, links.T), strict=True):
            tails, heads = np.nonzero(mask)
            first = np.searchsorted(tails, np.arange(len(mask) + 1))
            arcs.append(Links(first, heads, side.reduced.arcs[tails, heads]))
        self._arcs = (arcs[0], arcs[1])
        self.work = int((self.alive * links.sum(axis=1)).sum()) + CELL_WORK * self.alive.size

    def _links(self, side: int, weights: FloatArray) -> Links:
        """The arcs that are left, with the weights of their heads taken off."""
        arcs = self._arcs[side]
        return arcs._replace(cost=arcs.cost - weights[self.problem.cluster[arcs.head]])

    def _walks(self, side: int, links: Links, run: Run) -> Walks | None:
        from optplan.ordering._kernels.ideals_bound import Walks, walk_back

        shape = self.alive.shape
        walks = Walks(np.empty(shape), np.empty(shape), np.empty(shape, dtype=np.int32))
        never, reduced = self.sides[side].never, self.sides[side].reduced
        alive = np.ascontiguousarray(self.alive[::-1]) if side else self.alive
        for high, low in self._slices(len(alive) - 1):
            if run.stop():
                return None
            walk_back(links, reduced.end, self.problem.cluster, alive, never, walks, high, low)
        return walks

    def _slices(self, last: int) -> list[tuple[int, int]]:
        """Places last..0 in blocks of about equal work."""
        size = max(1, WALK_SLICE * len(self.alive) // max(self.work, 1))
        return [(high, max(high - size + 1, 0)) for high in range(last, -1, -size)]
