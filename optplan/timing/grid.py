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


def grid_of(path: Path, robot: Robot, options: Options, step: float = STEP, *, even: bool = False) -> Grid:
    """The intervals of a path; step : longest one where the curvature changes (even: anywhere), m."""
    mobility = robot.mobility
    half = mobility.track / 2 if isinstance(mobility, DiffDrive) else 0.0
    joint = _joint_speeds(path, robot)
    piece, begin, end = _intervals(path, half, step, even, (joint[:-1] == 0) & (joint[1:] == 0))
    sharpness, length = path.sharpness[piece], end - begin
    curvature = np.column_stack([path.curvature[piece] + sharpness * place for place in (begin, end)])
    limit, inside = _caps(path, robot, options, piece, curvature, sharpness)
    cap = np.concatenate([limit[:, 0], [0.0]])
    cap[1:-1] = np.minimum(cap[1:-1], limit[:-1, 1])
    # ends of pieces: the last interval of each
    last = np.append(np.flatnonzero(np.diff(piece)) + 1, len(piece))
    cap[np.append(0, last)] = np.minimum(cap[np.append(0, last)], joint**2)
    short = (length > 0) & (length < SHORTEST)
    level = short & (cap[:-1] > 0) & (cap[1:] > 0)
    acceleration = np.where(level, 0.0, np.where(short, 0.9 * mobility.acceleration, mobility.acceleration))
    inside = np.full(len(piece), np.inf) if even else inside
    s = np.append(path.offsets[piece] + begin, path.offsets[-1])
    return Grid(piece, s, length, curvature, sharpness, cap, inside, acceleration, half)


def _intervals(
    path: Path, half: float, step: float, even: bool, alone: BoolArray
) -> tuple[IntArray, FloatArray, FloatArray]:
    """Pieces, and where on them each interval begins and ends, m.

    Where a wheel's acceleration depends on the speed, intervals are so short that the passes of the sweep are exact:
    2 length r |kappa'| < |1 +- kappa r| for each wheel, unless it hardly moves.
    """
    cut = np.full(len(path), even) | ((half > 0) & (path.sharpness != 0))
    # from rest to rest there has to be a place in between
    least = np.where(alone, 2, 1)
    count = np.where(cut, np.maximum(np.ceil(path.length / step), least), 1).astype(np.int64)
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
    curvature, sharpness = path.curvature[piece], path.sharpness[piece]
    first, last = (np.abs(1.0 - half * np.abs(curvature + sharpness * place)) for place in (begin, end))
    least, most = np.minimum(first, last), np.maximum(first, last)
    reach = 2.2 * (end - begin) * half * np.abs(sharpness)
    coarse: BoolArray = (least <= reach) & (most > STANDING)
    return coarse


def _caps(
    path: Path, robot: Robot, options: Options, piece: IntArray, curvature: FloatArray, sharpness: FloatArray
) -> tuple[FloatArray, FloatArray]:
    """Greatest b at both ends (n, 2) of every interval, and between them where nothing changes, else infinite."""
    mobility = robot.mobility
    work, transit = options.time.speeds(mobility)
    moving = path.length[piece] > 0
    common = np.where(moving, np.where(path.tool[piece] == RAISED, transit, work) ** 2, 0.0)
    first, last = np.ascontiguousarray(curvature.T)
    middle = (first + last) / 2
    caps = []
    if isinstance(mobility, DiffDrive):
        half = mobility.track / 2
        rim = (mobility.wheel_speed * mobility.wheel_radius) ** 2
        for side in (half, -half):
            caps.append(_below(rim, (1 + side * first) ** 2, (1 + side * middle) ** 2, (1 + side * last) ** 2))
        if math.isfinite(mobility.lateral_acceleration):
            caps.append(_below(mobility.lateral_acceleration, np.abs(first), np.abs(middle), np.abs(last)))
        place = robot.offset
        if place.aside:  # the work speed is that of the tool, beside the robot's middle
            down = path.tool[piece] != RAISED
            right, ahead = down * path.gear[piece] * place.right, down * place.ahead
            ratios = [(1 + right * bend) ** 2 + (ahead * bend) ** 2 for bend in (first, middle, last)]
            caps.append(_below(np.where(down, work, transit) ** 2, *ratios))
            common = np.where(moving, np.inf, 0.0)
        with np.errstate(divide="ignore"):
            steer = mobility.acceleration / (np.abs(sharpness) * half)
        # a wheel that hardly moves is not told of the robot's acceleration, which is at most this share of the limit
        slow = np.maximum(np.abs(1.0 - half * np.abs(first)), np.abs(1.0 - half * np.abs(last)))
        share = 2.0 * slow / (1.0 + half * np.minimum(np.abs(first), np.abs(last)))
        common = np.minimum(common, np.where(slow <= STANDING, steer * (1.0 - share), steer))
    begin, end = common, common
    for at_first, at_last in caps:
        begin, end = np.minimum(begin, at_first), np.minimum(end, at_last)
    return np.column_stack([begin, end]), np.where(sharpness == 0, np.minimum(begin, end), np.inf)


def _below(
    limit: float | FloatArray, first: FloatArray, middle: FloatArray, last: FloatArray
) -> tuple[FloatArray, FloatArray]:
    """b (n,) at both ends so that b q <= limit all along, for convex q (n,) at the ends and in the middle."""
    most = np.maximum(first, last)
    with np.errstate(divide="ignore", invalid="ignore"):
        double, scale, least = 2.0 * middle, limit / middle**2, limit / most
        smooth = most < FLAT * middle
        return np.where(smooth, scale * (double - first), least), np.where(smooth, scale * (double - last), least)


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
