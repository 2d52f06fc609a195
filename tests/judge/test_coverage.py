"""Areas with closed forms."""

from __future__ import annotations

import math
from itertools import pairwise

import numpy as np
import pytest

from optplan.domain.path import Path
from optplan.domain.result import Area, Cover, Plan
from optplan.domain.stroke import Stroke
from optplan.judge import verify
from tests.judge.hand_made import PLOTTER, RAKE, Pen, failures, plan_of

FACETS = 0.007  # share of a round end that its flat sides leave out


def drawn(cover: Cover, indices: list[int] | None = None) -> Plan:
    pen = Pen(cover.strokes[0].points[0])
    for index in range(len(cover.strokes)) if indices is None else indices:
        pen.draw(cover.strokes[index], index)
    return plan_of(PLOTTER, pen.path, cover)


def test_a_straight_mark_is_a_rectangle_with_round_ends() -> None:
    report = verify(drawn(Cover((Stroke("bar", np.array([[0.0, 0], [4, 0]]), tool=2),))))
    exact = 4 * 0.3 + math.pi * 0.15**2
    assert report.figure("wanted area") == pytest.approx(exact, abs=FACETS * math.pi * 0.15**2)
    assert report.figure("done area") == report.figure("wanted area")
    assert report.figure("missed area") == report.figure("overspill area") == 0
    assert report.figure("coverage") == 1


def test_a_circle_driven_as_an_arc_covers_its_polyline() -> None:
    angle = np.linspace(0, 2 * math.pi, 100, endpoint=False)
    ring = Stroke("ring", np.stack([2 * np.sin(angle), 2 - 2 * np.cos(angle)], axis=1), closed=True)
    pen = Pen(np.zeros(2))
    pen.curve(4 * math.pi, 0.5, tool=1, stroke=0)
    report = verify(plan_of(RAKE, pen.path, Cover((ring,))))
    assert failures(report) == set()
    assert report.figure("done area") == pytest.approx(math.pi * (2.05**2 - 1.95**2), rel=1e-3)
    deviation = next(check for check in report.checks if check.name == "deviation")
    assert deviation.value == pytest.approx(2 * (1 - math.cos(math.pi / 100)), rel=0.05)
    # chord against arc: 2/3 of the rise, on both sides of the mark
    assert report.figure("missed area") == pytest.approx(4 * math.pi * 2 / 3 * deviation.value, rel=0.15)


def test_area_with_a_hole_under_three_marks() -> None:
    outer = np.array([[0.0, 0], [4, 0], [4, 0.9], [0, 0.9]])
    hole = np.array([[1.0, 0.3], [2, 0.3], [2, 0.6], [1, 0.6]])
    lines = tuple(Stroke(f"{k}", np.array([[0.15, y], [3.85, y]]), tool=2) for k, y in enumerate((0.15, 0.45, 0.75)))
    report = verify(drawn(Cover(lines, (Area("sign", (outer, hole), 2),)), [0, 2, 1]))
    corners = 6 * (2 * 0.15 * 0.15 - math.pi * 0.15**2 / 2)  # six round ends in square corners
    size = 4 * 0.9 - 0.3
    assert report.figure("area coverage") == pytest.approx(1 - corners / size, abs=6 * FACETS * 0.07 / size)
    assert report.figure("missed area") == pytest.approx(corners, rel=0.1)
    # the middle mark runs over the hole, as asked: it is a stroke
    assert report.figure("overspill area") == pytest.approx(0, abs=1e-9)
    assert failures(report) == set()


def test_overlapping_marks_count_once() -> None:
    cross = (Stroke("a", np.array([[-1.0, 0], [1, 0]])), Stroke("b", np.array([[0.0, -1], [0, 1]])))
    report = verify(drawn(Cover(cross)))
    assert report.figure("done area") == pytest.approx(2 * (2 * 0.1 + math.pi * 0.05**2) - 0.01, rel=1e-3)


