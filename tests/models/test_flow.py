"""The model with a flow of one commodity."""

from __future__ import annotations

import math
from pathlib import Path

import numpy as np
import pyomo.environ as pyo
import pytest

from optplan_models.ordering import flow
from optplan_models.ordering.rooted import set_tour, tour_of
from tests.models.rooted_cases import least, rooted, small, tours
from tests.ordering_cases import optimum, random_problem


@pytest.mark.parametrize("seed", range(9))
def test_every_solution_is_feasible(seed: int) -> None:
    problem = small(seed)
    model = flow.build(rooted(problem))
    for nodes in tours(problem)[:40]:
        set_tour(model, nodes)
        flow.set_flow(model, nodes)
        assert tour_of(model, rooted(problem)).tolist() == nodes.tolist()
        assert pyo.value(model.cost) == pytest.approx(problem.cost_of(nodes[1:]))
        for row in model.component_data_objects(pyo.Constraint, active=True):
            value = pyo.value(row.body)
            assert row.lower is None or value >= pyo.value(row.lower) - 1e-9, row.name
            assert row.upper is None or value <= pyo.value(row.upper) + 1e-9, row.name


@pytest.mark.parametrize("seed", range(12))
def test_the_model_finds_the_optimum(seed: int) -> None:
    problem = small(seed)
    model = flow.build(rooted(problem))
    best = optimum(problem)
    assert least(model, relaxed=True) <= best + 1e-6
    assert least(model) == pytest.approx(best, abs=1e-6)
    if math.isfinite(best):
        nodes = tour_of(model, rooted(problem))
        assert problem.faults(nodes[1:]) == []
        assert problem.cost_of(nodes[1:]) == pytest.approx(best, abs=1e-6)


def test_exports(tmp_path: Path) -> None:
    model = flow.build(rooted(random_problem("matrix", 5, 1, precedence=True, start=True, end=False)))
    model.write(str(tmp_path / "model.mps"))
    assert (tmp_path / "model.mps").stat().st_size > 100


def test_a_total_order_leaves_one_tour() -> None:
    """The relaxation finds it."""
    rng = np.random.default_rng(0)
    problem = rooted(random_problem("matrix", 5, 3, precedence=False, start=False, end=False))
    names = rng.permutation(5)
    model = flow.build(problem._replace(precedence=np.stack([names[:-1], names[1:]], axis=1)))
    assert {(int(problem.cluster[i]), int(problem.cluster[j])) for i, j in model.x} == {
        *zip(names[:-1].tolist(), names[1:].tolist(), strict=True),
        (5, int(names[0])),
        (int(names[-1]), 5),
    }
