"""Sports fields against the numbers of their rules, measured on what is drawn."""

from __future__ import annotations

import math
import re

import numpy as np
import pytest

import optplan as op
from optplan.domain.errors import InputError, LimitError
from optplan.domain.job import Field, FieldSegment
from optplan.jobs.fields import TEMPLATES, template
from optplan.jobs.fields.pen import Pen

FOOT, YARD, INCH = 0.3048, 0.9144, 0.0254


def found(field: Field, id: str) -> list[FieldSegment]:
    made = [segment for segment in field.segments if re.fullmatch(id, segment.id)]
    assert made, id
    return made


def only(field: Field, id: str) -> FieldSegment:
    (segment,) = found(field, id)
    return segment


def extent(field: Field) -> tuple[float, float]:
    points = np.array([p for s in found(field, r"boundary \d") for p in (s.start, s.end)])
    size = points.max(axis=0) - points.min(axis=0)
    return float(size[0]), float(size[1])


def apart(a: FieldSegment, b: FieldSegment) -> float:
    """Distance of two parallel lines, m."""
    direction = (a.end - a.start) / np.linalg.norm(a.end - a.start)
    step = b.start - a.start
    return abs(float(direction[0] * step[1] - direction[1] * step[0]))


@pytest.mark.parametrize("name", TEMPLATES)
def test_every_template_fits_its_boundary_and_is_symmetric(name: str) -> None:
    field = template(name)
    assert len(field.segments) > 4
    assert all(segment.length > 0 for segment in field.segments)
    assert field.line_width is not None


@pytest.mark.parametrize(
    ("name", "measure", "value"),
    [
        ("basketball", "width", 1), ("basketball", "width", 20), ("basketball", "length", 10),
        ("handball", "length", 1), ("handball", "width", 25), ("handball", "circle", 15),
        ("field-hockey", "width", 1), ("field-hockey", "length", 10),
        ("baseball", "foul", 1), ("baseball", "pitch", 0), ("baseball", "grass", 500), ("baseball", "base", 1),
        ("softball", "grass", 1), ("football", "corner", 40), ("football", "length", 1e12), ("football", "spot", 60),
        ("football", "penalty_mark", 90), ("tennis", "line_width", 50), ("athletics", "lanes", 2.5),
        ("athletics", "lanes", "many"), ("athletics", "lane_width", 40), ("athletics", "radius", 2),
        ("rugby-union", "dash", 0), ("rugby-union", "dash", 1e-6), ("rugby-union", "dash", 60),
        ("rugby-league", "dash", 0), ("rugby-league", "dash", 11), ("rugby-union", "in_goal", 90),
    ],
)  # fmt: skip
def test_measures_that_do_not_fit_are_named(name: str, measure: str, value: float | str) -> None:
    with pytest.raises(InputError, match=f"{measure}.*(does not fit|expected)"):
        template(name, **{measure: value})


def test_broken_lines_of_too_many_dashes_are_refused_before_they_are_drawn() -> None:
    pen = Pen()
    with pytest.raises(LimitError, match="20000 lines"):
        pen.dashes("x", (0, 0), (100, 0), 1e-6, 1e-6)
    with pytest.raises(InputError, match="dashes"):
        pen.dashes("x", (0, 0), (100, 0), 0.0, 0.0)


@pytest.mark.parametrize(
    ("name", "size"),
    [
        ("football", (105, 68)),
        ("football-9v9", (80 * YARD, 50 * YARD)),
        ("football-7v7", (60 * YARD, 40 * YARD)),
        ("football-5v5", (40 * YARD, 30 * YARD)),
        ("american-football", (120 * YARD, 160 * FOOT)),
        ("rugby-union", (120, 70)),
        ("rugby-league", (116, 68)),
        ("lacrosse", (110 * YARD, 60 * YARD)),
        ("field-hockey", (91.40, 55.00)),
        ("tennis", (78 * FOOT, 36 * FOOT)),
        ("basketball", (28, 15)),
        ("volleyball", (18, 9)),
        ("handball", (40, 20)),
    ],
)
def test_outer_measures(name: str, size: tuple[float, float]) -> None:
    assert extent(template(name)) == pytest.approx(size)


