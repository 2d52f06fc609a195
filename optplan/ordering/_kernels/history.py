"""Annealing of a path whose costs depend on what has been done before, in compiled code."""

from __future__ import annotations

import math

import numpy as np
import numpy.typing as npt

from optplan.compiled import njit
from optplan.domain.arrays import FloatArray, IntArray
from optplan.ordering._kernels.tour import draw

BITS = 1 << 30


@njit(cache=True, nogil=True)
def total(
    order: IntArray,
    cluster: IntArray,
    costs: FloatArray,
    start: FloatArray,
    end: FloatArray,
    on_node: FloatArray,
    on_arc: FloatArray,
    weight: float,
    must: IntArray,
) -> float:
    """Cost of an order (m,) of nodes: arcs, and `weight` for what nodes and arcs meet of clusters done before them.

    on_node (n, m), on_arc (n, n, m): what each meets of each cluster. must (k, 2): clusters in their order; an order
    against it, like an arc of infinite cost, costs infinitely much.
    """
    m = len(order)
    rank = np.empty(m, dtype=np.int64)
    for i in range(m):
        rank[cluster[order[i]]] = i
    for k in range(len(must)):
        if rank[must[k, 0]] > rank[must[k, 1]]:
            return math.inf
    found = start[order[0]] + end[order[m - 1]]
    met = 0.0
    for i in range(m):
        here = order[i]
        for j in range(i):
            met += on_node[here, cluster[order[j]]]
        if i > 0:
            last = order[i - 1]
            found += costs[last, here]
            for j in range(i):
                met += on_arc[last, here, cluster[order[j]]]
    return float(found + weight * met)


@njit(cache=True, nogil=True)
def propose(
    order: IntArray,
    tried: IntArray,
    cluster: IntArray,
    twin: IntArray,
    first: IntArray,
    members: IntArray,
    random: npt.NDArray[np.uint64],
) -> bool:
    """Write a neighbour of an order to `tried`; False when a piece cannot be turned round.

    Moves: a piece elsewhere, perhaps turned round, a piece turned round where it is, another node of a cluster. twin
    (n,): the node that drives a cluster the other way round, or -1; the nodes of cluster c are
    members[first[c]:first[c + 1]].
    """
    m = len(order)
    kind = draw(random, 10)
    for i in range(m):
        tried[i] = order[i]
    good = True
    if kind < 3 or m < 3:
        i = draw(random, m)
        c = cluster[order[i]]
        tried[i] = members[first[c] + draw(random, first[c + 1] - first[c])]
    elif kind < 5:
        i = draw(random, m)
        j = draw(random, m)
        if i > j:
            i, j = j, i
        for k in range(i, j + 1):
            tried[k] = twin[order[j - (k - i)]]
            good = good and tried[k] >= 0
    else:
        size = 1 + draw(random, 1 + draw(random, min(m - 1, 8)))
        i = draw(random, m - size + 1)
        to = draw(random, m - size + 1)
        turned = draw(random, 2) == 0
        at = 0
        rest = 0
        while at < m:
            if at == to:
                for k in range(size):
                    node = twin[order[i + size - 1 - k]] if turned else order[i + k]
                    good = good and node >= 0
                    tried[at] = node
                    at += 1
                if at >= m:
                    break
            if rest == i:
                rest += size
            tried[at] = order[rest]
            at += 1
            rest += 1
    return good


@njit(cache=True, nogil=True)
def anneal(
    order: IntArray,
    best: IntArray,
    cluster: IntArray,
    twin: IntArray,
    first: IntArray,
    members: IntArray,
    costs: FloatArray,
    start: FloatArray,
    end: FloatArray,
    on_node: FloatArray,
    on_arc: FloatArray,
    weight: float,
    must: IntArray,
    value: float,
    known: float,
    hot: float,
    cold: float,
    steps: int,
    random: npt.NDArray[np.uint64],
) -> tuple[float, float]:
    """So many steps from `order`, which is changed, as is `best`; returns the costs of both. See `propose`."""
    m = len(order)
    tried = np.empty(m, dtype=np.int64)
    for step in range(steps):
        heat = hot * (cold / hot) ** (step / steps)
        good = propose(order, tried, cluster, twin, first, members, random)
        if not good:
            continue
        new = total(tried, cluster, costs, start, end, on_node, on_arc, weight, must)
        if new <= value or (new < math.inf and draw(random, BITS) / BITS < math.exp((value - new) / heat)):
            value = new
            for i in range(m):
                order[i] = tried[i]
            if value < known - 1e-9:
                known = value
                for i in range(m):
                    best[i] = order[i]
    return value, known
