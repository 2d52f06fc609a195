"""Circles of a facade, row by row."""

from __future__ import annotations

import math
from dataclasses import replace

import numpy as np
import pytest

from optplan.domain.errors import SolverError
from optplan.domain.ordering import EuclidCosts, OrderingProblem, Status
from optplan.domain.stop import StopReason, StopRule
from optplan.ordering import SOLVERS, solve
from tests.ordering_cases import strokes
from tests.washing import washing

BOTH = pytest.mark.parametrize("solver", ["rows", "rows-split"])


def facade(columns: int = 4, lines: int = 3) -> OrderingProblem:
    """Rows of circles, each shifted a little, washed from the lowest."""
    x, y = np.meshgrid(np.arange(float(columns)), np.arange(float(lines)))
    points = np.column_stack([(x + 0.2 * (y % 2)).ravel(), y.ravel()])
    close = np.abs(points[:, None, 0] - points[None, :, 0]) < 0.5
    before = np.argwhere((points[:, None, 1] < points[None, :, 1]) & close)
    return OrderingProblem(np.arange(len(points)), EuclidCosts(points, points), precedence=before)


@BOTH
@pytest.mark.parametrize("upwards", [True, False])
def test_rows_are_found_in_either_direction(solver: str, upwards: bool) -> None:
    problem = facade()
    if not upwards:
        problem = replace(problem, precedence=problem.precedence[:, ::-1])
    answer = solve(problem, solver, seed=1)
    best = solve(problem, "brute").cost
    assert problem.faults(answer.nodes) == []
    assert answer.cost == pytest.approx(best)
    assert answer.bound == -math.inf
    assert answer.status is Status.FEASIBLE
    assert answer.stopped is StopReason.FINISHED
    assert "is no bound for others" in answer.message


@BOTH
def test_ends_and_node_costs_are_those_of_the_circles(solver: str) -> None:
    problem = facade()
    begin, end = np.full(12, math.inf), np.full(12, math.inf)
    begin[3], end[8], end[11] = 1.0, 2.0, 7.0
    problem = replace(problem, start_costs=begin, end_costs=end, node_costs=np.arange(12.0))
    answer = solve(problem, solver)
    assert problem.faults(answer.nodes) == []
    assert answer.nodes[0] == 3
    assert answer.nodes[-1] in (8, 11)
    assert f"costs less than {answer.cost:.6g}" in answer.message


@BOTH
def test_cancel_and_start(solver: str) -> None:
    problem = facade()
    best = solve(problem, "brute").nodes
    answer = solve(problem, solver, StopRule(cancelled=lambda: True), start=best)
    assert answer.stopped is StopReason.CANCELLED
    assert answer.nodes.tolist() == best.tolist()


def test_what_is_no_facade_is_refused() -> None:
    problem = facade()
    costs = problem.costs
    assert isinstance(costs, EuclidCosts)
    apart = replace(problem, costs=EuclidCosts(costs.exits, costs.entries + 1.0))
    tilted = np.column_stack([costs.exits, np.arange(12.0)])
    folded = replace(problem, costs=EuclidCosts(tilted, tilted))
    for solver in ("rows", "rows-split"):
        with pytest.raises(SolverError, match="one node a stroke"):
            solve(strokes(4), solver)
        for other in (apart, folded):
            with pytest.raises(SolverError, match="in a plane"):
                solve(other, solver)
        level = np.column_stack([costs.exits, np.full(12, 3.0)])
        assert SOLVERS[solver].refusal(replace(problem, costs=EuclidCosts(level, level))) is None
    both_ways = replace(problem, precedence=np.array([[0, 4], [5, 1]]))
    assert "which lies in a lower row" in str(SOLVERS["rows"].refusal(both_ways))
    zigzag = replace(problem, precedence=np.array([[0, 1], [2, 1]]))
    assert "neither direction" in str(SOLVERS["rows"].refusal(zigzag))


def test_figures_of_the_washing_cases() -> None:
    for name, strict in (("case1", 228.167), ("case2", 214.774)):
        case = washing(name)
        assert solve(case.problem, "rows").cost == pytest.approx(strict, abs=1e-3)
        split = solve(case.problem, "rows-split")
        assert case.problem.faults(split.nodes) == []
        assert case.optimum - 1e-3 <= split.cost <= 1.002 * case.optimum