def test_football() -> None:
    field = template("football")
    for end in ("west", "east"):
        assert only(field, f"{end} penalty area 2").length == pytest.approx(40.32)
        assert only(field, f"{end} penalty area 1").length == pytest.approx(16.5)
        assert only(field, f"{end} goal area 2").length == pytest.approx(18.32)
        arc = only(field, f"{end} penalty arc")
        assert arc.radius == pytest.approx(9.15)
        # its ends lie on the penalty area's line
        assert abs(arc.start[0] - only(field, f"{end} penalty area 2").start[0]) < 1e-9
        mark = only(field, f"{end} penalty mark").start
        goal_line = 0.0 if end == "west" else 105.0
        assert abs(mark[0] - goal_line) == pytest.approx(11)
    assert only(field, "centre circle").radius == pytest.approx(9.15)
    assert {round(s.radius, 9) for s in found(field, ".* corner arc")} == {1.0}
    total = sum(segment.length for segment in field.segments)
    assert total == pytest.approx(717.6, abs=0.01)


def test_american_football() -> None:
    for rules, inches in (("nfl", 849), ("ncaa", 720), ("high school", 640)):
        field = template("american-football", rules=rules)
        hash_mark = only(field, "west hash 1 south")
        assert min(hash_mark.start[1], hash_mark.end[1]) + 2 * FOOT == pytest.approx(inches * INCH)
        assert hash_mark.length == pytest.approx(2 * FOOT)
    lines = [s for s in field.segments if re.fullmatch(r"(west|east) \d+ yd|50 yd|(west|east) goal line", s.id)]
    places = np.sort([s.start[0] for s in lines])
    assert len(places) == 21
    assert np.diff(places) == pytest.approx(np.full(20, 5 * YARD))
    figures = found(field, r"number 10 south .*")
    heights = [p[1] for s in figures for p in (s.start, s.end)]
    assert max(heights) - min(heights) == pytest.approx(6 * FOOT)


def test_numbers_read_from_the_nearer_side_line() -> None:
    """The 1 of 10 stands left of the 0, seen from the nearer side line."""
    field = template("american-football")
    for side, sign in (("south", 1), ("north", -1)):
        one = np.mean([s.start[0] for s in found(field, rf"number 10 {side} figure 1.*")])
        zero = np.mean([s.start[0] for s in found(field, rf"number 10 {side} figure 2.*")])
        assert sign * (zero - one) > 0


def test_rugby() -> None:
    union = template("rugby-union")
    assert apart(only(union, "west goal line"), only(union, "west 22 m")) == pytest.approx(22)
    assert apart(only(union, "west goal line"), only(union, "east goal line")) == pytest.approx(100)
    assert apart(only(union, "halfway"), found(union, r"west 10 m \d+")[0]) == pytest.approx(10)
    league = template("rugby-league")
    assert len(found(league, r"(west|east) \d+ m")) == 8


def test_diamonds() -> None:
    ball = template("baseball")
    arcs = found(ball, ".*grass line")
    assert {round(arc.radius / FOOT, 6) for arc in arcs} == {95}
    assert {round(float(arc.center[1]) / FOOT, 6) for arc in arcs if arc.center is not None} == {60.5}
    # it meets the foul lines
    assert all(abs(abs(arc.start[0]) - arc.start[1]) < 1e-9 for arc in arcs)
    box = found(ball, r"first base batter's box \d")
    assert sorted(round(s.length / FOOT, 6) for s in box) == [4, 4, 6, 6]
    soft = template("softball")
    assert only(soft, "pitcher's circle").radius == pytest.approx(8 * FOOT)
    assert sorted(round(s.length / FOOT, 6) for s in found(soft, r"first base batter's box \d")) == [3, 3, 7, 7]


