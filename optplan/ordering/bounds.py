"""A certified lower bound for ordering problems of any size, by 1-trees."""

from __future__ import annotations

import math
from typing import NamedTuple

import numpy as np

from optplan.domain.arrays import FloatArray, IntArray
from optplan.domain.ordering import DubinsCosts, EuclidCosts, MatrixCosts, OrderingProblem
from optplan.domain.stop import RunningStop, StopRule
from optplan.ordering.near import (
    CLOSE,
    EXACT_NODES,
    box_distances_beyond,
    cheapest_arcs,
    cluster_matrix,
    nearest_clusters,
)

DENSE_TERMINALS = 2500
"""Up to this many terminals the bound comes from 1-trees (50 MB a matrix), above from the nearest of each."""
ALL_ARCS = 20_000
"""Costs that no straight line bounds are looked at one by one, up to this many nodes."""
ROUNDS = 300
"""Most steps of the ascent."""
ASCENT_WORK = 4e8
"""Links looked at in the ascent, by which many terminals get fewer steps; never fewer than 60."""
SAFETY = 1e-9
"""Relative amount taken off for rounding."""


class Terminals(NamedTuple):
    """Where links between clusters can end.

    A cluster of one or two nodes has two terminals with one link each: it is entered at one and left at the other.
    A larger cluster has one terminal with two links.

    enter, leave (n,) terminal where a node is entered and left; mate (t,) the cluster's other terminal or -1.
    """

    enter: IntArray
    leave: IntArray
    mate: IntArray

    @property
    def links(self) -> IntArray:
        """(t,) links at each terminal on a path between depots."""
        return np.where(self.mate >= 0, 1, 2)


def terminals(problem: OrderingProblem) -> Terminals:
    """The terminals of the problem's clusters, in the clusters' order."""
    sizes = np.diff(problem.first_node)
    split = sizes <= 2
    if isinstance(problem.costs, EuclidCosts):
        # a point has no two sides
        same = (problem.costs.exits == problem.costs.entries).all(axis=1)
        split &= ~((sizes == 1) & same[problem.first_node[:-1]])
    counts = np.where(split, 2, 1)
    base = np.concatenate([[0], np.cumsum(counts)[:-1]])
    member = np.arange(problem.nodes) - problem.first_node[problem.cluster]
    is_split = split[problem.cluster]
    enter = base[problem.cluster] + np.where(is_split, member, 0)
    leave = base[problem.cluster] + np.where(is_split, 1 - member, 0)
    mate = np.full(int(counts.sum()), -1, dtype=np.int64)
    mate[base[split]], mate[base[split] + 1] = base[split] + 1, base[split]
    return Terminals(enter, leave, mate)


def tree_bound(problem: OrderingProblem, stop: StopRule | RunningStop | None = None) -> float:
    """No order costs less than this; infinite when there is provably none, minus infinity when nothing is known.

    Most of the nodes are forgotten: going from one cluster to another costs at least the cheapest arc between their
    terminals, in either direction. A path is a spanning tree of terminals plus two depot arcs, a closed path one plus
    a link; their least cost is raised by weights on terminals (Held and Karp, "The travelling-salesman problem and
    minimum spanning trees", 1970). Valid under precedence, which it ignores.

    Parameters
    ----------
    problem : of any size
    stop : its time limit and cancel end the ascent early; iterations are steps of the ascent
    """
    count = problem.clusters
    if count == 0:
        return 0.0
    first = problem.first_node[:-1]
    if count == 1:
        return float((problem.start_costs + problem.end_costs + problem.node_costs).min())
    known = isinstance(problem.costs, EuclidCosts | DubinsCosts | MatrixCosts)
    clock = stop if isinstance(stop, RunningStop) else (stop or StopRule()).start()
    if (not known and problem.nodes > ALL_ARCS) or clock.reason():
        return -math.inf
    ways = terminals(problem)
    size = len(ways.mate)
    start, end = np.full(size, np.inf), np.full(size, np.inf)
    np.minimum.at(start, ways.enter, problem.start_costs)
    np.minimum.at(end, ways.leave, problem.end_costs)
    if size <= DENSE_TERMINALS:
        bound, numbers = _ascent(_terminal_matrix(problem, ways), ways, start, end, clock, problem.closed)
    else:
        bound, numbers = _nearest(problem, ways, start, end)
    if problem.closed:
        bound += float(start.min() + end.min())
    bound += float(np.minimum.reduceat(problem.node_costs, first).sum())
    return bound if math.isinf(bound) else bound - SAFETY * (abs(bound) + numbers)


def _terminal_matrix(problem: OrderingProblem, ways: Terminals) -> FloatArray:
    """(t, t) no link between two terminals costs less; infinite inside a cluster."""
    lines = isinstance(problem.costs, EuclidCosts | DubinsCosts)
    if lines and problem.nodes > EXACT_NODES:
        matrix = cluster_matrix(_points(problem, ways))
    else:
        matrix = cheapest_arcs(problem, ways.enter, ways.leave)
    np.fill_diagonal(matrix, np.inf)
    split = np.flatnonzero(ways.mate >= 0)
    matrix[split, ways.mate[split]] = np.inf
    return matrix


