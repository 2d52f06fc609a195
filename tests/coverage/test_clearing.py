"""Marking a field without driving into what is beside its lines."""

from __future__ import annotations

import math
from dataclasses import replace

import numpy as np
import pytest

import optplan as op
from optplan.domain.errors import InputError
from optplan.domain.job import Field, FieldSegment
from optplan.domain.options import ConnectOptions, Options, OrderOptions
from optplan.domain.result import Plan
from optplan.domain.robot import DiffDrive

array = np.array
MARKER = op.load_robot("line-marker")  # its nozzle is 0.41 m to its right
SIDE = FieldSegment("side", array([0.0, 0.0]), array([20.0, 0.0]))
LEFT = array([[9, 0.2], [11, 0.2], [11, 1], [9, 1]])
RIGHT = array([[9, -0.2], [11, -0.2], [11, -1], [9, -1]])


def areas(plan: Plan) -> tuple[str, float]:
    assert plan.report is not None
    found = {check.name: check for check in plan.report.checks}["areas"]
    return found.verdict.value, found.value


def test_a_line_is_not_marked_in_the_direction_in_which_the_robot_would_hit_something() -> None:
    plan = op.plan(Field("x", (SIDE,), keep_out=(LEFT,)), MARKER)
    assert plan.visits is not None
    assert plan.cover is not None
    assert plan.visits.reverse.tolist() == [True]
    assert any("against the order" in note.text and "obstacle 0" in note.text for note in plan.cover.notes)
    assert areas(plan) == ("passed", 0.0)
    assert plan.report is not None
    assert plan.report.ok


@pytest.mark.parametrize(
    ("segment", "rings", "names"),
    [
        (replace(SIDE, directed=True), (LEFT,), r"'side'.*its direction.*obstacle 0"),
        (SIDE, (LEFT, RIGHT), r"'side'.*any direction.*obstacle 0.*obstacle 1"),
    ],
)
def test_a_line_that_no_direction_is_free_for_is_refused_by_name(
    segment: FieldSegment, rings: tuple[np.ndarray, ...], names: str
) -> None:
    with pytest.raises(InputError, match=names):
        op.cover(Field("x", (segment,), keep_out=rings), MARKER)


def test_half_the_track_is_kept_while_marking_whatever_connectors_keep() -> None:
    assert isinstance(MARKER.mobility, DiffDrive)
    half = MARKER.mobility.track / 2
    for gap, free in ((half - 0.01, 1), (half + 0.01, 2)):
        box = array([[9, 0.41124 + gap], [11, 0.41124 + gap], [11, 2], [9, 2]])
        for clearance in (0.0, 1.0):
            options = Options(connect=ConnectOptions(clearance=clearance))
            strokes = op.cover(Field("x", (SIDE,), keep_out=(box,)), MARKER, options).strokes
            assert len(op.traversals(strokes, MARKER, options)) == free


def test_the_robot_stays_inside_the_fence_while_it_marks() -> None:
    fence = array([[-5, -0.1], [25, -0.1], [25, 9], [-5, 9]])
    strokes = op.cover(Field("x", (SIDE,), keep_in=fence), MARKER).strokes
    assert op.traversals(strokes, MARKER).reverse.tolist() == [False]
    with pytest.raises(InputError, match=r"'side'.*keep-in"):
        op.cover(Field("x", (replace(SIDE, start=SIDE.end, end=SIDE.start, directed=True),), keep_in=fence), MARKER)


@pytest.mark.parametrize("radius", [2.3, 3.2])
def test_a_ring_is_turned_round_where_only_one_direction_is_free(radius: float) -> None:
    """An obstacle inside is passed outside, and the other way round."""
    turn = np.linspace(0, 2 * math.pi, 24, endpoint=False)
    box = radius * np.column_stack([np.cos(turn), np.sin(turn)])
    box = box if radius < 3 else array([[3.2, -1], [5, -1], [5, 1], [3.2, 1]])
    ring = FieldSegment("ring", array([3.0, 0.0]), array([3.0, 0.0]), array([0.0, 0.0]), 2 * math.pi)
    field = Field("x", (ring,), keep_out=(box,), start=(0.0, -9.0))
    plan = op.plan(field, MARKER, Options(order=OrderOptions(metric="cc")))
    assert plan.path is not None
    away = np.linalg.norm(plan.path.start[plan.path.stroke >= 0, :2], axis=1)
    assert away == pytest.approx(np.full(len(away), 3.41124 if radius < 3 else 2.58876), abs=0.01)
    assert areas(plan)[0] == "passed"
    assert plan.report is not None
    assert plan.report.ok


