"""Maximum flow and minimum cut in a directed network, after Dinic (1970)."""

from __future__ import annotations

from typing import NamedTuple

import numpy as np

from optplan.compiled import njit
from optplan.domain.arrays import FloatArray, IntArray

TOLERANCE = 1e-9
"""Residual capacities below are rounding and carry nothing."""
SOURCE_SIDE = 1
SINK_SIDE = 2


class Network(NamedTuple):
    """A directed graph of n vertices and k arcs; every arc has a mate that carries flow back.

    first (n + 1,): the slots first[v] .. first[v + 1] - 1 leave vertex v; head, mate (2k,) of a slot; slot (k,) of an
    arc.
    """

    first: IntArray
    head: IntArray
    mate: IntArray
    slot: IntArray


@njit(cache=True, nogil=True)
def network(count: int, tails: IntArray, heads: IntArray) -> Network:
    """The network of `count` vertices with the arcs tails[a] -> heads[a] (k,)."""
    arcs = len(tails)
    first = np.zeros(count + 1, dtype=np.int64)
    for a in range(arcs):
        first[tails[a] + 1] += 1
        first[heads[a] + 1] += 1
    for v in range(count):
        first[v + 1] += first[v]
    free = first[:-1].copy()
    head = np.empty(2 * arcs, dtype=np.int64)
    mate = np.empty(2 * arcs, dtype=np.int64)
    slot = np.empty(arcs, dtype=np.int64)
    for a in range(arcs):
        there = free[tails[a]]
        free[tails[a]] += 1
        back = free[heads[a]]
        free[heads[a]] += 1
        head[there], head[back] = heads[a], tails[a]
        mate[there], mate[back] = back, there
        slot[a] = there
    return Network(first, head, mate, slot)


@njit(cache=True, nogil=True)
def _levels(net: Network, residual: FloatArray, closed: IntArray, source: int, sink: int, level: IntArray) -> bool:
    """Arcs from each vertex to the sink, -1 where it cannot be reached; whether the source reaches it.

    When it does, vertices as far as the source or farther, which no shortest path uses, may be left out.
    """
    count = len(level)
    queue = np.empty(count, dtype=np.int64)
    level[:] = -1
    level[sink], queue[0] = 0, sink
    begin, end = 0, 1
    while begin < end:
        v = queue[begin]
        begin += 1
        for s in range(net.first[v], net.first[v + 1]):
            u = net.head[s]
            if level[u] < 0 and closed[u] == 0 and residual[net.mate[s]] > TOLERANCE:
                level[u] = level[v] + 1
                if u == source:
                    return True
                queue[end] = u
                end += 1
    return False


@njit(cache=True, nogil=True)
def _blocking_flow(net: Network, residual: FloatArray, source: int, sink: int, level: IntArray) -> float:
    """Fill shortest paths until none is left."""
    count = len(level)
    cursor = net.first[:-1].copy()
    walk = np.empty(count, dtype=np.int64)  # slots from the source to where we are
    total, length, v = 0.0, 0, source
    while True:
        if v == sink:
            amount, narrow = np.inf, 0
            for k in range(length):
                if residual[walk[k]] < amount:
                    amount, narrow = residual[walk[k]], k
            for k in range(length):
                residual[walk[k]] -= amount
                residual[net.mate[walk[k]]] += amount
            total += amount
            length = narrow
            v = net.head[net.mate[walk[narrow]]]
            continue
        while cursor[v] < net.first[v + 1]:
            s = cursor[v]
            if residual[s] > TOLERANCE and level[net.head[s]] == level[v] - 1:
                break
            cursor[v] += 1
        if cursor[v] < net.first[v + 1]:
            walk[length] = cursor[v]
            length += 1
            v = net.head[cursor[v]]
        elif length == 0:
            return total
        else:
            # a dead end: never enter it again
            length -= 1
            v = net.head[net.mate[walk[length]]]
            cursor[v] += 1


@njit(cache=True, nogil=True)
def max_flow(
    net: Network, residual: FloatArray, closed: IntArray, source: int, sink: int, enough: float, side: IntArray
) -> float:
    """Value of the maximum flow from source to sink, or of a flow of at least `enough` if there is one.

    Parameters
    ----------
    net : the network
    residual : (2k,) capacities at `net.slot`, 0 at their mates; becomes the residual capacities
    closed : (n,) 1 where a vertex may not be used, else 0; source and sink are open
    enough : at this value the search stops, and `side` means nothing
    side : (n,) output: `SOURCE_SIDE` for vertices that the source still reaches, `SINK_SIDE` for those that still
        reach the sink, 0 for the others: the arcs that leave the former, and those that enter the latter, are both
        minimum cuts among the open vertices
    """
    total = 0.0
    while total < enough and _levels(net, residual, closed, source, sink, side):
        total += _blocking_flow(net, residual, source, sink, side)
    if total >= enough:
        return total
    for v in range(len(side)):
        side[v] = SINK_SIDE if side[v] >= 0 else 0
    stack = np.empty(len(side), dtype=np.int64)
    stack[0], side[source] = source, SOURCE_SIDE
    length = 1
    while length:
        length -= 1
        v = stack[length]
        for s in range(net.first[v], net.first[v + 1]):
            u = net.head[s]
            if side[u] == 0 and closed[u] == 0 and residual[s] > TOLERANCE:
                side[u] = SOURCE_SIDE
                stack[length] = u
                length += 1
    return total
