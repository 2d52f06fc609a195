"""Commands to the tool: each is given its delay ahead of the change, and none overtakes another."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest

import optplan as op
from optplan.domain.arrays import FloatArray
from optplan.domain.errors import InputError
from optplan.domain.options import Options, OrderOptions
from optplan.domain.path import Path, Trajectory
from optplan.domain.result import Plan
from optplan.exports.tool import tool_text
from optplan.timing.actuation import tool_commands
from optplan.timing.fastest import profile
from optplan.timing.sampling import begins
from tests.strategies import PLOTTER, TOOL


def _line(lengths: list[float], tools: list[int]) -> Path:
    count = len(lengths)
    zero, offsets = np.zeros(count), np.concatenate([[0.0], np.cumsum(lengths)])[:-1]
    start = np.column_stack([offsets, zero, zero])
    strokes = np.where(np.array(tools) > 0, np.arange(count), -1)
    return Path(start, zero, zero, zero, zero, np.array(lengths), zero, zero, np.array(tools), strokes)


def _place_at(made: Trajectory, time: FloatArray) -> FloatArray:
    """By fine steps through the knots."""
    places = []
    for t in time.tolist():
        k = int(np.clip(np.searchsorted(made.t, t, side="right") - 1, 0, len(made.t) - 2))
        step = made.t[k + 1] - made.t[k]
        rate = (made.v[k + 1] - made.v[k]) / step if step > 0 else 0.0
        into = max(t - made.t[k], 0.0)
        places.append(made.s[k] + made.v[k] * into + rate * into**2 / 2)
    return np.array(places)


def test_changes_are_told_ahead() -> None:
    made = profile(_line([2.0, 1.0, 2.0, 1.0, 1.0], [0, 1, 0, 2, 0]), PLOTTER)
    commands = tool_commands(made, replace(TOOL, on_delay=0.5, off_delay=0.2))
    assert commands.setting.tolist() == [1, 0, 2, 0]
    assert commands.at == pytest.approx([2.0, 3.0, 5.0, 6.0])
    reached = np.interp(commands.at, made.s, np.arange(len(made.s)))
    assert (reached == np.round(reached)).all()
    ahead = made.t[reached.astype(int)] - commands.time
    assert ahead == pytest.approx([0.5, 0.2, 0.5, 0.2])
    assert commands.s == pytest.approx(_place_at(made, commands.time))


def test_without_delays_they_are_given_where_they_hold() -> None:
    made = profile(_line([2.0, 1.0], [0, 1]), PLOTTER)
    commands = tool_commands(made, TOOL)
    assert commands.setting.tolist() == [1, 0]  # raised at the end
    assert commands.s == pytest.approx(commands.at)


def test_a_gap_too_short_for_the_tool_is_not_tried() -> None:
    made = profile(_line([1.0, 1.0, 0.01, 1.0], [0, 1, 0, 1]), PLOTTER)
    commands = tool_commands(made, replace(TOOL, on_delay=1.0))
    assert commands.setting.tolist() == [1, 1, 0]
    assert (np.diff(commands.time) > 0).all()


def test_marks_at_the_beginning_are_told_before_it() -> None:
    made = profile(_line([1.0], [1]), PLOTTER)
    commands = tool_commands(made, replace(TOOL, on_delay=0.3))
    assert commands.time[0] == pytest.approx(-0.3)
    assert commands.s[0] == 0


def test_what_works_at_a_stop_is_on_while_the_robot_stands() -> None:
    """A turn on the spot, five seconds of work, another turn: in their order, and the turns take what is left."""
    zero = np.zeros(5)
    path = Path(
        np.array([[0.0, 0, 0], [2, 0, 0], [2, 0, 0], [2, 0, 0], [2, 0, 0]]),
        zero, zero, zero, zero,
        np.array([2.0, 0, 0, 0, 2]),
        np.array([0, 1.0, 0, 3, 0]),
        np.array([0, 0, 5.0, 0, 0]),
        np.array([0, 0, 1, 0, 0]),
        np.array([-1, -1, 0, -1, -1]),
    )  # fmt: skip
    made = Trajectory(
        path, np.array([0, 1, 2.0, 2, 3, 4]), np.array([0, 2, 4.0, 13, 15, 17]), np.array([0, 1, 0, 0, 1, 0.0])
    )
    assert begins(made) == pytest.approx([0, 4, 5, 10, 13, 17])
    commands = tool_commands(made, replace(TOOL, on_delay=0.5, off_delay=0.25))
    assert commands.setting.tolist() == [1, 0]
    assert commands.time == pytest.approx([4.5, 9.75])
    assert commands.s == pytest.approx([2.0, 2.0])


def test_a_plans_commands_are_written() -> None:
    plan = op.plan(op.read(op.instance("logo")), "beach-rake", Options(order=OrderOptions(iterations=100)))
    rows = [line.split(",") for line in tool_text(plan).splitlines()]
    assert rows[0] == ["t", "s", "tool", "code", "reached"]
    times = [float(row[0]) for row in rows[1:]]
    assert times == sorted(times)
    assert rows[-1][2] == "up"
    assert plan.path is not None
    assert len(rows) - 1 == int((np.diff(np.concatenate([[0], plan.path.tool, [0]])) != 0).sum())
    with pytest.raises(InputError, match="no speeds yet"):
        tool_text(Plan(plan.job, plan.robot, plan.options, plan.cover))


def test_delays_below_zero_are_refused() -> None:
    with pytest.raises(InputError, match="off_delay"):
        replace(TOOL, off_delay=-1.0)
