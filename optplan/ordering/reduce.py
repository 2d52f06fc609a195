"""What is taken out of a problem before a solver sees it: enforced connections, and nodes that are the same."""

from __future__ import annotations

import math
from collections.abc import Callable
from dataclasses import dataclass, replace
from itertools import pairwise

import numpy as np

from optplan.domain.arrays import FloatArray, IntArray
from optplan.domain.costs import ArcCosts, ChosenCosts, DubinsCosts, EuclidCosts, MatrixCosts
from optplan.domain.enforced import arcs_between, chains, directions
from optplan.domain.errors import InputError
from optplan.domain.ordering import OrderingProblem


@dataclass(frozen=True, eq=False)
class Reduced:
    """A smaller problem with the same optimum.

    Parameters
    ----------
    problem : the smaller one
    expand : from a path (k,) of its nodes to one (m,) of the given problem's, of the same cost
    shrink : from a path of the given problem to one of the smaller, which costs no more
    """

    problem: OrderingProblem
    expand: Callable[[IntArray], IntArray]
    shrink: Callable[[IntArray], IntArray]


def reduced(problem: OrderingProblem) -> Reduced:
    """The problem without enforced connections and without duplicate nodes."""
    first = contracted(problem)
    second = distinct_nodes(first.problem)
    return Reduced(
        second.problem,
        lambda nodes: first.expand(second.expand(nodes)),
        lambda nodes: second.shrink(first.shrink(nodes)),
    )


def distinct_nodes(problem: OrderingProblem) -> Reduced:
    """The problem with one node of each group of equals, the one of least node cost.

    Under straight lines a closed stroke driven the other way round is the same node: this halves most drawings.
    """
    costs = problem.costs
    if not isinstance(costs, EuclidCosts | DubinsCosts) or problem.nodes == 0:
        return _unchanged(problem)
    ends = np.column_stack([problem.start_costs, problem.end_costs])
    # + 0.0 turns -0.0 into 0.0
    rows = np.ascontiguousarray(np.column_stack([problem.cluster, costs.exits, costs.entries, ends]) + 0.0)
    # equal rows are equal bytes, which sort faster than floats; the order of groups does not matter
    keys = rows.view(np.dtype((np.void, rows.shape[1] * rows.itemsize))).ravel()
    _, group = np.unique(keys, return_inverse=True)
    count = int(group.max()) + 1
    if count == problem.nodes:
        return _unchanged(problem)
    order = np.lexsort((np.arange(problem.nodes), problem.node_costs, group))
    original = np.sort(order[np.flatnonzero(np.diff(group[order], prepend=-1))])
    of_group = np.empty(count, dtype=np.int64)
    of_group[group[original]] = np.arange(count)
    same = of_group[group]
    smaller = _with_nodes(problem, problem.cluster[original], original, original, problem.node_costs[original])
    return Reduced(smaller, lambda nodes: original[nodes], lambda nodes: same[nodes])


def contracted(problem: OrderingProblem) -> Reduced:
    """The problem with each chain of enforced connections as one cluster.

    Its nodes are the pairs of a first and a last node between which the chain can be driven, in either direction; what
    is driven inside is the cheapest way between them, and its cost the node's.
    """
    if not len(problem.enforced):
        return _unchanged(problem)
    groups = {min(chain): chain for chain in chains(problem.cluster, problem.enforced, problem.precedence)}
    tied = {c for chain in groups.values() for c in chain}
    groups |= {c: [c] for c in range(problem.clusters) if c not in tied}
    group_of = np.empty(problem.clusters, dtype=np.int64)
    paths: list[list[int]] = []
    cluster: list[int] = []
    cost: list[float] = []
    for number, head in enumerate(sorted(groups)):
        group_of[groups[head]] = number
        ways = _ways(problem, groups[head])
        cluster += [number] * len(ways)
        paths += [way for way, _ in ways]
        cost += [value for _, value in ways]
    firsts, lasts = (np.array([path[end] for path in paths], dtype=np.int64) for end in (0, -1))
    own = np.array(cost)
    if problem.closed and len(groups) == 1:
        own = own + problem.costs.pairs(lasts, firsts)  # a path of one cluster has no arc back
    pairs = group_of[problem.precedence]
    pairs = np.unique(pairs[pairs[:, 0] != pairs[:, 1]], axis=0)
    smaller = _with_nodes(problem, np.array(cluster), firsts, lasts, own, pairs)
    size = np.array([len(groups[head]) for head in sorted(groups)])
    of_ends = {(int(a), int(b)): k for k, (a, b) in enumerate(zip(firsts, lasts, strict=True))}

    def expand(nodes: IntArray) -> IntArray:
        return np.array([node for k in nodes.tolist() for node in paths[k]], dtype=np.int64)

    def shrink(nodes: IntArray) -> IntArray:
        pieces, low, order = [], 0, nodes.tolist()
        while low < len(order):
            high = low + int(size[group_of[problem.cluster[order[low]]]])
            pieces.append(of_ends[order[low], order[high - 1]])
            low = high
        return np.array(pieces, dtype=np.int64)

    return Reduced(smaller, expand, shrink)


