"""A path by nearest feasible neighbours, from several first clusters: what searches begin with."""

from __future__ import annotations

import numpy as np

from optplan.domain.arrays import IntArray
from optplan.domain.ordering import OrderingProblem
from optplan.domain.stop import StopReason
from optplan.ordering.arrays import kernel_costs, kernel_structure
from optplan.ordering.method import Run

NN_SLICE = 2_000_000
"""Arc costs of nearest neighbours between two looks at the stop rule."""
NN_WORK = 20_000_000
"""Arc costs spent on trying several first clusters."""
EFFORT = {0: 1, 1: 1, 2: 30}
"""How many times an arc cost counts, by kind: Dubins paths take longer than straight lines."""


def nearest_neighbour(run: Run, most: int = 2**62) -> StopReason:
    """Nearest feasible neighbour. One iteration is one first cluster tried, at most `most`; the best path is kept."""
    from optplan.ordering._kernels.construct import nearest

    problem = run.problem
    costs = kernel_costs(problem)
    structure = kernel_structure(problem)
    count = problem.clusters
    first = problem.first_node
    waiting = np.diff(structure.before[: count + 1])
    may_end = np.logical_or.reduceat(np.isfinite(problem.end_costs), first[:-1]).astype(np.int64)
    steps = max(1, NN_SLICE // EFFORT[costs.kind] // problem.nodes)
    for c in _first_clusters(problem, waiting, costs.kind)[:most]:
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
