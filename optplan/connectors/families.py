"""Which movements a robot makes between strokes."""

from __future__ import annotations

import math

import numpy as np

from optplan.domain.arrays import FloatArray
from optplan.domain.errors import InputError
from optplan.domain.options import Options
from optplan.domain.robot import Robot

START_HEADINGS = 36
"""Headings tried at a start point, which itself asks for none."""


def metric_of(robot: Robot, options: Options) -> str:
    """The metric that "auto" stands for: "dubins" where headings count, else "euclid".

    Raises InputError when straight moves are asked of a robot that cannot turn on the spot.
    """
    asked = options.order.metric
    if asked == "euclid" and robot.heading_counts:
        raise InputError(f"the metric 'euclid' needs turns on the spot, which {robot.name} cannot; expected 'dubins'")
    return asked if asked != "auto" else "dubins" if robot.heading_counts else "euclid"


def transit_radius(robot: Robot, options: Options) -> float:
    """Turning radius of connectors: the least at transit speed, m. Raises InputError when the robot cannot turn."""
    speed = options.time.transit_speed or robot.mobility.transit_speed
    curvature = robot.mobility.curvature_limits(speed).curvature
    if not 0 < curvature < math.inf:
        reason = "follows any curve" if curvature > 0 else f"cannot turn at {speed:g} m/s"
        raise InputError(f"the metric 'dubins' needs a turning radius, but {robot.name} {reason}; expected 'euclid'")
    return 1 / curvature


def start_states(start: tuple[float, float], entries: FloatArray, radius: float) -> tuple[FloatArray, FloatArray]:
    """Best heading (k,) at a start point for reaching entry states (k, 3), and the lengths (k,), m.

    The robot is set down at its start by hand, so its heading there is free; START_HEADINGS of them are tried, and the
    straight line of sight.
    """
    from optplan.geometry.dubins import dubins_lengths

    sight = np.arctan2(entries[:, 1] - start[1], entries[:, 0] - start[0])
    around = np.linspace(0, 2 * math.pi, START_HEADINGS, endpoint=False)
    tried = [sight, *(np.full(len(entries), heading) for heading in around)]
    lengths = []
    for headings in tried:
        states = np.column_stack([np.full(len(entries), start[0]), np.full(len(entries), start[1]), headings])
        lengths.append(dubins_lengths(states, np.ascontiguousarray(entries), radius))
    best = np.argmin(lengths, axis=0)
    rows = np.arange(len(entries))
    return np.array(tried)[best, rows], np.array(lengths)[best, rows]
