"""Prices of the assignment problem: valid, optimal, and soon left when asked."""

from __future__ import annotations

import numpy as np
import pytest
from scipy.optimize import linear_sum_assignment

from optplan.domain.arrays import FloatArray
from optplan.ordering.duals import prices


def never() -> None:
    """Go on."""


def reduced_costs(costs: FloatArray) -> FloatArray:
    leave, enter = prices(costs, never)
    return costs - leave[:, None] - enter


def costs_of(count: int, kind: str, seed: int) -> FloatArray:
    rng = np.random.default_rng(seed)
    costs = rng.integers(0, 10, (count, count)).astype(np.float64) if kind == "ties" else rng.random((count, count))
    if kind == "gaps":
        costs[rng.random((count, count)) < 0.5] = np.inf
        # one assignment at least exists
        costs[np.arange(count), (np.arange(count) + 1) % count] = rng.random(count)
    np.fill_diagonal(costs, np.inf)
    return costs


@pytest.mark.parametrize("kind", ["ties", "real", "gaps"])
@pytest.mark.parametrize("count", [2, 7, 60])
def test_the_prices_add_up_to_the_cost_of_the_best_assignment(kind: str, count: int) -> None:
    costs = costs_of(count, kind, count)
    reduced = reduced_costs(costs)
    assert reduced.min() >= -1e-12
    assert (np.isinf(reduced) == np.isinf(costs)).all()
    rows, columns = linear_sum_assignment(costs)
    # an assignment loses the same sum of prices whichever it is: the best one has nothing left
    assert reduced[rows, columns].sum() == pytest.approx(0, abs=1e-9)
    least = costs[rows, columns].sum()
    other = np.roll(np.arange(count), -1)
    if np.isfinite(costs[np.arange(count), other]).all():
        rest = costs[np.arange(count), other].sum() - reduced[np.arange(count), other].sum()
        assert rest == pytest.approx(least)


def test_prices_are_valid_when_stopped() -> None:
    costs = costs_of(30, "real", 1)
    leave, enter = prices(costs, lambda: True)
    assert (costs - leave[:, None] - enter).min() >= -1e-12
