"""Tools that answer late."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest

import optplan as op
from optplan.domain.drive import Drive
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
