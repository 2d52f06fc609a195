"""`search`: local search under annealing, for open and closed paths, clusters and precedence alike."""

from __future__ import annotations

import heapq
import math
from dataclasses import replace
from typing import TYPE_CHECKING

import numpy as np

from optplan.domain.arrays import IntArray
from optplan.domain.ordering import OrderingProblem
from optplan.domain.stop import StopReason
from optplan.ordering.annealing import EACH, LEAST, anneal
from optplan.ordering.arrays import grouped, partners
from optplan.ordering.branched import branchable, branched
from optplan.ordering.graph import circular_graph
from optplan.ordering.local import nearest_neighbour
from optplan.ordering.method import Run
from optplan.ordering.opened import rotatable
from optplan.ordering.population import anneal_many, from_anchor

if TYPE_CHECKING:
    from optplan.ordering._kernels.tour import Graph

BRANCHING = 0.2
"""Share of the limits for branching on assignments, before anything is annealed."""
LOOKS = 100_000
"""Costs that branching looks at in about the time of an iteration."""


def search(run: Run) -> StopReason:
    """Improve a path from any time to any time; see the kernel `search` for what an iteration is.

    Starts from the given solution, else from nearest neighbours. Anneals over the iteration limit when there is one
    (the answer is then the same for the same seed), else over the time limit, else over 200 iterations a cluster. Where
    nodes are chosen, or precedence rules, and the limits are generous, anneals several times and merges what it found
    (`population`).
    Beyond 3000 nodes (1000 under Dubins) costs are computed on demand, and memory grows with the nodes.
    """
    problem = run.problem
    if not problem.closed:
        return _anneal(run, None)
    firsts = _firsts(problem)
    if len(firsts) == 1:
        return _anneal(run, firsts[0])
    stopped = StopReason.FINISHED
    for number, c in enumerate(firsts):
        stopped = _anneal_from(run, c, 1.0 / (len(firsts) - number))
        if stopped in (StopReason.CANCELLED, StopReason.TARGET):
            break
    return stopped


def _firsts(problem: OrderingProblem) -> list[int]:
    """Clusters of which one must be listed first; the smallest where that does not matter."""
    sizes = np.diff(problem.first_node)
    if rotatable(problem):
        return [int(sizes.argmin())]
    possible = np.isfinite(np.minimum.reduceat(problem.start_costs, problem.first_node[:-1]))
    possible[problem.precedence[:, 1]] = False
    firsts: list[int] = np.flatnonzero(possible).tolist()
    return firsts


def _anneal_from(run: Run, first: int, share: float) -> StopReason:
    """Search the closed paths that begin with this cluster, with a share of what is left of the limits."""
    problem = run.problem
    part = _part(run, share)
    part.problem = replace(problem, start_costs=np.where(problem.cluster == first, problem.start_costs, np.inf))
    if part.start is not None and problem.cluster[part.start[0]] != first:
        part.start = None
    stopped = _anneal(part, first)
    run.adopt(part)
    return stopped


def _part(run: Run, share: float) -> Run:
    """A share of what is left of the limits."""
    limit = run.rule.iterations
    return run.within(
        share * run.clock.remaining, None if limit is None else math.ceil(share * max(0, limit - run.iterations))
    )


def _anneal(run: Run, anchor: int | None) -> StopReason:
    """Branch on assignments, then anneal in the way that suits the problem."""
    from optplan.ordering._kernels.tour import CHOICES, MIRROR, ORDER

    given = run.start is not None
    start, stopped = _start(run)
    if start is None:
        return stopped
    start = from_anchor(run, start, anchor)
    graph = circular_graph(run.problem, anchor, run.stop)
    if not given and branchable(graph):
        start, optimal = _branched(run, graph, anchor, start)
        if optimal:
            return run.stop() or StopReason.FINISHED
    limited = run.rule.iterations is not None or math.isfinite(run.rule.seconds)
    if given or not limited:
        return anneal(run, graph, anchor, start)
    if graph.flags[ORDER] and graph.flags[MIRROR]:
        # costs that hardly tell the two directions apart: under precedence no small change turns a path
        return anneal_many(run, graph, anchor, [start, _turned(run.problem, start, anchor)])
    if graph.flags[CHOICES] or graph.flags[ORDER]:
        return anneal_many(run, graph, anchor, [start])
    return anneal(run, graph, anchor, start)


def _turned(problem: OrderingProblem, path: IntArray, anchor: int | None) -> IntArray:
    """The path backwards, as far as precedence lets it be; the anchor stays the first."""
    clusters = problem.cluster[path]
    rank = np.empty(len(path), dtype=np.int64)
    rank[clusters] = np.arange(len(path))[::-1]
    if anchor is not None:
        rank[anchor] = -1
    pairs = problem.precedence if anchor is None else problem.precedence[(problem.precedence != anchor).all(axis=1)]
    waiting = np.bincount(pairs[:, 1], minlength=len(path))
    after = grouped(pairs[:, 0], pairs[:, 1], len(path))
    ready = [(int(rank[c]), c) for c in np.flatnonzero(waiting == 0).tolist()]
    heapq.heapify(ready)
    order = []
    while ready:
        _, c = heapq.heappop(ready)
        order.append(c)
        for d in after[after[c] : after[c + 1]].tolist():
            waiting[d] -= 1
            if not waiting[d]:
                heapq.heappush(ready, (int(rank[d]), d))
    node = np.empty(len(path), dtype=np.int64)
    node[clusters] = partners(problem)[path]
    turned: IntArray = node[order]
    return turned


def _branched(run: Run, graph: Graph, anchor: int | None, start: IntArray) -> tuple[IntArray, bool]:
    """The better of the given path and that from assignments, and whether it is optimal."""
    rule = run.rule
    timed = rule.iterations is None and math.isfinite(rule.seconds)
    looks = math.inf if timed else BRANCHING * LOOKS * (rule.iterations or LEAST + EACH * run.problem.clusters)
    until = run.clock.elapsed + BRANCHING * run.clock.remaining if timed else math.inf
    depot = len(graph.first) - 2
    first = np.append(depot, start) if anchor is None else start
    tour, optimal = branched(graph, first, lambda: run.stop() or run.clock.elapsed > until, looks)
    path = tour[1:] if anchor is None else tour
    run.offer(path)
    return path, optimal


def _start(run: Run) -> tuple[IntArray | None, StopReason]:
    """The path to begin with, perhaps with infinite arcs, and why there is none."""
    if run.start is not None:
        return run.start, StopReason.FINISHED
    part = run.within(math.inf)
    stopped = nearest_neighbour(part, 1)
    start = part.nodes if len(part.nodes) else part.start
    part.iterations = 0
    run.adopt(part)
    return (None if stopped in (StopReason.CANCELLED, StopReason.TARGET) else start), stopped
