"""Which cuts a fractional tour violates."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass, field
from typing import TYPE_CHECKING, NamedTuple

import numpy as np

from optplan.domain.arrays import FloatArray, IntArray
from optplan.ordering.cutting.directed_graph import RootedTour

if TYPE_CHECKING:
    from optplan.ordering._kernels.maxflow import Network

Marks = np.ndarray[tuple[int, int], np.dtype[np.uint8]]
WORK = 3_000_000
"""Arcs looked at between two looks at the stop rule: some 0.02 s."""
DEEP = 20
"""How many times that much goes into pairs of clusters far apart in the order."""
MOST = 2_000
"""Most cuts looked at in a round, before the best are chosen."""
VIOLATION = 0.01
"""By how much a cut has to be violated."""


class Found(NamedTuple):
    """Violated cuts: 1 for vertices in S (c, n + 1), the pair of clusters (c, 2), the left-hand side (c,)."""

    sides: Marks
    pairs: IntArray
    values: FloatArray


@dataclass
class Separator:
    """Finds violated cuts of a rooted tour by minimum cuts in the graph of its fractional arcs.

    When `ended` says so it stops looking, and what it did not find means nothing.
    """

    tour: RootedTour
    ended: Callable[[], bool] = field(default=lambda: False)
    _cluster: IntArray = field(init=False)
    _hubs: IntArray = field(init=False)
    _shared: IntArray = field(init=False)
    _next: int = field(init=False, default=0)

    def __post_init__(self) -> None:
        tour = self.tour
        count, end = tour.clusters, tour.nodes
        self._cluster = np.append(tour.cluster, count)
        first = np.searchsorted(self._cluster, np.arange(count + 1))
        self._hubs = np.stack([first, first])
        sizes = np.bincount(tour.cluster, minlength=count)
        self._shared = np.flatnonzero(sizes > 1)
        self._hubs[0, self._shared] = end + 1 + np.arange(len(self._shared))
        self._hubs[1, self._shared] = end + 1 + len(self._shared) + np.arange(len(self._shared))
        order, others = tour.order, np.delete(np.arange(count), tour.root)
        inner = order[:count, :count].astype(np.float32)
        inner[tour.root] = 0
        between = inner @ inner > 0
        cover = np.argwhere((inner > 0) & ~between)
        tied = np.any(inner + inner.T, axis=0)[others]
        to_end = np.stack([others, np.full(len(others), count)], axis=1)
        from_root = np.stack([np.full(len(others), tour.root), others], axis=1)[tied]
        self.basic = np.concatenate([to_end, from_root, cover])
        every = np.argwhere(between)
        self.further = np.random.default_rng(0).permutation(every)

    def violated(self, tails: IntArray, heads: IntArray, values: FloatArray, most: int, *, deep: bool) -> Marks:
        """Up to `most` cuts (c, n + 1) that the point violates, the most violated ones; of all pairs when `deep`."""
        net, capacity = self._support(tails, heads, values)
        found, _ = self._look(net, capacity, self.basic, 2**62)
        if deep and len(found.values) < most // 4 and len(self.further):
            turned = np.roll(self.further, -self._next, axis=0)
            more, seen = self._look(net, capacity, turned, DEEP * WORK)
            self._next = (self._next + seen) % len(turned)
            sides, pairs = np.concatenate([found.sides, more.sides]), np.concatenate([found.pairs, more.pairs])
            found = Found(sides, pairs, np.concatenate([found.values, more.values]))
        return self._marks(found, most)

    def _marks(self, found: Found, most: int) -> Marks:
        """Of the most violated cuts, without doubles: marks take longer than to find them."""
        from optplan.ordering._kernels.separate import mark_cuts

        best = np.argsort(found.values, kind="stable")
        marks = np.zeros((0, self.tour.nodes + 1), dtype=np.uint8)
        for begin in range(0, len(best), most):
            some = best[begin : begin + most]
            rows = mark_cuts(found.sides[some], np.arange(len(some)), found.pairs[some], self._cluster, self.tour.order)
            marks = np.concatenate([marks, rows])
            _, chosen = np.unique(marks, axis=0, return_index=True)
            marks = marks[np.sort(chosen)]
            if len(marks) >= most:
                break
        return marks[:most]

    def _support(self, tails: IntArray, heads: IntArray, values: FloatArray) -> tuple[Network, FloatArray]:
        from optplan.ordering._kernels.maxflow import network

        tour = self.tour
        used = np.flatnonzero(values > 1e-9)
        visits = np.bincount(tails[used], weights=values[used], minlength=tour.nodes)
        nodes = np.flatnonzero(np.isin(tour.cluster, self._shared) & (visits > 1e-9))
        hub = self._hubs[:, tour.cluster[nodes]]
        net = network(
            tour.nodes + 1 + 2 * len(self._shared),
            np.concatenate([tails[used], hub[0], nodes]),
            np.concatenate([tour.ends(heads[used]), nodes, hub[1]]),
        )
        capacity = np.zeros(len(net.head))
        capacity[net.slot] = np.concatenate([values[used], visits[nodes], visits[nodes]])
        return net, capacity

    def _look(self, net: Network, capacity: FloatArray, pairs: IntArray, work: int) -> tuple[Found, int]:
        """Cuts between pairs of clusters, and how many pairs were looked at."""
        from optplan.ordering._kernels.separate import separate

        room = min(MOST, 2 * len(pairs) + 2)
        sides = np.zeros((room, self.tour.nodes + 1), dtype=np.uint8)
        which, values = np.zeros(room, dtype=np.int64), np.zeros(room)
        pairs = np.ascontiguousarray(pairs)
        found = seen = 0
        while seen < len(pairs) and found + 2 <= room and work > 0 and not self.ended():
            more, seen = separate(
                net,
                capacity,
                self._cluster,
                self.tour.order,
                self._hubs,
                pairs,
                seen,
                WORK,
                1.0 - VIOLATION,
                sides[found:],
                which[found:],
                values[found:],
            )
            found, work = found + more, work - WORK
        return Found(sides[:found], pairs[which[:found]], values[:found]), seen
