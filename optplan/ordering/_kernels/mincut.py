"""Separation of generalised subtour cuts by maximum flow."""

from __future__ import annotations

import numpy as np

from optplan.compiled import njit
from optplan.domain.arrays import FloatArray, IntArray
from optplan.ordering._kernels.maxflow import SINK_SIDE, SOURCE_SIDE, max_flow, network

VIOLATION = 1e-4
"""A flow that lacks less than this is no cut worth having."""


@njit(cache=True, nogil=True)
def subtour_sets(
    count: int,
    tails: IntArray,
    heads: IntArray,
    weights: FloatArray,
    cluster: IntArray,
    clusters: IntArray,
    root: int,
    most: int,
) -> IntArray:
    """Sets that hold a whole cluster, not the root, and that the graph leaves with a weight below 2.

    Parameters
    ----------
    count, tails, heads, weights : an undirected graph of n = `count` vertices with k edges
    cluster : (n,) of each vertex
    clusters : (c,) clusters to look at: the least cut between each and the root cluster
    root : cluster that the sets stay outside of
    most : clusters that are in so many small sets already are not looked at

    Returns
    -------
    sets : (s, n + 1) 1 for a vertex in the set, 0 outside; at the end its cluster
    """
    # all vertices of the two clusters hang on one more vertex each
    edges = len(tails)
    size = np.zeros(cluster.max() + 1, dtype=np.int64)
    for v in range(count):
        size[cluster[v]] += 1
    source, sink = count, count + 1
    extra = size.max() + size[root]
    all_tails = np.empty(edges + extra, dtype=np.int64)
    all_heads = np.empty(edges + extra, dtype=np.int64)
    all_tails[:edges], all_heads[:edges] = tails, heads
    sets = np.zeros((2 * len(clusters), count + 1), dtype=np.int64)
    found = 0
    side = np.empty(count + 2, dtype=np.int64)
    closed = np.zeros(count + 2, dtype=np.int64)
    covered = np.zeros(len(size), dtype=np.int64)
    last = np.full(len(size), -1, dtype=np.int64)
    for c in clusters:
        if covered[c] >= most:
            continue
        k = edges
        for v in range(count):
            if cluster[v] == c:
                all_tails[k], all_heads[k] = source, v
                k += 1
            elif cluster[v] == root:
                all_tails[k], all_heads[k] = v, sink
                k += 1
        net = network(count + 2, all_tails[:k], all_heads[:k])
        residual = np.zeros(2 * k)
        for a in range(k):
            amount = weights[a] if a < edges else 4.0
            residual[net.slot[a]] = amount
            residual[net.mate[net.slot[a]]] = amount if a < edges else 0.0
        if max_flow(net, residual, closed, source, sink, 2.0 - VIOLATION, side) >= 2.0 - VIOLATION:
            continue
        near, far = 0, 0
        for v in range(count):
            sets[found, v] = 1 if side[v] == SOURCE_SIDE else 0
            sets[found + 1, v] = 0 if side[v] == SINK_SIDE else 1
            near += sets[found, v]
            far += sets[found + 1, v]
        sets[found, count] = c
        sets[found + 1, count] = c
        if 2 * near < count:
            for v in range(count):
                if sets[found, v] == 1 and last[cluster[v]] != found:
                    last[cluster[v]] = found
                    covered[cluster[v]] += 1
        found += 1 if near == far else 2
    return sets[:found]


@njit(cache=True, nogil=True)
def cut_tree_sets(count: int, tails: IntArray, heads: IntArray, weights: FloatArray) -> IntArray:
    """(n - 1, n) one side of a least cut between any two of n = `count` vertices, after Gusfield (1990).

    tails, heads, weights (k,) : an undirected graph
    """
    net = network(count, tails, heads)
    parent = np.zeros(count, dtype=np.int64)
    sets = np.zeros((count - 1, count), dtype=np.int64)
    side = np.empty(count, dtype=np.int64)
    closed = np.zeros(count, dtype=np.int64)
    residual = np.empty(2 * len(tails))
    for s in range(1, count):
        for a in range(len(tails)):
            residual[net.slot[a]] = weights[a]
            residual[net.mate[net.slot[a]]] = weights[a]
        max_flow(net, residual, closed, s, parent[s], np.inf, side)
        for v in range(count):
            if side[v] == SOURCE_SIDE:
                sets[s - 1, v] = 1
                if v > s and parent[v] == parent[s]:
                    parent[v] = s
    return sets


@njit(cache=True, nogil=True)
def cheap_edges(
    matrix: FloatArray,
    places: FloatArray,
    depot: FloatArray,
    cluster: IntArray,
    price: FloatArray,
    first: IntArray,
    sets: IntArray,
    duals: FloatArray,
    first_tooth: IntArray,
    teeth: IntArray,
    limit: float,
    low: int,
    high: int,
    least: FloatArray,
    most: int,
) -> tuple[IntArray, FloatArray]:
    """Edges from the points low..high-1 to points of larger number with a reduced cost below `limit`.

    Reduced cost: cost - price[u] - price[v] + the duals of all sets that hold both ends, or one end where the two
    clusters are one of the set's teeth.

    Parameters
    ----------
    matrix, places, depot, cluster : of the undirected form
    price : (n,) what a link at a point pays
    first, sets, duals : the sets that hold point v are sets[first[v]:first[v + 1]], in rising order; duals (k,) >= 0
    first_tooth, teeth : the teeth of set k are the pairs of clusters (a m + b, a < b, of m clusters)
        teeth[first_tooth[k]:first_tooth[k + 1]]
    least : (n,) input and output: least reduced cost seen at each point
    most : stop after so many edges (the caller looks at fewer points)

    Returns
    -------
    edges (k, 2), reduced costs (k,)
    """
    nodes = depot.shape[1]
    count = len(cluster)
    clusters, none = cluster[-1] + 1, len(duals)
    edges = np.empty((most, 2), dtype=np.int64)
    reduced = np.empty(most)
    found = 0
    for u in range(low, high):
        for v in range(u + 1, count):
            if cluster[u] == cluster[v]:
                continue
            if v >= nodes:
                cost = depot[v - nodes, u]
            elif len(matrix):
                cost = matrix[u, v]
            else:
                square = 0.0
                for d in range(places.shape[1]):
                    square += (places[u, d] - places[v, d]) ** 2
                cost = np.sqrt(square)
            cost -= price[u] + price[v]
            if cost >= limit and cost >= least[u] and cost >= least[v]:
                continue
            pair = min(cluster[u], cluster[v]) * clusters + max(cluster[u], cluster[v])
            a, b = first[u], first[v]
            while a < first[u + 1] or b < first[v + 1]:
                one = sets[a] if a < first[u + 1] else none
                other = sets[b] if b < first[v + 1] else none
                k = min(one, other)
                if one == other:
                    cost += duals[k]
                else:
                    for t in range(first_tooth[k], first_tooth[k + 1]):
                        if teeth[t] == pair:
                            cost += duals[k]
                if one == k:
                    a += 1
                if other == k:
                    b += 1
            least[u] = min(least[u], cost)
            least[v] = min(least[v], cost)
            if cost < limit and found < most:
                edges[found, 0], edges[found, 1] = u, v
                reduced[found] = cost
                found += 1
    return edges[:found], reduced[:found]
