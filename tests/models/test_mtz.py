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
CASES = [case for case in OPEN if math.isfinite(case.optimum)][::3]


def model_of(problem: OrderingProblem) -> Any:
    return mtz.build(
        dense_costs(problem),
        problem.cluster,
        problem.start_costs,
        problem.end_costs,
        problem.node_costs,
        problem.precedence,
    )


@pytest.mark.parametrize("case", CASES, ids=lambda c: c.name)
def test_optimum_is_feasible_and_the_relaxation_below(case: Case) -> None:
    best = solve(case.problem, "brute")
    model = model_of(case.problem)
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
