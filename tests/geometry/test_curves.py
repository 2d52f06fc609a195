"""Curves of clothoid pieces, against integrations of the tests' own."""

from __future__ import annotations

import math

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st
from scipy.integrate import quad

from optplan.domain.arrays import FloatArray
from optplan.domain.errors import InputError, LimitError
from optplan.geometry.clothoids import clothoid_displacement
from optplan.geometry.curves import (
    Curve,
    evaluate,
    from_path,
    joined,
    joints,
    moved,
    part,
    reversed_curve,
    sampled_curve,
    split,
    to_path,
)
from optplan.geometry.rounding import wrapped
from tests.strategies import array, states

WAVE = Curve(array([1, 2, 0.3]), array([0, 1, 1]), array([1, 0, -0.5]), array([1, 2, 3]))


@st.composite
def curves(draw: st.DrawFn) -> Curve:
    count = draw(st.integers(1, 5))

    def column(low: float, high: float) -> FloatArray:
        return array([draw(st.floats(low, high, allow_subnormal=False)) for _ in range(count)])

    return Curve(array(draw(states)), column(-3, 3), column(-2, 2), column(0.01, 3))


def _same(a: Curve, b: Curve, size: float = 1e-9) -> None:
    s = np.linspace(0, min(a.total, b.total), 40)
    one, two = evaluate(a, s), evaluate(b, s)
    assert a.total == pytest.approx(b.total)
    assert np.hypot(one.x - two.x, one.y - two.y).max() < size
    assert np.abs(wrapped(one.heading - two.heading)).max() < size


def _dense(b: float, a: float) -> complex:
    """Integral of exp(i (b t + a t^2 / 2)) over 0..1 by panels of one radian, phases in extended precision."""
    nodes, weights = np.polynomial.legendre.leggauss(20)
    panels = math.ceil(abs(b) + abs(a) / 2 + 1)
    t = (np.arange(panels)[:, None] + (nodes + 1) / 2).astype(np.longdouble) / panels
    phase = np.longdouble(b) * t + np.longdouble(a) * t * t / 2
    return complex((np.cos(phase) @ weights).sum(), (np.sin(phase) @ weights).sum()) / (2 * panels)


def test_displacement_over_a_kilometre() -> None:
    rng = np.random.default_rng(1)
    b = rng.choice([-1, 1], 300) * 10 ** rng.uniform(-6, 4, 300)
    a = rng.choice([-1, 1], 300) * 10 ** rng.uniform(-20, 4, 300)
    a[:100] = -b[:100] * rng.uniform(0.5, 2, 100)  # inflections inside
    length = 1000.0
    dx, dy = clothoid_displacement(np.zeros(300), b / length, a / length**2, np.full(300, length))
    true = length * array([[z.real, z.imag] for z in map(_dense, b, a)]).T
    assert np.hypot(dx - true[0], dy - true[1]).max() < 1e-9


@pytest.mark.parametrize(
    ("kappa", "sigma", "length"), [(0, 0, 5), (1e-12, 1e-15, 1e3), (0.5, 1e-300, 10), (2, -1, 4), (0, 1e6, 1e-3)]
)
def test_displacement_against_quad(kappa: float, sigma: float, length: float) -> None:
    dx, dy = clothoid_displacement(*(array([value]) for value in (0.4, kappa, sigma, length)))
    for value, wave in ((dx, math.cos), (dy, math.sin)):
        true = quad(lambda u, f=wave: f(0.4 + kappa * u + sigma * u * u / 2), 0, length, epsabs=1e-12, limit=400)[0]
        assert value[0] == pytest.approx(true, abs=1e-10)


@given(curves())
def test_reversing_twice_changes_nothing(curve: Curve) -> None:
    back = reversed_curve(curve)
    _same(reversed_curve(back), curve)
    there, here = evaluate(curve, curve.offsets), evaluate(back, curve.total - curve.offsets)
    assert np.abs(there.points - here.points).max() < 1e-9


@given(curves(), st.floats(0, 1))
def test_splitting_and_joining_changes_nothing(curve: Curve, share: float) -> None:
    _same(joined(*split(curve, share * curve.total)), curve)
    middle = part(curve, 0.3 * curve.total, 0.7 * curve.total)
    s = np.linspace(0, middle.total, 9)
    assert np.abs(evaluate(middle, s).points - evaluate(curve, s + 0.3 * curve.total).points).max() < 1e-9


@given(curves(), states)
def test_it_moves_as_a_whole(curve: Curve, place: tuple[float, float, float]) -> None:
    there = moved(curve, array(place))
    s = np.linspace(0, curve.total, 20)
    one, two = evaluate(curve, s), evaluate(there, s)
    turn = place[2] - curve.start[2]
    spin = array([[math.cos(turn), -math.sin(turn)], [math.sin(turn), math.cos(turn)]])
    assert np.abs((one.points - curve.start[:2]) @ spin.T + place[:2] - two.points).max() < 1e-9


@given(curves())
def test_paths_hold_the_same(curve: Curve) -> None:
    _same(from_path(to_path(curve, 1, 2)), curve)


@given(curves(), st.floats(1e-4, 0.1))
def test_chords_stay_close(curve: Curve, tolerance: float) -> None:
    s = sampled_curve(curve, tolerance)
    ends, middle = evaluate(curve, s).points, evaluate(curve, (s[1:] + s[:-1]) / 2).points
    chord = np.diff(ends, axis=0)
    offset = middle - ends[:-1]
    away = np.abs(chord[:, 0] * offset[:, 1] - chord[:, 1] * offset[:, 0]) / np.hypot(*chord.T)
    assert away.max() <= tolerance * (1 + 1e-6)


def test_joints_are_graded() -> None:
    line, ahead = Curve(array([0, 0, 0]), *array([[0], [0], [1]])), array([1, 0, 0])
    assert joints(line, moved(line, ahead)).order.tolist() == [2]
    assert joints(line, Curve(ahead, *array([[1], [0], [1]]))).order.tolist() == [1]
    corner = joints(line, moved(line, array([1, 0, 1])))
    assert corner.order.tolist() == [0]
    assert corner.heading.tolist() == [1]
    assert joints(line, moved(line, array([3, 0, 0]))).order.tolist() == [-1]
    assert joints(WAVE).order.tolist() == [2, 2]
    assert len(joints().order) == 0


def test_wrong_input() -> None:
    with pytest.raises(InputError, match="length 0 m"):
        Curve(array([0, 0, 0]), *array([[0], [0], [0]]))
    with pytest.raises(InputError, match="shape"):
        Curve(array([0, 0, 0]), array([0, 1]), array([0]), array([1]))
    with pytest.raises(InputError, match="nan"):
        Curve(array([0, math.nan, 0]), *array([[0], [0], [1]]))
    for s in (-1, 7, math.nan):
        with pytest.raises(InputError, match="not on the curve"):
            evaluate(WAVE, array([s]))
    with pytest.raises(InputError, match="do not meet"):
        joined(WAVE, WAVE)
    with pytest.raises(InputError, match="at least one"):
        joined()
    with pytest.raises(InputError, match="tolerance"):
        sampled_curve(WAVE, 0)
    with pytest.raises(LimitError):
        sampled_curve(WAVE, 1e-16)
    with pytest.raises(InputError, match="at least one"):
        from_path(to_path(WAVE), 2, 2)
    with pytest.raises(ValueError, match="read-only"):
        WAVE.length[0] = 2
