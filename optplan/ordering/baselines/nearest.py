"""`nn` and `nn-feasible`: always on to the nearest stroke, without and with an eye on precedence."""

from __future__ import annotations

import numpy as np

from optplan.domain.arrays import BoolArray, FloatArray, IntArray
from optplan.domain.ordering import EuclidCosts, OrderingProblem
from optplan.domain.stop import StopReason
from optplan.ordering.baselines.honest import offer_as_published
from optplan.ordering.method import Run

TIE = 1e-6
"""Costs closer than this, relatively, are equal: patterns have many equal distances that rounding tells apart."""


def nearest_neighbour_as_published(run: Run) -> StopReason:
    """Nearest neighbour; among equals the lowest node. It knows nothing of precedence. One iteration is the one walk.

    After Rosenkrantz, Stearns and Lewis, "An analysis of several heuristics for the traveling salesman problem" (1977).
    """
    nodes = nearest_path(run, run.problem.precedence[:0])
    if nodes is None:
        return StopReason.CANCELLED
    run.iterations += 1
    offer_as_published(run, nodes)
    return run.stop() or StopReason.FINISHED


def nearest_feasible_neighbour(run: Run) -> StopReason:
    """Nearest of the strokes whose predecessors are all done; among equals the lower one. One iteration is the walk.

    The "modified nearest neighbour" of facade washing: ties go downwards, because a way up that is no shorter leaves
    circles behind which have to be fetched later.
    """
    nodes = nearest_path(run, run.problem.precedence, _heights(run.problem))
    if nodes is None:
        return StopReason.CANCELLED
    run.iterations += 1
    if not run.offer(nodes) and not np.isfinite(run.problem.cost_of(nodes)):
        run.message = "it does not look ahead: its order uses an arc that does not exist"
    return run.stop() or StopReason.FINISHED


def nearest_path(run: Run, precedence: IntArray, height: FloatArray | None = None) -> IntArray | None:
    """The path (m,) of nodes that always goes on to the nearest cluster that is ready; None when cancelled.

    Parameters
    ----------
    run : its problem, and its cancel; an unfinished path is worth nothing, so that no other limit ends the walk
    precedence : (k, 2) pairs of clusters to be obeyed
    height : (n,) decides between nodes that are equally near, the lower first; left out, the lower number
    """
    problem = run.problem
    waiting = np.bincount(precedence[:, 1], minlength=problem.clusters)
    to_do = np.ones(problem.clusters, dtype=np.bool_)
    nodes: list[int] = []
    while to_do.any():
        if run.stop() is StopReason.CANCELLED:
            return None
        ready = keep_last(problem, to_do & (waiting == 0), to_do)
        node = nearest_node(problem, nodes, ready, height)
        nodes.append(node)
        done = problem.cluster[node]
        to_do[done] = False
        np.subtract.at(waiting, precedence[precedence[:, 0] == done, 1], 1)
    return np.array(nodes, dtype=np.int64)


def keep_last(problem: OrderingProblem, ready: BoolArray, to_do: BoolArray) -> BoolArray:
    """The clusters (m,) of `ready` without the only one with which the path may end, while there are others."""
    ends = np.logical_or.reduceat(np.isfinite(problem.end_costs), problem.first_node[:-1])
    if (ends & to_do).sum() == 1 and (ready & ~ends).any():
        return ready & ~ends
    return ready


def nearest_node(problem: OrderingProblem, nodes: list[int], ready: BoolArray, height: FloatArray | None = None) -> int:
    """The nearest node of the `ready` (m,) clusters from the end of the path `nodes`, or to begin with."""
    candidates = np.flatnonzero(ready[problem.cluster])
    costs = problem.node_costs[candidates] + (
        problem.costs.pairs(np.full(len(candidates), nodes[-1]), candidates)
        if nodes
        else problem.start_costs[candidates]
    )
    if len(nodes) == problem.clusters - 1:
        costs = costs + problem.end_costs[candidates]
    least = costs.min()
    tied = candidates[costs <= least + TIE * abs(least)]
    return int(tied[0] if height is None else tied[np.argmin(height[tied])])


def _heights(problem: OrderingProblem) -> FloatArray | None:
    """(n,) y of where each node is entered, when costs are straight lines."""
    costs = problem.costs
    return costs.entries[:, 1] if isinstance(costs, EuclidCosts) and costs.entries.shape[1] > 1 else None
