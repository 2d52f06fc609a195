"""Curves to polylines."""

from __future__ import annotations

import itertools
from typing import Any

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from optplan.domain.arrays import FloatArray
from optplan.domain.errors import InputError, LimitError
from optplan.domain.job import Curve
from optplan.geometry import flatten as module
from optplan.geometry.flatten import flatten

COORDINATE = st.floats(-10, 10)


def curve_of(points: Any, handles: Any = None, *, closed: bool = False) -> Curve:
    return Curve(np.array(points, dtype=float), None if handles is None else np.array(handles, dtype=float), closed)


def dense(curve: Curve, count: int = 400) -> FloatArray:
    """Points of the curve by the definition of Beziers (de Casteljau)."""
    assert curve.handles is not None
    t = np.linspace(0, 1, count)[:, None]
    pieces = []
    for k, (first, second) in enumerate(curve.handles):
        row = [curve.points[k], first, second, curve.points[(k + 1) % len(curve.points)]]
        while len(row) > 1:
            row = [(1 - t) * a + t * b for a, b in itertools.pairwise(row)]
        pieces.append(row[0])
    return np.concatenate(pieces)


def distance(points: FloatArray, polyline: FloatArray) -> float:
    """Largest distance from points to a polyline."""
    a, b = polyline[:-1], polyline[1:]
    along = np.einsum("nmk,mk->nm", points[:, None] - a, b - a) / np.maximum(((b - a) ** 2).sum(axis=1), 1e-300)
    nearest = a + np.clip(along, 0, 1)[..., None] * (b - a)
    return float(np.linalg.norm(points[:, None] - nearest, axis=2).min(axis=1).max())


@given(
    st.lists(st.tuples(COORDINATE, COORDINATE), min_size=4, max_size=4),
    st.sampled_from([1.0, 0.1, 0.003]),
)
def test_no_point_of_the_curve_is_further_away_than_the_tolerance(
    corners: list[tuple[float, float]], tol: float
) -> None:
    p, q, r, s = np.array(corners)
    curve = Curve(np.array([p, s]), np.array([[q, r]]))
    flat = flatten(curve, tol)
    if len(flat) > 1:
        assert distance(dense(curve), flat) <= tol * (1 + 1e-9)


def test_the_number_of_pieces_is_not_wasteful() -> None:
    curve = curve_of([[0, 0], [1, 1]], [[[0.5523, 0], [1, 0.4477]]])
    # a quarter circle within 1e-4 takes (pi / 2) / (2 acos(1 - 1e-4)) = 55.6 chords of equal length
    assert 56 <= len(flatten(curve, 1e-4)) - 1 <= 90


def test_straight_lines_stay_as_they_are() -> None:
    curve = curve_of([[0, 0], [1, 0], [1, 1]])
    assert flatten(curve, 1e-3).tolist() == curve.points.tolist()


def test_lines_with_handles_at_thirds_are_not_cut() -> None:
    curve = curve_of([[0, 0], [3, 0]], [[[1, 0], [2, 0]]])
    assert flatten(curve, 1e-9).tolist() == [[0, 0], [3, 0]]


def test_closed_curves_do_not_repeat_their_first_point() -> None:
    curve = curve_of([[0, 0], [1, 0]], [[[0.3, 0.5], [0.6, 0.5]], [[0.6, -0.5], [0.3, -0.5]]], closed=True)
    flat = flatten(curve, 0.01)
    assert not np.array_equal(flat[0], flat[-1])
    assert distance(dense(curve), np.concatenate([flat, flat[:1]])) <= 0.01


def test_vertices_are_kept_exactly() -> None:
    curve = curve_of([[0.1, 0.2], [0.3, 0.7], [0.9, 0.4]], [[[0, 1], [1, 1]], [[0, 0], [1, 2]]])
    flat = flatten(curve, 0.01).tolist()
    assert all(vertex in flat for vertex in curve.points.tolist())


def test_duplicates_are_removed() -> None:
    assert flatten(curve_of([[0, 0], [0, 0], [1, 0], [1, 0]]), 0.1).tolist() == [[0, 0], [1, 0]]
    assert flatten(curve_of([[0, 0], [1, 0], [0, 0]], closed=True), 0.1).tolist() == [[0, 0], [1, 0]]


@pytest.mark.parametrize("tolerance", [0.0, -1.0, np.nan, np.inf])
def test_a_tolerance_that_is_none_is_refused(tolerance: float) -> None:
    with pytest.raises(InputError, match="tolerance"):
        flatten(curve_of([[0, 0], [1, 0]]), tolerance)


@pytest.mark.parametrize("tolerance", [1e-30, 5e-324])
def test_a_tolerance_that_takes_too_many_points_is_refused(tolerance: float) -> None:
    with pytest.raises(LimitError, match=str(module.MAX_POINTS)):
        flatten(curve_of([[0, 0], [1, 0]], [[[0, 1], [1, 1]]]), tolerance)
