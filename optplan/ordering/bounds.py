"""A certified lower bound for ordering problems of any size."""

from __future__ import annotations

import math

import numpy as np

from optplan.domain.arrays import FloatArray, IntArray
from optplan.domain.ordering import DubinsCosts, EuclidCosts, MatrixCosts, OrderingProblem
from optplan.domain.stop import RunningStop, StopRule
from optplan.ordering.near import CLOSE, box_distances_beyond, cluster_matrix, nearest_clusters

DENSE_CLUSTERS = 1500
"""Up to this many clusters the bound comes from 1-trees, above from the two nearest neighbours of each cluster."""
ALL_ARCS = 20_000
"""Costs that no straight line bounds are looked at one by one, up to this many nodes."""
ROUNDS = 300
"""Steps of the ascent."""
SAFETY = 1e-9
"""Relative amount taken off for rounding."""


def lower_bound(problem: OrderingProblem, stop: StopRule | RunningStop | None = None) -> float:
    """No order costs less than this; infinite when there is provably none, minus infinity when nothing is known.

    Nodes are forgotten: going from cluster A to cluster B costs at least the cheapest arc between them in either
    direction. A path and its depot arcs form a spanning tree plus two depot arcs, whose least cost is raised by
    weights on clusters (Held and Karp, "The travelling-salesman problem and minimum spanning trees", 1970). Valid
    under precedence, which it ignores.

    Parameters
    ----------
    problem : of any size
    stop : its time limit and cancel end the ascent early; iterations are steps of the ascent
    """
    count = problem.clusters
    if count == 0:
        return 0.0
    first = problem.first_node[:-1]
    fixed = float(np.minimum.reduceat(problem.node_costs, first).sum())
    start = np.minimum.reduceat(problem.start_costs, first)
    end = np.minimum.reduceat(problem.end_costs, first)
    if count == 1:
        both = problem.start_costs + problem.end_costs + problem.node_costs
        return float(both.min())
    known = isinstance(problem.costs, EuclidCosts | DubinsCosts | MatrixCosts)
    if not known and problem.nodes > ALL_ARCS:
        return -math.inf
    clock = stop if isinstance(stop, RunningStop) else (stop or StopRule()).start()
    if clock.reason():
        return -math.inf
    if count <= DENSE_CLUSTERS:
        bound, size = _ascent(cluster_matrix(problem), start, end, clock)
    else:
        bound, size = _two_nearest(problem, start, end)
    bound += fixed
    return bound if math.isinf(bound) else bound - SAFETY * (abs(bound) + size)


def _depot(start: FloatArray, end: FloatArray) -> tuple[float, int, int]:
    """The cheapest way to begin with one cluster and end with another: cost, first, last."""
    a, b = np.argsort(start, kind="stable")[:2], np.argsort(end, kind="stable")[:2]
    return min((float(start[i] + end[j]), int(i), int(j)) for i in a for j in b if i != j)


def _ascent(matrix: FloatArray, start: FloatArray, end: FloatArray, clock: RunningStop) -> tuple[float, float]:
    """Best 1-tree bound over weights on clusters, and the size of the numbers summed up in it."""
    from optplan.ordering._kernels.trees import spanning_tree

    count = len(start)
    shift = np.zeros(count)
    key, origin, seen = np.zeros(count), np.zeros(count, dtype=np.int64), np.zeros(count, dtype=np.int64)
    best, size, step = -math.inf, 0.0, 0.0
    previous = np.zeros(count)
    for round_ in range(ROUNDS):
        degree: IntArray = np.zeros(count, dtype=np.int64)
        tree = spanning_tree(matrix, shift, degree, key, origin, seen)
        ends, a, b = _depot(start + shift, end + shift)
        if math.isinf(tree + ends):
            return math.inf, 0.0  # no spanning tree of finite arcs, so no path either
        degree[a] += 1
        degree[b] += 1
        bound = tree + ends - 2.0 * float(shift.sum())
        if bound > best:
            best = bound
            size = abs(tree) + abs(ends) + 2.0 * float(np.abs(shift).sum())
        excess = (degree - 2).astype(np.float64)
        if not excess.any():
            break  # the tree is a path: nothing is left to gain
        if round_ == 0:
            step = max(abs(bound), 1e-300) / count * 0.5
        elif round_ % 10 == 0:
            step *= 0.8
        # the mean of the last two directions, as Volgenant and Jonker (1982) recommend
        shift = shift + step * (0.7 * excess + 0.3 * previous)
        previous = excess
        if clock.reason(iterations=round_ + 1):
            break
    return best, size


def _two_nearest(problem: OrderingProblem, start: FloatArray, end: FloatArray) -> tuple[float, float]:
    """Half of the two cheapest arcs at every cluster, less what the two ends of the path lack."""
    near, distances = nearest_clusters(problem, CLOSE)
    two: FloatArray = np.sort(distances, axis=1)[:, :2]
    if isinstance(problem.costs, EuclidCosts | DubinsCosts):
        # clusters whose distance was not computed are no nearer than their bounding boxes
        beyond = box_distances_beyond(problem, near)
        two = np.sort(np.column_stack([two, beyond, beyond]), axis=1)[:, :2]
    ends = _depot(start, end)[0]
    if not (np.isfinite(two[:, 0]).all() and math.isfinite(ends)):
        return math.inf, 0.0
    # each path has two clusters with one neighbour only; take off the dearest second arcs
    second = np.sort(np.where(np.isfinite(two[:, 1]), two[:, 1], 0.0))
    bound = 0.5 * float(two[:, 0].sum() + second[:-2].sum()) + ends
    return bound, float(np.abs(two[np.isfinite(two)]).sum()) + abs(ends)
