"""Plans whose connectors may be driven backwards."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest

import optplan as op
from optplan.domain.errors import InputError
from optplan.domain.options import ConnectOptions, Options, OrderOptions
from optplan.domain.robot import DiffDrive
from optplan.exports.points import csv_text, points_text
from optplan.schema.plans import plan_from_json, plan_json

PAGE = """<svg xmlns="http://www.w3.org/2000/svg" viewBox="0 0 20 20">
<path d="M2 2H9" fill="none" stroke="#000"/><path d="M9 3H2" fill="none" stroke="#000"/>
<path d="M4 9V16" fill="none" stroke="#000"/><path d="M9 15L16 16" fill="none" stroke="#000"/>
<path d="M10 8Q12 12 15 12" fill="none" stroke="#000"/></svg>"""


def options(metric: str, reversing: bool = True, start: tuple[float, float] | None = None) -> Options:
    return Options(order=OrderOptions(metric=metric, start=start), connect=ConnectOptions(reversing=reversing))


@pytest.mark.parametrize("start", [None, (5.0, 5.0)])
@pytest.mark.parametrize("metric", ["dubins", "cc"])
def test_connectors_with_cusps_are_shorter_and_cost_what_was_said(
    metric: str, start: tuple[float, float] | None
) -> None:
    plan = op.plan(op.read(PAGE), "line-marker", options(metric, start=start))
    forwards = op.plan(op.read(PAGE), "line-marker", options(metric, reversing=False, start=start))
    assert plan.report is not None
    assert plan.report.ok, [check for check in plan.report.checks if check.verdict.value == "failed"]
    path, ordering = plan.path, plan.ordering
    assert path is not None
    assert ordering is not None
    assert forwards.ordering is not None
    assert forwards.path is not None
    assert path.length[path.stroke < 0].sum() == pytest.approx(ordering.cost, rel=1e-9)
    assert ordering.cost < forwards.ordering.cost
    assert len(path.cusps) > 0
    assert (forwards.path.gear == 1).all()
    assert plan.report.figure("gear changes") == len(path.cusps)
    # work is done forwards
    assert (path.gear[path.stroke >= 0] == 1).all()
    # the heading of the body is continuous, that of travel turns round
    end = path.heading + path.length * (path.curvature + path.sharpness * path.length / 2)
    jump = np.cos(path.heading[path.cusps] - end[path.cusps - 1])
    assert jump == pytest.approx(-np.ones(len(jump)))
    if metric == "cc":
        bend = path.curvature + path.sharpness * path.length
        assert np.abs(bend[path.cusps - 1]).max() < 1e-9
        assert np.abs(path.curvature[path.cusps]).max() < 1e-9


def test_gears_are_written_and_read_again() -> None:
    plan = op.plan(op.read(PAGE), "line-marker", options("cc"))
    again = plan_from_json(plan_json(plan))
    assert plan.path is not None
    assert again.path is not None
    assert (again.path.gear == plan.path.gear).all()
    assert again.options.connect.reversing
    rows = csv_text(plan).splitlines()
    column = rows[0].split(",").index("gear")
    assert {row.split(",")[column] for row in rows[1:]} == {"1", "-1"}
    with pytest.raises(InputError, match="driven backwards"):
        points_text(plan)


def test_what_cannot_be_reversed_is_refused() -> None:
    drawing = op.read(PAGE)
    with pytest.raises(InputError, match="does not drive backwards"):
        op.plan(drawing, "beach-rake", options("cc"))
    with pytest.raises(InputError, match="does not drive backwards"):
        op.plan(drawing, "pen-plotter", options("auto"))
    rake = op.load_robot("beach-rake")
    assert isinstance(rake.mobility, DiffDrive)
    able = replace(rake, mobility=replace(rake.mobility, reverses=True))
    with pytest.raises(InputError, match="says nothing about the metric 'euclid'"):
        op.plan(drawing, able, options("auto"))


@pytest.mark.parametrize("headings", [(0.0, 0.0), (0.0, np.pi)])
def test_ways_around_areas_are_driven_in_one_gear(headings: tuple[float, float]) -> None:
    from shapely.geometry import LineString, Polygon

    from optplan.connectors.around import ReversingRoads
    from optplan.connectors.surroundings import Surroundings
    from optplan.geometry.curves import evaluate

    ring = np.array([(3.0, -2.0), (4.0, -2.0), (4.0, 2.0), (3.0, 2.0)])
    wall = Polygon(ring)
    roads = ReversingRoads(Surroundings((ring,), None, 0.1), 1.0, 1.0)
    start, end = np.array([0, 0, headings[0], 0.3]), np.array([7, 0, headings[1], 0.0])
    way = roads.between(start, end)
    assert way.source == "in one gear"
    # facing the wall the end is reached forwards; turned round there, either way costs a turn
    assert way.gear == 1 or headings[1] != 0
    turned = np.array([0, 0, 0 if way.gear > 0 else np.pi])
    assert way.curves[0].start == pytest.approx(start[:3] + turned)
    gap = way.curves[-1].end - turned - end[:3]
    assert [*gap[:2], np.sin(gap[2])] == pytest.approx([0, 0, 0], abs=1e-8)
    points = evaluate(way.curves[0], np.linspace(0, way.length, 2000)).points
    assert LineString(points).distance(wall) > 0.1 - 1e-3
    clear = roads.between(start, np.array([1.5, 1, 2.0, 0.0]))
    assert clear.source == "direct"
    assert len(clear.curves) > 1
    for before, after in zip(clear.curves, clear.curves[1:], strict=False):
        assert before.end[:2] == pytest.approx(after.start[:2])
        assert abs(np.sin(before.end[2] - after.start[2])) < 1e-9


def test_a_plan_among_areas_may_change_gear() -> None:
    ring = ((5.0, 4.0), (7.0, 4.0), (7.0, 8.0), (5.0, 8.0))
    areas = replace(options("cc"), connect=ConnectOptions(keep_out=(ring,), reversing=True))
    plan = op.plan(op.read(PAGE), "line-marker", areas)
    assert plan.report is not None
    assert plan.report.ok, [check for check in plan.report.checks if check.verdict.value == "failed"]
    assert plan.path is not None
    assert plan.ordering is not None
    assert len(plan.path.cusps) > 0
    assert plan.path.length[plan.path.stroke < 0].sum() == pytest.approx(plan.ordering.cost, rel=1e-9)
