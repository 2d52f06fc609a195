"""Strokes with a run-in and a run-out."""

from __future__ import annotations

import math
from dataclasses import replace

import numpy as np
import pytest

import optplan as op
from optplan.domain.errors import InputError
from optplan.domain.job import Field, FieldSegment
from optplan.domain.options import ConnectOptions, CoverOptions, Options, OrderOptions, TimeOptions

ROBOT = op.load_robot("line-marker")
ARC = FieldSegment("arc", np.array([4.0, 0.0]), np.array([0.0, 4.0]), np.zeros(2), math.pi / 2)
PARTS = (FieldSegment("a", np.array([0.0, 8.0]), np.array([6.0, 8.0])), ARC)


@pytest.mark.parametrize("metric", ["cc", "dubins"])
@pytest.mark.parametrize("curved", [False, True])
def test_padding_is_driven_tool_up_and_counted(metric: str, curved: bool) -> None:
    asked = ConnectOptions(pad_before=0.5, pad_after=0.1, curved_padding=curved)
    options = Options(cover=CoverOptions(cut=False), order=OrderOptions(metric=metric), connect=asked)
    plan = op.plan(Field("x", PARTS), ROBOT, replace(options, time=TimeOptions(constant_speed=1.0)))
    assert plan.report is not None
    checks = {check.name: check for check in plan.report.checks}
    for name in ("gaps", "strokes", "deviation", "visits", "tool", "coverage", "cost"):
        assert checks[name].verdict.value == "passed", checks[name]
    # padding that goes on bent keeps the curvature continuous; straight padding steps at an arc
    bare = op.plan(Field("x", PARTS), ROBOT, replace(options, connect=ConnectOptions()))
    assert bare.ordering is not None
    assert plan.ordering is not None
    assert plan.path is not None
    order = plan.path.stroke
    for stroke in (0, 1):
        rows = np.flatnonzero(order == stroke)
        before = rows[0] - 1
        assert plan.path.tool[before] == 0
        assert plan.path.length[before] == pytest.approx(0.5)
        assert plan.path.length[rows[-1] + 1] == pytest.approx(0.1)
        bend = plan.path.curvature[rows[0]] if curved else 0.0
        assert plan.path.curvature[before] == pytest.approx(bend)


def test_padding_makes_plans_longer_never_shorter_than_the_padding() -> None:
    lengths = []
    for pad in (0.0, 0.3):
        asked = ConnectOptions(pad_before=pad, pad_after=pad)
        plan = op.plan(Field("x", PARTS), ROBOT, Options(order=OrderOptions(metric="cc"), connect=asked))
        assert plan.ordering is not None
        lengths.append(plan.ordering.cost)
    assert lengths[1] >= 4 * 0.3
    assert lengths[1] > lengths[0]


def test_turning_robots_and_drawings_take_padding_too() -> None:
    lines = '<path d="M10 10 L60 10 M20 40 L60 90 L10 90 Z" fill="none" stroke="black"/>'
    svg = f'<svg xmlns="http://www.w3.org/2000/svg" width="100" height="100">{lines}</svg>'
    options = Options(connect=ConnectOptions(pad_before=0.2, pad_after=0.3))
    plan = op.plan(op.read(svg), "beach-rake", options)
    assert plan.report is not None
    assert plan.report.ok, [check for check in plan.report.checks if check.verdict.value == "failed"]


def test_padding_says_what_it_cannot_do() -> None:
    with pytest.raises(InputError, match="'cc'"):
        op.plan(
            Field("x", PARTS), ROBOT, Options(order=OrderOptions(metric="time"), connect=ConnectOptions(pad_before=1))
        )
    for bad in (-1.0, math.nan, True):
        with pytest.raises(InputError, match="pad_before"):
            ConnectOptions(pad_before=bad)


def _clean(plan: op.Plan) -> None:
    assert plan.report is not None
    assert plan.report.ok, [check for check in plan.report.checks if check.verdict.value == "failed"]


@pytest.mark.parametrize("curved", [False, True])
@pytest.mark.parametrize("metric", ["cc", "dubins"])
def test_arcs_that_are_tighter_than_the_robot_steers_in_transit_have_it_too(metric: str, curved: bool) -> None:
    # the nozzle is outside of a left turn: the robot itself drives circles of 0.44 m and 0.19 m
    arcs = tuple(
        FieldSegment(f"{r}", np.array([x + r, 0.0]), np.array([x, r]), np.array([x, 0.0]), math.pi / 2, directed=True)
        for x, r in ((0.0, 0.85), (6.0, 0.6))
    )
    asked = ConnectOptions(pad_before=0.5, pad_after=0.1, curved_padding=curved)
    options = Options(cover=CoverOptions(cut=False), order=OrderOptions(metric=metric), connect=asked)
    plan = op.plan(Field("x", arcs), ROBOT, options)
    _clean(plan)
    assert plan.report is not None
    assert plan.report.figure("padding") == pytest.approx(2 * 0.6)


def test_closed_lines_have_it_and_stops_for_the_tank_do_not() -> None:
    ring = FieldSegment("ring", np.array([10.0, 0.0]), np.array([10.0, 0.0]), np.array([8.0, 0]), math.tau)
    asked = ConnectOptions(pad_before=0.5, pad_after=0.1)
    order = OrderOptions(metric="cc", start=(0.0, 0.0), refill=16.0)
    plan = op.plan(
        Field("x", (*PARTS, ring)), ROBOT, Options(cover=CoverOptions(cut=False), order=order, connect=asked)
    )
    _clean(plan)
    assert plan.report is not None
    assert plan.cover is not None
    assert any(stroke.is_stop for stroke in plan.cover.strokes)
    assert plan.report.figure("padding") == pytest.approx(3 * 0.6)
