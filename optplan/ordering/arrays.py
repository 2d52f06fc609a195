"""An ordering problem as the arrays that compiled kernels take."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any, TypeVar, cast

import numpy as np

from optplan.domain.arrays import FloatArray, IntArray
from optplan.domain.costs import DubinsCosts, EuclidCosts, MatrixCosts
from optplan.domain.ordering import OrderingProblem

if TYPE_CHECKING:
    from optplan.ordering._kernels.costs import Costs, Structure

DENSE_NODES = 3000
"""Costs of a kind unknown to the kernels are written out up to this many nodes (72 MB)."""
DENSE_DUBINS = 1000
"""Dubins paths are computed once and kept up to this many nodes (8 MB, 0.4 s)."""
_Array = TypeVar("_Array", bound=np.ndarray[Any, Any])


def refuse_unknown_costs(problem: OrderingProblem) -> str | None:
    """Why the kernels cannot take these costs."""
    if isinstance(problem.costs, MatrixCosts | EuclidCosts | DubinsCosts) or problem.nodes <= DENSE_NODES:
        return None
    return f"{problem.nodes} nodes with costs that are neither a matrix, lines nor Dubins paths; at most {DENSE_NODES}"


def dense_costs(problem: OrderingProblem) -> FloatArray:
    """All arc costs (n, n), row by row; those inside a cluster may be anything."""
    if isinstance(problem.costs, MatrixCosts):
        return problem.costs.matrix
    count = problem.nodes
    heads = np.arange(count)
    matrix = np.empty((count, count))
    for i in range(count):
        matrix[i] = problem.costs.pairs(np.full(count, i), heads)
    return matrix


def kernel_costs(problem: OrderingProblem) -> Costs:
    """Costs for the kernels, infinite ones replaced by a penalty larger than any solution."""
    from optplan.ordering._kernels.costs import Costs

    costs = problem.costs
    ends = np.stack([problem.start_costs, problem.end_costs, problem.node_costs])
    largest = float(np.abs(ends[np.isfinite(ends)]).max(initial=0.0))
    kind, radius = 0, 1.0
    if isinstance(costs, EuclidCosts):
        kind, data = 1, np.concatenate([costs.entries, costs.exits], axis=1)
        largest += 2.0 * float(np.abs(data).sum(axis=1).max())
    elif isinstance(costs, DubinsCosts) and problem.nodes > DENSE_DUBINS:
        kind, radius, data = 2, float(costs.radius), np.concatenate([costs.entries, costs.exits], axis=1)
        largest += 2.0 * float(np.abs(data).sum(axis=1).max()) + 14.0 * radius
    else:
        data = dense_costs(problem)
        largest += float(np.abs(data[np.isfinite(data)]).max(initial=0.0))
    penalty = (largest + 1.0) * (problem.clusters + 1) * 2
    if kind == 0 and np.isinf(data).any():
        data = np.where(np.isinf(data), penalty, data)
    return Costs(kind, radius, fixed(data), fixed(np.where(np.isinf(ends), penalty, ends)))


def kernel_structure(problem: OrderingProblem) -> Structure:
    """Clusters and precedence for the kernels."""
    from optplan.ordering._kernels.costs import Structure

    count = problem.clusters
    pairs = np.unique(problem.precedence, axis=0).reshape(-1, 2)
    return Structure(
        fixed(problem.cluster),
        fixed(problem.first_node.astype(np.int64)),
        fixed(grouped(pairs[:, 1], pairs[:, 0], count)),
        fixed(grouped(pairs[:, 0], pairs[:, 1], count)),
    )


def partners(problem: OrderingProblem) -> IntArray:
    """(n,) the node of the same cluster that drives it the other way; the node itself where there is none.

    It is left where the node is entered and entered where the node is left (under Dubins with the heading turned
    round); of a matrix, the other node of a cluster of two whose reversed arcs cost least.
    """
    count = problem.nodes
    partner = np.arange(count)
    costs = problem.costs
    if isinstance(costs, EuclidCosts | DubinsCosts):
        ways: dict[tuple[float, ...], int] = {}
        exits, entries = _flipped(costs.exits, costs), _flipped(costs.entries, costs)
        here = np.column_stack([problem.cluster, _rounded(costs.entries, costs), _rounded(costs.exits, costs)])
        there = np.column_stack([problem.cluster, _rounded(exits, costs), _rounded(entries, costs)])
        for node, key in enumerate(map(tuple, here.tolist())):
            ways.setdefault(key, node)
        for node, key in enumerate(map(tuple, there.tolist())):
            partner[node] = ways.get(key, node)
    elif problem.nodes <= DENSE_NODES:
        first = problem.first_node
        for c in np.flatnonzero(np.diff(first) == 2).tolist():
            a, b = int(first[c]), int(first[c]) + 1
            outside = np.flatnonzero(problem.cluster != c)
            leave, enter = np.full(len(outside), a), np.full(len(outside), b)
            # leaving a costs what entering b costs: they are the two ways of one stroke
            swapped = np.array_equal(
                np.sort(costs.pairs(leave, outside)), np.sort(costs.pairs(outside, enter))
            ) or np.array_equal(np.sort(costs.pairs(enter, outside)), np.sort(costs.pairs(outside, leave)))
            if swapped:
                partner[a], partner[b] = b, a
    return partner


def _flipped(states: FloatArray, costs: EuclidCosts | DubinsCosts) -> FloatArray:
    return states + np.array([0.0, 0.0, np.pi]) if isinstance(costs, DubinsCosts) else states


def _rounded(states: FloatArray, costs: EuclidCosts | DubinsCosts) -> FloatArray:
    """Places to compare; a heading counts as its direction to 1e-6 rad."""
    if not isinstance(costs, DubinsCosts):
        return states + 0.0
    heading = np.round(np.column_stack([np.cos(states[:, 2]), np.sin(states[:, 2])]), 6)
    return np.column_stack([states[:, :2], heading]) + 0.0


def grouped(keys: IntArray, values: IntArray, count: int) -> IntArray:
    """One array in which the values of key c are at places array[c]..array[c + 1]-1."""
    order = np.argsort(keys, kind="stable")
    ranges = np.searchsorted(keys[order], np.arange(count + 1)) + count + 1
    return np.concatenate([ranges, values[order]]).astype(np.int64)


def fixed(values: _Array) -> _Array:
    """The array read-only and contiguous: numba compiles one signature."""
    fixed = np.ascontiguousarray(values).view()
    fixed.setflags(write=False)
    return cast(_Array, fixed)
