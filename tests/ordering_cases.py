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
    from optplan.geometry._kernels.dubins import dubins_length

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
    tied: dict[frozenset[int], set[tuple[int, int]]] = {}
    for _, tail, head in problem.enforced.tolist():
        pair = frozenset((int(problem.cluster[tail]), int(problem.cluster[head])))
        tied.setdefault(pair, set()).add((tail, head))
    best = math.inf
    for order in itertools.permutations(range(problem.clusters)):
        place = {c: k for k, c in enumerate(order)}
        if any(place[a] > place[b] for a, b in before):
            continue
        if any(abs(place[a] - place[b]) != 1 for a, b in map(tuple, tied)):
            continue
        for group in [[i] for i in members[order[0]]] if problem.closed else [members[order[0]]]:
            # the cheapest way of reaching each node of the last cluster so far: plain, but it sees every choice
            reach = {i: start[i] + own[i] for i in group}
            for a, b in itertools.pairwise(order):
                arcs = tied.get(frozenset((a, b)))
                reach = {
                    j: own[j]
                    + min(
                        (cost + matrix[i][j] for i, cost in reach.items() if arcs is None or (i, j) in arcs),
                        default=math.inf,
                    )
                    for j in members[b]
                }
            back = problem.closed and len(order) > 1
            best = min(best, min(cost + end[i] + (matrix[i][group[0]] if back else 0.0) for i, cost in reach.items()))
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


def random_problem(
    kind: str,
    count: int,
    seed: int,
    *,
    precedence: bool,
    start: bool,
    end: bool,
    tied: bool = False,
    closed: bool = False,
) -> OrderingProblem:
    """A problem of that kind; with precedence, a fixed first and last cluster, enforced connections, as asked."""
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
    costs = _costs(kind, rng, nodes)
    return OrderingProblem(
        cluster,
        costs,
        starts if start or (seed % 2 and not closed) else np.zeros(0),
        ends if end or (seed % 3 and not closed) else np.zeros(0),
        np.where(rng.random(nodes) < 0.5, 0.0, rng.uniform(0, 2, nodes)),
        np.array([(names[a], names[b]) for a, b in pairs], dtype=np.int64).reshape(-1, 2),
        _ties(costs, cluster, names, rng) if tied else np.zeros((0, 3), dtype=np.int64),
        closed,
    )


def _ties(costs: Any, cluster: Any, names: Any, rng: np.random.Generator) -> Any:
    """Enforced connections along `names`, an order that precedence allows: single ones and chains."""
    chosen = [int(rng.choice(np.flatnonzero(cluster == c))) for c in range(len(names))]
    rows: list[tuple[int, int, int]] = []
    for a, b in itertools.pairwise(names.tolist()):
        if rng.random() < 0.5 and math.isfinite(costs.pairs(np.array([chosen[a]]), np.array([chosen[b]]))[0]):
            link = 1 + max((row[0] for row in rows), default=-1)
            tails, heads = np.flatnonzero(cluster == a), np.flatnonzero(cluster == b)
            rows += [(link, chosen[a], chosen[b]), (link, chosen[b], chosen[a])]
            rows += [(link, int(rng.choice(tails)), int(rng.choice(heads)))]
    return np.array(rows, dtype=np.int64).reshape(-1, 3)


def cases() -> Iterator[Case]:
    """All kinds, sizes and combinations of conditions."""
    for seed, (kind, conditions) in enumerate(itertools.product(KINDS, itertools.product((False, True), repeat=5))):
        precedence, start, end, tied, closed = conditions
        count = (2, 3, 4, 5, 6, 3, 4, 5, 4, 7, 5)[seed % 11]
        problem = random_problem(
            kind, count, seed, precedence=precedence, start=start, end=end, tied=tied, closed=closed
        )
        letters = "".join(letter for letter, used in zip("psetc", conditions, strict=True) if used)
        yield Case(f"{kind}-{count}-{letters}", problem, optimum(problem))


def strokes(count: int, seed: int = 0) -> OrderingProblem:
    """Open strokes in a square, driven either way."""
    rng = np.random.default_rng(seed)
    a = rng.uniform(size=(count, 2))
    b = a + rng.normal(0, 0.1, (count, 2))
    exits, entries = np.stack([b, a], axis=1).reshape(-1, 2), np.stack([a, b], axis=1).reshape(-1, 2)
    return OrderingProblem(np.repeat(np.arange(count), 2), EuclidCosts(exits, entries))


def renamed(problem: OrderingProblem, seed: int, factor: float = 1.0) -> OrderingProblem:
    """The same problem with clusters, nodes and rules listed in another order, and all costs times a factor."""
    rng = np.random.default_rng(seed)
    names = rng.permutation(problem.clusters)  # old cluster -> new cluster
    nodes = rng.permutation(problem.nodes)
    nodes = nodes[np.argsort(names[problem.cluster[nodes]], kind="stable")]  # new node -> old node
    old = np.repeat(nodes, problem.nodes), np.tile(nodes, problem.nodes)
    ways = np.empty(problem.nodes, dtype=np.int64)
    ways[nodes] = np.arange(problem.nodes)
    enforced = problem.enforced.copy()
    enforced[:, 1:] = ways[enforced[:, 1:]]
    return OrderingProblem(
        names[problem.cluster[nodes]],
        MatrixCosts(factor * problem.costs.pairs(*old).reshape(problem.nodes, problem.nodes)),
        factor * problem.start_costs[nodes],
        factor * problem.end_costs[nodes],
        factor * problem.node_costs[nodes],
        rng.permutation(names[problem.precedence]) if len(problem.precedence) else problem.precedence,
        enforced,
        problem.closed,
    )