def _ways(problem: OrderingProblem, chain: list[int]) -> list[tuple[list[int], float]]:
    """The cheapest path of nodes through a chain for each pair of ends, in both directions, and what it costs."""
    first, own = problem.first_node, problem.node_costs
    if len(chain) == 1:
        return [([node], float(own[node])) for node in range(first[chain[0]], first[chain[0] + 1])]
    found: list[tuple[list[int], float]] = []
    allowed = directions(chain, problem.cluster, problem.enforced, problem.precedence)
    for order in (way for way, good in zip((chain, chain[::-1]), allowed, strict=True) if good):
        steps = []
        for a, b in pairwise(order):
            arcs = arcs_between(problem.cluster, problem.enforced, a, b)
            steps.append((arcs, problem.costs.pairs(arcs[:, 0], arcs[:, 1]) + own[arcs[:, 1]]))
        for start in np.unique(steps[0][0][:, 0]).tolist():
            reach = {start: ([start], float(own[start]))}
            for arcs, costs in steps:
                onward: dict[int, tuple[list[int], float]] = {}
                for (tail, head), cost in zip(arcs.tolist(), costs.tolist(), strict=True):
                    if tail in reach and reach[tail][1] + cost < onward.get(head, ([], math.inf))[1]:
                        onward[head] = ([*reach[tail][0], head], reach[tail][1] + cost)
                reach = onward
            found += reach.values()
    if not found:
        names = " - ".join(map(str, chain))
        raise InputError(f"the enforced connections of clusters {names} use arcs of infinite cost")
    return found


def _with_nodes(
    problem: OrderingProblem,
    cluster: IntArray,
    firsts: IntArray,
    lasts: IntArray,
    node_costs: FloatArray,
    precedence: IntArray | None = None,
) -> OrderingProblem:
    """The problem whose nodes are entered as `firsts` and left as `lasts` of the given one's nodes."""
    return replace(
        problem,
        cluster=cluster,
        costs=chosen_costs(problem.costs, firsts, lasts),
        start_costs=problem.start_costs[firsts],
        end_costs=problem.end_costs[lasts],
        node_costs=node_costs,
        precedence=problem.precedence if precedence is None else precedence,
        enforced=np.zeros((0, 3), dtype=np.int64),
    )


def chosen_costs(costs: ArcCosts, firsts: IntArray, lasts: IntArray) -> ArcCosts:
    """Costs of nodes that are entered as `firsts` (k,) and left as `lasts` (k,) of the given nodes."""
    if isinstance(costs, MatrixCosts):
        return MatrixCosts(costs.matrix[np.ix_(lasts, firsts)])
    if isinstance(costs, EuclidCosts | DubinsCosts):
        return replace(costs, exits=costs.exits[lasts], entries=costs.entries[firsts])
    return ChosenCosts(costs, firsts, lasts)


def _unchanged(problem: OrderingProblem) -> Reduced:
    return Reduced(problem, lambda nodes: nodes, lambda nodes: nodes)
