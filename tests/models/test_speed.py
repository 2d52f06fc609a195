"""The fastest speeds: the sweep, the linear programme and the cone programme agree; limits of jerk and power hold."""

from __future__ import annotations

import math
from typing import Literal

import numpy as np
import pytest

from optplan.domain.arrays import FloatArray
from optplan.domain.options import Options
from optplan.timing.fastest import greatest, profile
from optplan.timing.grid import Grid, grid_of
from optplan_models.speed import SpeedPath, duration, fastest_speeds
from tests.timing.clothoid_paths import ROBOTS, random_path

_OBJECTIVES: tuple[Literal["time", "squares"], ...] = ("time", "squares")


def _path_of(grid: Grid) -> SpeedPath:
    return SpeedPath(grid.length, grid.curvature, grid.sharpness, grid.acceleration, grid.cap, grid.half_track)


@pytest.mark.parametrize("seed", range(3))
@pytest.mark.parametrize("robot", ROBOTS, ids=lambda robot: robot.name)
def test_sweep_and_programmes_agree(robot: object, seed: int) -> None:
    grid = grid_of(random_path(8, seed), robot, Options(), 0.05, even=True)  # type: ignore[arg-type]
    swept = greatest(grid)
    time = duration(grid.length, swept)
    for objective in _OBJECTIVES:
        found = fastest_speeds(_path_of(grid), objective)
        assert found.time == pytest.approx(time, rel=1e-6)
        # the sweep is the greatest of all that keep the limits
        assert (found.square <= swept + 1e-5).all()


def _rates(grid: Grid, square: FloatArray) -> FloatArray:
    rates: FloatArray = np.diff(square) / (2 * grid.length)
    return rates


@pytest.mark.parametrize("jerk", [0.5, 3.0])
def test_jerk_is_limited(jerk: float) -> None:
    grid = grid_of(random_path(6, 4), ROBOTS[0], Options(), 0.05, even=True)
    free = fastest_speeds(_path_of(grid))
    found = fastest_speeds(_path_of(grid), jerk=jerk)
    change = np.abs(np.diff(_rates(grid, found.square))) * np.sqrt(found.square[1:-1])
    assert (change / ((grid.length[1:] + grid.length[:-1]) / 2) <= jerk * (1 + 1e-5)).all()
    assert free.time < found.time < 2 * free.time
    assert found.time == pytest.approx(duration(grid.length, found.square))


def test_a_straight_start_under_limited_jerk_is_known() -> None:
    """Over s = 1 m from rest to rest: four parts of constant jerk J take 4 (s / (2 J))^(1/3)."""
    count, jerk = 50, 2.0
    length = np.full(count, 1.0 / count)
    cap = np.full(count + 1, 100.0)
    cap[[0, -1]] = 0.0
    zero = np.zeros(count)
    path = SpeedPath(length, np.zeros((count, 2)), zero, np.full(count, 100.0), cap, 0.0)
    assert fastest_speeds(path, jerk=jerk).time == pytest.approx(4 * (1.0 / (2 * jerk)) ** (1 / 3), rel=0.02)


def test_power_is_limited() -> None:
    grid = grid_of(random_path(6, 5), ROBOTS[1], Options(), 0.05, even=True)
    found = fastest_speeds(_path_of(grid), power=0.1)
    assert (_rates(grid, found.square) * np.sqrt(found.square[1:]) <= 0.1 * (1 + 1e-5)).all()
    assert found.time > fastest_speeds(_path_of(grid)).time


def test_out_of_rest_at_constant_power() -> None:
    """v^3 = 3 P s: a line of 2 m takes sqrt of (9 / 8) s^2 / P cubed-rooted, up to the grid."""
    count, power = 400, 1.5
    length = np.full(count, 2.0 / count)
    cap = np.full(count + 1, 100.0)
    cap[0] = 0.0
    path = SpeedPath(length, np.zeros((count, 2)), np.zeros(count), np.full(count, 100.0), cap, 0.0)
    expected = (9 * 2.0**2 / (8 * power)) ** (1 / 3)
    assert fastest_speeds(path, power=power).time == pytest.approx(expected, rel=0.02)


def test_level_intervals_keep_their_speed() -> None:
    count = 6
    acceleration = np.full(count, 1.0)
    acceleration[2:4] = 0.0
    cap = np.full(count + 1, 4.0)
    cap[[0, -1]] = 0.0
    path = SpeedPath(np.full(count, 0.1), np.zeros((count, 2)), np.zeros(count), acceleration, cap, 0.0)
    square = fastest_speeds(path).square
    assert square[2] == pytest.approx(square[4], abs=1e-6)
    assert math.isfinite(fastest_speeds(path).time)


def test_the_profile_is_the_sweeps() -> None:
    path = random_path(8, 7)
    grid = grid_of(path, ROBOTS[1], Options())
    assert profile(path, ROBOTS[1]).duration == pytest.approx(duration(grid.length, greatest(grid)), rel=1e-9)
