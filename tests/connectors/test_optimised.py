"""Optimised connectors: feasible, at their ends, never worse than what they begin with."""

from __future__ import annotations

import csv
import math
from pathlib import Path

import numpy as np
import pytest

from optplan.connectors.optimised import optimised_connector, value_of
from optplan.domain.errors import InputError
from optplan.geometry.cc import cc_path
from optplan.geometry.curves import evaluate
from optplan_models.connector import Objective, Pace

ORACLES = Path(__file__).parents[3] / "shared" / "data" / "connectors"
PACE = Pace(1.4, 1.6, 0.25)


def states(seed: int, bend: float) -> tuple[np.ndarray, np.ndarray]:
    rng = np.random.default_rng(seed)
    first, last = (
        np.array([*rng.uniform(0, 6, 2), rng.uniform(-math.pi, math.pi), rng.uniform(-bend, bend)]) for _ in range(2)
    )
    return first, last


@pytest.mark.parametrize("objective", ["length", "time", "effort"])
@pytest.mark.parametrize("seed", range(6))
def test_it_is_a_connector_and_no_worse(seed: int, objective: Objective) -> None:
    start, end = states(seed, 1.0 if seed % 2 else 0.0)
    kappa, sigma = 1.1, 0.9
    answer = optimised_connector(start, end, kappa, sigma, objective, PACE)
    curve = answer.curve
    assert answer.converged
    assert curve is not None
    reached = curve.end
    assert math.hypot(*(reached[:2] - end[:2])) < 1e-6
    assert abs(math.remainder(reached[2] - end[2], 2 * math.pi)) < 1e-6
    assert curve.end_curvature[-1] == pytest.approx(end[3], abs=1e-6)
    dense = evaluate(curve, np.linspace(0, curve.total, 2000))
    assert np.abs(dense.curvature).max() <= kappa * (1 + 1e-6)
    assert np.abs(curve.sharpness).max() <= sigma * (1 + 1e-6)
    known = cc_path(start, end, kappa, sigma)
    if objective == "length":
        assert curve.total <= known.length * (1 + 1e-12)
    assert answer.value == pytest.approx(value_of(curve, objective, PACE))


def test_nowhere_to_go() -> None:
    here = np.array([1.0, 2.0, 0.5, 0.1])
    curve = optimised_connector(here, here, 1.0, 1.0).curve
    assert curve is not None
    assert curve.total == 0


def test_bad_input() -> None:
    here, there = np.zeros(4), np.array([1.0, 0.0, 0.0, 0.0])
    with pytest.raises(InputError):
        optimised_connector(here, there, 0.0, 1.0)
    with pytest.raises(InputError):
        optimised_connector(here, np.array([1.0, 0.0, math.nan, 0.0]), 1.0, 1.0)
    with pytest.raises(ValueError, match="pace"):
        optimised_connector(here, there, 1.0, 1.0, "time")


def test_it_meets_the_best_known() -> None:
    if not (ORACLES / "best.csv").is_file():
        pytest.skip("the oracles are not at hand")
    with (ORACLES / "cc00.csv").open() as stream:
        queries = {row["id"]: row for row in csv.DictReader(stream)}
    with (ORACLES / "best.csv").open() as stream:
        rows = [
            row for row in csv.DictReader(stream) if 1 <= float(row["kappa_max"]) ** 2 / float(row["sigma_max"]) <= 2
        ]
    good = 0
    for row in rows:
        query = {key: float(queries[row["id"]][key]) for key in ("x0", "y0", "th0", "x1", "y1", "th1")}
        start, end = np.array([*list(query.values())[:3], 0.0]), np.array([*list(query.values())[3:], 0.0])
        answer = optimised_connector(start, end, float(row["kappa_max"]), float(row["sigma_max"]))
        assert answer.curve is not None
        good += answer.curve.total <= 1.002 * float(row["best_known_len"])
    assert good >= 0.98 * len(rows)
