"""Drawings to strokes: place, syntax, fills, corners."""

from __future__ import annotations

import math
from dataclasses import replace
from itertools import pairwise

import numpy as np
import pytest
import shapely
from hypothesis import given, settings
from hypothesis import strategies as st

import optplan as op
from optplan.coverage import cover
from optplan.coverage import drawing as module
from optplan.coverage.placing import canvas_of, placed, placement
from optplan.coverage.splitting import split_at_stops
from optplan.coverage.stops import curves_of, stops_of
from optplan.domain.errors import InputError, LimitError
from optplan.domain.job import Curve, Drawing, Element, FillRule, FillSettings, Surface
from optplan.domain.options import CoverOptions, Options, PageOptions
from optplan.domain.result import Cover
from optplan.domain.robot import Canvas
from optplan.domain.stroke import Stroke
from tests.strategies import CAR, PLOTTER, RAKE, array, box, circle, drawing, element, polylines, star_shaped

SYNTAX = replace(RAKE, tool=replace(RAKE.tool, stroke_widths=(2.0,), red_is_travel=True, green_is_start=True))
OWN_SIZE = replace(RAKE, canvas=None)


@st.composite
def curves(draw: st.DrawFn) -> Curve:
    ring = draw(star_shaped())
    handles = draw(st.lists(st.tuples(*[st.floats(-9, 9)] * 4), min_size=len(ring), max_size=len(ring)))
    return Curve(ring, array(handles).reshape(-1, 2, 2), closed=True)


@given(st.lists(curves(), min_size=1, max_size=3), st.floats(1, 50), st.floats(1, 50), st.floats(0, 0.4))
def test_what_is_placed_fits_and_keeps_its_shape(shapes: list[Curve], width: float, height: float, part: float) -> None:
    canvas = Canvas(width, height, part * min(width, height))
    whole = Element("e", tuple(shapes), "#000000", None)
    where = placement([whole], canvas)
    lines = placed(whole, where, 1e-3)
    points = np.concatenate([line.points for line in lines])
    low, high = points.min(axis=0), points.max(axis=0)
    room = array([width, height]) - canvas.margin
    assert (low >= canvas.margin - 1e-6).all()
    assert (high <= room + 1e-6).all()
    assert (low + high) / 2 == pytest.approx([width / 2, height / 2], abs=2e-3)
    # one direction is used up to the margin
    assert np.min((room - canvas.margin) - (high - low)) < 3e-3
    # the same scale both ways
    moved = where.apply(shapes[0].points)
    assert moved - moved[0] == pytest.approx((shapes[0].points - shapes[0].points[0]) * where.scale)


def test_canvases() -> None:
    assert canvas_of(PageOptions(), RAKE) == RAKE.canvas
    assert canvas_of(PageOptions(width=7.0), RAKE) == Canvas(7.0, 20.0, 0.5)
    assert canvas_of(PageOptions(margin=0.0), RAKE) == Canvas(20.0, 20.0, 0.0)
    assert canvas_of(PageOptions(), OWN_SIZE) is None
    assert canvas_of(PageOptions(width=7.0, height=3.0), OWN_SIZE) == Canvas(7.0, 3.0)
    for page in (PageOptions(width=1.0), PageOptions(margin=0.1)):
        with pytest.raises(InputError, match="canvas"):
            canvas_of(page, OWN_SIZE)
    with pytest.raises(InputError, match="smaller than its margin"):
        canvas_of(PageOptions(width=0.5), RAKE)


def test_a_line_across_is_placed() -> None:
    job = drawing(element("l", [[0, 0], [3, 0]], closed=False))
    assert cover(job, RAKE).strokes[0].points == pytest.approx(array([[0.5, 10], [19.5, 10]]))


