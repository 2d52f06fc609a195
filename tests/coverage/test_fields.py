"""Fields as strokes."""

from __future__ import annotations

import math
import time
from dataclasses import replace

import numpy as np
import pytest

import optplan as op
from optplan.domain.errors import InputError, LimitError
from optplan.domain.job import Anchor, Field, FieldSegment
from optplan.domain.options import ConnectOptions, CoverOptions, Options, OrderOptions
from optplan.domain.robot import DiffDrive, Robot
from optplan.instances import instance
from optplan.jobs.fields import template

array = np.array


def line(id: str, a: tuple[float, float], b: tuple[float, float], **more: object) -> FieldSegment:
    return FieldSegment(id, array(a), array(b), **more)  # type: ignore[arg-type]


def circle(id: str, at: tuple[float, float], radius: float, **more: object) -> FieldSegment:
    start = array([at[0] + radius, at[1]])
    return FieldSegment(id, start, start, array(at), 2 * math.pi, **more)  # type: ignore[arg-type]


RAKE = op.load_robot("beach-rake")
MARKER = op.load_robot("line-marker")
TEE = (line("long", (0, 0), (20, 0)), line("post", (8, 0), (8, 9)))
WHOLE = Options(cover=CoverOptions(cut=False))


def test_lines_are_cut_where_others_meet_them_and_only_when_asked() -> None:
    field = Field("tee", TEE)
    assert [round(s.length, 9) for s in op.cover(field, MARKER).strokes] == [8.0, 12.0, 9.0]
    assert [round(s.length, 9) for s in op.cover(field, MARKER, WHOLE).strokes] == [20.0, 9.0]


def test_all_of_the_paint_is_kept_by_cutting() -> None:
    parts = (*TEE, circle("ring", (8, 0), 5))
    both = [sum(s.length for s in op.cover(Field("x", parts), MARKER, o).strokes) for o in (Options(), WHOLE)]
    assert both[0] == pytest.approx(both[1])


def test_lines_that_go_on_are_one_stroke() -> None:
    parts = (line("a", (0, 0), (5, 0)), line("b", (12, 0), (5, 0)))
    (stroke,) = op.cover(Field("x", parts), MARKER).strokes
    assert stroke.length == pytest.approx(12)


def test_a_track_of_lines_and_arcs_is_one_ring() -> None:
    def bend(id: str, x: float, start: float) -> FieldSegment:
        side = array([x, start])
        return FieldSegment(id, side, -side * [-1, 1], array([x, 0.0]), math.pi)

    parts = (
        line("home", (-20, -30), (20, -30)),
        bend("east", 20, -30),
        line("back", (20, 30), (-20, 30)),
        bend("west", -20, 30),
    )
    (stroke,) = op.cover(Field("track", parts), MARKER).strokes
    assert stroke.closed
    assert stroke.length == pytest.approx(80 + 60 * math.pi, rel=1e-4)
    plan = op.plan(Field("track", parts), MARKER)
    assert plan.report is not None
    assert plan.report.ok, [check for check in plan.report.checks if check.verdict.value == "failed"]


def test_passes_and_wide_lines_become_strokes_side_by_side() -> None:
    field = Field("x", (line("wide", (0, 0), (10, 0), width=0.3, passes=2),))
    strokes = op.cover(field, MARKER).strokes
    assert len(strokes) == 6  # three lines of 12 cm, twice
    assert sorted({round(float(s.points[0, 1]), 9) for s in strokes}) == [-0.09, 0.0, 0.09]


def test_what_is_not_marked_is_said() -> None:
    cover = op.cover(Field("x", (*TEE, line("way", (0, 5), (3, 5), actuation="NONE"))), MARKER)
    assert [note.place for note in cover.notes if note.kind == "ignored"] == ["way"]
    assert all(stroke.element != "way" for stroke in cover.strokes)


