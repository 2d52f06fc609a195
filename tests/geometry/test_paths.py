"""Evaluating clothoid paths, against fine integration by the test."""

from __future__ import annotations

import math

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from optplan.domain.arrays import FloatArray
from optplan.domain.path import Path
from optplan.geometry.clothoids import clothoid_displacement
from optplan.geometry.paths import along, ends, sampled
from tests.strategies import array


def _integrated(heading: float, curvature: float, sharpness: float, length: float) -> complex:
    """Simpson's rule on 4000 intervals."""
    u = np.linspace(0, length, 4001)
    weights = np.ones(4001)
    weights[1:-1:2], weights[2:-1:2] = 4, 2
    values = np.exp(1j * (heading + curvature * u + sharpness * u**2 / 2))
    return complex((values * weights).sum() * length / 12000)


def _path(rows: list[tuple[float, float, float, float]]) -> Path:
    """Pieces of curvature, sharpness, length, turn, one after the other."""
    x, y, heading = 1.0, 2.0, 0.3
    start, headings = [], []
    for curvature, sharpness, length, turn in rows:
        start.append([x, y, 0.0])
        headings.append(heading)
        step = _integrated(heading, curvature, sharpness, length)
        x, y = x + step.real, y + step.imag
        heading += curvature * length + sharpness * length**2 / 2 + turn
    columns = array(rows)
    zero = np.zeros(len(rows))
    index = np.zeros(len(rows), dtype=np.int64)
    curvature, sharpness, length, turn = columns.T
    return Path(array(start), array(headings), zero, curvature, sharpness, length, turn, zero, index, index)


MIXED = _path([(0, 0, 1, 0), (0.5, 0, 2, 0), (0, 0, 0, 1.0), (-1, 0.7, 3, 0), (2, -8, 1.5, 0), (0, 0, 0.4, 0)])


@given(st.floats(-4, 4), st.floats(-5, 5), st.floats(-5, 5), st.floats(0, 4))
def test_displacement(heading: float, curvature: float, sharpness: float, length: float) -> None:
    columns = (array([value]) for value in (heading, curvature, sharpness, length))
    dx, dy = clothoid_displacement(*columns)
    assert complex(dx[0], dy[0]) == pytest.approx(_integrated(heading, curvature, sharpness, length), abs=1e-9)


def test_ends_meet_the_next_starts() -> None:
    final = ends(MIXED)
    assert final.position[:-1] == pytest.approx(MIXED.start[1:], abs=1e-9)
    assert final.heading[:-1] == pytest.approx(MIXED.heading[1:], abs=1e-12)


def test_pieces_in_space_are_straight() -> None:
    zero = np.zeros(1)
    row = np.zeros(1, dtype=np.int64)
    up, north = array([math.pi / 6]), array([math.pi / 2])
    path = Path(np.zeros((1, 3)), north, up, zero, zero, array([2.0]), zero, zero, row, row)
    assert along(path, np.array([0]), array([2.0])).position[0] == pytest.approx([0, math.sqrt(3), 1])


@pytest.mark.parametrize("spacing", [0.01, 0.3, 100.0])
def test_samples_are_even(spacing: float) -> None:
    states = sampled(MIXED, spacing)
    s = MIXED.offsets[states.piece] + states.distance
    assert s[0] == 0
    assert s[-1] == pytest.approx(MIXED.offsets[-1])
    assert np.diff(s).max() <= spacing + 1e-9
    assert set(np.round(MIXED.offsets, 9)) <= set(np.round(s, 9))
    for piece in range(len(MIXED)):
        gaps = np.diff(states.distance[:-1][states.piece[:-1] == piece])
        assert np.ptp(gaps) < 1e-9 if len(gaps) else True
    assert (states.piece == 2).sum() == 1
    assert states.curvature == pytest.approx(
        MIXED.curvature[states.piece] + MIXED.sharpness[states.piece] * states.distance
    )


def test_nothing_driven_gives_no_samples() -> None:
    none: FloatArray = np.zeros(0)
    path = Path(np.zeros((0, 3)), none, none, none, none, none, none, none, none, none)  # type: ignore[arg-type]
    assert len(sampled(path, 1.0).heading) == 0