def test_nothing_to_draw() -> None:
    white = element("w", box(0, 0, 1, 1), stroke="#ffffff")
    for job in (Drawing("d", ()), drawing(white), drawing(element("g", [[0, 0], [1, 0]], False, stroke="#00ff00"))):
        with pytest.raises(InputError, match="nothing in this drawing"):
            cover(job, SYNTAX)
    dot = drawing(element("p", [[1, 1], [1, 1]], closed=False))
    with pytest.raises(InputError, match="no extent"):
        cover(dot, RAKE)
    with pytest.raises(InputError, match="surface cannot be covered"):
        cover(Surface("s", np.zeros((3, 3))), RAKE)


def test_the_drawing_syntax() -> None:
    job = drawing(
        element("thin", [[0, 0], [9, 0]], False, stroke_width=1.0),
        element("red1", [[0, 1], [9, 1]], False, stroke="#ff0000"),
        element("thick", box(1, 2, 5, 5), stroke_width=3.0),
        element("red2", [[9, 2], [0, 2]], False, stroke="#ff0000"),
        element("white", box(2, 2, 1, 1), stroke="#ffffff"),
        element("green", [[4, 4], [9, 9]], False, stroke="#00ff00"),
        element("red3", [[0, 9], [9, 9]], False, stroke="#ff0000"),
    )
    made = cover(job, replace(SYNTAX, canvas=None))
    assert [(s.id, s.tool, s.closed, s.directed) for s in made.strokes] == [
        ("thin", 1, False, False),
        ("red1", 0, False, True),
        ("thick", 2, True, False),
        ("red2", 0, False, True),
        ("red3", 0, False, True),
    ]
    assert made.precedence == ((1, 3), (3, 4))
    assert made.strokes[3].points.tolist() == [[9, 2], [0, 2]]
    assert made.start == (9.0, 9.0)
    assert any(note.place == "white" for note in made.notes)
    plain = cover(job, OWN_SIZE)
    assert [s.layer for s in plain.strokes[:2]] == ["#000000", "#ff0000"]
    assert plain.start is None
    assert plain.precedence == ()


def test_a_closed_travel_comes_back() -> None:
    made = cover(
        drawing(element("a", [[0, 0], [9, 0]], False), element("r", box(1, 2, 5, 5), stroke="#ff0000")), SYNTAX
    )
    travel = made.strokes[1]
    assert not travel.closed
    assert len(travel.points) == 5
    assert travel.points[0].tolist() == travel.points[-1].tolist()


def _filled(*rings: object, rule: FillRule = FillRule.NONZERO, boundary: bool = False, **more: object) -> Cover:
    shapes = tuple(Curve(array(ring), closed=True) for ring in rings)
    job = drawing(Element("e", shapes, None, "#000000", fill_rule=rule))
    return cover(job, OWN_SIZE, Options(cover=CoverOptions(boundary=boundary, **more)))  # type: ignore[arg-type]


def test_fills_follow_the_rule() -> None:
    rings = (box(0, 0, 9, 9), box(2, 2, 5, 5))
    for rule, hole in ((FillRule.NONZERO, False), (FillRule.EVENODD, True)):
        made = _filled(*rings, rule=rule)
        assert len(made.areas[0].rings) == 1 + hole
        lines = shapely.MultiLineString([stroke.points for stroke in made.strokes])
        assert lines.intersects(shapely.box(2.1, 2.1, 6.9, 6.9)) != hole
        assert all(stroke.tool == 2 and stroke.element == "e" for stroke in made.strokes)


@pytest.mark.parametrize("degrees", range(0, 180, 30))
def test_boundaries_give_full_areas(degrees: int) -> None:
    for ring in (box(0, 0, 9, 5), circle(4, 50), array([[0, 0], [9, 1], [3, 8]])):
        made = _filled(ring, boundary=True, direction=math.radians(degrees))
        area = shapely.Polygon(ring)
        marks = shapely.union_all([shapely.LineString(s.closed_points).buffer(0.2) for s in made.strokes])
        assert marks.intersection(area).area > 0.99 * area.area
        assert marks.difference(area.buffer(1e-3)).area < 0.01 * area.area
        assert made.strokes[0].closed


