"""Small ordering problems, and their optimum by looking at every path."""

from __future__ import annotations

import itertools
import math
from collections.abc import Iterator
from dataclasses import dataclass
from typing import Any

import numpy as np

from optplan.domain.arrays import FloatArray
from optplan.domain.ordering import DubinsCosts, EuclidCosts, MatrixCosts, OrderingProblem


def dubins_batch(starts: FloatArray, ends: FloatArray, radius: float) -> FloatArray:
    from optplan.geometry._kernels import dubins_length

    length: Any = dubins_length
    rows = zip(starts.tolist(), ends.tolist(), strict=True)
    return np.array([length(*a, *b, radius) for a, b in rows], dtype=np.float64)


@dataclass(frozen=True, eq=False)
class Case:
    name: str
    problem: OrderingProblem
    optimum: float


def optimum(problem: OrderingProblem) -> float:
    """Least cost over all orders and all choices; shares nothing with the solvers."""
    if problem.clusters == 0:
        return 0.0
    everything = np.arange(problem.nodes)
    matrix = [problem.costs.pairs(np.full(problem.nodes, i), everything).tolist() for i in everything.tolist()]
    start, end, own = problem.start_costs.tolist(), problem.end_costs.tolist(), problem.node_costs.tolist()
    members = [np.flatnonzero(problem.cluster == c).tolist() for c in range(problem.clusters)]
    before = problem.precedence.tolist()
    best = math.inf
    for order in itertools.permutations(range(problem.clusters)):
        if any(order.index(a) > order.index(b) for a, b in before):
            continue
        # the cheapest way of reaching each node of the last cluster so far: plain, but enough to see every choice
        reach = {i: start[i] + own[i] for i in members[order[0]]}
        for c in order[1:]:
            reach = {j: min(cost + matrix[i][j] for i, cost in reach.items()) + own[j] for j in members[c]}
        best = min(best, min(cost + end[i] for i, cost in reach.items()))
    return best


def optimum_by_product(problem: OrderingProblem) -> float:
    """The same without any cleverness."""
    members = [np.flatnonzero(problem.cluster == c).tolist() for c in range(problem.clusters)]
    best = math.inf
    for order in itertools.permutations(range(problem.clusters)):
        for nodes in itertools.product(*(members[c] for c in order)):
            if not problem.faults(nodes):
                best = min(best, problem.cost_of(nodes))
    return best


def _clusters(rng: np.random.Generator, count: int, most: int) -> Any:
    return np.repeat(np.arange(count), rng.integers(1, most + 1, count))


def _costs(kind: str, rng: np.random.Generator, nodes: int) -> Any:
    if kind == "matrix":
        return MatrixCosts(rng.uniform(0, 10, (nodes, nodes)))
    if kind == "holes":
        return MatrixCosts(np.where(rng.random((nodes, nodes)) < 0.35, math.inf, rng.uniform(0, 10, (nodes, nodes))))
    if kind == "negative":
        return MatrixCosts(rng.uniform(-3, 7, (nodes, nodes)))
    if kind == "ties":
        return MatrixCosts(rng.integers(0, 3, (nodes, nodes)).astype(float))
    if kind == "euclid":
        return EuclidCosts(rng.uniform(0, 10, (nodes, 2)), rng.uniform(0, 10, (nodes, 2)))
    if kind == "euclid3d":
        return EuclidCosts(rng.uniform(0, 10, (nodes, 3)), rng.uniform(0, 10, (nodes, 3)))
    if kind == "duplicates":
        return EuclidCosts(rng.integers(0, 2, (nodes, 2)).astype(float), rng.integers(0, 2, (nodes, 2)).astype(float))
    states = [np.column_stack([rng.uniform(0, 5, (nodes, 2)), rng.uniform(-4, 4, nodes)]) for _ in range(2)]
    return DubinsCosts(states[0], states[1], 0.7, dubins_batch)


KINDS = ("matrix", "holes", "negative", "ties", "euclid", "euclid3d", "duplicates", "dubins")


def random_problem(kind: str, count: int, seed: int, *, precedence: bool, start: bool, end: bool) -> OrderingProblem:
    """A problem of that kind; with precedence, with a fixed first and last cluster, as asked."""
    rng = np.random.default_rng(seed)
    cluster = _clusters(rng, count, 4 if count <= 5 else 2)
    nodes = len(cluster)
    pairs = [(a, b) for a in range(count) for b in range(a + 1, count) if rng.random() < 0.3] if precedence else []
    names = rng.permutation(count)  # precedence need not follow the numbering
    starts, ends = rng.uniform(0, 2, nodes), rng.uniform(0, 2, nodes)
    if start:
        starts[cluster != names[0]] = math.inf
    if end:
        ends[cluster != names[-1]] = math.inf
    return OrderingProblem(
        cluster,
        _costs(kind, rng, nodes),
        starts if start or seed % 2 else np.zeros(0),
        ends if end or seed % 3 else np.zeros(0),
        np.where(rng.random(nodes) < 0.5, 0.0, rng.uniform(0, 2, nodes)),
        np.array([(names[a], names[b]) for a, b in pairs], dtype=np.int64).reshape(-1, 2),
    )


def cases() -> Iterator[Case]:
    """All kinds, sizes and combinations of conditions."""
    combinations = itertools.product(KINDS, (False, True), (False, True), (False, True))
    for seed, (kind, precedence, start, end) in enumerate(combinations):
        for count in (2, 3 + seed % 5):
            problem = random_problem(kind, count, seed, precedence=precedence, start=start, end=end)
            conditions = "".join(k for k, used in (("p", precedence), ("s", start), ("e", end)) if used)
            yield Case(f"{kind}-{count}-{conditions}", problem, optimum(problem))


def strokes(count: int, seed: int = 0) -> OrderingProblem:
    """Open strokes in a square, driven either way."""
    rng = np.random.default_rng(seed)
    a = rng.uniform(size=(count, 2))
    b = a + rng.normal(0, 0.1, (count, 2))
    exits, entries = np.stack([b, a], axis=1).reshape(-1, 2), np.stack([a, b], axis=1).reshape(-1, 2)
    return OrderingProblem(np.repeat(np.arange(count), 2), EuclidCosts(exits, entries))
