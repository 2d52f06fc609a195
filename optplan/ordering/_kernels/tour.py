"""A circular tour of clusters as a linked list with order labels: the state that the search changes and takes back.

One cluster, the anchor, is where the order begins: the depot of an open path, the first cluster of a closed one.
Labels grow along the tour from the anchor's 0, so that which of two clusters comes first is one comparison.
"""

from __future__ import annotations

import math
from typing import NamedTuple

import numpy as np
import numpy.typing as npt

from optplan.compiled import njit
from optplan.domain.arrays import FloatArray, IntArray
from optplan.geometry._kernels.dubins import dubins_length


class Graph(NamedTuple):
    """What is to be ordered.

    data holds the arc costs (n, n), node costs included, less prices that add up to `offset` in every tour; or, when
    flags[DISTANT] is 1, where nodes are (n, 2 d + 4): where a node is entered and left, its cost as the first and as
    the last node, its own cost, and 0 for a node, 1 for one of the anchor, 2 for a depot. Then radius is that of Dubins
    paths, 0 for straight lines. Infinite costs are large penalties: a search may pass through an impossible order on
    its way to a possible one.

    first (m + 1,) nodes of each cluster; near (2, m, k) clusters that are good successors and good predecessors of
    each, best first, then -1; the direct predecessors of cluster c are before[before[c]:before[c + 1]], its
    successors after[after[c]:...]; partner (n,) the node that replaces one whose piece of tour is reversed.

    flags (6,): whether costs are computed on demand; EXACT when reversing a piece leaves its inner cost, ROUGHLY when
    it changes it little; whether there is precedence; the anchor; the smallest cluster; how many arcs a choice of all
    nodes looks at (0: there is nothing to choose).

    Few arrays, because numba counts references to each of them at each call.
    """

    offset: float
    radius: float
    data: FloatArray
    first: IntArray
    near: IntArray
    before: IntArray
    after: IntArray
    partner: IntArray
    flags: IntArray


class State(NamedTuple):
    """The tour and what is remembered between two slices.

    rows (m, 4): next, previous, node, label of each cluster; next is -1 while it is out of the tour. saved (m, 4): rows
    as they were when the iteration began. best (m, 2): next and node in the best tour. lists (5, m): clusters changed
    in this iteration, active in it, in the queue (a ring), out of the tour, changed since the best tour was saved;
    counts (9,) begins with their lengths. marks (5, m): for the first two the last iteration in which a cluster was put
    there, for the others whether it is in there. value, parent (n,): of the dynamic programme. cost (4,): of the tour
    now, before the iteration, of the best; the smallest gain that counts.
    """

    rows: IntArray
    saved: IntArray
    best: IntArray
    marks: IntArray
    lists: IntArray
    value: FloatArray
    parent: IntArray
    counts: IntArray
    cost: FloatArray
    random: npt.NDArray[np.uint64]


NEXT, PREVIOUS, NODE, LABEL = 0, 1, 2, 3
DISTANT, MIRROR, ORDER, ANCHOR, SMALLEST, CHOICES = 0, 1, 2, 3, 4, 5
EXACT, ROUGHLY = 1, 2
CHANGED, ACTIVE, QUEUE, REMOVED, DIRTY = 0, 1, 2, 3, 4
HEAD, ITERATION, FINISHED, WORK = 5, 6, 7, 8
NOW, BEFORE, BEST, GAIN = 0, 1, 2, 3
END = 2**62
"""Label of the anchor seen from the end of the tour."""


@njit(cache=True, nogil=True)
def _distance(radius: float, data: FloatArray, i: int, j: int) -> float:
    """Cost of going from node i to node j, computed from where they are."""
    size = data.shape[1] - 4
    extra = data[j, size + 2]
    if data[j, size + 3] > 0.0:
        extra += data[i, size + 1]
        if data[j, size + 3] > 1.0:
            return float(extra)
    if data[i, size + 3] > 1.0:
        return float(data[j, size] + extra)
    half = size // 2
    if radius > 0.0:
        extra += dubins_length(data[i, 3], data[i, 4], data[i, 5], data[j, 0], data[j, 1], data[j, 2], radius)
        return float(extra)
    square = 0.0
    for k in range(half):
        step = data[i, half + k] - data[j, k]
        square += step * step
    return float(extra + math.sqrt(square))


@njit(cache=True, nogil=True)
def arc(distant: int, radius: float, data: FloatArray, i: int, j: int) -> float:
    """Cost of going from node i to node j and of node j."""
    if distant == 0:
        return float(data[i, j])
    return _distance(radius, data, i, j)


