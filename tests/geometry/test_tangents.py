"""Lines and arcs as one curve of continuous curvature."""

from __future__ import annotations

import math

import numpy as np
import pytest

from optplan.geometry.curves import evaluate
from optplan.geometry.tangents import eased


def _oval(radius: float, straight: float) -> tuple[np.ndarray, np.ndarray]:
    """A running track from the middle of a straight on, counter-clockwise: points and bends."""
    half = straight / 2
    angles = np.linspace(-math.pi / 2, math.pi / 2, 60, endpoint=False)
    east = np.column_stack([half + radius * np.cos(angles), radius * np.sin(angles)])
    west = -east
    points = np.concatenate([[[0.0, -radius]], east, [[half, radius]], west, [[-half, -radius]]])
    bends = np.concatenate([[0.0], np.full(60, 1 / radius), [0.0], np.full(60, 1 / radius), [0.0]])
    return points, bends


def test_oval_closes_within_rounding_and_stays_on_its_line() -> None:
    points, bends = _oval(36.8, 84.39)
    made = eased(points, bends, True, 2.0)
    assert made is not None
    assert np.abs(made.end[:2] - made.start[:2]).max() < 1e-9
    assert made.end[2] - made.start[2] == pytest.approx(2 * math.pi, abs=1e-9)
    assert made.max_sharpness <= 2.0 * (1 + 1e-9)
    jumps = np.abs(made.curvature[1:] - made.end_curvature[:-1])
    assert jumps.max() < 1e-12
    at = evaluate(made, np.linspace(0, made.total, 5000))
    x = np.abs(at.x) - 84.39 / 2
    away = np.where(x > 0, np.hypot(x, at.y), np.abs(at.y)) - 36.8
    assert np.abs(away).max() < 1e-5


def test_open_chain_ends_where_it_should() -> None:
    arc = np.linspace(0, math.pi / 2, 20)
    points = np.concatenate([[[-5.0, 0.0]], np.column_stack([2 * np.sin(arc), 2 - 2 * np.cos(arc)]), [[2.0, 6.0]]])
    bends = np.concatenate([[0.0], np.full(19, 0.5), [0.0]])
    made = eased(points, bends, False, 3.0)
    assert made is not None
    assert made.end == pytest.approx([2.0, 6.0, math.pi / 2], abs=1e-9)


def test_one_arc_is_exact() -> None:
    arc = np.linspace(0, 2 * math.pi, 32, endpoint=False)
    points = 9.15 * np.column_stack([np.cos(arc), np.sin(arc)])
    made = eased(points, np.full(32, 1 / 9.15), True, 3.0)
    assert made is not None
    assert len(made) == 1
    assert made.total == pytest.approx(2 * math.pi * 9.15, rel=1e-12)


def test_an_arc_shorter_than_its_ramps_is_refused() -> None:
    points = np.array([[0.0, 0.0], [1.0, 0.0], [1.01, 0.0001], [2.0, 0.02]])
    assert eased(points, np.array([0.0, 2.0, 0.0]), False, 1.0) is None
