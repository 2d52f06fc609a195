"""`tree`: everything inside a stroke before the stroke itself, the nearest first."""

from __future__ import annotations

import numpy as np

from optplan.domain.arrays import BoolArray, IntArray
from optplan.domain.ordering import OrderingProblem
from optplan.domain.stop import StopReason
from optplan.ordering.baselines.nearest import keep_last, nearest_node
from optplan.ordering.method import Run


def kernel_first(run: Run) -> StopReason:
    """Walk the tree of containment, kernels first. One iteration is the walk.

    Precedence says which stroke lies inside which other. On every level the nearest stroke is next; the strokes inside
    it are done before it, in the same manner. Without precedence this is a walk of nearest neighbours.
    """
    problem = run.problem
    parent = parents(problem)
    nodes: list[int] = []
    waiting = np.bincount(parent + 1, minlength=problem.clusters + 1)[1:]  # children to come
    to_do = np.ones(problem.clusters, dtype=np.bool_)
    inside = -1  # the stroke whose children are being done; -1: the outermost ones
    while to_do.any():
        if run.stop() is StopReason.CANCELLED:
            return StopReason.CANCELLED
        siblings = to_do & (parent == inside)
        if not siblings.any():
            chosen, inside = inside, int(parent[inside])
        else:
            ready = keep_last(problem, siblings, to_do) if inside < 0 else siblings
            chosen = int(problem.cluster[nearest_node(problem, nodes, ready)])
            if waiting[chosen]:
                inside = chosen
                continue
        nodes.append(nearest_node(problem, nodes, np.arange(problem.clusters) == chosen))
        to_do[chosen] = False
        if inside >= 0:
            waiting[inside] -= 1
    run.iterations += 1
    if not run.offer(np.array(nodes)) and not np.isfinite(problem.cost_of(nodes)):
        run.message = "it does not look ahead: its order uses an arc that does not exist"
    return run.stop() or StopReason.FINISHED


def refuse_no_forest(problem: OrderingProblem) -> str | None:
    """Why precedence cannot mean that strokes lie inside one another."""
    direct = direct_pairs(problem.clusters, problem.precedence)
    several = np.flatnonzero(direct.sum(axis=1) > 1)
    if not len(several):
        return None
    inner = int(several[0])
    a, b = np.flatnonzero(direct[inner])[:2].tolist()
    return (
        f"precedence is no forest: cluster {inner} comes before clusters {a} and {b}, and none of these before the "
        "other; a stroke lies directly inside one other stroke at most"
    )


def parents(problem: OrderingProblem) -> IntArray:
    """(m,) the cluster directly around each cluster, the smallest encloser; -1 for the outermost ones."""
    direct = direct_pairs(problem.clusters, problem.precedence)
    return np.where(direct.any(axis=1), direct.argmax(axis=1), -1).astype(np.int64)


def direct_pairs(count: int, precedence: IntArray) -> BoolArray:
    """(m, m) the transitive reduction: pairs that do not follow from others.

    Precedence (k, 2) has no cycle; memory grows with the square of the number of clusters.
    """
    before = np.zeros((count, count), dtype=np.bool_)
    before[precedence[:, 0], precedence[:, 1]] = True
    for middle in range(count):
        before |= np.outer(before[:, middle], before[middle])
    paths = before.astype(np.float32)
    direct: BoolArray = before & ~(paths @ paths > 0)
    return direct
