"""Drawn polylines as curves of continuous curvature: within the tolerance and the limits, whatever was drawn."""

from __future__ import annotations

import math

import numpy as np
import pytest
import shapely
from hypothesis import given, settings
from hypothesis import strategies as st

from optplan.geometry.curves import evaluate, joints, reversed_curve
from optplan.geometry.rounding import wrapped
from optplan.geometry.smoothing import Smoothed, least_change, smoothed
from tests.strategies import array, circle, polylines, star_shaped


def check(made: Smoothed, points: np.ndarray, closed: bool, tolerance: float, kappa: float, sigma: float) -> None:
    """Everything that is promised, by dense evaluation."""
    ring = np.concatenate([points, points[:1]]) if closed else points
    dense = [evaluate(curve, np.linspace(0, curve.total, 60 * len(curve) + 1)).points for curve in made.curves]
    line, path = shapely.LineString(ring), shapely.LineString(np.concatenate(dense))
    assert shapely.distance(line, shapely.points(np.concatenate(dense))).max() <= tolerance * (1 + 1e-6) + 1e-9
    assert shapely.distance(path, shapely.points(ring)).max() <= tolerance * (1 + 1e-3) + 1e-9
    for curve in made.curves:
        assert curve.max_curvature <= kappa * (1 + 1e-9)
        assert curve.max_sharpness <= sigma * (1 + 1e-9)
        assert joints(curve).curvature.max(initial=0.0) < 1e-7 * (1 + kappa)
    if closed and len(made.stops) == 0:
        (curve,) = made.curves
        assert curve.end[:2] == pytest.approx(curve.start[:2], abs=1e-9)
        assert abs(wrapped(np.array([curve.end[2] - curve.start[2]]))[0]) < 1e-9
        assert curve.end_curvature[-1] == pytest.approx(curve.curvature[0], abs=1e-8)
        return
    # between stops the curves meet at the vertices drawn
    assert len(made.stops) == len(made.curves)
    assert np.array([curve.start[:2] for curve in made.curves]) == pytest.approx(points[made.stops], abs=1e-9)
    ends = np.append(made.stops[1:], made.stops[0] if closed else len(points) - 1)
    assert np.array([curve.end[:2] for curve in made.curves]) == pytest.approx(points[ends], abs=1e-9)


@settings(max_examples=60, deadline=None)
@given(
    st.one_of(polylines(), star_shaped()),
    st.booleans(),
    st.sampled_from([1e-3, 0.02, 0.3]),
    st.sampled_from([(2.0, 4.0), (0.7, 0.5), (30.0, 200.0), (5.0, math.inf)]),
    st.floats(0.1, 3.1),
)
def test_any_line_becomes_curves(
    points: np.ndarray, closed: bool, tolerance: float, limits: tuple[float, float], corner: float
) -> None:
    made = smoothed(points, closed, tolerance, *limits, corner)
    check(made, points, closed, tolerance, *limits)


def test_a_circle_needs_no_stop() -> None:
    points = circle(1.0, 90, (3, 4))
    made = smoothed(points, True, 2e-3, 1.1, 0.5, 0.5)
    assert len(made.stops) == 0
    check(made, points, True, 2e-3, 1.1, 0.5)
    assert made.curves[0].curvature == pytest.approx(1.0, rel=0.02)


def test_a_straight_line_is_one_piece() -> None:
    made = smoothed(array([[0, 0], [1, 1], [5, 5]]), False, 1e-3, 2.0, 4.0, 0.5)
    assert [len(curve) for curve in made.curves] == [1]


def test_corners_stay() -> None:
    points = array([[0, 0], [4, 0], [4, 3]])
    made = smoothed(points, False, 1e-2, 2.0, 4.0, 0.5)
    assert made.stops.tolist() == [0, 1]
    assert [curve.total for curve in made.curves] == pytest.approx([4, 3])
    ring = smoothed(points, True, 1e-2, 2.0, 4.0, 0.5)
    assert ring.stops.tolist() == [0, 1, 2]


def test_a_line_that_turns_into_an_arc_is_eased() -> None:
    """Curvature jumps there from 0 to 1; the tolerance leaves room for a ramp, unless the limit is too low for it."""
    turn = np.linspace(0, math.pi / 2, 60)[1:]
    arc = np.column_stack([np.sin(turn), 1 - np.cos(turn)])
    points = np.concatenate([[[-3, 0], [0, 0]], arc])
    eased = smoothed(points, False, 2e-3, 2.0, 6.0, 0.5)
    assert len(eased.curves) == 1
    check(eased, points, False, 2e-3, 2.0, 6.0)
    stopped = smoothed(points, False, 2e-3, 2.0, 1.0, 0.5)
    assert len(stopped.curves) > 1
    check(stopped, points, False, 2e-3, 2.0, 1.0)


def test_tight_curves_stop_the_robot() -> None:
    points = circle(0.2, 24)
    made = smoothed(points, True, 1e-3, 2.0, 4.0, 0.5)
    assert len(made.stops) >= 8
    check(made, points, True, 1e-3, 2.0, 4.0)


def test_samples_move_to_where_curvature_changes_least() -> None:
    """Noise of the size of the tolerance disappears, and no sample moves further than that."""
    random = np.random.default_rng(4)
    x = np.linspace(0, 4, 80)
    noisy = np.column_stack([x, 0.005 * random.uniform(-1, 1, 80)])
    moved, excess = least_change(noisy, False, 0.01, 1.0, 1.0)
    assert excess.max() <= 0
    assert np.linalg.norm(moved - noisy, axis=1).max() <= 0.01 * (1 + 1e-9)
    assert np.abs(np.diff(moved[:, 1], 3)).max() < 0.01 * np.abs(np.diff(noisy[:, 1], 3)).max()
    assert (moved[[0, -1]] == noisy[[0, -1]]).all()


def test_driven_backwards_it_is_the_same() -> None:
    points = np.column_stack([np.linspace(0, 6, 50), np.sin(np.linspace(0, 6, 50))])
    (one,) = smoothed(points, False, 5e-3, 2.0, 4.0, 0.5).curves
    (other,) = smoothed(points[::-1], False, 5e-3, 2.0, 4.0, 0.5).curves
    back = reversed_curve(other)
    s = np.linspace(0, min(one.total, back.total), 100)
    assert evaluate(one, s).points == pytest.approx(evaluate(back, s).points, abs=1e-4)
