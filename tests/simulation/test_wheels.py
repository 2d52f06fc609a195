"""The moving robot against closed forms."""

from __future__ import annotations

import math

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from optplan.simulation._kernels.wheels import advance, answered

rates = st.floats(-8, 8)


def test_straight() -> None:
    assert advance(1.0, 2.0, 0.5, 3.0, 0.0, 2.0, 0.0, 0.01) == pytest.approx(
        (1 + 0.0301 * math.cos(0.5), 2 + 0.0301 * math.sin(0.5), 0.5), abs=1e-15
    )


@given(st.floats(0.05, 2), rates.filter(lambda w: abs(w) > 1e-3), st.floats(-3, 3))
def test_circle_about_the_centre_of_rotation(speed: float, turn_rate: float, heading: float) -> None:
    x, y, h = 0.3, -0.2, heading
    for _ in range(100):
        x, y, h = advance(x, y, h, speed, turn_rate, 0.0, 0.0, 0.01)
    radius = speed / turn_rate  # the instantaneous centre of rotation is that far to the left
    cx, cy = 0.3 - radius * math.sin(heading), -0.2 + radius * math.cos(heading)
    assert h == pytest.approx(heading + turn_rate, abs=1e-12)
    assert x == pytest.approx(cx + radius * math.sin(h), abs=1e-9)
    assert y == pytest.approx(cy - radius * math.cos(h), abs=1e-9)


def test_hardly_turning_is_safe() -> None:
    for turn_rate in (0.0, 1e-300, 1e-18, 1e-9):
        x, y, _ = advance(0.0, 0.0, 0.0, 1.0, turn_rate, 0.0, 0.0, 0.01)
        assert x == pytest.approx(0.01, abs=1e-15)
        assert y == pytest.approx(turn_rate * 5e-5, abs=1e-15)


def test_turn_on_the_spot() -> None:
    assert advance(1.0, 2.0, 0.0, 0.0, 2.0, 0.0, 4.0, 0.5) == (1.0, 2.0, 1.5)


@given(rates, rates, st.floats(-4, 4), st.floats(-40, 40))
def test_accelerating_against_a_fine_sum(speed: float, turn_rate: float, gain: float, spin: float) -> None:
    t = (np.arange(20_000) + 0.5) * 0.01 / 20_000
    angle = 0.7 + turn_rate * t + spin * t**2 / 2
    v = speed + gain * t
    x, y, h = advance(0.0, 0.0, 0.7, speed, turn_rate, gain, spin, 0.01)
    assert x == pytest.approx(float((v * np.cos(angle)).mean()) * 0.01, abs=1e-9)
    assert y == pytest.approx(float((v * np.sin(angle)).mean()) * 0.01, abs=1e-9)
    assert h == pytest.approx(0.7 + turn_rate * 0.01 + spin * 5e-5, abs=1e-12)


def test_a_lag_is_an_exponential() -> None:
    speed, share = 0.0, 1 - math.exp(-0.01 / 0.2)
    for _ in range(20):
        speed = answered(speed, 3.0, share, 10.0, 1.0)
    assert speed == pytest.approx(3 * (1 - math.exp(-1)), abs=1e-12)


def test_limits_of_a_wheel() -> None:
    assert answered(1.0, 9.0, 1.0, 20.0, 0.5) == 1.5
    assert answered(1.0, -9.0, 1.0, 20.0, 0.5) == 0.5
    assert answered(19.9, 90.0, 1.0, 20.0, 0.5) == 20.0
