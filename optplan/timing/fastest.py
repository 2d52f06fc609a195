"""The fastest speed profile along a path."""

from __future__ import annotations

import math

import numpy as np

from optplan.domain.arrays import FloatArray, IntArray
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
    wanted = options.time
    if wanted.constant_speed is not None:
        return constant(path, robot, wanted.constant_speed)
    if wanted.jerk is not None or wanted.power is not None:
        return _gentle(path, robot, options, step)
    grid = grid_of(path, robot, options, step)
    return trajectory_of(path, robot, grid, greatest(grid))


def constant(path: Path, robot: Robot, speed: float) -> Trajectory:
    """One speed (m/s) wherever the path moves, reached in no time, as older planners count: to compare with."""
    waiting = path.dwell + np.array([turn_time(abs(turn), robot) for turn in path.turn.tolist()])
    step = np.where(path.length > 0, path.length / speed, waiting)
    level = np.where(path.length > 0, speed, 0.0)
    # two knots a piece: speeds may jump between them
    t = np.concatenate([[0.0], np.cumsum(step)])
    s, t = (np.column_stack([x[:-1], x[1:]]).ravel() for x in (path.offsets, t))
    return Trajectory(path, s, t, np.repeat(level, 2))


def _gentle(path: Path, robot: Robot, options: Options, step: float) -> Trajectory:
    """The profile under limits of jerk and power, from rest to rest by the convex programme."""
    from optplan_models.speed import SpeedPath, fastest_speeds

    grid = grid_of(path, robot, options, step, even=True)
    jerk, power = (math.inf if limit is None else limit for limit in (options.time.jerk, options.time.power))
    square = np.zeros(len(grid.s))
    moving = grid.length > 0
    fastest = greatest(grid)
    # runs between places of rest have nothing to do with each other
    rests = np.flatnonzero(fastest == 0)
    for first, last in zip(rests[:-1].tolist(), rests[1:].tolist(), strict=True):
        run = slice(first, last)
        if not moving[run].all():
            continue
        part = SpeedPath(
            grid.length[run],
            grid.curvature[run],
            grid.sharpness[run],
            grid.acceleration[run],
            fastest[first : last + 1],
            grid.half_track,
        )
        square[first : last + 1] = fastest_speeds(part, jerk=jerk, power=power).square
    return trajectory_of(path, robot, grid, square)


def greatest(grid: Grid) -> FloatArray:
    """The greatest b = v^2 (n + 1,) at the ends of the intervals, m^2/s^2."""
    from optplan.timing._kernels.sweep import sweep

    first, last = np.ascontiguousarray(grid.curvature.T)
    best: FloatArray = sweep(grid.length, first, last, grid.sharpness, grid.half_track, grid.acceleration, grid.cap)
    return best


def trajectory_of(path: Path, robot: Robot, grid: Grid, square: FloatArray) -> Trajectory:
    """The trajectory with b = v^2 (n + 1,) at the ends of the intervals.

    Where nothing changes along an interval, it is driven as fast as its ends allow: up to three parts of constant
    acceleration. Others are one part; a stop is its waiting time.
    """
    speed, length = np.sqrt(square), grid.length
    before, after, moving = speed[:-1], speed[1:], length > 0
    waiting = path.dwell + np.array([turn_time(abs(turn), robot) for turn in path.turn.tolist()])
    mean = (before + after) / 2
    times = np.divide(length, mean, out=waiting[grid.piece], where=moving & (mean > 0))
    free = np.flatnonzero(np.isfinite(grid.plateau) & (grid.acceleration > 0) & moving)
    up, cruise, down, peak = _parts(grid, free, before[free], after[free])
    with np.errstate(invalid="ignore"):
        risen = np.where(up > 0, 2 * up / (before[free] + peak), 0.0)
        level = np.where(cruise > 0, cruise / peak, 0.0)
        fallen = np.where(down > 0, 2 * down / (peak + after[free]), 0.0)
    times[free] = fallen
    # two more knots in each of the free intervals, ahead of the one at its end
    place = np.repeat(free, 2)
    inner = grid.s[free] + up
    s = np.insert(grid.s[1:], place, np.column_stack([inner, inner + cruise]).ravel())
    v = np.insert(np.where(moving, after, 0.0), place, np.repeat(peak, 2))
    step = np.insert(times, place, np.column_stack([risen, level]).ravel())
    ends = np.insert(np.append(grid.piece[1:] != grid.piece[:-1], True), place, False)
    s, v = np.append(0.0, np.maximum.accumulate(s)), np.append(before[0], v)
    t = np.append(0.0, np.cumsum(step))
    keep = np.append(True, ends | (step > 0))
    kept = np.flatnonzero(keep)
    middle = kept[1:-1]
    # knots inside a piece that do not change the acceleration say nothing
    idle = (v[kept[:-2]] == v[middle]) & (v[middle] == v[kept[2:]]) & ~ends[middle - 1]
    kept = np.delete(kept, np.flatnonzero(idle) + 1)
    return Trajectory(path, s[kept], t[kept], v[kept])


def _parts(grid: Grid, free: IntArray, before: FloatArray, after: FloatArray) -> tuple[FloatArray, ...]:
    """Metres faster, level and slower (k,) on intervals where nothing changes, and the speed between, m/s."""
    length = grid.length[free]
    rate = grid.acceleration[free] / (1.0 + grid.half_track * np.abs(grid.curvature[free, 0]))
    faster = np.maximum(before, after)
    peak = np.sqrt(np.minimum(grid.plateau[free], (before**2 + after**2) / 2 + rate * length))
    peak = np.maximum(peak, faster)
    for side in (before, after):  # what is hardly above one of its ends is level with the faster one
        hardly = (peak**2 - side**2) / (2 * rate) < SHORTEST
        peak = np.where(hardly & (faster > 0), faster, peak)
    up = np.minimum((peak**2 - before**2) / (2 * rate), length)
    down = np.clip((peak**2 - after**2) / (2 * rate), 0.0, length - up)
    return up, length - up - down, down, peak


def turn_time(angle: float, robot: Robot) -> float:
    """Seconds for turning on the spot by an angle (rad): a trapezoid of turn rate and wheel acceleration."""
    rate, acceleration = robot.mobility.turn_rate, robot.mobility.turn_acceleration
    if angle == 0 or math.isinf(rate):
        return 0.0
    if angle * acceleration < rate**2:
        return 2 * math.sqrt(angle / acceleration)
    return angle / rate + rate / acceleration
