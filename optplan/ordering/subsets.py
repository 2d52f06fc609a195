"""`brute`: dynamic programming over subsets of clusters. Independent of the models, and so their oracle."""

from __future__ import annotations

import math

import numpy as np

from optplan.domain.arrays import IntArray
from optplan.domain.ordering import OrderingProblem
from optplan.domain.stop import StopReason
from optplan.ordering.arrays import dense_costs
from optplan.ordering.method import Run

MAX_STATES = 2**23
"""Most states (set of clusters visited, last node): 16 bytes each."""
MAX_WORK = 2e9
"""Most transitions between states: 2-4 s."""
_SLICE = 20_000_000


def transitions(problem: OrderingProblem) -> float:
    """Transitions of the dynamic programme; infinite when its states do not fit."""
    states = 2.0 ** min(problem.clusters, 60) * problem.nodes
    return states * problem.nodes / 4 if states <= MAX_STATES else math.inf


def refuse_many_subsets(problem: OrderingProblem) -> str | None:
    """Why the subsets are too many."""
    if transitions(problem) <= MAX_WORK:
        return None
    return (
        f"{problem.clusters} clusters with {problem.nodes} nodes; 2^clusters x nodes must be at most {MAX_STATES}, "
        f"and 2^clusters x nodes^2 / 4 at most {MAX_WORK:.0e}"
    )


def subset_programme(run: Run) -> StopReason:
    """Prove the optimum (or that there is no solution). One iteration is one set of clusters."""
    from optplan.ordering._kernels.subsets import extend

    problem = run.problem
    count = problem.clusters
    sets = 1 << count
    matrix = dense_costs(problem)
    first = problem.first_node.astype(np.int64)
    needs = np.zeros(count, dtype=np.int64)
    for a, b in problem.precedence.tolist():
        needs[b] |= 1 << a
    value = np.full((sets, problem.nodes), math.inf)
    parent = np.full((sets, problem.nodes), -1, dtype=np.int64)
    for c in np.flatnonzero(needs == 0).tolist():
        own = slice(first[c], first[c + 1])
        value[1 << c, own] = problem.start_costs[own] + problem.node_costs[own]
    chunk = max(1, int(4 * _SLICE / problem.nodes**2))
    low = 1
    while low < sets - 1:
        if stop := run.stop():
            return stop
        high = min(low + chunk, sets - 1)
        extend(matrix, problem.node_costs, first, needs, value, parent, low, high)
        run.iterations += high - low
        low = high
    total = value[-1] + problem.end_costs
    last = int(total.argmin())
    if not math.isfinite(total[last]):
        run.prove(math.inf)
        return StopReason.FINISHED
    run.offer(_path(parent, problem.cluster, last))
    run.prove(float(total[last]))
    return StopReason.FINISHED


def _path(parent: IntArray, cluster: IntArray, last: int) -> IntArray:
    nodes, visited = [last], len(parent) - 1
    while (before := int(parent[visited, nodes[-1]])) >= 0:
        visited ^= 1 << int(cluster[nodes[-1]])
        nodes.append(before)
    return np.array(nodes[::-1], dtype=np.int64)
