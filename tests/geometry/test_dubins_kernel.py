"""The length of the shortest Dubins path against paths that are built word by word and driven."""

from __future__ import annotations

import math

import numpy as np
import pytest

from optplan.geometry._kernels.dubins import dubins_length

TAU = 2 * math.pi
Pose = tuple[float, float, float]


def drive(pose: Pose, turns: str, lengths: tuple[float, float, float], radius: float) -> Pose:
    x, y, t = pose
    for turn, length in zip(turns, lengths, strict=True):
        if turn == "S":
            x, y = x + length * math.cos(t), y + length * math.sin(t)
        else:
            side = 1.0 if turn == "L" else -1.0
            end = t + side * length / radius
            x += side * radius * (math.sin(end) - math.sin(t))
            y -= side * radius * (math.cos(end) - math.cos(t))
            t = end
    return x, y, t


def centre(pose: Pose, side: float, radius: float) -> complex:
    return complex(pose[0], pose[1]) + side * radius * 1j * complex(math.cos(pose[2]), math.sin(pose[2]))


def words(a: Pose, b: Pose, radius: float) -> list[tuple[str, tuple[float, float, float]]]:
    """All words by the geometry of the circles, without the formulas under test."""
    side = {"L": 1.0, "R": -1.0}
    found = []
    for turns in ("LSL", "RSR", "LSR", "RSL"):
        s, e = side[turns[0]], side[turns[2]]
        across = centre(b, e, radius) - centre(a, s, radius)
        apart = abs(across)
        if s == e:
            heading = math.atan2(across.imag, across.real) if apart > 1e-12 else a[2]
            straight = apart
        else:
            if apart < 2 * radius:
                continue
            straight = math.sqrt(apart**2 - 4 * radius**2)
            heading = math.atan2(across.imag, across.real) + s * math.asin(2 * radius / apart)
        found.append(
            (turns, (radius * ((s * (heading - a[2])) % TAU), straight, radius * ((e * (b[2] - heading)) % TAU)))
        )
    for turns in ("LRL", "RLR"):
        s = side[turns[0]]
        first, last = centre(a, s, radius), centre(b, s, radius)
        apart = abs(last - first)
        if apart > 4 * radius or apart < 1e-12:
            continue
        for fold in (1.0, -1.0):
            between = math.atan2((last - first).imag, (last - first).real) + fold * math.acos(apart / (4 * radius))
            middle = first + 2 * radius * complex(math.cos(between), math.sin(between))
            # headings where the circles touch
            touch = between + s * math.pi / 2
            leaving = math.atan2((middle - last).imag, (middle - last).real) + s * math.pi / 2
            lengths = ((s * (touch - a[2])) % TAU, (-s * (leaving - touch)) % TAU, (s * (b[2] - leaving)) % TAU)
            found.append((turns, (radius * lengths[0], radius * lengths[1], radius * lengths[2])))
    return found


def shortest(a: Pose, b: Pose, radius: float) -> float:
    best = math.inf
    for turns, lengths in words(a, b, radius):
        x, y, t = drive(a, turns, lengths, radius)
        assert math.hypot(x - b[0], y - b[1]) < 1e-6, turns
        assert abs(math.remainder(t - b[2], TAU)) < 1e-6
        best = min(best, sum(lengths))
    return best


def test_random_pairs() -> None:
    rng = np.random.default_rng(0)
    for _ in range(4000):
        radius = float(rng.uniform(0.2, 2))
        size = float(rng.choice([0.3, 1, 3, 10]))
        a: Pose = (*rng.uniform(-size, size, 2).tolist(), float(rng.uniform(-9, 9)))
        b: Pose = (*rng.uniform(-size, size, 2).tolist(), float(rng.uniform(-9, 9)))
        assert dubins_length(*a, *b, radius) == pytest.approx(shortest(a, b, radius), abs=1e-6)


def test_identical_poses_cost_nothing() -> None:
    for t in (0.0, 1.0, -math.pi, 1e3):
        assert dubins_length(1.0, 2.0, t, 1.0, 2.0, t + TAU, 0.5) == 0.0


def test_straight_ahead_never_goes_round() -> None:
    rng = np.random.default_rng(1)
    for _ in range(2000):
        x, y, t = rng.uniform(-5, 5, 3)
        d = rng.uniform(1e-6, 20)
        ahead = dubins_length(x, y, t, x + d * math.cos(t), y + d * math.sin(t), t, 1.3)
        assert ahead == pytest.approx(d, rel=1e-6, abs=1e-6)


def test_arcs_never_go_round_once_more() -> None:
    for angle in np.linspace(1e-3, 3.0, 50):
        for side in (1.0, -1.0):
            x, y = math.sin(angle), side * (1 - math.cos(angle))
            assert dubins_length(0, 0, 0, x, y, side * angle, 1.0) == pytest.approx(angle, abs=1e-6)


def test_half_turn_on_the_spot_and_full_circle_behind() -> None:
    # three circles in a triangle: 7 pi / 3
    assert dubins_length(0, 0, 0, 0, 0, math.pi, 1.0) == pytest.approx(7 * math.pi / 3)
    assert dubins_length(0, 0, 0, -1e-3, 0, 0, 1.0) == pytest.approx(TAU - 1e-3, abs=1e-2)


def test_never_nan_on_lattices() -> None:
    values = (0.0, 1e-13, 1.0, 2.0, 4.0, -1.0)
    angles = (0.0, math.pi / 2, math.pi, -math.pi / 2, TAU, 1e-10)
    for x in values:
        for y in values:
            for s in angles:
                for t in angles:
                    length = dubins_length(0, 0, s, x, y, t, 1.0)
                    assert math.isfinite(length)
                    assert length >= math.hypot(x, y) - 1e-9


def test_symmetry_and_scale() -> None:
    rng = np.random.default_rng(2)
    for _ in range(500):
        x0, y0, t0, x1, y1, t1 = rng.uniform(-3, 3, 6)
        length = dubins_length(x0, y0, t0, x1, y1, t1, 1.0)
        assert dubins_length(x1, y1, t1 + math.pi, x0, y0, t0 + math.pi, 1.0) == pytest.approx(length, abs=1e-6)
        assert dubins_length(x0, -y0, -t0, x1, -y1, -t1, 1.0) == pytest.approx(length, abs=1e-6)
        assert dubins_length(5 * x0, 5 * y0, t0, 5 * x1, 5 * y1, t1, 5.0) == pytest.approx(5 * length, abs=1e-6)
