"""Branching on assignments: optimal where it says so, and soon left when asked."""

from __future__ import annotations

import math

import numpy as np
import pytest
from scipy.optimize import linear_sum_assignment

from optplan.domain.costs import MatrixCosts
from optplan.domain.ordering import OrderingProblem
from optplan.domain.stop import StopRule
from optplan.ordering import solve
from optplan.ordering.arrays import dense_costs
from optplan.ordering.branched import branchable, branched
from optplan.ordering.graph import circular_graph


def never() -> None:
    """Go on."""


def problem(count: int, most: float, seed: int) -> OrderingProblem:
    costs = most * np.random.default_rng(seed).random((count, count)) ** 4
    return OrderingProblem(np.arange(count), MatrixCosts(np.rint(costs) if most > 1 else costs))


@pytest.mark.parametrize("most", [1, 5, 100])
@pytest.mark.parametrize("count", [5, 8, 10])
def test_the_tour_is_optimal(count: int, most: float) -> None:
    for seed in range(5):
        case = problem(count, most, seed)
        graph = circular_graph(case, None, never)
        assert branchable(graph)
        tour, optimal = branched(graph, np.roll(np.arange(count + 1), 1), never, math.inf)
        assert optimal
        assert tour[0] == count
        best = solve(case, "brute", StopRule(seconds=20))
        assert best.status == "optimal"
        assert case.cost_of(tour[1:]) == pytest.approx(best.cost)


@pytest.mark.parametrize("unit", [1e-9, 0.1, 1 / 3])
@pytest.mark.parametrize("closed", [False, True])
def test_ties_that_rounding_tells_apart_end_too(closed: bool, unit: float) -> None:
    random = np.random.default_rng(0)
    for _ in range(60):
        costs = MatrixCosts(unit * np.floor(random.uniform(0, 10, (8, 8))))
        case = OrderingProblem(np.arange(8), costs, closed=closed)
        graph = circular_graph(case, 0 if closed else None, never)
        start = np.arange(8) if closed else np.roll(np.arange(9), 1)
        tour, optimal = branched(graph, start, never, math.inf)
        assert optimal
        best = solve(case, "brute")
        assert case.cost_of(tour if closed else tour[1:]) == pytest.approx(best.cost, abs=1e-9 * unit)


def test_random_matrices_of_hundreds_of_clusters_are_solved_at_once() -> None:
    case = problem(400, 1000, 3)
    answer = solve(case, "search", StopRule(seconds=30, iterations=20_000))
    assert answer.iterations == 0
    padded = np.pad(dense_costs(case), (0, 1))
    np.fill_diagonal(padded, math.inf)
    assert answer.cost == pytest.approx(padded[linear_sum_assignment(padded)].sum(), rel=0.01)


def test_stopped_at_once_the_start_comes_back() -> None:
    graph = circular_graph(problem(50, 100, 0), None, never)
    start = np.roll(np.arange(51), 1)
    tour, optimal = branched(graph, start, lambda: True, math.inf)
    assert not optimal
    assert tour.tolist() == start.tolist()