def test_what_is_marked_outside_is_overspill() -> None:
    plan = drawn(Cover((Stroke("a", np.array([[0.0, 0], [1, 0]])),)))
    pen = Pen(np.array([-2.0, 0]))
    pen.go((-1.0, 0), tool=1)
    pen.go((0.0, 0))
    pen.draw(Stroke("a", np.array([[0.0, 0], [1, 0]])), 0)
    report = verify(plan_of(PLOTTER, pen.path, plan.cover or Cover(())))
    assert failures(report) == {"tool"}
    assert report.figure("overspill area") == pytest.approx(0.1 + math.pi * 0.05**2, rel=1e-2)
    spot = next(check.place for check in report.checks if check.name == "overspill")
    assert spot is not None
    assert -2.1 < spot[0] < -0.9


@pytest.mark.parametrize(
    "cover",
    [
        Cover(()),
        Cover((), (Area("nothing", (np.zeros((0, 2)),), 1),)),
        Cover((), (Area("point", (np.zeros((5, 2)),), 1),)),
        Cover((), (Area("line", (np.array([[0.0, 0], [1, 0], [2, 0]]),), 1),)),
        Cover((), (Area("bow tie", (np.array([[0.0, 0], [1, 1], [1, 0], [0, 1]]),), 1),)),
        Cover((Stroke("there and back", np.array([[0.0, 0], [1, 0], [0, 0]])),)),
        Cover((Stroke("dust", np.array([[0.0, 0], [1e-9, 0]])),)),
        Cover((Stroke("far away", np.array([[1e7, 1e7], [1e7 + 1, 1e7]])),)),
    ],
    ids=lambda cover: (cover.strokes + cover.areas)[0].__class__.__name__ if cover.strokes + cover.areas else "empty",
)
@pytest.mark.parametrize("driven", [False, True])
def test_odd_shapes_are_measured_without_a_word(cover: Cover, driven: bool) -> None:
    pen = Pen(np.zeros(2))
    if driven and cover.strokes:
        pen = Pen(cover.strokes[0].points[0])
        pen.draw(cover.strokes[0], 0)
    path: Path = pen.path
    report = verify(plan_of(PLOTTER, path, cover))
    assert all(math.isfinite(value) for _, value, _ in report.figures)
    assert report.ok == (driven or not cover.strokes)


def test_what_is_marked_twice_is_overlap() -> None:
    cross = (Stroke("a", np.array([[-1.0, 0], [1, 0]])), Stroke("b", np.array([[0.0, -1], [0, 1]])))
    report = verify(drawn(Cover(cross)))
    assert report.figure("overlap area") == pytest.approx(0.1 * 0.1, rel=1e-6)
    spot = next(check.place for check in report.checks if check.name == "overlap")
    assert spot == pytest.approx((0, 0), abs=0.05)
    apart = (cross[0], Stroke("c", np.array([[-1.0, 2], [1, 2]])))
    assert verify(drawn(Cover(apart))).figure("overlap area") == pytest.approx(0, abs=1e-12)


def test_mean_deviation_and_the_share_that_is_near() -> None:
    # a metre exactly on the line, then a bulge of 2 m that leaves it by 8 mm in the middle
    line = Stroke("a", np.array([[0.0, 0], [3, 0]]))
    pen = Pen(np.zeros(2))
    pen.go((1.0, 0), tool=1, stroke=0)
    pen.go((2.0, 0.008), tool=1, stroke=0)
    pen.go((3.0, 0), tool=1, stroke=0)
    report = verify(plan_of(PLOTTER, pen.path, Cover((line,))))
    assert report.figure("mean deviation") == pytest.approx(2 / 3 * 0.004, rel=1e-3)
    # within 5 mm: the first metre, and of both slopes all up to five eighths
    assert report.figure("within 5 mm") == pytest.approx((1 + 2 * 5 / 8) / 3, rel=1e-3)
    clean = verify(drawn(Cover((line,))))
    assert clean.figure("mean deviation") == pytest.approx(0, abs=1e-9)
    assert clean.figure("within 5 mm") == 1


