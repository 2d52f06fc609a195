"""Wheels on finished work: planted crossings are counted, in the order in which things happen."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest

from optplan.domain.options import Options, OrderOptions
from optplan.domain.result import Cover, Plan
from optplan.domain.stroke import Stroke
from optplan.judge import verify
from tests.judge.hand_made import RAKE, Pen, plan_of
from tests.strategies import PLOTTER

ACROSS = Stroke("across", np.array([[0.0, 0.0], [4.0, 0.0]]))
"""0.1 m wide, along the x axis"""
UP = Stroke("up", np.array([[2.0, -2.0], [2.0, 2.0]]))
ASIDE = Stroke("aside", np.array([[0.0, 5.0], [4.0, 5.0]]))


def driven(*strokes: Stroke) -> Plan:
    pen = Pen(np.array([0.0, 0.0]))
    for k, stroke in enumerate(strokes):
        pen.draw(stroke, k)
    return plan_of(RAKE, pen.path, Cover(tuple(strokes)))


def metres(plan: Plan) -> float:
    return next(check.value for check in verify(plan).checks if check.name == "wheels over finished work")


def test_each_wheel_counts_once_across_a_mark() -> None:
    """The way from the one to the other is the same, whatever it drives over."""
    short = replace(UP, points=np.array([[2.0, -2.0], [2.0, -1.0]]))
    assert metres(driven(ACROSS, UP)) - metres(driven(ACROSS, short)) == pytest.approx(2 * 0.1, rel=1e-6)


def test_what_comes_later_is_not_driven_over() -> None:
    first, second = metres(driven(UP, ACROSS)), metres(driven(UP, ASIDE))
    assert first > second


def test_dry_work_does_not_count() -> None:
    plan = driven(ACROSS, ASIDE, UP)
    wet = metres(plan)
    assert wet >= 0.2
    assert plan.trajectory is not None
    quick = replace(plan, options=Options(order=OrderOptions(drying=1e-3)))
    slow = replace(plan, options=Options(order=OrderOptions(drying=plan.trajectory.duration)))
    # the way that begins where the mark has just been finished still counts
    assert metres(quick) <= wet - 0.2 + 1e-9
    assert metres(slow) == pytest.approx(wet)


def test_robots_without_wheels_have_none() -> None:
    assert metres(replace(driven(ACROSS, UP), robot=PLOTTER)) == 0
