"""`local`: a path by nearest neighbours, and its improvement by local search."""

from __future__ import annotations

import math

import numpy as np

from optplan.domain.arrays import IntArray
from optplan.domain.ordering import OrderingProblem
from optplan.domain.stop import StopReason
from optplan.ordering.arrays import kernel_costs, kernel_structure
from optplan.ordering.method import Run

ITERATIONS_EACH = 50
"""Perturbations for each cluster when nothing else ends the search, but at least 2000 and at most MOST."""
MOST = 6_000
MOST_SLICES = 300
"""Slices of work after which the search ends when nothing else ends it: some 10 to 20 s. Counted in arc costs, not in
seconds, so that the same seed gives the same path everywhere."""
SLICE = {0: 500_000, 1: 500_000, 2: 15_000}
"""Arc costs between two looks at the stop rule, by kind of cost: at most some 0.05 s."""
NN_SLICE = 2_000_000
"""Arc costs of nearest neighbours between two looks at the stop rule."""
NN_WORK = 20_000_000
"""Arc costs spent on trying several first clusters."""
SWEEP_WORK = 40_000_000
"""Most arc costs of one choice of all nodes."""
EFFORT = {0: 1, 1: 1, 2: 30}
"""How many times an arc cost counts, by kind: Dubins paths take longer than straight lines."""


def nearest_neighbour(run: Run) -> StopReason:
    """Nearest feasible neighbour. One iteration is one first cluster tried; the best path is kept."""
    from optplan.ordering._kernels.construct import nearest

    problem = run.problem
    costs = kernel_costs(problem)
    structure = kernel_structure(problem, neighbours=0)
    count = problem.clusters
    first = problem.first_node
    waiting = np.diff(structure.before[: count + 1])
    may_end = np.logical_or.reduceat(np.isfinite(problem.end_costs), first[:-1]).astype(np.int64)
    steps = max(1, NN_SLICE // EFFORT[costs.kind] // problem.nodes)
    for c in _first_clusters(problem, waiting, costs.kind):
        if (stop := run.stop()) and (len(run.nodes) or stop is StopReason.CANCELLED):
            return stop
        own = np.arange(first[c], first[c + 1])
        nodes = np.zeros(count, dtype=np.int64)
        nodes[0] = own[np.argmin(costs.ends[0, own] + costs.ends[2, own])]
        left = waiting.copy()
        left[structure.after[structure.after[c] : structure.after[c + 1]]] -= 1
        alive = np.delete(np.arange(count), c)
        alive = np.append(alive, c)
        done = 1
        while done < count:
            done = nearest(costs, structure, may_end, nodes, left, alive, done, steps)
            # an unfinished path is worth nothing: only a cancel interrupts it
            if run.rule.cancelled is not None and run.rule.cancelled():
                return StopReason.CANCELLED
        # the first node was chosen without knowing the second
        onward = problem.costs.pairs(own, np.full(len(own), nodes[1]))
        nodes[0] = own[np.argmin(problem.start_costs[own] + problem.node_costs[own] + onward)]
        run.iterations += 1
        run.offer(nodes)
        run.start = nodes if run.start is None else run.start
    return run.stop() or StopReason.FINISHED


def _first_clusters(problem: OrderingProblem, waiting: IntArray, kind: int) -> list[int]:
    """Clusters to begin with: those of least cost from the depot, as many as are cheap to try."""
    entry = np.minimum.reduceat(problem.start_costs + problem.node_costs, problem.first_node[:-1])
    ready = np.flatnonzero(waiting == 0)
    if np.isfinite(entry[ready]).any():
        ready = ready[np.isfinite(entry[ready])]
    ready = ready[entry[ready] <= entry[ready].min()]
    work = problem.nodes * problem.clusters * EFFORT[kind]
    tries = int(np.clip(2 * NN_WORK / work, 1, len(ready)))
    return [int(c) for c in ready[np.linspace(0, len(ready) - 1, tries).astype(np.int64)]]


def local_search(run: Run) -> StopReason:
    """Descent by 2-opt, or-opt and node choice, then perturbation; see the kernel `search` for what an iteration is.

    Starts from the given solution, else from nearest neighbours. Without limits of its own it ends after 50
    iterations for each cluster, at least 2000 and at most 6000.
    """
    from optplan.ordering._kernels.path import FINISHED, ITERATIONS, SWEEP, Path, Work, refresh
    from optplan.ordering._kernels.search import search

    problem = run.problem
    count = problem.clusters
    start = run.start
    if start is None:
        first = run.within(math.inf)
        stopped = nearest_neighbour(first)
        start = first.nodes if len(first.nodes) else first.start
        first.iterations = 0
        run.adopt(first)
        if stopped in (StopReason.CANCELLED, StopReason.TARGET) or start is None:
            return stopped
    costs = kernel_costs(problem)
    structure = kernel_structure(problem)
    path = Path(np.array(start, dtype=np.int64), np.zeros(count, dtype=np.int64), np.zeros((4, count)))
    best = Path(path.nodes.copy(), path.place.copy(), path.sums.copy())
    cost = refresh(costs, structure, path, 0, count - 1)
    scale = max(abs(cost) / count, float(np.abs(path.sums[0]).mean()))
    work = Work(
        queue=np.stack([structure.cluster[path.nodes], np.ones(count, dtype=np.int64)]),
        value=np.zeros(problem.nodes),
        parent=np.zeros(problem.nodes, dtype=np.int64),
        buffer=np.zeros(count, dtype=np.int64),
        counters=np.array([0, count, 0, 0, _sweep(problem, costs.kind), 0, 0, _ends(problem)], dtype=np.int64),
        # gains in the last digits are rounding, and could go on for ever
        cost=np.array([cost, math.inf, 1e-10 * scale]),
        random=np.array([run.seed % 2**64], dtype=np.uint64),
    )
    limit = run.rule.iterations
    endless = limit is None and math.isfinite(run.rule.seconds)
    slices = MOST_SLICES if limit is None and not endless else 2**62
    if limit is None:
        limit = 2**62 if endless else min(max(2000, ITERATIONS_EACH * count), MOST)
    if count <= 2:
        limit = 0  # the descent has seen both orders
    known = run.cost
    while True:
        search(costs, structure, path, best, work, limit, run.rule.target, SLICE[costs.kind])
        run.iterations = int(work.counters[ITERATIONS])
        found = path if work.cost[0] < work.cost[1] else best
        if min(work.cost[0], work.cost[1]) < known:
            known = float(min(work.cost[0], work.cost[1]))
            run.offer(found.nodes)
        stop = run.stop()
        slices -= 1
        if work.counters[FINISHED] or slices == 0:
            return stop or StopReason.FINISHED
        # no iteration counts before the first descent is done, not even when none is wanted
        if stop and stop is not StopReason.ITERATIONS:
            return stop
        assert work.counters[SWEEP] <= 1


def _ends(problem: OrderingProblem) -> int:
    """-2 to consider moves to the two ends of the path from everywhere, 0 only from clusters near them.

    With free ends a move there pays only when the new neighbour is near, and then it is among the neighbours.
    """
    free = all(v.min() == v.max() for v in (problem.start_costs, problem.end_costs))
    return 0 if free else -2


def _sweep(problem: OrderingProblem, kind: int) -> int:
    """1 to choose all nodes anew after the first descent, -1 where that takes too long."""
    sizes = np.diff(problem.first_node)
    effort = float((sizes[1:] * sizes[:-1]).sum()) * EFFORT[kind]
    return 1 if effort <= SWEEP_WORK else -1
