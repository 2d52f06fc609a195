"""Trapezoidal speeds: accelerate, cruise, brake, within what each piece of the path allows."""

from __future__ import annotations

import math

import numpy as np

from optplan.domain.arrays import FloatArray
from optplan.domain.options import Options
from optplan.domain.path import RAISED, Path, Trajectory
from optplan.domain.robot import DiffDrive, Robot

CONTROL_PERIOD = 0.1
"""Where lines and arcs meet the curvature steps, and with it the wheels' speeds. The step may be as large as the wheels
can follow within this time, s: so the robot slows down at such a joint."""
SHORTEST = 1e-5
"""Parts shorter than this are driven at one speed, m: at a kilometre arc lengths are known to 1e-13 m only, and what a
speed gained along such a part would be rounding."""
HEADING_STEP = 1e-6
"""A direction that changes by more than this between two pieces, rad, is a corner: speed 0."""


def profile(path: Path, robot: Robot, options: Options | None = None) -> Trajectory:
    """The fastest trapezoidal speed profile along a path, at rest at its ends, stops and cusps.

    Every piece has its greatest speed (tool and wheels) and acceleration (the outer wheel's share of it in an arc); a
    pass forwards and a pass backwards give the greatest speeds at the joints, and each piece is driven as fast as its
    ends allow.

    Parameters
    ----------
    path : what is driven
    robot, options : give speeds and accelerations; the options' speeds win
    """
    options = options or Options()
    if len(path) == 0:
        return Trajectory(path, np.zeros(1), np.zeros(1), np.zeros(1))
    cap, acceleration = _limits(path, robot, options)
    joint = _joint_speeds(path, robot, cap)
    short = (path.length > 0) & (path.length < SHORTEST)
    level = short & (joint[:-1] > 0) & (joint[1:] > 0)
    acceleration = np.where(level, 0.0, np.where(short, 0.9 * acceleration, acceleration))
    length = path.length.tolist()
    rate = acceleration.tolist()
    speed = joint.tolist()
    for k in range(len(length)):
        speed[k + 1] = min(speed[k + 1], math.sqrt(speed[k] ** 2 + 2 * rate[k] * length[k]))
    for k in range(len(length) - 1, -1, -1):
        speed[k] = min(speed[k], math.sqrt(speed[k + 1] ** 2 + 2 * rate[k] * length[k]))
    return _knots(path, robot, np.array(speed), cap, acceleration)


def _limits(path: Path, robot: Robot, options: Options) -> tuple[FloatArray, FloatArray]:
    """Greatest speed (m/s) and acceleration (m/s^2) of every piece."""
    mobility = robot.mobility
    work = options.time.work_speed or mobility.work_speed
    transit = options.time.transit_speed or mobility.transit_speed
    cap = np.where(path.tool == RAISED, transit, work)
    acceleration = np.full(len(path), mobility.acceleration)
    if isinstance(mobility, DiffDrive):
        bend = np.maximum(np.abs(path.curvature), np.abs(path.curvature + path.sharpness * path.length))
        outer = 1 + bend * mobility.track / 2
        cap = np.minimum(cap, mobility.wheel_speed * mobility.wheel_radius / outer)
        # along a clothoid the wheels change their speed even while the robot keeps its own
        with np.errstate(divide="ignore"):
            steer = mobility.acceleration / (np.abs(path.sharpness) * mobility.track / 2)
        cap = np.minimum(cap, np.sqrt(steer))
        acceleration = acceleration / outer
    return cap, acceleration


def _joint_speeds(path: Path, robot: Robot, cap: FloatArray) -> FloatArray:
    """Greatest speed (n + 1,) at the beginning of every piece and at the end, m/s."""
    joint = np.zeros(len(path) + 1)
    joint[1:-1] = np.minimum(cap[:-1], cap[1:])
    moving = path.length > 0
    joint[:-1][~moving] = 0.0
    joint[1:][~moving] = 0.0
    end_curvature = path.curvature + path.sharpness * path.length
    end_heading = path.heading + path.length * (path.curvature + path.length * path.sharpness / 2) + path.turn
    change = np.abs(np.sin((path.heading[1:] - end_heading[:-1]) / 2)) * 2
    lift = np.abs(np.diff(path.elevation))
    joint[1:-1][(change > HEADING_STEP) | (lift > HEADING_STEP)] = 0.0
    joint[path.cusps] = 0.0
    mobility = robot.mobility
    if isinstance(mobility, DiffDrive):
        step = np.abs(path.curvature[1:] - end_curvature[:-1]) * mobility.track / 2
        with np.errstate(divide="ignore"):
            joint[1:-1] = np.minimum(joint[1:-1], mobility.acceleration * CONTROL_PERIOD / step)
    return joint


def _knots(path: Path, robot: Robot, speed: FloatArray, cap: FloatArray, acceleration: FloatArray) -> Trajectory:
    """Each piece as up to three parts of constant acceleration; each stop as its waiting time."""
    before, after, length = speed[:-1], speed[1:], path.length
    moving = length > 0
    rate = np.where(acceleration > 0, acceleration, np.inf)
    peak = np.minimum(cap, np.sqrt((before**2 + after**2) / 2 + acceleration * length))
    faster = np.maximum(before, after)
    for side in (before, after):  # what is hardly above one of its ends is level with the faster one
        hardly = (peak**2 - side**2) / (2 * rate) < SHORTEST
        peak = np.where(hardly & (faster > 0), faster, peak)
    up = (peak**2 - before**2) / (2 * rate)
    down = (peak**2 - after**2) / (2 * rate)
    cruise = np.maximum(length - up - down, 0.0)
    up = np.where(moving, np.minimum(up, length), 0.0)
    down = np.where(moving, length - up - cruise, 0.0)
    waiting = path.dwell + np.array([turn_time(abs(turn), robot) for turn in path.turn.tolist()])
    offset = path.offsets[:-1]
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
    times[~moving, 2] = waiting[~moving]
    steps = np.stack([offset + up, offset + up + cruise, path.offsets[1:]], axis=1)
    speeds = np.stack([np.where(moving, peak, 0.0), np.where(moving, peak, 0.0), np.where(moving, after, 0.0)], axis=1)
    s = np.concatenate([[0.0], np.maximum.accumulate(steps.ravel())])
    t = np.concatenate([[0.0], np.cumsum(times.ravel())])
    v = np.concatenate([[0.0], speeds.ravel()])
    # a knot at every piece's end stays; inner knots without duration go
    ends = np.zeros(len(s), dtype=np.bool_)
    ends[::3] = True
    keep = ends | np.concatenate([[True], times.ravel() > 0])
    return Trajectory(path, s[keep], t[keep], v[keep])


def turn_time(angle: float, robot: Robot) -> float:
    """Seconds for turning on the spot by an angle (rad): a trapezoid of turn rate and wheel acceleration."""
    rate, acceleration = robot.mobility.turn_rate, robot.mobility.turn_acceleration
    if angle == 0 or math.isinf(rate):
        return 0.0
    if angle * acceleration < rate**2:
        return 2 * math.sqrt(angle / acceleration)
    return angle / rate + rate / acceleration