def test_spots_are_offered_in_several_directions_and_driven_once() -> None:
    spot = FieldSegment("spot", array([3.0, 3.0]), array([3.0, 3.0]), spot=0.22)
    field = Field("x", (*TEE, spot))
    cover = op.cover(field, MARKER)
    ways = op.traversals(cover.strokes, MARKER)
    own = ways.stroke == len(cover.strokes) - 1
    assert own.sum() == 8
    headings = np.sort(ways.entry[own, 3] % (2 * math.pi))
    assert np.diff(headings) == pytest.approx(np.full(7, math.pi / 4))
    plan = op.plan(field, MARKER, Options(order=OrderOptions(metric="cc")))
    assert plan.report is not None
    assert plan.report.ok


def test_the_order_of_the_job_is_kept_when_asked() -> None:
    field = Field("x", (line("c", (30, 0), (30, 9)), line("a", (0, 0), (0, 9)), line("b", (15, 9), (15, 0))))
    for keep in ("order", "all"):
        plan = op.plan(field, MARKER, Options(order=OrderOptions(metric="cc", keep=keep)))
        assert plan.visits is not None
        assert plan.visits.stroke.tolist() == [0, 1, 2]
        assert plan.report is not None
        assert plan.report.ok
        assert keep == "order" or not plan.visits.reverse.any()


def _wide_turning(radius: float) -> Robot:
    assert isinstance(MARKER.mobility, DiffDrive)
    return replace(MARKER, mobility=replace(MARKER.mobility, radius=radius))


def test_an_arc_the_robot_cannot_drive_one_way_is_driven_the_other() -> None:
    limited = _wide_turning(1 / 1.125)
    corner = FieldSegment("corner", array([1.0, 0.0]), array([0.0, 1.0]), array([0.0, 0.0]), math.pi / 2)
    cover = op.cover(Field("x", (corner,)), limited)
    assert any("only driven" in note.text for note in cover.notes)
    assert op.traversals(cover.strokes, limited).reverse.tolist() == [True]


def test_an_arc_no_way_fits_is_an_error_with_its_name() -> None:
    tight = FieldSegment("tiny", array([0.1, 0.0]), array([0.0, 0.1]), array([0.0, 0.0]), math.pi / 2)
    limited = _wide_turning(3.0)
    with pytest.raises(InputError, match="tiny"):
        op.plan(Field("x", (tight,)), limited)


def test_parts_of_parts_are_counted_through() -> None:
    cover = op.cover(Field("x", (circle("ring", (0, 0), 0.35),)), _wide_turning(3.0))
    assert len(cover.strokes) > 2
    assert [stroke.id for stroke in cover.strokes] == [f"ring~{k + 1}" for k in range(len(cover.strokes))]


@pytest.mark.parametrize(
    ("make", "names"),
    [
        (lambda: line("a", (1, 1), (1, 1)), "'a'.*coincide"),
        (lambda: FieldSegment("a", array([1, 0]), array([1, 0]), array([1.0, 0.0]), 1.0), "'a'.*radius"),
        (lambda: FieldSegment("a", array([1, 0]), array([1, 0]), array([0.0, 0.0]), 7.0), "'a'.*turn"),
        (lambda: FieldSegment("a", array([1, 0]), array([0, 1]), array([0.0, 0.0]), 1.0), "'a'.*ends"),
        (lambda: line("a", (0, 0), (1, 0), actuation="GLITTER"), "'a'.*GLITTER"),
        (lambda: line("a", (0, 0), (1, 0), passes=0), "'a'.*passes"),
        (lambda: line("a", (0, 0), (1, 0), width=-1.0), "'a'.*width"),
        (lambda: line("a", (0, math.nan), (1, 0)), "'a'"),
        (lambda: Field("x", (TEE[0], TEE[0])), "'long'"),
        (lambda: Field("x", ()), "segments"),
        (lambda: Field("x", "abc"), "segments"),  # type: ignore[arg-type]
        (lambda: Field("x", ("abc",)), "segments"),  # type: ignore[arg-type]
        (lambda: line("a", (0, 0), (1e29, 0)), "'a'.*1e\\+29.*1e\\+06"),
        (lambda: line("a", (0, 0), (1, 0), width=1e8), "'a'.*width"),
        (lambda: Field("x", TEE, start=(1e9, 0)), "start"),
        (lambda: Field("x", TEE, keep_out=(array([[0, 0], [1e9, 0], [0, 1]]),)), "keep_out"),
        (lambda: Field("x", TEE, anchor=Anchor(88, 0, 0)), "no place"),
        (lambda: Field("x", TEE, anchor=Anchor(50, 0, 1e300)), "no place"),
        (lambda: op.cover(Field("x", (line("a", (0, 0), (60, 0), width=1e6),)), MARKER), "8333334 of them.*'a'"),
        (lambda: op.cover(Field("x", (line("a", (0, 0), (1, 0), actuation="NONE"),)), MARKER), "nothing"),
        (
            lambda: op.cover(Field("x", (line("a", (0, 0), (1, 0), actuation="PUMP"),)), op.load_robot("beach-rake")),
            "'a'",
        ),
    ],
)
def test_bad_segments_are_named(make: object, names: str) -> None:
    with pytest.raises(InputError, match=names):
        make()  # type: ignore[operator]