def test_sticks() -> None:
    hockey = template("field-hockey")
    assert {round(s.radius, 9) for s in found(hockey, r".* circle (south|north)")} >= {14.63}
    assert only(hockey, "west circle").length == pytest.approx(3.66)
    assert only(hockey, "west 23 m line").start[0] == pytest.approx(22.90)
    assert only(hockey, "west penalty spot").start[0] == pytest.approx(6.40)
    lax = template("lacrosse")
    assert only(lax, "west crease").radius == pytest.approx(9 * FOOT)
    assert only(lax, "west crease").center[0] == pytest.approx(15 * YARD)  # type: ignore[index]


def test_courts() -> None:
    tennis = template("tennis")
    assert apart(only(tennis, "west service line"), only(tennis, "east service line")) == pytest.approx(42 * FOOT)
    assert apart(*found(tennis, "singles line .*")) == pytest.approx(27 * FOOT)
    ball = template("basketball")
    assert only(ball, "west three-point arc").radius == pytest.approx(6.75)
    assert found(ball, "west three-point line .*")[0].start[1] == pytest.approx(0.90)
    assert only(ball, "west restricted area 2").length == pytest.approx(4.90)
    assert only(ball, "west restricted area 1").length == pytest.approx(5.80)
    volley = template("volleyball")
    assert apart(only(volley, "west attack line"), only(volley, "centre line")) == pytest.approx(3)
    hand = template("handball")
    assert {round(s.radius, 9) for s in found(hand, r"west goal area (south|north)")} == {6.0}
    assert {round(s.radius, 9) for s in found(hand, r"west free-throw line (south|north) \d+")} == {9.0}
    # the last dashes reach the side line
    reach = [s.end[1] for s in found(hand, r"west free-throw line north \d+")]
    assert max(reach) == pytest.approx(20, abs=0.02)


def test_a_track_measures_400_m() -> None:
    from optplan.jobs.fields.track import lane_length

    assert lane_length(1, 36.5, 84.39, 1.22) == pytest.approx(400.00, abs=0.01)
    # staggers of the manual, lanes 2 and 8
    for lane, stagger in ((2, 7.04), (8, 53.03)):
        longer = lane_length(lane, 36.5, 84.39, 1.22) - lane_length(1, 36.5, 84.39, 1.22)
        assert longer == pytest.approx(stagger, abs=0.01)


def test_measures_take_units_and_bad_ones_are_refused() -> None:
    field = template("football", length="110 yd", width="70yd")
    assert extent(field) == pytest.approx((110 * YARD, 70 * YARD))
    for measures in ({"length": "far"}, {"colour": "red"}, {"length": -5.0}, {"penalty_depth": 90.0}, {"circle": 50}):
        with pytest.raises(InputError, match="football"):
            template("football", **measures)
    with pytest.raises(InputError, match="quidditch"):
        template("quidditch")
    with pytest.raises(InputError, match="lanes"):
        template("athletics", lanes=99)
    with pytest.raises(InputError, match="rules"):
        template("american-football", rules="aussie")


@pytest.mark.parametrize("name", sorted(set(TEMPLATES) - {"american-football"}))
def test_every_template_plans_and_passes_the_judge(name: str) -> None:
    options = op.Options(order=op.OrderOptions(metric="cc", solver="search", iterations=200))
    plan = op.plan(template(name), "line-marker", options)
    assert plan.report is not None
    assert plan.report.ok, [check for check in plan.report.checks if check.verdict.value == "failed"]
    assert plan.report.figure("continuity order") == 2


def test_american_football_plans_and_passes_the_judge() -> None:
    options = op.Options(
        cover=op.CoverOptions(cut=False), order=op.OrderOptions(metric="cc", solver="search", iterations=50, entries=4)
    )
    plan = op.plan(template("american-football", numbers=False), "line-marker", options)
    assert plan.report is not None
    assert plan.report.ok


def test_angles_of_arcs_agree_with_their_ends() -> None:
    for name in TEMPLATES:
        for segment in template(name).segments:
            if segment.center is not None:
                assert abs(segment.sweep) <= 2 * math.pi + 1e-12
