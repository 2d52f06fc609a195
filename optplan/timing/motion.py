"""Where the robot is at a time when it drives exactly as planned."""

from __future__ import annotations

import math
from typing import NamedTuple

import numpy as np

from optplan.domain.arrays import FloatArray, IntArray
from optplan.domain.drive import Motion
from optplan.domain.path import Path, Trajectory
from optplan.domain.robot import Robot
from optplan.geometry.paths import along

_SAME = 1e-9
"""Share by which an arc length may miss the end of its piece by rounding."""


class Stations(NamedTuple):
    """Bodily headings and knots at the pieces of a trajectory."""

    gear: FloatArray
    """(n,) 1, or -1 where the robot drives backwards"""
    knot: IntArray
    """(n + 1,) knot at the beginning of every piece, and at the end of the last"""
    begin: FloatArray
    """(n,) rad, where the body's front points at the beginning of every piece"""
    end: FloatArray
    """(n,) rad, at its end"""


def stations(trajectory: Trajectory) -> Stations:
    """Knots and the body's headings at the ends of all pieces. Headings are those of each piece, not wrapped."""
    path = trajectory.path
    gear = path.gear.astype(np.float64)
    knot = np.zeros(len(path) + 1, dtype=np.int64)
    s, here, last = trajectory.s, 0, len(trajectory.s) - 1
    slack = _SAME * (1 + float(s[-1]))
    for k, (length, until) in enumerate(zip(path.length.tolist(), path.offsets[1:].tolist(), strict=True)):
        if length > 0:
            here = int(min(max(here + 1, np.searchsorted(s, until - slack)), last))
        elif here < last and s[here + 1] - s[here] <= slack:
            here += 1  # a stop is two knots at one place
        knot[k + 1] = here
    turned = path.length * (path.curvature + path.length * path.sharpness / 2) + path.turn
    begin = path.heading + np.where(gear < 0, math.pi, 0.0)
    return Stations(gear, knot, begin, begin + turned)


def motion(trajectory: Trajectory, robot: Robot, time: FloatArray) -> Motion:
    """Where the robot is at these moments.

    Parameters
    ----------
    trajectory : with one piece or more
    time : (n,) s from the beginning, increasing; beyond the end it stands there

    A turn on the spot follows a trapezoid of the robot's turn rate, dwelling comes after it.
    """
    path, at = trajectory.path, stations(trajectory)
    t = np.clip(np.asarray(time, dtype=np.float64), 0.0, trajectory.duration) + float(trajectory.t[0])
    knot = np.clip(np.searchsorted(trajectory.t, t, side="right") - 1, 0, len(trajectory.t) - 2)
    piece = np.clip(np.searchsorted(at.knot, knot, side="right") - 1, 0, len(path) - 1)
    span = trajectory.t[knot + 1] - trajectory.t[knot]
    into = t - trajectory.t[knot]
    before, after = trajectory.v[knot], trajectory.v[knot + 1]
    rate = np.divide(after - before, span, out=np.zeros_like(span), where=span > 0)
    speed = np.where(path.is_stop[piece], 0.0, before + rate * into)
    s = trajectory.s[knot] + into * (before + rate * into / 2)
    distance = np.clip(s - path.offsets[piece], 0.0, path.length[piece])
    states = along(path, piece, distance)
    angle, turning = _turning(path, piece, t - trajectory.t[at.knot[piece]], robot)
    heading = states.heading + np.where(at.gear[piece] < 0, math.pi, 0.0) + angle
    x, y = states.position[:, 0], states.position[:, 1]
    right, ahead = robot.offset
    tool_x = x + ahead * np.cos(heading) + right * np.sin(heading)
    tool_y = y + ahead * np.sin(heading) - right * np.cos(heading)
    turn_rate = speed * states.curvature + turning
    return Motion(time, x, y, heading, at.gear[piece] * speed, turn_rate, path.tool[piece], tool_x, tool_y)


def _turning(path: Path, piece: IntArray, since: FloatArray, robot: Robot) -> tuple[FloatArray, FloatArray]:
    """Angle (rad) and rate (rad/s) of turns on the spot, `since` seconds after the stop's beginning."""
    turn = path.turn[piece]
    rate, acceleration = robot.mobility.turn_rate, robot.mobility.turn_acceleration
    if math.isinf(rate):
        return turn, np.zeros_like(turn)
    size = np.abs(turn)
    top = np.minimum(rate, np.sqrt(size * acceleration))
    ramp = top / acceleration
    whole = np.divide(size, top, out=np.zeros_like(size), where=top > 0) + ramp
    now = np.clip(since, 0.0, whole)
    left = whole - now
    angle = np.where(now < ramp, acceleration * now**2 / 2, top * (now - ramp / 2))
    angle = np.where(left < ramp, size - acceleration * left**2 / 2, angle)
    speed = np.minimum(top, acceleration * np.minimum(now, left))
    return np.sign(turn) * angle, np.sign(turn) * speed
