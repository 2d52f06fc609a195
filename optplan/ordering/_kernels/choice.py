"""The best nodes for a given order of clusters: a shortest path through the layers."""

from __future__ import annotations

import math

from optplan.compiled import njit
from optplan.ordering._kernels.tour import (
    ACTIVE,
    DISTANT,
    GAIN,
    ITERATION,
    NEXT,
    NODE,
    NOW,
    PREVIOUS,
    SMALLEST,
    WORK,
    Graph,
    State,
    arc,
    push,
    touch,
)

LONGEST = 200
"""Most clusters whose nodes are chosen together around a change."""


@njit(cache=True, nogil=True)
def _layers(graph: Graph, state: State, low: int, high: int, left: int, right: int) -> tuple[float, int]:
    """The least cost of the clusters low..high between nodes left and right, and the node of the last; fills parent."""
    rows, first, value, parent = state.rows, graph.first, state.value, state.parent
    data, radius, distant = graph.data, graph.radius, graph.flags[DISTANT]
    for k in range(first[low], first[low + 1]):
        value[k] = arc(distant, radius, data, left, k)
    b = low
    while b != high:
        c = rows[b, NEXT]
        for k in range(first[c], first[c + 1]):
            best, origin = math.inf, first[b]
            for h in range(first[b], first[b + 1]):
                cost = value[h] + arc(distant, radius, data, h, k)
                if cost < best:
                    best, origin = cost, h
            value[k], parent[k] = best, origin
        state.counts[WORK] += 1
        b = c
    best, chosen = math.inf, -1
    for k in range(first[high], first[high + 1]):
        cost = value[k] + arc(distant, radius, data, k, right)
        if cost < best:
            best, chosen = cost, k
    return best, chosen


@njit(cache=True, nogil=True)
def _settle(state: State, low: int, high: int, chosen: int) -> None:
    """Take over the nodes of low..high that lead to the last of them."""
    rows = state.rows
    c = high
    while True:
        if rows[c, NODE] != chosen:
            touch(state, c)
            rows[c, NODE] = chosen
        if c == low:
            return
        chosen, c = state.parent[chosen], rows[c, PREVIOUS]


@njit(cache=True, nogil=True)
def _choose(graph: Graph, state: State, low: int, high: int) -> None:
    """Choose the nodes of the clusters low..high anew, between the present nodes of the clusters around them."""
    rows, data, radius, distant = state.rows, graph.data, graph.radius, graph.flags[DISTANT]
    b, right = rows[low, PREVIOUS], rows[rows[high, NEXT], NODE]
    left = rows[b, NODE]
    now = arc(distant, radius, data, rows[high, NODE], right)
    c = low
    while b != high:
        now += arc(distant, radius, data, rows[b, NODE], rows[c, NODE])
        b, c = c, rows[c, NEXT]
    best, chosen = _layers(graph, state, low, high, left, right)
    if best < now - state.cost[GAIN]:
        state.cost[NOW] += best - now
        _settle(state, low, high, chosen)


@njit(cache=True, nogil=True)
def choose_around(graph: Graph, state: State) -> None:
    """Choose the nodes of all clusters anew that are active in this iteration, and of their neighbours."""
    rows, marks, lists, count = state.rows, state.marks, state.lists, state.counts
    longest = min(len(rows) - 1, LONGEST)
    for a in range(count[ACTIVE]):
        low = lists[ACTIVE, a]
        if marks[ACTIVE, low] != count[ITERATION]:
            continue
        high, width = low, 1
        marks[ACTIVE, low] = -1
        while width < longest and marks[ACTIVE, rows[low, PREVIOUS]] == count[ITERATION]:
            low, width = rows[low, PREVIOUS], width + 1
            marks[ACTIVE, low] = -1
        while width < longest and marks[ACTIVE, rows[high, NEXT]] == count[ITERATION]:
            high, width = rows[high, NEXT], width + 1
            marks[ACTIVE, high] = -1
        for _ in range(2):
            if width < longest:
                low, width = rows[low, PREVIOUS], width + 1
            if width < longest:
                high, width = rows[high, NEXT], width + 1
        _choose(graph, state, low, high)
    count[ACTIVE] = 0


@njit(cache=True, nogil=True)
def choose_all(graph: Graph, state: State) -> bool:
    """Choose all nodes anew, for each node of the smallest cluster; whether that made the tour better."""
    rows, first = state.rows, graph.first
    c = graph.flags[SMALLEST]
    low, high = rows[c, NEXT], rows[c, PREVIOUS]
    least, node = state.cost[NOW] - state.cost[GAIN], first[c + 1]
    for k in range(first[c], first[c + 1]):
        best, _ = _layers(graph, state, low, high, k, k)
        if best < least:
            least, node = best, k
    if node == first[c + 1]:
        return False
    _, chosen = _layers(graph, state, low, high, node, node)
    _settle(state, low, high, chosen)
    touch(state, c)
    rows[c, NODE] = node
    state.cost[NOW] = least
    for c in range(len(rows)):
        push(state, c)
    return True
