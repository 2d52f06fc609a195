"""The judge's integration against closed forms and an ODE solver."""

from __future__ import annotations

import math

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from scipy.integrate import solve_ivp
from scipy.special import fresnel

from optplan.domain.errors import LimitError
from optplan.domain.path import Path
from optplan.judge._integrate import integrate


def piece(heading: float, kappa: float, sharpness: float, length: float, elevation: float = 0.0) -> Path:
    columns = (heading, elevation, kappa, sharpness, length)
    theta, phi, start, rate, size = (np.array([value]) for value in columns)
    zero = np.zeros(1)
    return Path(np.zeros((1, 3)), theta, phi, start, rate, size, zero, zero, np.ones(1, int), np.zeros(1, int))


@pytest.mark.parametrize(("sharpness", "length"), [(1.0, 3.0), (25.0, 2.0), (0.01, 40.0)])
def test_clothoid_is_a_fresnel_integral(sharpness: float, length: float) -> None:
    scale = math.sqrt(math.pi / sharpness)
    y, x = fresnel(length / scale)
    found = integrate(piece(0, 0, sharpness, length), 1e-3)
    assert found.ends[0] == pytest.approx([scale * x, scale * y, 0], abs=1e-12 * max(1, length))
    assert found.end_heading[0] == pytest.approx(sharpness * length**2 / 2)
    assert found.end_curvature[0] == pytest.approx(sharpness * length)


@given(st.floats(-7, 7), st.floats(-3, 3), st.floats(-2, 2), st.floats(0.01, 6))
@settings(deadline=None, max_examples=40)
def test_clothoid_is_the_solution_of_its_equation(
    heading: float, kappa: float, sharpness: float, length: float
) -> None:
    def slope(s: float, _: object) -> list[float]:
        theta = heading + kappa * s + sharpness * s**2 / 2
        return [math.cos(theta), math.sin(theta)]

    solved = solve_ivp(slope, (0, length), [0, 0], method="DOP853", rtol=1e-12, atol=1e-13)
    found = integrate(piece(heading, kappa, sharpness, length), 1e-3)
    assert found.ends[0, :2] == pytest.approx(solved.y[:, -1], abs=1e-9)


def test_lines_in_space_and_arcs() -> None:
    rising = integrate(piece(math.pi / 2, 0, 0, 2.0, elevation=math.pi / 6), 1e-3)
    assert rising.ends[0] == pytest.approx([0, math.sqrt(3), 1])
    circle = integrate(piece(0, 0.5, 0, 4 * math.pi), 1e-3)
    assert circle.ends[0] == pytest.approx([0, 0, 0], abs=1e-12)
    away = np.linalg.norm(circle.points[:, :2] - [0, 2], axis=1)
    assert np.allclose(away, 2)
    middle = (circle.points[1:] + circle.points[:-1])[:, :2] / 2
    assert 2 - np.linalg.norm(middle - [0, 2], axis=1).min() <= 1e-3


def test_a_path_that_curls_beyond_measure_is_refused() -> None:
    with pytest.raises(LimitError, match="piece 0 curls too much"):
        integrate(piece(0, 1e9, 0, 1e3), 1e-3)
    with pytest.raises(LimitError):
        integrate(piece(0, 0, 1e25, 1e20), 1e-3)
