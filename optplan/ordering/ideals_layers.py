"""The dynamic programme over (order ideal, last node), layer by layer, with all states or the best of them."""

from __future__ import annotations

import math
from dataclasses import dataclass
from typing import TYPE_CHECKING, Any, NamedTuple

import numpy as np

from optplan.domain.arrays import IntArray
from optplan.domain.ordering import OrderingProblem
from optplan.domain.stop import StopReason
from optplan.ordering.ideals_network import Side
from optplan.ordering.method import Run

if TYPE_CHECKING:
    from optplan.ordering._kernels.ideals import Candidates, Guide, Layer, ShortArray

MEMORY = 1_500_000_000
"""Bytes that the states may take."""
SLICE = 200_000
"""Extensions between two looks at the stop rule: some 0.03 s."""
SPARE = 4
"""Candidates are collected up to this many times the width before the worst are dropped."""


class Sweep(NamedTuple):
    """What going through all layers brought.

    nodes : (m,) the best path that was reached, in the order of its side; empty when none was
    floor : no path that costs less than the cutoff costs less than this; infinite when there is none
    states : how many were kept, over all layers
    stopped : why it ended early, or None
    """

    nodes: IntArray
    floor: float
    states: int
    stopped: StopReason | None = None


def most_states(problem: OrderingProblem) -> int:
    """States of a layer that fit into the memory, with two layers, candidates and the ways back."""
    words = -(-problem.clusters // 64)
    layers = 2 * (16 * words + 28)
    return int(MEMORY / (layers + 52 * SPARE + 8 * problem.clusters))


def sweep(run: Run, side: Side, guide: Guide, width: int, cutoff: float) -> Sweep:
    """Go through all layers with at most `width` states in each, those of least bound.

    A state whose bound reaches the cutoff is forgotten: no path from it is wanted. One that is dropped for the width
    lowers the floor to its bound. When there was none, the best path is proved, or that there is no path.
    """
    layer, pool = _root(side), _Pool(width, len(side.network.cluster))
    lowest, states = -math.inf, 0
    ways: list[tuple[ShortArray, ShortArray]] = []
    nothing = np.zeros(0, dtype=np.int64)
    for place in range(len(side.network.name)):
        if stop := pool.fill(run, side, guide, layer, place, cutoff):
            # every path that was not dropped yet goes through this layer
            return Sweep(nothing, min(pool.floor, lowest), states, stop)
        if pool.count == 0:
            return Sweep(nothing, pool.floor, states)
        lowest = float(pool.arrays.bound[: pool.count].min())
        states += pool.count
        layer, way = pool.grow(side, layer)
        ways.append(way)
    total = layer.cost + side.network.end[layer.last]
    return Sweep(_path(ways, int(total.argmin())), pool.floor, states)


@dataclass
class _Pool:
    """Candidates for the next layer.

    width : most of them that are kept
    nodes : most that one state can have
    floor : least bound of those that were dropped, in all layers
    """

    width: int
    nodes: int
    count: int = 0
    floor: float = math.inf

    def __post_init__(self) -> None:
        self.arrays = _room(min(SPARE * self.width, 4096) + self.nodes)

    def fill(self, run: Run, side: Side, guide: Guide, layer: Layer, place: int, cutoff: float) -> StopReason | None:
        """Collect what the states of a layer extend to, and keep the best; why it ended early, or None."""
        from optplan.ordering._kernels.ideals import FOUND, FULL, NEXT, expand

        counters = np.zeros(3, dtype=np.int64)
        self.count, limit = 0, cutoff
        self.arrays.slots.fill(-1)
        while counters[NEXT] < len(layer.last):
            if stop := run.stop():
                return stop
            least = expand(layer, side.network, guide, self.arrays, place, limit, SLICE, counters)
            self.count = int(counters[FOUND])
            if limit < cutoff:
                self.floor = min(self.floor, least)
            if counters[FULL]:
                limit = self._make_room(layer, limit)
                counters[FOUND], counters[FULL] = self.count, 0
        self._drop(limit)
        return None

    def _make_room(self, layer: Layer, limit: float) -> float:
        """Drop the worst candidates or, when there are few, make their arrays larger; the new limit of bounds."""
        from optplan.ordering._kernels.ideals import index

        if self.count >= (SPARE - 1) * self.width:
            limit = self._drop(limit)
        else:
            larger = _room(2 * len(self.arrays.bound))
            for old, new in zip(_columns(self.arrays), _columns(larger), strict=True):
                new[: self.count] = old[: self.count]
            self.arrays = larger
        index(layer, self.arrays, self.count)
        return limit

    def _drop(self, limit: float) -> float:
        """Keep the best, best first; the least bound that was dropped, or the limit."""
        if self.count <= self.width:
            return limit
        bound = self.arrays.bound[: self.count]
        order = np.argpartition(bound, self.width)
        limit = float(bound[order[self.width]])
        self.floor = min(self.floor, limit)
        kept = order[: self.width]
        kept = kept[np.argsort(bound[kept], kind="stable")]
        for values in _columns(self.arrays):
            values[: self.width] = values[kept]
        self.count = self.width
        return limit

    def grow(self, side: Side, layer: Layer) -> tuple[Layer, tuple[ShortArray, ShortArray]]:
        """The next layer, and for each of its states the one it came from and its last node."""
        from optplan.ordering._kernels.ideals import Layer, grow

        k = self.count
        parent, node, cost, spent, _, name, _ = self.arrays
        parent, node = parent[:k].copy(), node[:k].copy()
        shape = (k, layer.done.shape[1])
        sets = np.empty(shape, dtype=np.uint64), np.empty(shape, dtype=np.uint64)
        grown = Layer(*sets, node, cost[:k].copy(), spent[:k].copy(), name[:k].copy())
        grow(layer, side.network, parent, grown)
        return grown, (parent, node)


def _root(side: Side) -> Layer:
    """The state before the first node."""
    from optplan.ordering._kernels.ideals import Layer

    nothing = np.zeros_like(side.free)
    none = np.full(1, -1, dtype=np.int32)
    return Layer(nothing, side.free.copy(), none, np.zeros(1), np.zeros(1), np.zeros(1, dtype=np.uint64))


def _room(size: int) -> Candidates:
    """Room for that many candidates; at most half of the slots are used."""
    from optplan.ordering._kernels.ideals import Candidates

    slots = np.full(1 << (2 * size - 1).bit_length(), -1, dtype=np.int32)
    parent, node = np.empty(size, dtype=np.int32), np.empty(size, dtype=np.int32)
    return Candidates(
        parent, node, np.empty(size), np.empty(size), np.empty(size), np.empty(size, dtype=np.uint64), slots
    )


def _columns(candidates: Candidates) -> list[np.ndarray[Any, Any]]:
    """What is known of each candidate."""
    return list(candidates[:-1])


def _path(ways: list[tuple[ShortArray, ShortArray]], state: int) -> IntArray:
    """The nodes on the way to a state of the last layer."""
    nodes = np.zeros(len(ways), dtype=np.int64)
    for k in range(len(ways) - 1, -1, -1):
        parent, node = ways[k]
        nodes[k], state = node[state], int(parent[state])
    return nodes
