"""How far clusters are apart: never more than any arc between them costs."""

from __future__ import annotations

import numpy as np

from optplan.domain.arrays import FloatArray, IntArray
from optplan.domain.ordering import DubinsCosts, EuclidCosts, OrderingProblem

EXACT_NODES = 1000
"""Up to this many nodes all arcs are looked at, for any costs."""
CLOSE = 40
"""Clusters of which the exact distance is computed; of others, that between bounding boxes."""
_ROWS = 256


def cluster_matrix(problem: OrderingProblem) -> FloatArray:
    """(m, m) no arc between two clusters, in either direction, costs less; infinite on the diagonal.

    Exact for matrices and up to 1000 nodes. Beyond that straight lines: exact between close clusters, from bounding
    boxes between others. Memory grows with the square of the number of clusters.
    """
    count = problem.clusters
    if _places(problem) is None or problem.nodes <= EXACT_NODES:
        matrix = _from_arcs(problem)
    else:
        matrix = np.empty((count, count))
        close, distances = nearest_clusters(problem, CLOSE)
        for low in range(0, count, _ROWS):
            matrix[low : low + _ROWS] = _box_distances(problem, low, low + _ROWS)
        np.put_along_axis(matrix, close, distances, axis=1)
        # close is no symmetric relation, but both entries are valid: keep the larger
        matrix = np.maximum(matrix, matrix.T)
    np.fill_diagonal(matrix, np.inf)
    return matrix


def nearest_clusters(problem: OrderingProblem, wanted: int) -> tuple[IntArray, FloatArray]:
    """(m, k) the clusters nearest to each cluster, nearest first, and their distances; k = min(wanted, m - 1).

    Exact for matrices and up to 1000 nodes; else among the 3 k nearest bounding boxes.
    """
    count = problem.clusters
    wanted = min(wanted, count - 1)
    places = _places(problem)
    if places is None or problem.nodes <= EXACT_NODES:
        matrix = _from_arcs(problem)
        np.fill_diagonal(matrix, np.inf)
        near = np.argsort(matrix, axis=1, kind="stable")[:, :wanted].astype(np.int64)
        return near, np.take_along_axis(matrix, near, axis=1)
    from optplan.ordering._kernels.construct import set_distances

    exits, entries = places
    pool = min(3 * wanted, count - 1)
    candidates = np.empty((count, pool), dtype=np.int64)
    for low in range(0, count, _ROWS):
        boxes = _box_distances(problem, low, low + _ROWS)
        rows = np.arange(len(boxes))
        boxes[rows, rows + low] = np.inf
        candidates[low : low + _ROWS] = np.argpartition(boxes, pool - 1, axis=1)[:, :pool]
    candidates.sort(axis=1)
    pairs = np.column_stack([np.repeat(np.arange(count), pool), candidates.ravel()])
    # each pair once, whichever side asked for it
    unique, back = np.unique(np.sort(pairs, axis=1), axis=0, return_inverse=True)
    distances = set_distances(exits, entries, problem.first_node.astype(np.int64), unique)[back.ravel()]
    distances = distances.reshape(count, pool)
    order = np.argsort(distances, axis=1, kind="stable")[:, :wanted]
    return np.take_along_axis(candidates, order, axis=1), np.take_along_axis(distances, order, axis=1)


def box_distances_beyond(problem: OrderingProblem, near: IntArray) -> FloatArray:
    """(m,) distance from each cluster to the nearest bounding box of a cluster that is not in its row of `near`."""
    count = problem.clusters
    result = np.full(count, np.inf)
    for low in range(0, count, _ROWS):
        boxes = _box_distances(problem, low, low + _ROWS)
        rows = np.arange(len(boxes))
        boxes[rows, rows + low] = np.inf
        np.put_along_axis(boxes, near[low : low + _ROWS], np.inf, axis=1)
        result[low : low + _ROWS] = boxes.min(axis=1)
    return result


def _places(problem: OrderingProblem) -> tuple[FloatArray, FloatArray] | None:
    """Exits and entries as points, when straight lines bound the costs."""
    costs = problem.costs
    if isinstance(costs, EuclidCosts):
        return costs.exits, costs.entries
    if isinstance(costs, DubinsCosts):
        return np.ascontiguousarray(costs.exits[:, :2]), np.ascontiguousarray(costs.entries[:, :2])
    return None


def _box_distances(problem: OrderingProblem, low: int, high: int) -> FloatArray:
    """(high - low, m) distances between the bounding boxes of clusters low..high-1 and all."""
    places = _places(problem)
    assert places is not None
    starts = problem.first_node[:-1]
    lower = np.minimum(*(np.minimum.reduceat(p, starts, axis=0) for p in places))
    upper = np.maximum(*(np.maximum.reduceat(p, starts, axis=0) for p in places))
    square = np.zeros((len(lower[low:high]), len(lower)))
    for k in range(lower.shape[1]):
        gap = np.maximum(lower[None, :, k] - upper[low:high, None, k], lower[low:high, None, k] - upper[None, :, k])
        square += np.maximum(gap, 0.0) ** 2
    distances: FloatArray = np.sqrt(square)
    return distances


def _from_arcs(problem: OrderingProblem) -> FloatArray:
    """(m, m) the cheapest arc between two clusters in either direction, from all arcs."""
    starts = problem.first_node[:-1]
    count = problem.nodes
    heads = np.arange(count)
    least = np.full((problem.clusters, problem.clusters), np.inf)
    for i in range(count):
        arcs = problem.costs.pairs(np.full(count, i), heads)
        c = problem.cluster[i]
        least[c] = np.minimum(least[c], np.minimum.reduceat(arcs, starts))
    both: FloatArray = np.minimum(least, least.T)
    return both
