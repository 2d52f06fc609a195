"""Nodes that are the same in every respect are looked at once."""

from __future__ import annotations

import numpy as np

from optplan.domain.arrays import IntArray
from optplan.domain.ordering import DubinsCosts, EuclidCosts, OrderingProblem


def distinct_nodes(problem: OrderingProblem) -> tuple[OrderingProblem, IntArray, IntArray]:
    """The problem without duplicate nodes.

    Under straight lines a closed stroke driven the other way round is the same node: this halves most drawings.

    Returns
    -------
    problem : with one node of each group of equals, the one of least node cost
    original : (k,) the node of the given problem that each of its nodes is
    same : (n,) its node that stands for each node of the given problem
    """
    everything = np.arange(problem.nodes)
    costs = problem.costs
    if not isinstance(costs, EuclidCosts | DubinsCosts) or problem.nodes == 0:
        return problem, everything, everything
    ends = np.column_stack([problem.start_costs, problem.end_costs])
    # + 0.0 turns -0.0 into 0.0
    rows = np.ascontiguousarray(np.column_stack([problem.cluster, costs.exits, costs.entries, ends]) + 0.0)
    # equal rows are equal bytes, which sort faster than floats; the order of groups does not matter
    keys = rows.view(np.dtype((np.void, rows.shape[1] * rows.itemsize))).ravel()
    _, group = np.unique(keys, return_inverse=True)
    count = int(group.max()) + 1
    if count == problem.nodes:
        return problem, everything, everything
    order = np.lexsort((everything, problem.node_costs, group))
    chosen = order[np.flatnonzero(np.diff(group[order], prepend=-1))]
    original = np.sort(chosen)
    of_group = np.empty(count, dtype=np.int64)
    of_group[group[original]] = np.arange(count)
    exits, entries = costs.exits[original], costs.entries[original]
    smaller = OrderingProblem(
        problem.cluster[original],
        EuclidCosts(exits, entries)
        if isinstance(costs, EuclidCosts)
        else DubinsCosts(exits, entries, costs.radius, costs.batch),
        problem.start_costs[original],
        problem.end_costs[original],
        problem.node_costs[original],
        problem.precedence,
    )
    return smaller, original, of_group[group]
