"""Plans whose connectors have continuous curvature."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest

import optplan as op
from optplan.connectors.families import family_of
from optplan.domain.errors import InputError
from optplan.domain.options import Options, OrderOptions, PageOptions
from optplan.domain.ordering import Status
from optplan.domain.report import Verdict

PAGE = """<svg xmlns="http://www.w3.org/2000/svg" viewBox="0 0 20 20">
<path d="M2 2H9" fill="none" stroke="#000"/><path d="M12 5L18 9" fill="none" stroke="#000"/>
<path d="M4 9V16" fill="none" stroke="#000"/><path d="M9 15L16 16" fill="none" stroke="#000"/>
<path d="M10 8Q12 12 15 12" fill="none" stroke="#000"/></svg>"""
CC = Options(order=OrderOptions(metric="cc"))


def test_the_robot_stops_before_a_ring_tighter_than_connectors() -> None:
    """Its curvature may jump while it stands, and nowhere else."""
    ring = """<svg xmlns="http://www.w3.org/2000/svg" viewBox="0 0 20 20"><path d="M2 2H18M2 18H18" fill="none"
    stroke="#000"/><circle id="ring" cx="10" cy="10" r="0.12" fill="none" stroke="#000"/></svg>"""
    options = Options(order=OrderOptions(metric="cc", start=(1.0, 1.0)), page=PageOptions(margin=5.0))
    robot = op.load_robot("line-marker")
    # beside its tool the robot would drive a wider ring
    plan = op.plan(op.read(ring), replace(robot, tool=replace(robot.tool, right=0.0)), options)
    assert plan.report is not None
    assert plan.report.ok, [check for check in plan.report.checks if check.verdict is Verdict.FAILED]
    assert plan.report.figure("continuity order") == 2
    assert plan.path is not None
    tight = np.abs(plan.path.curvature) > 1.7
    assert (plan.path.tool[tight] > 0).all()
    assert plan.path.is_stop.sum() == 2


@pytest.mark.parametrize("start", [None, (5.0, 5.0)])
def test_connectors_are_g2_within_limits_and_cost_what_was_said(start: tuple[float, float] | None) -> None:
    plan = op.plan(op.read(PAGE), "line-marker", Options(order=OrderOptions(metric="cc", start=start)))
    assert plan.report is not None
    assert plan.report.ok
    path, ordering = plan.path, plan.ordering
    assert path is not None
    assert ordering is not None
    assert ordering.status is Status.OPTIMAL
    between = path.stroke < 0
    assert path.length[between].sum() == pytest.approx(ordering.cost, rel=1e-9)
    family = family_of(plan.robot, CC)
    bend = path.curvature + path.sharpness * path.length
    assert np.abs(np.concatenate([path.curvature, bend])[np.tile(between, 2)]).max() <= (1 + 1e-9) / family.radius
    assert np.abs(path.sharpness).max() <= family.sharpness * (1 + 1e-9)
    assert (path.sharpness[between] != 0).any()
    # wherever a connector begins, goes on or ends, curvature is continuous
    joint = between[1:] | between[:-1]
    assert np.abs(path.curvature[1:] - bend[:-1])[joint].max() < 1e-9
    dubins = op.plan(op.read(PAGE), "line-marker", Options(order=OrderOptions(metric="dubins", start=start)))
    assert dubins.ordering is not None
    assert dubins.ordering.cost <= ordering.cost


def test_robots_that_follow_any_curve_have_no_use_for_it() -> None:
    with pytest.raises(InputError, match="follows any curve"):
        op.plan(op.read(PAGE), "pen-plotter", CC)
