"""The best nodes for a given order of clusters: a shortest path through the layers."""

from __future__ import annotations

import math

from optplan.compiled import njit
from optplan.ordering._kernels.costs import Costs, Structure, arc, link
from optplan.ordering._kernels.path import EFFORT, Path, Work, at, push, refresh

WINDOW_WORK = 3000
"""Arc costs that choosing three consecutive nodes together may take; else one node at a time."""


@njit(cache=True, nogil=True)
def layer(costs: Costs, structure: Structure, path: Path, work: Work, low: int, p: int) -> int:
    """One step of the dynamic programme over node choices from place low on: the values at place p. Work done."""
    first = structure.first
    c = structure.cluster[path.nodes[p]]
    if p == low:
        before = at(path.nodes, low - 1)
        for k in range(first[c], first[c + 1]):
            work.value[k] = link(costs, before, k) + costs.ends[2, k]
        return int(first[c + 1] - first[c])
    b = structure.cluster[path.nodes[p - 1]]
    for k in range(first[c], first[c + 1]):
        best, origin = math.inf, first[b]
        for h in range(first[b], first[b + 1]):
            cost = work.value[h] + arc(costs, h, k)
            if cost < best:
                best, origin = cost, h
        work.value[k] = best + costs.ends[2, k]
        work.parent[k] = origin
    return int((first[c + 1] - first[c]) * (first[b + 1] - first[b]))


@njit(cache=True, nogil=True)
def settle(costs: Costs, structure: Structure, path: Path, work: Work, low: int, high: int) -> bool:
    """After `layer` for low..high: take over the choices if they are better than the present ones."""
    first = structure.first
    after = at(path.nodes, high + 1)
    c = structure.cluster[path.nodes[high]]
    best, chosen = math.inf, -1
    for k in range(first[c], first[c + 1]):
        cost = work.value[k] + link(costs, k, after)
        if cost < best:
            best, chosen = cost, k
    now = link(costs, at(path.nodes, low - 1), path.nodes[low]) + link(costs, path.nodes[high], after)
    now += costs.ends[2, path.nodes[low]]
    for p in range(low + 1, high + 1):
        now += path.sums[0, p]
    if best >= now - work.cost[2]:
        return False
    for p in range(high, low - 1, -1):
        path.nodes[p] = chosen
        if p > low:
            chosen = work.parent[chosen]
    return True


@njit(cache=True, nogil=True)
def choose_nodes(costs: Costs, structure: Structure, path: Path, work: Work, p: int) -> bool:
    """Choose the node at place p anew, together with its neighbours' where that is cheap."""
    low, high = max(0, p - 1), min(len(path.nodes) - 1, p + 1)
    first = structure.first
    expected = 0
    for q in range(low + 1, high + 1):
        a, b = structure.cluster[path.nodes[q - 1]], structure.cluster[path.nodes[q]]
        expected += (first[a + 1] - first[a]) * (first[b + 1] - first[b])
    if expected > WINDOW_WORK:
        low = high = p
    elif expected <= high - low:
        return False
    for q in range(low, high + 1):
        work.counters[EFFORT] += layer(costs, structure, path, work, low, q)
    if not settle(costs, structure, path, work, low, high):
        return False
    work.cost[0] = refresh(costs, structure, path, low, high)
    for q in range(low - 1, high + 2):
        push(work.queue, work.counters, structure.cluster, path.nodes, q)
    return True
