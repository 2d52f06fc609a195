"""A path cut into intervals, and what limits the speed on each.

With b = v^2, the acceleration a = db/ds / 2 constant on an interval and the curvature kappa linear in s, a wheel at the
distance r from the middle has the speed v (1 +- kappa r) and the acceleration

    a (1 +- kappa r) +- r kappa' b,

which is linear in s: within its limit at both ends of an interval, it is within it everywhere.

Limits of speed have the form b q(s) <= limit with q convex, while b is linear. 1/x is above its tangent at any m > 0:

    b <= limit (2 m - q) / m^2

is enough, and has a concave right-hand side: what holds at both ends holds between them. With m = q in the middle
it is exact there, and hardly less than limit / q elsewhere.
"""

from __future__ import annotations

import math
from typing import NamedTuple

import numpy as np

from optplan.domain.arrays import BoolArray, FloatArray, IntArray
from optplan.domain.options import Options
from optplan.domain.path import RAISED, Path
from optplan.domain.robot import DiffDrive, Robot

STEP = 0.05
"""Longest interval where the curvature changes, m."""
CONTROL_PERIOD = 0.1
"""Where lines and arcs meet the curvature steps, and with it the wheels' speeds. The step may be as large as the wheels
can follow within this time, s: so the robot slows down at such a joint."""
SHORTEST = 1e-5
"""Parts shorter than this are driven at one speed, m: at a kilometre arc lengths are known to 1e-13 m only, and what a
speed gained along such a part would be rounding."""
HEADING_STEP = 1e-6
"""A direction that changes by more than this between two pieces, rad, is a corner: speed 0."""
STANDING = 0.02
"""A wheel that moves by less than this share of the robot's way hardly feels the robot's acceleration."""
FLAT = 1.5
"""A limit that changes by more than this factor along half an interval is taken at its least."""


class Grid(NamedTuple):
    """Intervals in driving order, stops among them, and limits of b = v^2 at their ends."""

    piece: IntArray
    """(n,) row of the path"""
    s: FloatArray
    """(n + 1,) arc length, m"""
    length: FloatArray
    """(n,) m; 0 for a stop"""
    curvature: FloatArray
    """(n, 2) 1/m, at both ends"""
    sharpness: FloatArray
    """(n,) 1/m^2"""
    cap: FloatArray
    """(n + 1,) greatest b at the ends, m^2/s^2"""
    plateau: FloatArray
    """(n,) greatest b between them where nothing changes along the interval, else infinite, m^2/s^2"""
    acceleration: FloatArray
    """(n,) limit of each wheel, m/s^2; 0: the speed does not change"""
    half_track: float
    """m; 0 for robots without wheels"""

    @property
    def weight(self) -> FloatArray:
        """(n, 2, 2) |1 +- kappa r| of each wheel at both ends."""
        sides = 1.0 + np.array([1.0, -1.0])[None, :, None] * self.curvature[:, None, :] * self.half_track
        return np.abs(sides)

    @property
    def steer(self) -> FloatArray:
        """(n, 2) +- r kappa' of each wheel, with the sign of 1 +- kappa r."""
        middle = 1.0 + np.array([1.0, -1.0]) * self.curvature.mean(axis=1)[:, None] * self.half_track
        steer: FloatArray = np.array([1.0, -1.0]) * self.half_track * self.sharpness[:, None] * np.sign(middle)
        return steer


def grid_of(path: Path, robot: Robot, options: Options, step: float = STEP) -> Grid:
    """The intervals of a path; step : longest one where the curvature changes, m."""
    mobility = robot.mobility
    half = mobility.track / 2 if isinstance(mobility, DiffDrive) else 0.0
    piece, begin, end = _intervals(path, half, step)
    curvature = path.curvature[piece, None] + path.sharpness[piece, None] * np.column_stack([begin, end])
    sharpness, length = path.sharpness[piece], end - begin
    limit, inside = _caps(path, robot, options, piece, curvature, sharpness)
    cap = np.concatenate([limit[:, 0], [0.0]])
    cap[1:-1] = np.minimum(cap[1:-1], limit[:-1, 1])
    # ends of pieces: the last interval of each
    last = np.append(np.flatnonzero(np.diff(piece)) + 1, len(piece))
    cap[np.append(0, last)] = np.minimum(cap[np.append(0, last)], _joint_speeds(path, robot) ** 2)
    short = (length > 0) & (length < SHORTEST)
    level = short & (cap[:-1] > 0) & (cap[1:] > 0)
    acceleration = np.where(level, 0.0, np.where(short, 0.9 * mobility.acceleration, mobility.acceleration))
    s = np.append(path.offsets[piece] + begin, path.offsets[-1])
    return Grid(piece, s, length, curvature, sharpness, cap, inside, acceleration, half)


