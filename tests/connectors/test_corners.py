"""Corners rounded inside and looped around outside."""

from __future__ import annotations

import math

import numpy as np
import pytest
import shapely
from hypothesis import given, settings
from hypothesis import strategies as st

from optplan.connectors.corners import inner_rounding, outer_loop, outer_loops, turns
from optplan.domain.arrays import FloatArray
from optplan.domain.errors import InputError
from optplan.geometry.curves import Curve, joints
from tests.strategies import array, polylines

sharpnesses = st.sampled_from([0.3, 2.0, 20.0])


def _walk(curve: Curve, step: float = 1e-3) -> tuple[FloatArray, FloatArray, FloatArray]:
    """Points, headings and curvatures of a curve by the midpoint rule, from its table alone."""
    x, heading = curve.start[:2], float(curve.start[2])
    points, headings, kappas = [x[None]], [array([heading])], [curve.curvature[:1]]
    for kappa, sigma, length in zip(curve.curvature, curve.sharpness, curve.length, strict=True):
        count = max(8, math.ceil(length / step))
        u = (np.arange(count) + 0.5) * length / count
        angle = heading + kappa * u + sigma * u * u / 2
        points.append(
            points[-1][-1] + np.cumsum(np.column_stack([np.cos(angle), np.sin(angle)]), axis=0) * length / count
        )
        headings.append(angle)
        kappas.append(kappa + sigma * u)
        heading += kappa * length + sigma * length**2 / 2
    headings.append(array([heading]))
    return np.concatenate(points), np.concatenate(headings), np.concatenate(kappas)


@given(st.floats(-12, 12), st.floats(0.2, 5), sharpnesses)
def test_turns_turn(angle: float, kappa: float, sigma: float) -> None:
    made = turns(array([angle]), kappa, sigma)
    peak, clothoid, arc = float(made.peak[0]), float(made.clothoid[0]), float(made.arc[0])
    assert abs(peak) <= kappa
    assert peak * (clothoid + arc) == pytest.approx(angle, abs=1e-9)
    rows = array(
        [(0, math.copysign(sigma, angle), clothoid), (peak, 0, arc), (peak, -math.copysign(sigma, angle), clothoid)]
    )
    rows = rows[rows[:, 2] > 1e-9]
    if len(rows):
        points, _, _ = _walk(Curve(array([0, 0, 0]), *rows.T))
        want = made.width[0] * array([math.cos(angle / 2), math.sin(angle / 2)])
        assert points[-1] == pytest.approx(want, abs=1e-4)


@settings(deadline=None)
@given(polylines(), st.floats(0.05, 1), st.floats(0.5, 10), sharpnesses)
def test_rounding_keeps_its_limits(points: FloatArray, deviation: float, kappa: float, sigma: float) -> None:
    made = inner_rounding(points, deviation, kappa, sigma)
    line = shapely.LineString(points)
    assert len(made.curves) == 1 + made.kept.sum()
    assert (made.deviation <= deviation).all()
    here = points[0]
    for curve in made.curves:
        assert curve.start[:2] == pytest.approx(here, abs=1e-8)
        walked, _, bends = _walk(curve, 0.01)
        assert np.abs(bends).max() <= kappa * (1 + 1e-9)
        assert np.abs(curve.sharpness).max() <= sigma
        assert (joints(curve).order == 2).all()
        assert shapely.distance(line, shapely.points(walked)).max() <= deviation + 1e-3
        here = curve.end[:2]
    assert here == pytest.approx(points[-1], abs=1e-8)


@pytest.mark.parametrize("theta", [*np.linspace(0.01, math.pi - 0.01, 12), math.pi])
def test_rounding_is_bounded(theta: float) -> None:
    points = array([[-1e6, 0], [0, 0], [1e6 * math.cos(theta), 1e6 * math.sin(theta)]])
    made = inner_rounding(points, 0.5, 1.0, 2.0)
    assert made.deviation[0] <= 0.5
    if not made.kept[0]:
        middle = made.curves[0]
        assert middle.length[1:-1].sum() < 10


@pytest.mark.parametrize("sigma", [0.2, 1.0, 5.0, 100.0])
def test_loops_are_bounded_and_exact(sigma: float) -> None:
    small = turns(array([2 * math.pi]), 1.0, sigma).length[0]
    for theta in (*np.linspace(-3.1, math.pi, 12), 0.0, 1e-9, 1e-3, math.pi - 1e-3, math.pi - 1e-9):
        loop = outer_loop(theta, 1.0, sigma)
        points, headings, bends = _walk(loop, 2e-3)
        assert math.hypot(*points[-1]) < 1e-4
        assert loop.end[:2] == pytest.approx([0, 0], abs=1e-9)
        assert abs(math.sin((headings[-1] - theta) / 2)) < 1e-9
        assert np.abs(bends).max() <= 1 + 1e-9
        assert loop.max_sharpness <= sigma
        assert (joints(loop).order == 2).all()
        assert [loop.curvature[0], loop.end_curvature[-1]] == pytest.approx([0, 0], abs=1e-12)
        assert 0 < loop.total < 2.0 * small


def test_loops_are_mirrored() -> None:
    left, right = outer_loop(1.2, 2.0, 3.0), outer_loop(-1.2, 2.0, 3.0)
    assert left.curvature == pytest.approx(-right.curvature)
    assert left.length == pytest.approx(right.length)


def test_loops_of_a_polyline_leave_its_edges_whole() -> None:
    points = array([[0, 0], [3, 0], [3, 3], [3.2, 0]])
    made = outer_loops(points, 2.0, 3.0, 10.0)
    assert list(made) == [2]
    assert made[2].start == pytest.approx([3, 3, math.pi / 2])
    assert made[2].end[:2] == pytest.approx([3, 3], abs=1e-9)


def test_wrong_input() -> None:
    line = array([[0, 0], [1, 0], [1, 1]])
    for values in ((0, 1, 1), (1, 0, 1), (1, 1, math.nan)):
        with pytest.raises(InputError, match="above 0"):
            inner_rounding(line, *values)
    with pytest.raises(InputError, match="repeats"):
        inner_rounding(array([[0, 0], [0, 0]]), 1, 1, 1)
    with pytest.raises(InputError, match="finite"):
        outer_loop(math.inf, 1, 1)
    with pytest.raises(InputError, match="threshold"):
        outer_loops(line, 0, 1, 1)
