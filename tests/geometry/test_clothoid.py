"""Ends of clothoid pieces against quadrature on ever so many panels, and against closed forms."""

from __future__ import annotations

import math

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from optplan.geometry._kernels.clothoid import clothoid_end, clothoid_ends

NODES, WEIGHTS = np.polynomial.legendre.leggauss(20)


def driven(theta: float, kappa: float, sigma: float, length: float) -> tuple[float, float]:
    """Composite Gauss quadrature with about one rad of heading a panel."""
    swing = max(abs(kappa), abs(kappa + sigma * length)) * abs(length)
    edges = np.linspace(0.0, length, 2 + int(swing))
    half = np.diff(edges)[:, None] / 2
    u = edges[:-1, None] + half * (1 + NODES)
    heading = theta + u * (kappa + 0.5 * sigma * u)
    return float((half * WEIGHTS * np.cos(heading)).sum()), float((half * WEIGHTS * np.sin(heading)).sum())


sizes = st.one_of(st.just(0.0), st.floats(-13, 3.5).map(lambda e: 10.0**e))
signs = st.sampled_from([-1.0, 1.0])


@given(st.floats(-4, 4), sizes, signs, sizes, signs, st.floats(-6, 2).map(lambda e: 10.0**e), signs)
def test_ends_match_quadrature(
    theta: float, kappa: float, left: float, sigma: float, sharper: float, length: float, way: float
) -> None:
    kappa, sigma, length = left * min(kappa, 300 / length), sharper * min(sigma, 600 / length**2), way * length
    x, y, heading, curvature = clothoid_end(1.0, -2.0, theta, kappa, sigma, length)
    dx, dy = driven(theta, kappa, sigma, length)
    # a heading of many rad is itself known to its rounding only
    slack = 1e-12 * abs(length) + 1e-15
    assert math.hypot(x - 1.0 - dx, y + 2.0 - dy) <= slack
    assert heading == pytest.approx(theta + kappa * length + sigma * length**2 / 2, rel=1e-13, abs=1e-13)
    assert curvature == kappa + sigma * length


@given(st.floats(-4, 4), st.floats(-3, 3), st.floats(0.1, 50))
def test_a_vanishing_sharpness_gives_the_arc(theta: float, kappa: float, length: float) -> None:
    arc = clothoid_end(0.0, 0.0, theta, kappa, 0.0, length)
    for sigma in (1e-18, -1e-17, 1e-16):
        end = clothoid_end(0.0, 0.0, theta, kappa, sigma, length)
        assert end == pytest.approx(arc, abs=1e-12 * length)


@pytest.mark.parametrize("share", np.linspace(0.05, 1.5, 30))
def test_counter_turns_are_as_exact(share: float) -> None:
    """Through the inflection in the middle, where the heading's second order is all there is."""
    kappa, length = 1.0, 2.0 * share
    sigma = -2 * kappa / length
    x, y, *_ = clothoid_end(0.0, 0.0, 0.0, kappa, sigma, length)
    dx, dy = driven(0.0, kappa, sigma, length)
    assert math.hypot(x - dx, y - dy) <= 1e-14


def test_lines_have_no_rounding() -> None:
    assert clothoid_end(0.0, 0.0, 0.0, 0.0, 0.0, 1e9) == (1e9, 0.0, 0.0, 0.0)


def test_a_whole_spiral_ends_in_its_eye() -> None:
    """From one infinite end to the other: sqrt(pi / sigma) in both directions."""
    sigma, half = 1e-4, 1e7
    x, y, *_ = clothoid_end(0.0, 0.0, -0.5 * sigma * half**2, 0.0, sigma, half)
    # heading 0 at u = half, counted from the inflection: turn back to it
    assert math.hypot(x, y) == pytest.approx(math.sqrt(math.pi / sigma / 2), rel=1e-4)


def test_batches_are_rows_of_single_ends() -> None:
    random = np.random.default_rng(0)
    starts, sharpnesses, lengths = random.normal(size=(50, 4)), random.normal(size=50), random.normal(size=50) * 9
    ends = clothoid_ends(starts, sharpnesses, lengths)
    for start, sigma, length, end in zip(starts, sharpnesses, lengths, ends, strict=True):
        assert tuple(end) == clothoid_end(start[0], start[1], start[2], start[3], sigma, length)