def _points(problem: OrderingProblem, ways: Terminals) -> OrderingProblem:
    """The terminals as clusters of points: the places where their nodes are entered or left."""
    costs = problem.costs
    assert isinstance(costs, EuclidCosts | DubinsCosts)
    size = 2 if isinstance(costs, DubinsCosts) else costs.exits.shape[1]
    places = np.concatenate([costs.entries[:, :size], costs.exits[:, :size]])
    rows = np.unique(np.column_stack([np.concatenate([ways.enter, ways.leave]), places]), axis=0)
    points = rows[:, 1:]
    return OrderingProblem(rows[:, 0].astype(np.int64), EuclidCosts(points, points))


def _depot(start: FloatArray, end: FloatArray) -> tuple[float, int, int]:
    """The cheapest way to begin with one cluster and end with another: cost, first, last."""
    a, b = np.argsort(start, kind="stable")[:2], np.argsort(end, kind="stable")[:2]
    return min((float(start[i] + end[j]), int(i), int(j)) for i in a for j in b if i != j)


def _cheapest_link(matrix: FloatArray, shift: FloatArray) -> tuple[float, int, int]:
    """The cheapest link that closes a path: cost, its two terminals."""
    weights = matrix + shift + shift[:, None]
    a, b = divmod(int(weights.argmin()), len(weights))
    return float(weights[a, b]), a, b


def _ascent(
    matrix: FloatArray, ways: Terminals, start: FloatArray, end: FloatArray, clock: RunningStop, closed: bool
) -> tuple[float, float]:
    """Best 1-tree bound over weights on terminals, and the size of the numbers summed up in it."""
    from optplan.ordering._kernels.trees import spanning_tree

    count = len(start)
    links = ways.links
    shift, previous = np.zeros(count), np.zeros(count)
    key, origin, seen = np.zeros(count), np.zeros(count, dtype=np.int64), np.zeros(count, dtype=np.int64)
    best, numbers, step = -math.inf, 0.0, 0.0
    for round_ in range(int(np.clip(ASCENT_WORK / count**2, 60, ROUNDS))):
        degree: IntArray = np.zeros(count, dtype=np.int64)
        tree = spanning_tree(matrix, ways.mate, shift, degree, key, origin, seen)
        ends, a, b = _cheapest_link(matrix, shift) if closed else _depot(start + shift, end + shift)
        if math.isinf(tree + ends):
            return math.inf, 0.0  # no spanning tree of finite arcs, so no path either
        degree[a] += 1
        degree[b] += 1
        bound = tree + ends - float((links * shift).sum())
        if bound > best:
            best = bound
            numbers = abs(tree) + abs(ends) + 4.0 * float(np.abs(shift).sum())
        excess = (degree - links).astype(np.float64)
        if not excess.any():
            break  # the tree is a path: nothing is left to gain
        if round_ == 0:
            finite = matrix.min(axis=1)
            step = 0.5 * max(float(np.abs(finite[np.isfinite(finite)]).mean()), 1e-300)
        elif round_ % 10 == 0:
            step *= 0.85
        # the mean of the last two directions, as Volgenant and Jonker (1982) recommend
        shift = shift + step * (0.7 * excess + 0.3 * previous)
        previous = excess
        if clock.reason(iterations=round_ + 1):
            break
    return best, numbers


def _nearest(problem: OrderingProblem, ways: Terminals, start: FloatArray, end: FloatArray) -> tuple[float, float]:
    """Half of the cheapest links at every terminal, less what the two ends of the path lack."""
    if isinstance(problem.costs, EuclidCosts | DubinsCosts):
        points = _points(problem, ways)
        near, distances = nearest_clusters(points, CLOSE)
        # a terminal has no link to its mate; terminals that were not looked at are no nearer than their boxes
        distances = np.where(near == ways.mate[:, None], np.inf, distances)
        beyond = box_distances_beyond(points, near)
        two: FloatArray = np.sort(np.column_stack([distances, beyond, beyond]), axis=1)[:, :2]
    else:
        two = np.sort(_terminal_matrix(problem, ways), axis=1)[:, :2]
    ends = 0.0 if problem.closed else _depot(start, end)[0]
    if not math.isfinite(ends):
        return math.inf, 0.0
    two = np.where(np.isfinite(two), two, 0.0)
    single = ways.mate < 0
    # a path has two clusters with one link only; take off the dearest
    dearest = 0.0 if problem.closed else float(np.sort(np.where(single, two[:, 1], two[:, 0]))[-2:].sum())
    bound = 0.5 * (float(two[:, 0].sum() + two[single, 1].sum()) - dearest) + ends
    return bound, float(np.abs(two).sum()) + abs(ends)