def test_spots_are_crossed_in_the_directions_that_are_free() -> None:
    spot = FieldSegment("spot", array([0.0, 0.0]), array([0.0, 0.0]), spot=0.22)
    wall = array([[-5, 0.4], [5, 0.4], [5, 2], [-5, 2]])
    field = Field("x", (spot,), keep_out=(wall,))
    plan = op.plan(field, MARKER, Options(order=OrderOptions(metric="cc")))
    assert plan.cover is not None
    assert any("spot" in note.text and "directions" in note.text for note in plan.cover.notes)
    assert areas(plan)[0] == "passed"


def test_lines_that_go_on_are_marked_one_by_one_where_no_direction_is_free_for_both() -> None:
    other = FieldSegment("other", array([20.0, 0.0]), array([40.0, 0.0]))
    strokes = op.cover(Field("x", (SIDE, other), keep_out=(LEFT,)), MARKER).strokes
    assert [stroke.id for stroke in strokes] == ["side+"]
    strokes = op.cover(Field("x", (SIDE, other), keep_out=(LEFT, RIGHT + array([20.0, 0.0]))), MARKER).strokes
    assert [stroke.id for stroke in strokes] == ["side", "other"]
    assert op.traversals(strokes, MARKER).reverse.tolist() == [True, False]


def test_directions_that_are_kept_give_way_to_obstacles() -> None:
    options = Options(order=OrderOptions(keep="all"))
    strokes = op.cover(Field("x", (SIDE,), keep_out=(LEFT,)), MARKER, options).strokes
    assert op.traversals(strokes, MARKER, options).reverse.tolist() == [True]


def test_the_judge_sees_a_robot_that_marks_through_an_obstacle() -> None:
    plan = op.plan(Field("x", (replace(SIDE, directed=True),)), MARKER)
    moved = replace(plan, job=Field("x", (SIDE,), keep_out=(LEFT,)))
    verdict, depth = areas(replace(moved, report=op.verify(moved)))
    assert verdict == "failed"
    assert depth == pytest.approx(0.211, abs=0.01)


@pytest.mark.parametrize(
    ("ring", "says"),
    [
        ([[-9, -9], [30, 9], [30, -9], [-9, 9]], "Self-intersection"),
        ([[0, 0], [1, 1]], "2 corners"),
        ([[0, 0], [1, 1], [2, 2]], "no simple polygon"),
    ],
)
def test_areas_that_are_no_polygons_are_named_first(ring: list[list[float]], says: str) -> None:
    with pytest.raises(InputError, match=f"keep_in.*{says}"):
        op.cover(Field("x", (SIDE,), keep_in=array(ring, dtype=float)), MARKER)
    with pytest.raises(InputError, match=rf"keep_out\[1\].*{says}"):
        op.cover(Field("x", (SIDE,), keep_out=(LEFT, array(ring, dtype=float))), MARKER)


def test_a_start_that_is_not_free_is_refused_before_any_order() -> None:
    fence = array([[-5, -5], [25, -5], [25, 9], [-5, 9]], dtype=float)
    with pytest.raises(InputError, match=r"start \(10, 0.5\) lies inside keep_out\[0\]"):
        op.cover(Field("x", (SIDE,), keep_out=(LEFT,), start=(10, 0.5)), MARKER)
    with pytest.raises(InputError, match="outside keep_in"):
        op.cover(Field("x", (SIDE,), keep_in=fence), MARKER, Options(order=OrderOptions(start=(30.0, 0.0))))
    op.cover(Field("x", (SIDE,), keep_in=fence, keep_out=(LEFT,), start=(0, -3)), MARKER)


def test_a_field_has_no_canvas_to_stay_on() -> None:
    with pytest.raises(InputError, match="canvas"):
        op.cover(Field("x", (SIDE,)), MARKER, Options(connect=ConnectOptions(on_canvas=True)))