def test_obstacles_on_lines_and_lines_outside_are_named() -> None:
    box = array([[3, -1], [5, -1], [5, 1], [3, 1]], dtype=float)
    with pytest.raises(InputError, match=r"'long'.*obstacle"):
        op.cover(Field("x", TEE, keep_out=(box,)), MARKER)
    with pytest.raises(InputError, match=r"'long'.*keep-in"):
        op.cover(Field("x", TEE, keep_in=array([[-1, -1], [12, -1], [12, 12], [-1, 12]], dtype=float)), MARKER)


def test_connectors_keep_out_of_the_fields_obstacles() -> None:
    parts = (line("a", (0, 0), (0, 9)), line("b", (10, 0), (10, 9)))
    box = array([[3, -40], [7, -40], [7, 10], [3, 10]], dtype=float)
    free = op.plan(Field("x", parts), MARKER, Options(order=OrderOptions(metric="cc")))
    for metric in ("cc", "time"):
        options = Options(order=OrderOptions(metric=metric), connect=ConnectOptions(clearance=0.5))
        plan = op.plan(Field("x", parts, keep_out=(box,)), MARKER, options)
        assert plan.report is not None
        assert plan.report.ok
        found = {check.name: check for check in plan.report.checks}["areas"]
        assert found.verdict.value == "passed"
        assert plan.path is not None
        assert free.path is not None
        assert plan.path.length.sum() > free.path.length.sum()


def test_fine_pens_mark_wide_lines_in_a_moment_and_true_to_the_arc() -> None:
    """A court for a pen is a thousand lines side by side: what meets what is looked up, not tried."""
    pen = op.load_robot("pen-plotter")
    began = time.perf_counter()
    cover = op.cover(template("tennis"), pen)
    assert time.perf_counter() - began < 20
    assert len(cover.strokes) > 1000
    plan = op.plan(Field("x", (circle("ring", (2, 5), 2.0, width=5e-4),)), pen)
    assert plan.report is not None
    assert plan.report.ok


def test_pieces_are_limited_too() -> None:
    comb = [line(f"a{k}", (0, 0.3 * k), (400, 0.3 * k)) for k in range(60)]
    comb += [line(f"b{k}", (2.0 * k, 0), (2.0 * k, 18)) for k in range(200)]
    with pytest.raises(LimitError, match=r"pieces.*--whole"):
        op.cover(Field("x", tuple(comb)), RAKE)
    assert len(op.cover(Field("x", tuple(comb)), RAKE, WHOLE).strokes) == 260


@pytest.mark.parametrize("job", ["drawings/lion", "fields/tennis-court"])
def test_a_boom_lift_marks_nothing(job: str) -> None:
    with pytest.raises(InputError, match=r"boom lift.*expected (line-marker|beach-rake)"):
        op.plan(op.read(instance(job)), "boom-washer")
