"""Other shapes of connections."""

from __future__ import annotations

import math

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from optplan.connectors.shapes import SHAPES, Shape, bezier3, bezier5, compare_shapes, fermat, shapes_table, spiro
from optplan.connectors.spiro import LIMIT_SLACK, spiro_connections
from optplan.domain.arrays import FloatArray
from optplan.domain.errors import InputError
from optplan.geometry.curves import evaluate, joints
from optplan.geometry.rounding import wrapped
from tests.strategies import array, states


def _queries(count: int, far: float) -> tuple[FloatArray, FloatArray]:
    rng = np.random.default_rng(7)
    starts = np.column_stack([rng.normal(size=(count, 2)), rng.uniform(-4, 4, count)])
    ends = np.column_stack([starts[:, :2] + rng.uniform(-far, far, (count, 2)), rng.uniform(-4, 4, count)])
    return starts, ends


@settings(deadline=None)
@given(states, states, st.floats(0.2, 3), st.sampled_from(sorted(SHAPES)))
def test_every_shape_meets_both_ends(
    a: tuple[float, float, float], b: tuple[float, float, float], radius: float, name: str
) -> None:
    start, end = array(a), array(b)
    if math.dist(a[:2], b[:2]) < 1e-3:
        return
    made = compare_shapes(start, end, radius)[name]
    if isinstance(made, str):
        assert name == "fermat"
        return
    assert np.abs(made.points[[0, -1]] - [a[:2], b[:2]]).max() < 1e-6
    assert np.abs(wrapped(made.heading[[0, -1]] - [a[2], b[2]])).max() < 1e-6
    assert made.length >= math.dist(a[:2], b[:2]) * (1 - 1e-6)


@pytest.mark.parametrize("make", [bezier3, bezier5, fermat, spiro])
def test_curvature_is_that_of_the_points(make: object) -> None:
    made: Shape = make(array([0, 0, 0]), array([5, 4, 1.4]), 1.0)  # type: ignore[operator]
    step = np.diff(made.points, axis=0)
    size, heading = np.hypot(*step.T), np.unwrap(np.arctan2(step[:, 1], step[:, 0]))
    even = (size[1:] < 0.05) & (size[:-1] < 0.05) & (size[1:] > 1e-4) & (size[:-1] > 1e-4)
    bend = np.diff(heading) / ((size[1:] + size[:-1]) / 2)
    assert np.abs(bend - made.curvature[1:-1])[even].max() < 0.02
    assert made.length == pytest.approx(size.sum(), rel=1e-4)


def test_orders() -> None:
    table = compare_shapes(array([0, 0, 0]), array([5, 4, 1.4]), 1.0)
    orders = {name: made.order for name, made in table.items() if not isinstance(made, str)}
    assert orders == {"dubins": 1, "bezier3": 1, "bezier5": 2, "spiro": 1, "fermat": 2}
    text = shapes_table(array([0, 0, 0]), array([5, 4, -1.4]), 1.0)
    assert "no Fermat spiral" in text
    assert len(text.splitlines()) == 1 + len(SHAPES)


def test_the_handle_is_an_option() -> None:
    start, end = array([0, 0, 0]), array([4, 3, 1])
    assert bezier3(start, end, 1.0).length == bezier3(start, end, 1.0, 5 / 4).length
    assert bezier3(start, end, 1.0, 3.0).length > bezier3(start, end, 1.0).length


def test_splines_keep_the_curvature_limit_on_a_grid() -> None:
    """alpha and beta against the line of sight, d in R."""
    turn = np.linspace(-math.pi, math.pi, 13)
    alpha, beta, d = (v.ravel() for v in np.meshgrid(turn, turn, [0.05, 0.5, 1, 2, 3, 5, 10, 30]))
    zero = np.zeros_like(d)
    made = spiro_connections(np.column_stack([zero, zero, alpha]), np.column_stack([d, zero, beta]), 1.0)
    assert (made.within == (made.max_curvature <= 1 + LIMIT_SLACK)).all()
    assert made.within.mean() > 0.99
    assert np.isfinite(made.max_curvature).all()


def test_no_nan_in_many_random_cases() -> None:
    starts, ends = _queries(2000, 8)
    made = spiro_connections(starts, ends, 1.0)
    for curve, end, largest in zip(made.curves, ends, made.max_curvature, strict=True):
        assert curve is not None
        assert math.hypot(*(curve.end[:2] - end[:2])) < 1e-7
        assert np.isfinite(curve.states).all()
        assert curve.max_curvature == pytest.approx(largest)


def test_splines_are_smooth_and_pass_their_points() -> None:
    starts, ends = _queries(50, 5)
    for curve in spiro_connections(starts, ends, 1.0).curves:
        assert curve is not None
        assert (joints(curve, tolerance=1e-6).order == 2).all()
        dense = evaluate(curve, np.linspace(0, curve.total, 500))
        assert np.abs(dense.curvature).max() <= curve.max_curvature + 1e-12


def test_wrong_input() -> None:
    here, there = array([0, 0, 0]), array([1, 1, 0])
    for make in SHAPES.values():
        with pytest.raises(InputError, match="one place"):
            make(here, here, 1.0)
        with pytest.raises(InputError, match="above 0"):
            make(here, there, 0.0)
        with pytest.raises(InputError, match="finite"):
            make(here, array([1, math.nan, 0]), 1.0)
    with pytest.raises(InputError, match="handle"):
        bezier3(here, there, 1.0, -1.0)
    with pytest.raises(InputError, match="parallel"):
        fermat(here, there, 1.0)
