"""The model with positions."""

from __future__ import annotations

import math
from pathlib import Path
from typing import Any

import numpy as np
import pyomo.environ as pyo
import pytest

from optplan.domain.ordering import OrderingProblem
from optplan.ordering import solve
from optplan.ordering.arrays import dense_costs
from optplan_models import highs
from optplan_models.ordering import mtz
from tests.ordering_cases import Case, cases, random_problem

OPEN = (case for case in cases() if not case.problem.closed and not len(case.problem.enforced))
PAIRS = np.zeros((0, 2), dtype=np.int64)
CASES = [case for case in OPEN if math.isfinite(case.optimum)][::3]


def model_of(problem: OrderingProblem, *, lifted: bool = True) -> Any:
    return mtz.build(
        dense_costs(problem),
        problem.cluster,
        problem.start_costs,
        problem.end_costs,
        problem.node_costs,
        problem.precedence,
        lifted=lifted,
    )


@pytest.mark.parametrize(
    ("case", "lifted"),
    [*((case, True) for case in CASES), *((case, False) for case in CASES[::4])],
    ids=[case.name for case in CASES] + [f"{case.name}-plain" for case in CASES[::4]],
)
def test_optimum_is_feasible_and_the_relaxation_below(case: Case, lifted: bool) -> None:
    best = solve(case.problem, "brute")
    model = model_of(case.problem, lifted=lifted)
    mtz.set_path(model, case.problem.cluster, best.nodes)
    assert mtz.path_of(model).tolist() == best.nodes.tolist()
    assert pyo.value(model.cost) == pytest.approx(case.optimum)
    for row in model.component_data_objects(pyo.Constraint, active=True):
        value = pyo.value(row.body)
        assert row.lower is None or value >= pyo.value(row.lower) - 1e-9, row.name
        assert row.upper is None or value <= pyo.value(row.upper) + 1e-9, row.name
    relaxed = highs.run(highs.compile_model(model).relaxed())
    assert relaxed.status == "Optimal"
    assert relaxed.bound <= case.optimum + 1e-6


def test_exports(tmp_path: Path) -> None:
    model = model_of(random_problem("matrix", 5, 1, precedence=True, start=True, end=False))
    for name in ("model.lp", "model.mps"):
        model.write(str(tmp_path / name))
        assert (tmp_path / name).stat().st_size > 100


def test_arcs_that_precedence_forbids_are_absent() -> None:
    before = mtz.closure(4, np.array([[0, 1], [1, 2]]))
    assert before[0, 2]
    arcs = {tuple(a) for a in mtz.possible_arcs(np.ones((4, 4)), np.arange(4), before).tolist()}
    assert arcs == {(0, 1), (1, 2), (0, 3), (1, 3), (2, 3), (3, 0), (3, 1), (3, 2)}


def test_precedence_alone_can_decide() -> None:
    """A total order: one path is left, and the relaxation finds it."""
    pairs = np.array([[3, 1], [1, 0], [0, 2]])
    costs = np.random.default_rng(0).uniform(size=(4, 4))
    zeros = np.zeros(4)
    model = mtz.build(costs, np.arange(4), zeros, zeros, zeros, pairs)
    compiled = highs.compile_model(model)
    result = highs.run(compiled.relaxed())
    assert result.objective == pytest.approx(costs[3, 1] + costs[1, 0] + costs[0, 2])


def test_as_published_is_weaker_and_larger() -> None:
    problem = random_problem("euclid", 6, 2, precedence=True, start=False, end=False)
    plain, lifted = model_of(problem, lifted=False), model_of(problem)
    assert len(plain.x) > len(lifted.x)
    bounds = [highs.run(highs.compile_model(model).relaxed()).bound for model in (plain, lifted)]
    assert bounds[0] < bounds[1]
    best = solve(problem, "brute").cost
    assert [highs.run(highs.compile_model(model)).objective for model in (plain, lifted)] == pytest.approx([best, best])


@pytest.mark.parametrize("count", [3, 4, 5])
def test_the_right_hand_side_that_is_sometimes_printed_is_infeasible(count: int) -> None:
    zeros = np.zeros(count)
    model = mtz.build(np.ones((count, count)), np.arange(count), zeros, zeros, zeros, PAIRS[:0], lifted=False)
    assert highs.run(highs.compile_model(model)).objective == pytest.approx(count - 1)
    for row in model.order.values():
        assert row.upper == count - 1
        row.set_value(row.body <= count - 2)
    for position in model.u.values():
        position.setlb(None)  # not even without limits on the positions
        position.setub(None)
    assert highs.run(highs.compile_model(model)).status == "Infeasible"
