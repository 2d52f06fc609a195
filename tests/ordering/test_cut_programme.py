"""The growing linear programme, and proofs in child processes."""

from __future__ import annotations

import math
import os
import time
from collections.abc import Callable
from typing import Any

import numpy as np
import pytest

from optplan.domain.arrays import FloatArray
from optplan.domain.stop import StopReason, StopRule
from optplan.ordering.cutting.child import prove_in_child
from optplan.ordering.cutting.lp import Programme, Solution, Sparse
from optplan.ordering.method import Run
from tests.ordering_cases import strokes


def vectors(rows: list[dict[int, float]]) -> Sparse:
    return Sparse(
        np.cumsum([0, *(len(row) for row in rows)]),
        np.array([k for row in rows for k in row], dtype=np.int64),
        np.array([v for row in rows for v in row.values()], dtype=np.float64),
    )


def solved(programme: Programme) -> Solution:
    solution = programme.solve()
    assert isinstance(solution, Solution)
    return solution


def triangle() -> Programme:
    """Each two of three columns sum to 1 at least."""
    programme = Programme(np.array([1.0, 2.0, 3.0]), np.zeros(3), np.ones(3))
    pairs = vectors([{0: 1.0, 1: 1.0}, {1: 1.0, 2: 1.0}, {0: 1.0, 2: 1.0}])
    programme.add_rows(np.ones(3), np.full(3, math.inf), pairs)
    return programme


def test_rows_and_columns_come_and_go() -> None:
    programme = triangle()
    first = solved(programme)
    assert first.objective == pytest.approx(3.0)
    assert first.primal @ programme.costs == pytest.approx(3.0)
    programme.add_rows(np.array([2.0]), np.array([math.inf]), vectors([{0: 1.0, 1: 1.0, 2: 1.0}]))
    assert solved(programme).objective == pytest.approx(3.0)
    programme.add_columns(np.array([0.5]), np.zeros(1), np.ones(1), vectors([{1: 1.0, 2: 1.0, 3: 1.0}]))
    second = solved(programme)
    assert (programme.rows, programme.columns) == (4, 4)
    assert second.objective == pytest.approx(1.5)
    # weak duality: no dual feasible point tells more
    assert second.reduced == pytest.approx(programme.costs - columns_of(programme).T @ second.duals)
    programme.set_bounds(np.array([3]), np.zeros(1), np.zeros(1))
    assert solved(programme).objective == pytest.approx(3.0)
    before = programme.rows
    programme.drop_rows(np.flatnonzero(programme.slack()))
    assert programme.rows < before
    assert solved(programme).objective == pytest.approx(3.0)
    programme.drop_columns(np.array([3]))
    assert solved(programme).objective == pytest.approx(3.0)


def columns_of(programme: Programme) -> FloatArray:
    entries = np.array([[1, 1, 0, 0], [0, 1, 1, 1], [1, 0, 1, 1], [1, 1, 1, 1]], dtype=np.float64)
    return entries[: programme.rows, : programme.columns]


def test_infeasible_is_told() -> None:
    programme = triangle()
    programme.set_bounds(np.arange(3), np.zeros(3), np.zeros(3))
    assert programme.solve() == "Infeasible"
    programme.set_bounds(np.arange(3), np.zeros(3), np.ones(3))
    assert solved(programme).objective == pytest.approx(3.0)
    assert programme.solve(seconds=10.0) != "TimeLimit"


def test_a_basis_can_be_kept() -> None:
    programme = triangle()
    kept = solved(programme)
    basis = programme.basis()
    programme.set_bounds(np.array([0]), np.zeros(1), np.zeros(1))
    assert solved(programme).objective == pytest.approx(5.0)
    programme.set_bounds(np.array([0]), np.zeros(1), np.ones(1))
    programme.set_basis(basis)
    assert solved(programme).primal == pytest.approx(kept.primal)


def test_integer_rounds_leave_the_programme_alone() -> None:
    """A triangle wants two of its corners; the relaxation takes a half of each."""
    programme = Programme(np.ones(3), np.zeros(3), np.ones(3))
    pairs = vectors([{0: 1.0, 1: 1.0}, {1: 1.0, 2: 1.0}, {0: 1.0, 2: 1.0}])
    programme.add_rows(np.ones(3), np.full(3, math.inf), pairs)
    assert solved(programme).objective == pytest.approx(1.5)
    seen: list[FloatArray] = []

    def found(point: FloatArray) -> bool:
        seen.append(point)
        return False

    result = programme.solve_integer(np.ones(3, dtype=np.bool_), start=np.array([1.0, 1.0, 0.0]), found=found)
    assert result.status == "Optimal"
    assert result.bound == pytest.approx(2.0)
    assert result.point is not None
    assert result.point.sum() == pytest.approx(2.0)
    assert solved(programme).objective == pytest.approx(1.5)
    programme.set_bounds(np.arange(3), np.zeros(3), np.zeros(3))
    nothing = programme.solve_integer(np.ones(3, dtype=np.bool_))
    assert (nothing.status, nothing.bound, nothing.point) == ("Infeasible", math.inf, None)


def streams(send: Callable[..., None], nodes: Any) -> None:
    send("incumbent", nodes)
    send("bound", 0.25)
    send("bound", 0.125)
    send("done", True)


def sleeps(send: Callable[..., None], nodes: Any) -> None:
    send("incumbent", nodes)
    send("bound", 0.25)
    time.sleep(60)


def crashes(send: Callable[..., None], _: Any) -> None:
    send("bound", 0.25)
    raise ValueError("out of ideas")


def dies(*_: Any) -> None:
    os._exit(7)


def run_of(rule: StopRule) -> Run:
    return Run(strokes(4), rule.start())


HERE = "tests.ordering.test_cut_programme"


def test_what_a_child_finds_is_heard() -> None:
    run = run_of(StopRule())
    assert prove_in_child(run, f"{HERE}:streams", np.arange(4) * 2) is StopReason.FINISHED
    assert run.bound == 0.25
    assert run.nodes.tolist() == [0, 2, 4, 6]


def test_a_cancel_ends_a_child() -> None:
    run = run_of(StopRule(cancelled=lambda: run.bound > 0))
    started = time.perf_counter()
    assert prove_in_child(run, f"{HERE}:sleeps", np.arange(4) * 2) is StopReason.CANCELLED
    assert run.bound == 0.25
    assert time.perf_counter() - started < 30


def test_a_late_child_is_ended(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr("optplan_models.child.GRACE", 0.1)
    run = run_of(StopRule(seconds=0.1))
    assert prove_in_child(run, f"{HERE}:sleeps", np.arange(4) * 2) is StopReason.TIME


@pytest.mark.parametrize(("function", "why"), [("crashes", "out of ideas"), ("dies", "exit code 7")])
def test_a_failure_is_told(function: str, why: str) -> None:
    run = run_of(StopRule())
    assert prove_in_child(run, f"{HERE}:{function}", 0) is StopReason.FAILED
    assert why in run.message