@pytest.mark.parametrize("boundary", [True, False])
@pytest.mark.parametrize("height", [1e-3, 0.05, 0.2, 0.399, 0.4, 0.5, 0.72, 0.8, 0.9])
def test_thin_areas(height: float, boundary: bool) -> None:
    made = _filled(box(0, 0, 9, height), boundary=boundary)
    assert made.strokes
    inside = shapely.box(0, 0, 9, height).buffer(1e-6)
    assert all(inside.covers(shapely.LineString(s.closed_points)) for s in made.strokes)
    assert made.areas[0].tool == (2 if height > 0.4 else 1)


def test_settings_of_single_elements() -> None:
    job = drawing(*(element(name, box(10 * k, 0, 8, 8), stroke=None, fill="#000000") for k, name in enumerate("ab")))
    own = (("b", FillSettings(direction=math.pi / 2, spacing=2.0, inset=1.0)),)
    options = CoverOptions(direction=0.0, spacing=0.4, boundary=False, elements=own)
    made = cover(job, OWN_SIZE, Options(cover=options))
    first, second = (next(s for s in made.strokes if s.element == name) for name in "ab")
    assert first.points[0, 1] == first.points[1, 1]
    assert second.points[0, 0] == pytest.approx(second.points[1, 0])
    assert np.unique(np.round(second.points[:, 0], 4)) == pytest.approx([11, 13, 15, 17], abs=1e-4)
    assert (second.points[:, 1].min(), second.points[:, 1].max()) == pytest.approx((1, 7))
    with pytest.raises(InputError, match="no element 'c'"):
        cover(job, OWN_SIZE, Options(cover=CoverOptions(elements=(("c", FillSettings()),))))


def test_too_many_strokes(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(module, "MAX_STROKES", 2)
    lines = [element(f"l{k}", [[0, k], [1, k]], closed=False) for k in range(3)]
    with pytest.raises(LimitError, match="more than 2 strokes"):
        cover(drawing(*lines), RAKE)


def test_nearly_closed_lines_are_closed() -> None:
    path = '<path id="p" d="{}" stroke="black" fill="none"/>'
    svg = f'<svg xmlns="http://www.w3.org/2000/svg" viewBox="0 0 99 99">{path}</svg>'
    for gap, closed in ((0.01, True), (9.0, False)):
        job = op.read(svg.format(f"M 10 10 H 90 V 90 H 10 V {10 + gap}"))
        assert cover(job, RAKE).strokes[0].closed == closed
        assert bool(job.notes) == closed


def test_forced_entries() -> None:
    job = drawing(element("e", box(0, 0, 1, 1))).with_element("e", entry=2)
    assert cover(job, RAKE).strokes[0].entry == 2
    with pytest.raises(InputError, match="entered at vertex 9"):
        cover(job.with_element("e", entry=9), RAKE)


@settings(max_examples=60)
@given(st.one_of(polylines(), star_shaped()), st.booleans(), st.floats(0.1, 3))
def test_strokes_are_split_at_stops(points: np.ndarray, closed: bool, corner: float) -> None:
    options = Options(page=PageOptions(tolerance=0.05), connect=op.ConnectOptions(corner))
    stroke = Stroke("s", points, closed=closed)
    assert split_at_stops([stroke], RAKE, options) == ([stroke], [0])
    parts = split_at_stops([stroke], CAR, options)[0]
    assert sum(part.length for part in parts) == pytest.approx(stroke.length)
    for part in parts:
        # split again, they stay whole
        assert len(stops_of(part, CAR, options)) == 0
    if len(parts) > 1:
        assert [part.id for part in parts] == [f"s~{k}" for k in range(1, len(parts) + 1)]
        for one, other in pairwise(parts):
            assert one.points[-1].tolist() == other.points[0].tolist()
        if closed:
            assert parts[-1].points[-1].tolist() == parts[0].points[0].tolist()
    assert curves_of(stroke, PLOTTER, options) is None
