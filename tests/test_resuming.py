"""The rest of an interrupted plan."""

from __future__ import annotations

import math
from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest
from typer.testing import CliRunner

import optplan as op
from optplan.cli.commands import app
from optplan.domain.errors import InputError
from optplan.domain.options import Options, OrderOptions
from optplan.domain.result import Plan

PAGE = """<svg xmlns="http://www.w3.org/2000/svg" viewBox="0 0 20 20">
<path d="M2 2H9" fill="none" stroke="#000"/><path d="M9 3H2" fill="none" stroke="#000"/>
<rect id="box" x="11" y="11" width="4" height="3" fill="#000" stroke="none"/>
<path d="M4 9V16" fill="none" stroke="#000"/><path d="M9 15L10 16" fill="none" stroke="#000"/></svg>"""


@pytest.fixture(scope="module")
def plan() -> Plan:
    return op.plan(op.read(PAGE), "beach-rake", Options(order=OrderOptions(iterations=300)))


def standing(plan: Plan, heading: float | None = 1.0) -> Options:
    return replace(plan.options, order=replace(plan.options.order, start=(1.0, 2.0), heading=heading))


@pytest.mark.parametrize("reorder", [False, True])
@pytest.mark.parametrize("done", [0, 2, 3])
def test_the_rest_is_done_from_where_the_robot_stands(plan: Plan, done: int, reorder: bool) -> None:
    rest = op.resumed(plan, done, standing(plan), reorder=reorder)
    assert plan.visits is not None
    assert plan.cover is not None
    assert rest.visits is not None
    assert rest.cover is not None
    assert rest.path is not None
    assert rest.report is not None
    assert rest.report.ok, rest.report
    assert rest.path.start[0].tolist() == [1.0, 2.0, 0.0]
    assert rest.path.heading[0] == pytest.approx(1.0)
    left = [plan.cover.strokes[k].id for k in plan.visits.stroke[done:]]
    found = [rest.cover.strokes[k].id for k in rest.visits.stroke]
    assert sorted(found) == sorted(left)
    assert reorder or found == left
    assert (rest.ordering is not None) == reorder


def test_what_is_partly_done_is_no_longer_judged(plan: Plan) -> None:
    assert plan.cover is not None
    assert plan.visits is not None
    box = {area.element for area in plan.cover.areas}
    assert len(box) == 1
    first = min(k for k, s in enumerate(plan.visits.stroke) if plan.cover.strokes[s].element in box)
    rest = op.resumed(plan, first + 1, standing(plan, None))
    assert rest.cover is not None
    assert rest.cover.areas == ()


def test_wrong_numbers_are_refused(plan: Plan) -> None:
    assert plan.visits is not None
    with pytest.raises(InputError, match=r"expected 0\.\."):
        op.resumed(plan, len(plan.visits), standing(plan))
    with pytest.raises(InputError, match="no order yet"):
        op.resumed(Plan(plan.job, plan.robot, plan.options, plan.cover), 0, standing(plan))
    with pytest.raises(InputError, match="there is no start"):
        OrderOptions(heading=1.0)
    with pytest.raises(InputError, match="finite"):
        OrderOptions(start=(0.0, 0.0), heading=math.inf)


def test_a_heading_at_the_start_is_kept_by_a_robot_that_cannot_turn() -> None:
    options = Options(order=OrderOptions(start=(5.0, 5.0), heading=2.0, iterations=300))
    made = op.plan(op.read(PAGE), "line-marker", options)
    assert made.path is not None
    assert made.ordering is not None
    assert made.report is not None
    assert made.report.ok
    assert made.path.heading[0] == pytest.approx(2.0)
    free = op.plan(op.read(PAGE), "line-marker", replace(options, order=replace(options.order, heading=None)))
    assert free.ordering is not None
    assert free.ordering.cost <= made.ordering.cost


def test_from_the_command_line(plan: Plan, tmp_path: Path) -> None:
    op.save_plan(plan, tmp_path / "plan.json")
    run = CliRunner().invoke(app, ["resume", str(tmp_path / "plan.json"), "--done", "2", "--from", "1,2,90"])
    assert run.exit_code == 0, run.output
    rest = op.load_plan(tmp_path / "plan-rest.json")
    assert rest.options.order.heading == pytest.approx(math.pi / 2)
    assert rest.path is not None
    assert np.isclose(rest.path.heading[0], math.pi / 2)
    assert op.verify(rest).ok