@njit(cache=True, nogil=True)
def total(graph: Graph, rows: IntArray) -> float:
    """Cost of the tour."""
    cost = 0.0
    for c in range(len(rows)):
        cost += arc(graph.flags[DISTANT], graph.radius, graph.data, rows[c, NODE], rows[rows[c, NEXT], NODE])
    return cost


# a signature of its own: numba would compile one for each number written out
@njit("int64(uint64[::1], int64)", cache=True, nogil=True)
def draw(random: npt.NDArray[np.uint64], bound: int) -> int:
    """A number in 0..bound-1 (splitmix64)."""
    random[0] += np.uint64(0x9E3779B97F4A7C15)
    z = random[0]
    z = (z ^ (z >> np.uint64(30))) * np.uint64(0xBF58476D1CE4E5B9)
    z = (z ^ (z >> np.uint64(27))) * np.uint64(0x94D049BB133111EB)
    z = z ^ (z >> np.uint64(31))
    return int(np.int64((z >> np.uint64(32)) * np.uint64(bound) >> np.uint64(32)))


@njit(cache=True, nogil=True)
def touch(state: State, c: int) -> None:
    """Keep the row of cluster c, so that this iteration can be taken back."""
    count, marks = state.counts, state.marks
    if marks[CHANGED, c] != count[ITERATION]:
        marks[CHANGED, c] = count[ITERATION]
        for k in range(4):
            state.saved[c, k] = state.rows[c, k]
        state.lists[CHANGED, count[CHANGED]] = c
        count[CHANGED] += 1


@njit(cache=True, nogil=True)
def push(state: State, c: int) -> None:
    """Look at cluster c again."""
    count, marks, lists = state.counts, state.marks, state.lists
    if marks[ACTIVE, c] != count[ITERATION]:
        marks[ACTIVE, c] = count[ITERATION]
        lists[ACTIVE, count[ACTIVE]] = c
        count[ACTIVE] += 1
    if marks[QUEUE, c] == 0:
        marks[QUEUE, c] = 1
        size = lists.shape[1]
        place = count[HEAD] + count[QUEUE]
        lists[QUEUE, place - size if place >= size else place] = c
        count[QUEUE] += 1


@njit(cache=True, nogil=True)
def renumber(graph: Graph, state: State) -> None:
    """Spread the labels evenly."""
    rows = state.rows
    anchor = graph.flags[ANCHOR]
    step = END // (len(rows) + 1)
    label = step
    c = rows[anchor, NEXT]
    while c != anchor:
        touch(state, c)
        rows[c, LABEL] = label
        label += step
        c = rows[c, NEXT]


@njit(cache=True, nogil=True)
def relabel(graph: Graph, state: State, first: int, last: int, size: int) -> None:
    """New labels for the linked piece first..last of that size, between those of the clusters around it."""
    rows = state.rows
    low = rows[rows[first, PREVIOUS], LABEL]
    after = rows[last, NEXT]
    high = END if after == graph.flags[ANCHOR] else rows[after, LABEL]
    step = (high - low) // (size + 1)
    if step == 0:
        renumber(graph, state)
        return
    c = first
    while True:
        low += step
        rows[c, LABEL] = low
        if c == last:
            return
        c = rows[c, NEXT]


@njit(cache=True, nogil=True)
def take_back(state: State) -> None:
    """Undo this iteration."""
    count, rows, saved = state.counts, state.rows, state.saved
    for a in range(count[CHANGED]):
        c = state.lists[CHANGED, a]
        for k in range(4):
            rows[c, k] = saved[c, k]
    state.cost[NOW] = state.cost[BEFORE]


@njit(cache=True, nogil=True)
def keep(state: State) -> None:
    """Accept this iteration; save the tour when it is the best."""
    count, marks, lists = state.counts, state.marks, state.lists
    for a in range(count[CHANGED]):
        c = lists[CHANGED, a]
        if marks[DIRTY, c] == 0:
            marks[DIRTY, c] = 1
            lists[DIRTY, count[DIRTY]] = c
            count[DIRTY] += 1
    if state.cost[NOW] < state.cost[BEST] - state.cost[GAIN]:
        state.cost[BEST] = state.cost[NOW]
        for a in range(count[DIRTY]):
            c = lists[DIRTY, a]
            marks[DIRTY, c] = 0
            state.best[c, 0] = state.rows[c, NEXT]
            state.best[c, 1] = state.rows[c, NODE]
        count[DIRTY] = 0
    state.cost[BEFORE] = state.cost[NOW]
