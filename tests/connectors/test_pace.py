"""Connectors that take the least time."""

from __future__ import annotations

import math
from dataclasses import replace

import numpy as np
import pytest

import optplan as op
from optplan.connectors.families import family_of, limits_between
from optplan.connectors.pace import pace_of
from optplan.domain.errors import InputError
from optplan.domain.job import Field, FieldSegment
from optplan.domain.options import ConnectOptions, Options, OrderOptions, TimeOptions
from optplan.geometry.cc import cc_path

ROBOT = op.load_robot("line-marker")
OPTIONS = Options(order=OrderOptions(metric="time"), time=TimeOptions(work_speed=1.5, transit_speed=1.9))
PACE = pace_of(ROBOT, OPTIONS)


def _states(count: int, seed: int) -> np.ndarray:
    random = np.random.default_rng(seed)
    place = random.uniform(-8, 8, (count, 2))
    return np.column_stack([place, random.uniform(-math.pi, math.pi, count), np.zeros(count)])


def test_rungs_fall_in_speed_and_rise_in_curvature() -> None:
    curvatures = [limits.curvature for limits in PACE.rungs]
    assert curvatures == sorted(curvatures)
    assert len(set(PACE.rungs)) == len(PACE.rungs) > 3


def test_times_are_those_of_the_speed_profile_of_the_same_connector() -> None:
    """Two long lines joined by the connector: what the whole takes, less what the lines take at work speed."""
    lines = [_states(12, 1), _states(12, 2)]
    family = family_of(ROBOT, OPTIONS)
    for here, there in zip(*lines, strict=True):
        times = PACE.times(here[None], there[None])
        kappa, sharpness = limits_between(here, there, family)
        made = cc_path(here, there, kappa, sharpness)
        back = 30.0
        first = [*(here[:2] - back * np.array([math.cos(here[2]), math.sin(here[2])])), here[2]]
        from optplan.domain.path import Path
        from optplan.geometry.curves import Curve

        length = np.concatenate([[back], made.lengths, [back]])
        curve = Curve(
            np.array(first),
            np.concatenate([[0.0], made.curvatures, [0.0]]),
            np.concatenate([[0.0], made.sharpnesses, [0.0]]),
            length,
        )
        count = len(length)
        zero = np.zeros(count)
        tool = np.array([1, *([0] * (count - 2)), 1])
        stroke = np.array([0, *([-1] * (count - 2)), 1])
        places = np.column_stack([curve.states[:-1, :2], zero])
        path = Path(
            places, curve.states[:-1, 2], zero, curve.curvature, curve.sharpness, length, zero, zero, tool, stroke
        )
        made_trajectory = op.profile(path, ROBOT, OPTIONS)
        at_ends = np.interp([back, curve.total - back], made_trajectory.s, made_trajectory.t)
        assert times[0] == pytest.approx(at_ends[1] - at_ends[0], rel=0.02, abs=0.05)


def test_matrix_and_pairs_agree_and_no_rung_is_faster() -> None:
    here, there = _states(30, 3), _states(20, 4)
    matrix = PACE.matrix(here, there)
    rows, columns = np.divmod(np.arange(matrix.size), matrix.shape[1])
    by_rung = PACE.by_rung(here[rows], there[columns])
    assert matrix.ravel() == pytest.approx(by_rung.min(axis=0), rel=1e-12)
    straight = np.linalg.norm(here[rows, :2] - there[columns, :2], axis=1)
    assert (matrix.ravel() >= straight / 1.9 - 1e-9).all()


def test_plans_by_time_are_no_slower_than_plans_by_length() -> None:
    random = np.random.default_rng(5)
    segments = []
    for k in range(7):
        start = random.uniform(0, 25, 2)
        angle = random.uniform(0, 2 * math.pi)
        segments.append(FieldSegment(f"s{k}", start, start + 6 * np.array([math.cos(angle), math.sin(angle)])))
    field = Field("x", tuple(segments))
    plans = {m: op.plan(field, ROBOT, replace(OPTIONS, order=OrderOptions(metric=m))) for m in ("cc", "time")}
    for plan in plans.values():
        assert plan.report is not None
        assert plan.report.ok
        assert plan.ordering is not None
        assert plan.ordering.status.value == "optimal"
    durations = {name: plan.trajectory.duration for name, plan in plans.items() if plan.trajectory is not None}
    assert durations["time"] <= durations["cc"]
    fast = plans["time"]
    assert fast.ordering is not None
    assert fast.trajectory is not None
    assert fast.ordering.unit == "s"
    assert {check.name: check for check in fast.report.checks}["cost"].value == pytest.approx(  # type: ignore[union-attr]
        fast.ordering.cost, rel=0.02
    )


@pytest.mark.parametrize(
    ("robot", "options", "match"),
    [
        ("pen-plotter", OPTIONS, "wheels"),
        ("line-marker", replace(OPTIONS, time=TimeOptions(constant_speed=1.0)), "'cc'"),
        ("line-marker", replace(OPTIONS, connect=ConnectOptions(reversing=True)), "forwards"),
    ],
)
def test_what_time_cannot_do_is_said(robot: str, options: Options, match: str) -> None:
    with pytest.raises(InputError, match=match):
        family_of(op.load_robot(robot), options)
