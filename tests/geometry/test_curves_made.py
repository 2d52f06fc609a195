"""Parallels, conversions and fits of curves."""

from __future__ import annotations

import math

import numpy as np
import pytest
import shapely
from hypothesis import given, settings
from hypothesis import strategies as st

from optplan.domain.arrays import FloatArray
from optplan.domain.errors import InputError
from optplan.geometry.converting import to_arcs, to_beziers, to_lines
from optplan.geometry.curves import Curve, evaluate, joints, sampled_curve
from optplan.geometry.hermite import clothoid_fit
from optplan.geometry.offsets import offset, offset_points, offset_states
from optplan.geometry.rounding import wrapped
from optplan.geometry.splines import drivable, euler_spline
from tests.strategies import array

WAVE = Curve(array([1, 2, 0.3]), array([0, 1, 1]), array([1, 0, -0.5]), array([1, 2, 3]))
TEN_METRES = Curve(array([0, 0, 0]), array([0, 0.5]), array([0.1, -0.2]), array([5, 5]))


def _apart(curve: Curve, points: FloatArray) -> float:
    line = shapely.LineString(evaluate(curve, sampled_curve(curve, 1e-8)).points)
    return float(shapely.distance(line, shapely.points(points)).max())


@pytest.mark.parametrize("tolerance", [1e-2, 1e-4])
@pytest.mark.parametrize("curve", [WAVE, TEN_METRES])
def test_conversions_keep_their_tolerance(curve: Curve, tolerance: float) -> None:
    lines, arcs, beziers = to_lines(curve, tolerance), to_arcs(curve, tolerance), to_beziers(curve, tolerance)
    for made in (lines, arcs, beziers):
        assert 0 < made.error <= tolerance
    assert _apart(curve, lines.points) < 1e-7
    assert not arcs.curve.sharpness.any()
    assert (joints(arcs.curve).order >= 1).all()
    assert _apart(curve, evaluate(arcs.curve, np.linspace(0, arcs.curve.total, 2000)).points) <= tolerance
    assert arcs.curve.end == pytest.approx(curve.end, abs=1e-9)
    t = np.linspace(0, 1, 21)[:, None, None]
    c = np.moveaxis(beziers.control, 1, 0)[:, None]
    bent = (1 - t) ** 3 * c[0] + 3 * t * (1 - t) ** 2 * c[1] + 3 * t * t * (1 - t) * c[2] + t**3 * c[3]
    assert _apart(curve, bent.reshape(-1, 2)) <= tolerance * (1 + 1e-3)


def test_beziers_at_ten_metres() -> None:
    made = to_beziers(TEN_METRES)
    assert made.error < 1e-3
    assert len(made.control) <= 12


def test_lines_and_arcs_stay_as_they_are() -> None:
    curve = Curve(array([0, 0, 0]), array([0, 1]), array([0, 0]), array([1, 4]))
    arcs = to_arcs(curve, 1e-3)
    assert arcs.curve.length == pytest.approx(curve.length)
    assert arcs.error < 1e-12


@pytest.mark.parametrize("distance", [0.4, -0.7])
def test_parallels(distance: float) -> None:
    made = offset(WAVE, distance, 1e-5)
    assert made.error <= 1e-5
    true = offset_states(WAVE, distance, np.linspace(0, WAVE.total, 4000))
    ours = evaluate(made.curve, np.linspace(0, made.curve.total, 500))
    near = shapely.distance(shapely.LineString(true.points), shapely.points(ours.points))
    assert near.max() < 1.1e-5
    assert made.curve.end == pytest.approx([true.x[-1], true.y[-1], true.heading[-1]], abs=1e-9)
    # curvature from differences of heading over arc length
    step = np.hypot(np.diff(true.x), np.diff(true.y))
    middle = (true.curvature[1:] + true.curvature[:-1]) / 2
    assert np.abs(np.diff(true.heading) / step - middle).max() < 2e-3
    assert len(offset_points(WAVE, distance, 1e-3)) > 10


def test_parallels_of_arcs_are_exact_and_come_back() -> None:
    curve = Curve(array([0, 0, 1]), array([0, 1]), array([0, 0]), array([1, 4]))
    there = offset(curve, 0.5).curve
    assert there.curvature == pytest.approx([0, 2])
    back = offset(there, -0.5).curve
    assert back.states == pytest.approx(curve.states)
    with pytest.raises(InputError, match="cusp"):
        offset(curve, 1.5)
    with pytest.raises(InputError, match="cusp"):
        offset_points(curve, 1.0, 1e-3)


angles = st.floats(-3.1, 3.1)


@given(angles, angles, st.floats(1e-3, 1e3), st.floats(-4, 4))
def test_a_clothoid_meets_both_ends(th0: float, th1: float, distance: float, turn: float) -> None:
    there = array([distance * math.cos(turn), distance * math.sin(turn)])
    curve = clothoid_fit(array([0, 0]), th0 + turn, there, th1 + turn)
    assert math.hypot(*(curve.end[:2] - there)) < 1e-9 * max(curve.total, 1)
    assert abs(wrapped(array([curve.end[2] - th1 - turn]))[0]) < 1e-9


def test_no_clothoid() -> None:
    with pytest.raises(InputError, match="two places"):
        clothoid_fit(array([1, 1]), 0, array([1, 1]), 1)
    with pytest.raises(InputError, match="finite"):
        clothoid_fit(array([0, 0]), math.nan, array([1, 1]), 1)


@settings(max_examples=30)
@given(st.lists(st.tuples(st.floats(0.5, 2), st.floats(-1, 1)), min_size=1, max_size=12))
def test_a_drawn_line_becomes_drivable(steps: list[tuple[float, float]]) -> None:
    size, bend = array(steps).T
    heading = np.cumsum(bend)
    moves = size[:, None] * np.column_stack([np.cos(heading), np.sin(heading)])
    points = np.concatenate([[[0, 0]], np.cumsum(moves, axis=0)])
    made = drivable(points)
    assert made.curve.states[:, :2] == pytest.approx(points, abs=1e-9)
    assert joints(made.curve).curvature.max(initial=0) < 1e-8
    assert abs(made.curve.curvature[0]) < 1e-8
    assert abs(made.curve.end_curvature[-1]) < 1e-8
    assert made.deviation < 2


def test_a_circle_is_found_again() -> None:
    turn = np.linspace(0, 5, 9)
    made = drivable(np.column_stack([np.cos(turn), np.sin(turn)]), math.pi / 2, 5 + math.pi / 2)
    assert made.max_curvature == pytest.approx(1)
    assert made.max_sharpness < 1e-9


def test_kinds_of_control_points() -> None:
    points = array([[0, 0], [1, 1], [2, 0], [4, 0], [5, 1], [6, 0]])
    first, second = euler_spline(points, kinds="cc][vc")
    assert first.end[:2] == pytest.approx(points[4])
    assert second.start[:2] == pytest.approx(points[4])
    straight = np.flatnonzero((first.curvature == 0) & (first.sharpness == 0))
    assert first.states[straight[0]] == pytest.approx([2, 0, 0])
    for kinds, what in (("cccco", "letters"), ("ccccco", "letters"), ("c]ccvc", None)):
        if what:
            with pytest.raises(InputError, match=what):
                euler_spline(points, kinds=kinds)
    with pytest.raises(InputError, match="apart"):
        euler_spline(array([[0, 0], [0, 0]]))