def _passes(line: np.ndarray, width: float, step: float) -> float:
    """The area that a disc sweeping along a line comes back to, m2, by counting its visits to the places of a grid."""
    pieces = [np.linspace(a, b, math.ceil(np.linalg.norm(b - a) / step), endpoint=False) for a, b in pairwise(line)]
    middle = np.concatenate([*pieces, line[-1:]])
    low, high = middle.min(axis=0) - width, middle.max(axis=0) + width
    axes = [np.arange(a, b, step) for a, b in zip(low, high, strict=True)]
    again = 0
    for x in axes[0]:
        near = np.hypot(x - middle[:, 0], axes[1][:, None] - middle[:, 1]) < width / 2
        visits = near[:, 0].astype(int) + (near[:, 1:] & ~near[:, :-1]).sum(axis=1)
        again += int(np.maximum(visits - 1, 0).sum())
    return again * step**2


_TURN = np.linspace(0, 2 * math.pi, 80)
SELF_MARKED = {
    "crosses itself": np.array([[-1.0, 0], [1, 0], [1, 1], [0, 1], [0, -1]]),
    "goes back": np.array([[0.0, 0], [1, 0], [0, 0.02]]),
    "goes there three times": np.array([[0.0, 0], [1, 0], [0, 0.02], [1, 0.04]]),
    "an eight": np.stack([np.sin(_TURN[:-3]), np.sin(2 * _TURN[:-3]) / 2], axis=1),
    "a spiral in its own mark": np.stack([_TURN / 40 * np.cos(3 * _TURN), _TURN / 40 * np.sin(3 * _TURN)], axis=1),
    "narrow rows": np.array([[0.0, 0], [1, 0], [1, 0.06], [0, 0.06], [0, 0.12], [1, 0.12]]),
}


@pytest.mark.parametrize("line", SELF_MARKED.values(), ids=list(SELF_MARKED))
@pytest.mark.parametrize("exact", [True, False])
def test_a_line_that_comes_back_over_its_own_mark_is_overlap(line: np.ndarray, exact: bool) -> None:
    step = 0.004
    pen = Pen(line[0] + (0 if exact else 1e-5))
    pen.draw(Stroke("driven", line + (0 if exact else 1e-5)), 0)
    report = verify(plan_of(PLOTTER, pen.path, Cover((Stroke("line", line),))))
    expected = _passes(line, 0.1, step)
    assert expected > 0.008
    assert report.figure("overlap area") == pytest.approx(expected, rel=0.04, abs=5e-4)


@pytest.mark.parametrize("closed", [True, False])
def test_smooth_lines_are_marked_once_and_corners_but_for_their_tips(closed: bool) -> None:
    angle = _TURN[:-1] if closed else _TURN[:-3]  # open, its ends are farther apart than it is wide
    ring = np.stack([np.cos(angle), np.sin(angle)], axis=1)
    smooth = Stroke("ring", ring, closed=closed)
    assert verify(drawn(Cover((smooth,)))).figure("overlap area") == pytest.approx(0, abs=1e-9)
    steps = np.array([[0.0, 3], [1, 3], [1, 4], [2, 4], [2, 5]])
    square = Stroke("square", np.array([[0.0, 6], [1, 6], [1, 7], [0, 7]]), closed=closed)
    tip = 0.05**2 * (1 - math.pi / 4)  # what a disc has left at the corner and comes back to
    report = verify(drawn(Cover((Stroke("steps", steps), square))))
    assert report.figure("overlap area") == pytest.approx((7 if closed else 5) * tip, rel=0.03)


def test_overlap_within_filled_areas_is_told_apart() -> None:
    box = Area("box", (np.array([[0.0, 0], [1, 0], [1, 0.3], [0, 0.3]]),), 1)
    rows = tuple(Stroke(f"{k}", np.array([[0.05, y], [0.95, y]])) for k, y in enumerate((0.05, 0.1, 0.15)))
    cross = (Stroke("a", np.array([[2.0, 0], [3, 0]])), Stroke("b", np.array([[2.5, -1], [2.5, 1]])))
    report = verify(drawn(Cover((*rows, *cross), (box,))))
    inside = report.figure("overlap in areas")
    ends = 0.05**2 * (2 * math.pi / 3 - math.sqrt(3) / 2)  # round ends side by side share a lens
    assert inside == pytest.approx(2 * (0.9 * 0.05 + ends), rel=1e-3)
    assert report.figure("overlap area") - inside == pytest.approx(0.01, rel=1e-6)
    detail = next(check.detail for check in report.checks if check.name == "overlap")
    assert "within areas" in detail
