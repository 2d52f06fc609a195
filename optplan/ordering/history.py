"""Orders in which what is done before matters: a path with arc costs, and a price for what is met of finished work."""

from __future__ import annotations

from collections.abc import Callable
from typing import NamedTuple

import numpy as np

from optplan.domain.arrays import FloatArray, IntArray

SLICE = 4000
"""Steps between two looks at the clock: some 0.03 s."""
LEAST, EACH = 100_000, 6_000
"""Steps of one cooling, and more of them a cluster."""
HOT, COLD = 1.0, 0.01
"""Temperatures, in mean arcs of the first path."""
MOST = 40_000_000
"""Numbers that the table of what arcs meet may hold: 320 MB."""


class History(NamedTuple):
    """What is met of finished work.

    Parameters
    ----------
    cluster : (n,) of the nodes
    costs : (n, n), infinite where no arc is to be used
    start, end : (n,) cost of beginning and ending with a node
    on_node : (n, m) what a node meets of each cluster, when that is done before it
    on_arc : (n, n, m) the same for arcs
    must : (k, 2) clusters: the first before the second
    """

    cluster: IntArray
    costs: FloatArray
    start: FloatArray
    end: FloatArray
    on_node: FloatArray
    on_arc: FloatArray
    must: IntArray

    def value(self, order: IntArray, weight: float) -> float:
        """Cost of an order (m,) of nodes with what it meets at this price."""
        from optplan.ordering._kernels.history import total

        tables = (self.cluster, self.costs, self.start, self.end, self.on_node, self.on_arc)
        return float(total(order, *tables, weight, self.must))


def annealed(
    history: History,
    twin: IntArray,
    order: IntArray,
    weight: float,
    seed: int,
    proceed: Callable[[float], bool],
    coolings: int,
) -> IntArray:
    """The best order found from one, by annealing again and again.

    Parameters
    ----------
    history : what is to be ordered
    twin : (n,) the node that drives the same cluster the other way round, -1 for none
    order : (m,) nodes to begin with, of finite cost
    weight : price of what is met
    proceed : told the share that is done; says whether to go on
    coolings : how often it cools down from hot to cold
    """
    from optplan.ordering._kernels.history import anneal

    members = np.argsort(history.cluster, kind="stable")
    first = np.searchsorted(history.cluster[members], np.arange(len(order) + 1))
    best = np.array(order, dtype=np.int64)
    known = history.value(best, weight)
    random = np.array([seed], dtype=np.uint64)
    steps = LEAST + EACH * len(order)
    mean = max(float(history.costs[order[:-1], order[1:]].mean()) if len(order) > 1 else 0.0, 1e-9)
    for cooling in range(coolings):
        here = best.copy()
        value = known
        count = -(-steps // SLICE)
        for part in range(count):
            hot, cold = (HOT * mean * (COLD / HOT) ** ((part + k) / count) for k in (0, 1))
            value, known = anneal(
                here,
                best,
                history.cluster,
                twin,
                first,
                members,
                history.costs,
                history.start,
                history.end,
                history.on_node,
                history.on_arc,
                weight,
                history.must,
                value,
                known,
                hot,
                cold,
                SLICE,
                random,
            )
            if not proceed((cooling + part / count) / coolings):
                return best
    return best
