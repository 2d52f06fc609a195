"""`bnb`: depth-first branch and bound, as textbooks describe it; for comparison, and for a dozen strokes."""

from __future__ import annotations

import math
from typing import TYPE_CHECKING

import numpy as np

from optplan.domain.arrays import FloatArray, IntArray
from optplan.domain.ordering import OrderingProblem
from optplan.domain.stop import StopReason
from optplan.ordering.cutoff import TOLERANCE, cutoff
from optplan.ordering.ideals_bound import SAFETY
from optplan.ordering.ideals_network import sides
from optplan.ordering.method import Run

if TYPE_CHECKING:
    from optplan.ordering._kernels.branch import Tree

MAX_NODES = 2000
"""Most nodes: the arcs are written out, and listed for each node of the tree."""
MOST_VISITS = 50_000_000
"""Nodes of the tree after which the search ends when nothing else ends it: some 20 to 40 s."""
SLICE = 50_000_000
"""Steps of sorting children between two looks at the stop rule, at most some 0.05 s; listing them takes n^2 / 4."""


def refuse_many_nodes(problem: OrderingProblem) -> str | None:
    """Why the arcs cannot be written out."""
    if problem.nodes <= MAX_NODES:
        return None
    return f"{problem.nodes} nodes; at most {MAX_NODES}, because all arcs are written out"


def branch_and_bound(run: Run) -> StopReason:
    """Nearest child first; bound: the cost so far and the cheapest links to come. One iteration is one tree node.

    Proves the optimum, or that there is none, when it has seen the whole tree. When it is stopped before, the best path
    and the least bound of what was not seen remain.
    """
    from optplan.ordering._kernels.branch import DEPTH, FOUND, VISITED, descend

    problem, goal = run.problem, cutoff(run.problem)
    network = sides(problem)[0].network
    into = np.minimum(network.arcs.min(axis=0), network.start)
    link = np.minimum.reduceat(into, network.first[:-1])
    least_end = float(network.end.min())
    if not math.isfinite(float(link.sum()) + least_end):
        run.prove(math.inf)  # a cluster that cannot be entered, or no end
        return StopReason.FINISHED
    rounding = SAFETY * (float(np.abs(link).sum()) + abs(least_end))
    tree = _root(network.after, link, problem.nodes)
    counters = np.zeros(3, dtype=np.int64)
    step = np.array([goal.step * (1.0 - 1e-6), 0.0 if goal.step else TOLERANCE])
    limit = run.rule.iterations
    if limit is None:
        limit = 2**62 if math.isfinite(run.rule.seconds) else MOST_VISITS
    best = goal.of(run)
    slice_ = max(1, 4 * SLICE // problem.nodes**2)
    while counters[DEPTH] >= 0:
        if (stop := run.stop()) or counters[VISITED] >= limit:
            goal.conclude(run, _open_bound(tree, int(counters[DEPTH])), rounding)
            return stop or StopReason.FINISHED
        found = counters[FOUND]
        work = min(slice_, limit - int(counters[VISITED]))
        best = descend(network, link, least_end, tree, best, step, work, counters)
        run.iterations = int(counters[VISITED])
        if counters[FOUND] > found:
            run.offer(tree.paths[1])
    goal.conclude(run, math.inf, rounding + SAFETY * (abs(run.cost) if math.isfinite(run.cost) else 0.0))
    return StopReason.FINISHED


def _root(after: IntArray, link: FloatArray, nodes: int) -> Tree:
    """The tree before its first node."""
    from optplan.ordering._kernels.branch import Tree

    count = len(link)
    places, sums = np.zeros((2, count + 1), dtype=np.int64), np.zeros((2, count + 1))
    places[0], sums[1, 0] = -1, link.sum()
    return Tree(
        children=np.zeros((count, nodes), dtype=np.int64),
        keys=np.zeros((2, count, nodes)),
        places=places,
        sums=sums,
        paths=np.zeros((2, count), dtype=np.int64),
        waiting=np.bincount(after[count + 1 :], minlength=count),
    )


def _open_bound(tree: Tree, depth: int) -> float:
    """The least bound of the children still to be tried, and of the one that is being looked at."""
    tried, size = tree.places
    least = -math.inf if tried[0] < 0 else math.inf
    for d in range(depth + 1):
        if tried[d] >= 0:
            # where the children of a child are listed, they are looked at instead
            listed = d < depth and tried[d + 1] >= 0
            least = min(least, tree.keys[1, d, max(tried[d] - (not listed), 0) : size[d]].min(initial=math.inf))
    return float(least)
