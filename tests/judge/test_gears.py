"""Driving backwards: what the judge lets pass, and the planted faults that it finds."""

from __future__ import annotations

import math
from dataclasses import replace

import numpy as np
import pytest

from optplan.domain.errors import InputError
from optplan.domain.path import Path, Trajectory
from optplan.domain.result import Cover, Plan
from optplan.domain.robot import DiffDrive
from optplan.domain.stroke import Stroke
from optplan.judge import verify
from optplan.timing.fastest import profile as planned
from tests.judge.hand_made import CAR, failures, plan_of, spoiled

assert isinstance(CAR.mobility, DiffDrive)
BOTH_WAYS = replace(CAR, mobility=replace(CAR.mobility, reverses=True))


def there_and_back() -> Plan:
    """A line forwards, an arc on, back along an arc the other way, and a line again: C|C."""
    cover = Cover((Stroke("one", np.array([[0.0, 0], [2, 0]])), Stroke("two", np.array([[3.0, 2], [3, 4]]))))
    quarter = math.pi / 2
    zero = np.zeros(4)
    # arcs of radius 1: forwards to (2 + sin, 1 - cos), backwards with the body turning on to the left
    half = quarter / 2
    at = np.array([2 + math.sin(half), 1 - math.cos(half)])
    # backwards the travel heading is half + pi; the arc goes on to the left
    travel = half + math.pi
    end = at + np.array([math.sin(travel + half) - math.sin(travel), math.cos(travel) - math.cos(travel + half)])
    start = np.array([[0, 0, 0], [2, 0, 0], [*at, 0], [*end, 0]])
    path = Path(
        start, np.array([0, 0, travel, quarter]), zero, np.array([0, 1.0, 1.0, 0]), zero,
        np.array([2, half, half, 2.0]), zero, zero, np.array([1, 0, 0, 1]), np.array([0, -1, -1, 1]),
        gear=np.array([1, 1, -1, 1]),
    )  # fmt: skip
    cover = replace(cover, strokes=(cover.strokes[0], Stroke("two", np.array([end, end + np.array([0, 2.0])]))))
    return plan_of(BOTH_WAYS, path, cover)


def test_a_cusp_at_rest_passes() -> None:
    plan = there_and_back()
    report = verify(plan)
    assert failures(report) == set()
    assert report.figure("gear changes") == 2
    assert report.figure("backwards") == pytest.approx(math.pi / 4)
    assert plan.path is not None
    assert plan.path.cusps.tolist() == [2, 3]


def test_speeds_are_0_at_cusps() -> None:
    plan = there_and_back()
    assert plan.path is not None
    timed = replace(plan, trajectory=planned(plan.path, BOTH_WAYS, plan.options))
    report = verify(timed)
    assert failures(report) == set()
    assert timed.trajectory is not None
    for row in plan.path.cusps:
        assert np.interp(plan.path.offsets[row], timed.trajectory.s, timed.trajectory.v) == 0.0


def test_a_gear_change_at_speed_is_found() -> None:
    plan = there_and_back()
    assert plan.trajectory is not None
    assert plan.path is not None
    slow = np.full(len(plan.path) + 1, 0.1)
    offsets = plan.path.offsets
    moving = Trajectory(plan.path, offsets, offsets / 0.1, slow)
    report = verify(replace(plan, trajectory=moving))
    assert "gear changes" in failures(report)
    check = next(check for check in report.checks if check.name == "gear changes")
    assert check.value == pytest.approx(0.1)
    assert "2 gear changes" in check.detail


def test_a_gear_that_changes_without_the_heading_is_found() -> None:
    """The body would have to turn round in no time."""
    plan = there_and_back()
    assert plan.path is not None
    flipped = spoiled(plan, gear=np.array([1, -1, -1, 1]))
    report = verify(flipped)
    assert "headings" in failures(report)
    assert next(check.value for check in report.checks if check.name == "headings") == pytest.approx(math.pi)


def test_a_robot_that_cannot_reverse_is_not_driven_backwards() -> None:
    report = verify(replace(there_and_back(), robot=CAR))
    assert failures(report) == {"backwards"}


def test_a_cusp_without_a_gear_is_a_corner() -> None:
    assert "headings" in failures(verify(spoiled(there_and_back(), gear=np.ones(4, dtype=np.int64))))


def test_gears_are_1_or_minus_1() -> None:
    plan = there_and_back()
    assert plan.path is not None
    with pytest.raises(InputError, match="gear"):
        replace(plan.path, gear=np.array([1, 0, 1, 1]))
