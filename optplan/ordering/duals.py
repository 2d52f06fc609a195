"""Prices of the assignment problem: with them, cheap arcs are those that good tours have."""

from __future__ import annotations

from collections.abc import Callable

import numpy as np

from optplan.domain.arrays import FloatArray

SLICE = 2_000_000
"""Costs looked at between two looks at the stop rule: a few hundredths of a second."""


def prices(costs: FloatArray, stop: Callable[[], object]) -> tuple[FloatArray, FloatArray]:
    """Prices (m,) of leaving and (m,) of entering a cluster: no arc of costs (m, m) costs less than both together.

    Every tour is an assignment of a successor to each cluster: the prices add up to a lower bound, and what an arc
    costs beyond its prices, its reduced cost, says by how much the bound of the assignments with this arc is higher at
    least. Stopped early, the prices are not optimal, but valid.
    """
    from optplan.ordering._kernels.assignment import assign

    finite = np.isfinite(costs)
    most = float(np.abs(costs[finite]).max(initial=0.0)) + 1.0
    bounded = np.where(finite, costs, 2.0 * most * (len(costs) + 1))
    enter = bounded.min(axis=0)
    row_of = np.full(len(costs), -1, dtype=np.int64)
    row = 0
    while row < len(costs) and not stop():
        row = assign(bounded, enter, row_of, row, SLICE)
    return (bounded - enter).min(axis=1), enter
