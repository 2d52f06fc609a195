"""Tools that answer late."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest

import optplan as op
from optplan.domain.drive import Drive
from optplan.simulation.switching import switched
from tests.simulation.plans import path_of, plan_of, rake

PATH = path_of([(2.0, 0.0, 0.0, 0.0), (1.0, 0.0, 0.0, 0.0), (2.0, 0.0, 0.0, 0.0)], [1, 0, 1])


def _drive(on: float, off: float) -> Drive:
    robot = rake()
    slow = replace(robot, tool=replace(robot.tool, on_delay=on, off_delay=off))
    plan = replace(plan_of(PATH), robot=slow)
    return op.simulate(plan, op.DriveOptions(ideal=True))


@pytest.mark.parametrize(("on", "off"), [(0.3, 0.0), (0.0, 0.2), (0.4, 0.1)])
def test_marks_begin_and_end_where_they_should_though_the_tool_is_late(on: float, off: float) -> None:
    drive = _drive(on, off)
    assert drive.finished
    changes = np.flatnonzero(np.diff(drive.tool)) + 1
    assert 2 <= len(changes) <= 4  # down at the start and up at the end, besides the gap, where these are late
    raised = drive.tool_x[(drive.tool == 0) & (drive.tool_x > 0.5) & (drive.tool_x < 4.5)]
    # at 100 Hz and 0.4 m/s a moment is 4 mm
    assert raised.min() == pytest.approx(2.0, abs=0.01)
    assert raised.max() == pytest.approx(3.0, abs=0.01)
    assert drive.figure("ends of marks, greatest error") < 0.01


def test_a_tool_that_answers_at_once_has_no_such_figure() -> None:
    with pytest.raises(KeyError):
        _drive(0.0, 0.0).figure("ends of marks, greatest error")


@pytest.mark.parametrize(("gap", "on"), [(0.05, 1.0), (0.1, 0.8)])
def test_a_gap_that_is_too_short_for_the_tool_is_an_error_as_long_as_the_gap(gap: float, on: float) -> None:
    robot = rake()
    slow = replace(robot, tool=replace(robot.tool, on_delay=on))
    path = path_of([(2.0, 0.0, 0.0, 0.0), (gap, 0.0, 0.0, 0.0), (2.0, 0.0, 0.0, 0.0)], [1, 0, 1])
    drive = op.simulate(replace(plan_of(path), robot=slow), op.DriveOptions(ideal=True))
    inside = (drive.tool_x > 2.0) & (drive.tool_x < 2.0 + gap)
    assert (drive.tool[inside] == 1).all()
    assert drive.figure("ends of marks, greatest error") == pytest.approx(gap, abs=0.005)


@pytest.mark.parametrize("delay", [0.1, 0.4])
@pytest.mark.parametrize("pace", [0.5, 1.0, 1.5])
def test_a_robot_at_another_speed_than_planned_misses_by_what_it_drives_meanwhile(delay: float, pace: float) -> None:
    tool = replace(rake().tool, on_delay=delay, off_delay=delay)
    trajectory = plan_of(PATH).trajectory
    assert trajectory is not None
    # every place is reached at a moment that is stretched; commands go by place, delays do not stretch
    time = np.arange(0.0, trajectory.duration / pace + 1.0, 0.001)
    place = np.interp(time * pace, trajectory.t, trajectory.s)
    lag = np.interp(time, trajectory.t, trajectory.s) - place
    _, missed = switched(time, lag, trajectory, tool)
    speed = float(np.max(np.diff(trajectory.s) / np.maximum(np.diff(trajectory.t), 1e-12)))
    assert missed == pytest.approx(abs(pace - 1) * delay * speed, abs=0.004)
