"""The fastest speed profile along a path."""

from __future__ import annotations

import math

import numpy as np

from optplan.domain.arrays import BoolArray, FloatArray
from optplan.domain.options import Options
from optplan.domain.path import Path, Trajectory
from optplan.domain.robot import Robot
from optplan.timing.grid import SHORTEST, STEP, Grid, grid_of


def profile(path: Path, robot: Robot, options: Options | None = None, step: float = STEP) -> Trajectory:
    """The fastest speed profile along a path, at rest at its ends, stops and cusps.

    Time-optimal on its grid (H. Pham and Q.-C. Pham, A new approach to time-optimal path parameterization based on
    reachability analysis, IEEE Transactions on Robotics 34 (2018)): each wheel's speed and acceleration, the speeds for
    work and transit, and the lateral acceleration hold between the knots, too. See docs/maths/speed.md.

    Parameters
    ----------
    path : what is driven
    robot, options : give speeds and accelerations; the options' speeds win
    step : longest part of one acceleration where the curvature changes, m; finer ones gain little

    Raises
    ------
    InputError : no speed satisfies the limits
    """
    options = options or Options()
    if len(path) == 0:
        return Trajectory(path, np.zeros(1), np.zeros(1), np.zeros(1))
    grid = grid_of(path, robot, options, step)
    return trajectory_of(path, robot, grid, greatest(grid))


def greatest(grid: Grid) -> FloatArray:
    """The greatest b = v^2 (n + 1,) at the ends of the intervals, m^2/s^2."""
    from optplan.timing._kernels.sweep import sweep

    arrays = (grid.length, grid.weight, grid.steer, grid.acceleration, grid.cap)
    best: FloatArray = sweep(*(np.ascontiguousarray(values) for values in arrays))
    return best


def trajectory_of(path: Path, robot: Robot, grid: Grid, square: FloatArray) -> Trajectory:
    """The trajectory with b = v^2 (n + 1,) at the ends of the intervals.

    Where nothing changes along an interval, it is driven as fast as its ends allow: up to three parts of constant
    acceleration. Others are one part; a stop is its waiting time.
    """
    speed = np.sqrt(square)
    before, after, length = speed[:-1], speed[1:], grid.length
    moving, free = length > 0, np.isfinite(grid.plateau) & (grid.acceleration > 0)
    faster = np.maximum(before, after)
    with np.errstate(divide="ignore", invalid="ignore"):
        slope = np.where(moving, np.abs(square[1:] - square[:-1]) / (2 * length), 0.0)
    outer = 1.0 + grid.half_track * np.abs(grid.curvature[:, 0])
    rate = np.where(free, grid.acceleration / outer, np.where(slope > 0, slope, np.inf))
    with np.errstate(invalid="ignore"):
        peak = np.sqrt(np.minimum(grid.plateau, (before**2 + after**2) / 2 + rate * length))
    peak = np.where(free, np.maximum(peak, faster), faster)
    for side in (before, after):  # what is hardly above one of its ends is level with the faster one
        hardly = (peak**2 - side**2) / (2 * rate) < SHORTEST
        peak = np.where(free & hardly & (faster > 0), faster, peak)
    up = np.where(moving, np.minimum((peak**2 - before**2) / (2 * rate), length), 0.0)
    down = np.where(moving, np.clip((peak**2 - after**2) / (2 * rate), 0.0, length - up), 0.0)
    cruise = np.where(moving, length - up - down, 0.0)
    down = np.where(free, down, length - up - cruise)
    waiting = path.dwell + np.array([turn_time(abs(turn), robot) for turn in path.turn.tolist()])
    with np.errstate(divide="ignore", invalid="ignore"):
        times = np.stack(
            [
                np.where(up > 0, 2 * up / (before + peak), 0.0),
                np.where(cruise > 0, cruise / peak, 0.0),
                np.where(down > 0, 2 * down / (peak + after), 0.0),
            ],
            axis=1,
        )
    times[~moving] = 0.0
    times[~moving, 2] = waiting[grid.piece[~moving]]
    steps = np.stack([grid.s[:-1] + up, grid.s[:-1] + up + cruise, grid.s[1:]], axis=1)
    level = np.where(moving, peak, 0.0)
    speeds = np.stack([level, level, np.where(moving, after, 0.0)], axis=1)
    s = np.concatenate([[0.0], np.maximum.accumulate(steps.ravel())])
    t = np.concatenate([[0.0], np.cumsum(times.ravel())])
    v = np.concatenate([[0.0], speeds.ravel()])
    keep = _needed(grid, times, v)
    return Trajectory(path, s[keep], t[keep], v[keep])


def _needed(grid: Grid, times: FloatArray, v: FloatArray) -> BoolArray:
    """Which knots say something: those at the ends of pieces, and inner ones between different accelerations."""
    count = len(v)
    ends = np.zeros(count, dtype=np.bool_)
    ends[0] = True
    ends[3 * np.append(np.flatnonzero(np.diff(grid.piece)) + 1, len(grid.piece))] = True
    keep: BoolArray = ends | np.concatenate([[True], times.ravel() > 0])
    kept = np.flatnonzero(keep)
    inner = kept[1:-1]
    level = (v[kept[:-2]] == v[inner]) & (v[inner] == v[kept[2:]])
    keep[inner[level & ~ends[inner]]] = False
    return keep


def turn_time(angle: float, robot: Robot) -> float:
    """Seconds for turning on the spot by an angle (rad): a trapezoid of turn rate and wheel acceleration."""
    rate, acceleration = robot.mobility.turn_rate, robot.mobility.turn_acceleration
    if angle == 0 or math.isinf(rate):
        return 0.0
    if angle * acceleration < rate**2:
        return 2 * math.sqrt(angle / acceleration)
    return angle / rate + rate / acceleration