def _intervals(path: Path, half: float, step: float) -> tuple[IntArray, FloatArray, FloatArray]:
    """Pieces, and where on them each interval begins and ends, m.

    Where a wheel's acceleration depends on the speed, intervals are so short that the passes of the sweep are exact:
    2 length r |kappa'| < |1 +- kappa r| for each wheel, unless it hardly moves.
    """
    count = np.ones(len(path), dtype=np.int64)
    if half > 0:
        count = np.where(path.sharpness != 0, np.maximum(np.ceil(path.length / step), 1), 1).astype(np.int64)
    piece = np.repeat(np.arange(len(path)), count)
    number = np.arange(len(piece)) - np.repeat(np.cumsum(count) - count, count)
    share = path.length[piece] / count[piece]
    begin, end = share * number, np.where(number + 1 == count[piece], path.length[piece], share * (number + 1))
    while True:
        coarse = _coarse(path, half, piece, begin, end)
        if not coarse.any():
            return piece, begin, end
        twice = np.repeat(np.arange(len(piece)), 1 + coarse)
        second = np.concatenate([[False], twice[1:] == twice[:-1]])
        first = np.concatenate([second[1:], [False]])
        middle = (begin + end)[twice] / 2
        piece = piece[twice]
        begin, end = np.where(second, middle, begin[twice]), np.where(first, middle, end[twice])


def _coarse(path: Path, half: float, piece: IntArray, begin: FloatArray, end: FloatArray) -> BoolArray:
    """(n,) which intervals are too long for their wheels."""
    ends = path.curvature[piece, None] + path.sharpness[piece, None] * np.column_stack([begin, end])
    least = np.abs(1.0 - half * np.abs(ends)).min(axis=1)
    most = np.abs(1.0 - half * np.abs(ends)).max(axis=1)
    reach = 2.2 * (end - begin) * half * np.abs(path.sharpness[piece])
    coarse: BoolArray = (least <= reach) & (most > STANDING)
    return coarse


def _caps(
    path: Path, robot: Robot, options: Options, piece: IntArray, curvature: FloatArray, sharpness: FloatArray
) -> tuple[FloatArray, FloatArray]:
    """Greatest b at both ends (n, 2) of every interval, and between them where nothing changes, else infinite."""
    mobility = robot.mobility
    work = options.time.work_speed or mobility.work_speed
    transit = options.time.transit_speed or mobility.transit_speed
    speed = np.where(path.tool[piece] == RAISED, transit, work)
    cap = np.repeat(speed[:, None] ** 2, 2, axis=1)
    if isinstance(mobility, DiffDrive):
        half = mobility.track / 2
        bend = np.abs(curvature)
        middle = curvature.mean(axis=1, keepdims=True)
        rim = (mobility.wheel_speed * mobility.wheel_radius) ** 2
        for side in (half, -half):
            cap = np.minimum(cap, _below(rim, (1 + side * curvature) ** 2, (1 + side * middle) ** 2))
        with np.errstate(divide="ignore"):
            steer = mobility.acceleration / (np.abs(sharpness) * half)
        # a wheel that hardly moves is not told of the robot's acceleration, which is at most this share of the limit
        slow = np.abs(1.0 - half * bend)
        share = 2.0 * slow.max(axis=1) / (1.0 + half * bend.min(axis=1))
        cap = np.minimum(cap, np.where(slow.max(axis=1) <= STANDING, steer * (1.0 - share), steer)[:, None])
        if math.isfinite(mobility.lateral_acceleration):
            cap = np.minimum(cap, _below(mobility.lateral_acceleration, bend, np.abs(middle)))
    moving = path.length[piece] > 0
    cap = np.where(moving[:, None], cap, 0.0)
    return cap, np.where(sharpness == 0, cap.min(axis=1), np.inf)


def _below(limit: float, ends: FloatArray, middle: FloatArray) -> FloatArray:
    """b (n, 2) at both ends so that b q <= limit all along, for convex q: (n, 2) at the ends, (n, 1) in the middle."""
    most = ends.max(axis=1, keepdims=True)
    with np.errstate(divide="ignore", invalid="ignore"):
        tangent = limit * (2.0 * middle - ends) / middle**2
        least = np.repeat(limit / most, 2, axis=1)
    below: FloatArray = np.where(most < FLAT * middle, tangent, least)
    return below


def _joint_speeds(path: Path, robot: Robot) -> FloatArray:
    """Greatest speed (n + 1,) at the beginning of every piece and at the end, m/s."""
    joint = np.full(len(path) + 1, np.inf)
    joint[[0, -1]] = 0.0
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
