"""HiGHS in a child process."""

from __future__ import annotations

import io
import math
import os
import signal
import threading
import time
from pathlib import Path
from typing import Any

import numpy as np
import psutil
import pyomo.environ as pyo
import pytest

from optplan.ordering.arrays import dense_costs
from optplan_models import highs, worker
from optplan_models.ordering import mtz
from tests.ordering_cases import strokes


def knapsack(count: int = 12) -> Any:
    model = pyo.ConcreteModel()
    model.take = pyo.Var(range(count), domain=pyo.Binary)
    model.rest = pyo.Var(bounds=(0, 3))
    model.cost = pyo.Objective(expr=5 - sum((3 + (7 * k) % 11) * model.take[k] for k in range(count)) - model.rest)
    model.room = pyo.Constraint(expr=sum((2 + (5 * k) % 7) * model.take[k] for k in range(count)) + model.rest <= 20)
    model.few = pyo.Constraint(expr=(1, sum(model.take.values()), 6))
    model.pair = pyo.Constraint(expr=model.take[0] == model.take[1])
    return model


def hard() -> highs.Compiled:
    """A model that keeps HiGHS busy for long."""
    problem = strokes(40)
    model = mtz.build(
        dense_costs(problem),
        problem.cluster,
        problem.start_costs,
        problem.end_costs,
        problem.node_costs,
        problem.precedence,
    )
    mtz.set_path(model, problem.cluster, np.arange(40) * 2)
    return highs.compile_model(model)


def children() -> list[psutil.Process]:
    return psutil.Process().children(recursive=True)


def test_a_small_model_is_solved_and_read_back() -> None:
    model = knapsack()
    compiled = highs.compile_model(model)
    result = highs.run(compiled)
    assert result.status == "Optimal"
    assert result.values is not None
    assert result.bound == pytest.approx(result.objective)
    highs.load_values(compiled, result.values)
    assert pyo.value(model.cost) == pytest.approx(result.objective)
    assert pyo.value(model.room.body) <= 20 + 1e-6
    assert pyo.value(model.take[0]) == pytest.approx(pyo.value(model.take[1]))
    # every choice of the 2^12
    best = min(
        5 - sum((3 + (7 * k) % 11) for k in chosen) - min(3, 20 - sum(2 + (5 * k) % 7 for k in chosen))
        for bits in range(1, 2**12)
        if 1 <= len(chosen := [k for k in range(12) if bits >> k & 1]) <= 6
        and (0 in chosen) == (1 in chosen)
        and sum(2 + (5 * k) % 7 for k in chosen) <= 20
    )
    assert result.objective == pytest.approx(best)


def test_relaxation_and_infeasibility() -> None:
    model = knapsack()
    compiled = highs.compile_model(model)
    assert highs.run(compiled.relaxed()).objective <= highs.run(compiled).objective + 1e-9
    model.never = pyo.Constraint(expr=sum(model.take.values()) >= 13)
    result = highs.run(highs.compile_model(model))
    assert (result.status, result.bound, result.values) == ("Infeasible", math.inf, None)


def test_the_start_is_used_and_progress_streams() -> None:
    compiled = hard()
    start = highs.start_values(compiled)
    assert start is not None
    found: list[float] = []
    bounds: list[float] = []
    result = highs.run(
        compiled,
        seconds=4.0,
        start=start,
        incumbent=lambda x: found.append(float(compiled.costs @ x)),
        bound=bounds.append,
    )
    assert result.status == "TimeLimit"
    assert result.values is not None
    assert result.objective <= float(compiled.costs @ start) + 1e-6
    assert 0 < result.bound <= result.objective
    assert bounds == sorted(bounds)
    assert found
    assert children() == []


def test_cancel_kills_the_child() -> None:
    started = time.perf_counter()
    result = highs.run(hard(), cancelled=lambda: time.perf_counter() - started > 1.5)
    assert result.status == "Cancelled"
    assert time.perf_counter() - started < 10
    assert children() == []


def test_keyboard_interrupt_kills_the_child() -> None:
    def interrupt() -> bool:
        raise KeyboardInterrupt

    with pytest.raises(KeyboardInterrupt):
        highs.run(hard(), cancelled=interrupt)
    assert children() == []


def test_a_crash_is_told() -> None:
    def kill() -> None:
        deadline = time.perf_counter() + 20
        while time.perf_counter() < deadline:
            for child in children():
                os.kill(child.pid, signal.SIGKILL)
                return
            time.sleep(0.01)

    thread = threading.Thread(target=kill)
    thread.start()
    with pytest.raises(highs.HighsError, match="unexpectedly"):
        highs.run(hard())
    thread.join()
    assert children() == []


def test_an_error_in_the_child_is_told() -> None:
    with pytest.raises(highs.HighsError, match="no option"):
        highs.run(highs.compile_model(knapsack()), options={"no_such_option": 1})


def test_a_child_that_cannot_start(monkeypatch: pytest.MonkeyPatch, tmp_path: Path) -> None:
    monkeypatch.setattr("sys.executable", str(tmp_path / "python"))
    with pytest.raises(highs.HighsError, match="cannot be started"):
        highs.run(highs.compile_model(knapsack()))


def test_frames() -> None:
    out = io.BytesIO()
    worker.send(out, "bound", 1.5)
    assert int.from_bytes(out.getvalue()[:8], "little") == len(out.getvalue()) - 8
