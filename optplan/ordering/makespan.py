"""Several paths through all clusters, of which the longest is to be short."""

from __future__ import annotations

from collections.abc import Callable
from typing import NamedTuple

import numpy as np

from optplan.domain.arrays import FloatArray, IntArray
from optplan.domain.ordering import MatrixCosts, OrderingProblem
from optplan.domain.stop import StopRule
from optplan.ordering import solve
from optplan.ordering.arrays import dense_costs
from optplan.ordering.history import COLD, HOT, SLICE

COOLINGS, ENDLESS = 4, 10_000
LEAST, EACH = 100_000, 6_000


class Shares(NamedTuple):
    """Who does what."""

    paths: tuple[IntArray, ...]
    """nodes of each path in order; an empty one stays idle"""
    longest: float
    """arcs and work of the longest path"""
    bound: float
    """no division has a longest path that is shorter; minus infinity when nothing is proved"""


def shared(
    problem: OrderingProblem,
    work: FloatArray,
    twin: IntArray,
    count: int,
    rule: StopRule,
    seed: int,
    progress: Callable[[float], None],
) -> Shares:
    """Clusters divided among so many paths.

    The bound: any division is a path with count - 1 breaks that cost nothing, so that what all paths cost together is
    at least what the best such path does, which is bounded as any order is; the longest is at least the mean. And it
    is at least as long as the work of any one cluster.

    Parameters
    ----------
    problem : without precedence and enforced connections; its start costs are those of every path
    work : (n,) of each node, in the unit of the costs
    twin : (n,) the node that drives the same cluster the other way round, -1 for none
    count : of the paths, >= 1
    rule : half of the time goes into the bound
    """
    with_breaks = _with_breaks(problem, count - 1)
    clock = rule.start()
    half = StopRule(rule.seconds / 2, rule.iterations, cancelled=rule.cancelled)
    found = solve(with_breaks, "auto", half, seed)
    least = np.full(problem.clusters, np.inf)
    np.minimum.at(least, problem.cluster, work)
    bound = max((found.bound + float(least.sum())) / count, float(least.max(initial=0.0)))
    order = np.concatenate([[problem.nodes + count - 1], found.nodes])
    best = _annealed(with_breaks, work, twin, order, count, rule, clock.elapsed, seed, progress)
    parts = np.split(best, np.flatnonzero(best >= problem.nodes))
    paths = tuple(part[part < problem.nodes] for part in parts if len(part) and part[0] >= problem.nodes)
    costs, start = dense_costs(problem), problem.start_costs
    lengths = [_length(path, work, costs, start) for path in paths]
    longest = max(lengths, default=0.0)
    return Shares(paths, longest, min(bound, longest))


def _with_breaks(problem: OrderingProblem, breaks: int) -> OrderingProblem:
    """The same with clusters of one node each that cost nothing to come to, and the start's costs to leave."""
    n = problem.nodes
    costs = np.zeros((n + breaks, n + breaks))
    costs[:n, :n] = dense_costs(problem)
    start = problem.start_costs if len(problem.start_costs) else np.zeros(n)
    costs[n:, :n] = start
    cluster = np.concatenate([problem.cluster, problem.clusters + np.arange(breaks)])
    begin = np.concatenate([start, np.zeros(breaks)])
    return OrderingProblem(cluster, MatrixCosts(costs), start_costs=begin)


def _annealed(
    problem: OrderingProblem,
    work: FloatArray,
    twin: IntArray,
    order: IntArray,
    count: int,
    rule: StopRule,
    spent: float,
    seed: int,
    progress: Callable[[float], None],
) -> IntArray:
    """The order with breaks, annealed; a break more than the problem has stands at its beginning."""
    from optplan.ordering._kernels.makespan import TOTAL, anneal_makespan, longest

    nodes, breaks = problem.nodes + 1, problem.nodes - (count - 1)
    costs = np.zeros((nodes, nodes))
    costs[:-1, :-1] = dense_costs(problem)
    costs[-1, :-1] = problem.start_costs
    cluster = np.append(problem.cluster, problem.clusters)
    whole = np.concatenate([work, np.zeros(count)])
    turned = np.concatenate([twin, np.arange(breaks, nodes)])
    members = np.argsort(cluster, kind="stable")
    first = np.searchsorted(cluster[members], np.arange(problem.clusters + 2))
    best = np.array(order, dtype=np.int64)
    most, total = longest(best, whole, costs, breaks)
    known = most + TOTAL * total
    random = np.array([seed], dtype=np.uint64)
    arcs = costs[best[:-1], best[1:]]
    mean = max(float(arcs[arcs > 0].mean()) if (arcs > 0).any() else 0.0, 1e-6)
    slices = -(-(LEAST + EACH * len(order)) // SLICE)
    limited = np.isfinite(rule.seconds)
    clock = StopRule(max(rule.seconds - spent, 0.05) if limited else rule.seconds, cancelled=rule.cancelled).start()
    for cooling in range(ENDLESS if limited else COOLINGS):
        here, value = best.copy(), known
        for part in range(slices):
            hot, cold = (3 * HOT * mean * (COLD / HOT) ** ((part + k) / slices) for k in (0, 1))
            value, known = anneal_makespan(
                here,
                best,
                cluster,
                turned,
                first,
                members,
                whole,
                costs,
                breaks,
                value,
                known,
                hot,
                cold,
                SLICE,
                random,
            )
            if clock.reason() is not None:
                return best
        progress(min(1.0, (cooling + 1) / COOLINGS))
    return best


def _length(path: IntArray, work: FloatArray, costs: FloatArray, start: FloatArray) -> float:
    if len(path) == 0:
        return 0.0
    begin = float(start[path[0]]) if len(start) else 0.0
    return begin + float(costs[path[:-1], path[1:]].sum() + work[path].sum())
