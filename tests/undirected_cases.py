"""Small ordering problems without a direction, and their optimum by looking at every order."""

from __future__ import annotations

import itertools
import math

import numpy as np

from optplan.domain.ordering import EuclidCosts, MatrixCosts, OrderingProblem
from tests.ordering_cases import optimum

KINDS = ("lines", "matrix", "holes", "ties")


def random_undirected(kind: str, count: int, seed: int, *, closed: bool) -> OrderingProblem:
    """Lines between open strokes, closed ones and both in one cluster, or a symmetric matrix."""
    rng = np.random.default_rng(seed)
    sizes = rng.integers(1, 4 if count < 6 else 5, count)
    if kind == "lines":
        cluster, entries, exits = [], [], []
        for c, size in enumerate(sizes.tolist()):
            points = rng.uniform(0, 10, (size, 2))
            if open_stroke := bool(rng.random() < 0.5):
                ends = rng.uniform(0, 10, (2, 2))
                cluster += [c, c]
                entries += list(ends)
                exits += list(ends[::-1])
            if not open_stroke or rng.random() < 0.3:
                cluster += [c] * size
                entries += list(points)
                exits += list(points)
        costs: EuclidCosts | MatrixCosts = EuclidCosts(np.array(exits), np.array(entries))
        clusters = np.array(cluster)
        own = np.zeros(len(clusters))
    else:
        clusters = np.repeat(np.arange(count), sizes)
        shape = (len(clusters), len(clusters))
        matrix = rng.integers(0, 3, shape).astype(float) if kind == "ties" else rng.uniform(0, 10, shape)
        matrix = matrix + matrix.T
        if kind == "holes":
            holes = rng.random(shape) < 0.2
            matrix[holes | holes.T] = math.inf
        costs = MatrixCosts(matrix)
        own = rng.uniform(-1, 2, len(clusters))
    start, end = np.zeros(len(clusters)), np.zeros(len(clusters))
    if not closed and seed % 3:
        start, end = rng.uniform(0, 2, len(clusters)), rng.uniform(0, 2, len(clusters))
        if seed % 3 == 2:
            start[clusters != rng.integers(count)] = math.inf
    return OrderingProblem(clusters, costs, start, end, own, closed=closed)


def tour_optimum(problem: OrderingProblem) -> float:
    """Least cost of a path, or of a closed tour; shares nothing with the solvers."""
    if not problem.closed:
        return optimum(problem)
    everything = np.arange(problem.nodes)
    matrix = [problem.costs.pairs(np.full(problem.nodes, i), everything).tolist() for i in everything.tolist()]
    own = problem.node_costs.tolist()
    members = [np.flatnonzero(problem.cluster == c).tolist() for c in range(problem.clusters)]
    best = math.inf
    for first in members[0]:
        for order in itertools.permutations(range(1, problem.clusters)):
            reach = {first: own[first]}
            for c in order:
                reach = {j: min(cost + matrix[i][j] for i, cost in reach.items()) + own[j] for j in members[c]}
            best = min(best, min(cost + matrix[i][first] for i, cost in reach.items()))
    return best
