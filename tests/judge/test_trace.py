"""Driven lines held against strokes."""

from __future__ import annotations

import math

import numpy as np
import pytest

from optplan.domain.arrays import FloatArray
from optplan.domain.stroke import Stroke
from optplan.judge._trace import in_space, trace

TOLERANCE = 0.01


def star(points: int = 40) -> FloatArray:
    angle = np.linspace(0, 2 * math.pi, points, endpoint=False)
    radius = 2 + 0.5 * np.sin(5 * angle)
    return np.stack([radius * np.cos(angle), radius * np.sin(angle)], axis=1)


@pytest.mark.parametrize("start", [0, 7, 39])
@pytest.mark.parametrize("reverse", [False, True])
def test_closed_stroke_from_any_vertex(start: int, reverse: bool) -> None:
    stroke = Stroke("star", star(), closed=True)
    ring = np.roll(stroke.points, -start, axis=0)
    ring = np.concatenate([ring, ring[:1]])
    found = trace(in_space(ring[::-1] if reverse else ring), stroke, TOLERANCE)
    assert found.deviation < 1e-12
    assert found.reverse == reverse
    along = np.linalg.norm(np.diff(stroke.closed_points, axis=0), axis=1)
    assert found.begin == pytest.approx(along[:start].sum(), abs=1e-9)


def test_closed_stroke_begun_between_vertices() -> None:
    stroke = Stroke("star", star(), closed=True)
    middle = (stroke.points[3] + stroke.points[4]) / 2
    ring = np.concatenate([[middle], stroke.points[4:], stroke.points[:4], [middle]])
    assert trace(in_space(ring), stroke, TOLERANCE).deviation < 1e-12


def test_figure_of_eight_begun_at_its_crossing() -> None:
    angle = np.linspace(0, 2 * math.pi, 64, endpoint=False)
    stroke = Stroke("eight", np.stack([np.sin(angle), np.sin(2 * angle)], axis=1), closed=True)
    ring = np.roll(stroke.points, 32, axis=0)
    for line in (ring, ring[::-1]):
        line = np.concatenate([line, line[:1]])
        assert trace(in_space(line), stroke, TOLERANCE).deviation < 0.02


@pytest.mark.parametrize(
    ("what", "line"),
    [
        ("a corner cut", np.delete(star(), 5, axis=0)),
        ("not closed", star()[:-3]),
        ("twice", np.concatenate([star(), star()])),
        ("a detour", np.insert(star(), 9, [[3.0, 3.0]], axis=0)),
        ("back and forth", np.concatenate([star()[:20], star()[10:20][::-1], star()[10:]])),
    ],
)
def test_being_near_is_not_enough(what: str, line: FloatArray) -> None:
    stroke = Stroke("star", star(), closed=True)
    ring = line if what == "not closed" else np.concatenate([line, line[:1]])
    assert trace(in_space(ring), stroke, TOLERANCE).deviation > 2 * TOLERANCE


def test_open_stroke_shifted_sideways_is_off_by_the_shift() -> None:
    stroke = Stroke("line", np.array([[0.0, 0], [1, 0], [2, 0.2]]))
    found = trace(in_space(stroke.points + np.array([0, 0.03])), stroke, TOLERANCE)
    assert found.deviation == pytest.approx(0.03, rel=0.02)
    assert not found.reverse


def test_long_line_is_walked_in_pieces() -> None:
    rng = np.random.default_rng(3)
    points = np.cumsum(rng.normal(0.05, 0.05, (20_000, 2)), axis=0)
    stroke = Stroke("long", points)
    middle = (points[1:] + points[:-1]) / 2
    fine = np.empty((2 * len(points) - 1, 2))
    fine[::2], fine[1::2] = points, middle
    assert trace(in_space(fine), stroke, TOLERANCE).deviation < 1e-9
    bent = fine.copy()
    bent[20_001] += [0.0, 0.5]
    found = trace(in_space(bent), stroke, TOLERANCE)
    assert found.deviation > 0.1
    assert found.place[:2] == pytest.approx(bent[20_001], abs=0.3)
