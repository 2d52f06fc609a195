"""Prices of the assignment problem: with them, cheap arcs are those that good tours have."""

from __future__ import annotations

from collections.abc import Callable

import numpy as np

from optplan.domain.arrays import FloatArray

SLICE = 2_000_000
"""Costs looked at between two looks at the stop rule: a few hundredths of a second."""


def reduced_costs(costs: FloatArray, stop: Callable[[], object]) -> FloatArray:
    """(m, m) costs of arcs less the optimal prices of their ends, none negative; infinite arcs stay so.

    Every tour is an assignment of a successor to each cluster: the prices add up to a lower bound, and an arc's reduced
    cost says by how much the bound of the assignments with this arc is higher at least. Stopped early, the prices are
    not optimal, but valid.
    """
    from optplan.ordering._kernels.assignment import assign

    finite = np.isfinite(costs)
    most = float(np.abs(costs[finite]).max(initial=0.0)) + 1.0
    bounded = np.where(finite, costs, 2.0 * most * (len(costs) + 1))
    price = bounded.min(axis=0)
    row_of = np.full(len(costs), -1, dtype=np.int64)
    row = 0
    while row < len(costs) and not stop():
        row = assign(bounded, price, row_of, row, SLICE)
    less = bounded - price
    reduced: FloatArray = np.where(finite, less - less.min(axis=1, keepdims=True), np.inf)
    return reduced
