"""Rounded polylines, followed by an integration of the test's own."""

from __future__ import annotations

import math

import numpy as np
import pytest
import shapely
from hypothesis import given
from hypothesis import strategies as st

from optplan.domain.arrays import FloatArray
from optplan.geometry.rounding import Pieces, inner_vertices, rounded, wrapped
from tests.strategies import array, circle, polylines

tolerances = st.floats(1e-3, 0.3)
least_radii = st.sampled_from([0.0, 0.05, 0.5, 2.0])
corners = st.floats(0.05, math.pi)


def _followed(pieces: Pieces, steps: int = 50) -> tuple[FloatArray, FloatArray, FloatArray]:
    """Dense points of the path, and the end points and end headings of its pieces, by the midpoint rule."""
    dense, ends, headings = [], [], []
    for start, heading, curvature, length, turn, _ in zip(*pieces, strict=True):
        h = length / steps
        middle = heading + curvature * (np.arange(steps) + 0.5) * h
        walk = start + h * np.cumsum(np.column_stack([np.cos(middle), np.sin(middle)]), axis=0)
        dense += [start[None], walk]
        ends.append(walk[-1])
        headings.append(heading + curvature * length + turn)
    return np.concatenate(dense), array(ends), array(headings)


@given(polylines(), tolerances, least_radii, corners)
def test_the_path_is_whole(points: FloatArray, tolerance: float, radius: float, corner: float) -> None:
    pieces = rounded(points, tolerance, radius, corner)
    dense, ends, headings = _followed(pieces)
    assert dense[0] == pytest.approx(points[0], abs=1e-9)
    assert ends[-1] == pytest.approx(points[-1], abs=1e-3)
    size = 1e-3 * np.maximum(pieces.length[:-1], 1e-6)  # of the midpoint rule
    assert (np.hypot(*(ends[:-1] - pieces.start[1:]).T) <= size).all()
    assert np.abs(np.sin((headings[:-1] - pieces.heading[1:]) / 2)).max(initial=0) < 1e-9  # G1 but for stated turns


@given(polylines(), tolerances, least_radii, corners)
def test_it_keeps_its_promises(points: FloatArray, tolerance: float, radius: float, corner: float) -> None:
    pieces = rounded(points, tolerance, radius, corner)
    dense, _, _ = _followed(pieces)
    line = shapely.LineString(points)
    assert shapely.distance(line, shapely.points(dense)).max() <= tolerance * (1 + 1e-6) + 1e-6
    assert shapely.distance(shapely.LineString(dense), shapely.points(points)).max() <= tolerance + 1e-4
    assert (np.abs(pieces.curvature) * radius <= 1 + 1e-9).all()
    arcs = pieces.curvature != 0
    bends = pieces.curvature[arcs] * pieces.length[arcs]
    assert (np.abs(bends) <= corner + 1e-9).all()
    steps = np.diff(points, axis=0)
    turning = wrapped(np.diff(np.arctan2(steps[:, 1], steps[:, 0]))).sum()
    assert (pieces.curvature * pieces.length + pieces.turn).sum() == pytest.approx(turning, abs=1e-6)
    assert pieces.total <= np.hypot(*steps.T).sum() + 1e-9
    assert ((pieces.length > 0) | (pieces.turn != 0)).all()


@pytest.mark.parametrize(("radius", "count"), [(1.0, 24), (0.3, 100), (7.5, 36)])
def test_an_even_circle_becomes_its_inscribed_arcs(radius: float, count: int) -> None:
    ring = circle(radius, count)
    pieces = rounded(np.concatenate([ring, ring[:2]]), 1.0, 0.0, math.pi)
    arcs = pieces.curvature != 0
    # arcs touch the chords' middles: the incircle of the polygon
    assert 1 / pieces.curvature[arcs] == pytest.approx(radius * math.cos(math.pi / count), rel=1e-9)
    assert pieces.length[arcs] == pytest.approx(math.tau / count * radius * math.cos(math.pi / count))
    assert (~arcs).sum() == 2  # half a chord at either end, nothing between the arcs


def test_clockwise_circles_bend_right() -> None:
    pieces = rounded(circle(1.0, 24)[::-1], 1.0, 0.0, math.pi)
    assert (pieces.curvature <= 0).all()


def test_which_vertices_stay_corners() -> None:
    points = array([[0, 0], [1, 0], [2, 0], [3, 0.2], [3, 2], [2.9, 2], [2.9, 0]])
    found = inner_vertices(points, False, 0.05, 0.3, math.radians(60))
    assert found.corner.tolist() == [False, False, True, True, True]
    assert (found.tangent > 0).tolist() == [False, True, False, False, False]
    tight = inner_vertices(points, False, 1e-4, 30.0, math.radians(60))
    assert tight.corner.tolist() == [False, True, True, True, True]  # no room for an arc of 30 m


def test_a_ring_has_as_many_vertices_as_points() -> None:
    found = inner_vertices(array([[0, 0], [4, 0], [4, 3]]), True, 0.1, 0.0, 1.0)
    expected = [math.pi - math.atan2(3, 4), math.pi / 2, math.pi - math.atan2(4, 3)]
    assert found.deflection == pytest.approx(expected)
    assert found.deflection.sum() == pytest.approx(math.tau)


@given(st.floats(-50, 50))
def test_wrapped_angles(angle: float) -> None:
    inside = float(wrapped(array([angle]))[0])
    assert -math.pi < inside <= math.pi
    assert math.sin((inside - angle) / 2) == pytest.approx(0, abs=1e-12)


def test_a_half_turn_is_to_the_left() -> None:
    assert wrapped(array([math.pi, -math.pi])).tolist() == [math.pi, math.pi]
