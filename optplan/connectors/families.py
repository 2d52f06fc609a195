"""Which movements a robot makes between strokes."""

from __future__ import annotations

import math
from collections.abc import Callable
from typing import NamedTuple

import numpy as np

from optplan.connectors.pace import Pace, pace_of
from optplan.domain.arrays import FloatArray
from optplan.domain.errors import InputError
from optplan.domain.options import Options
from optplan.domain.robot import Boom, CurvatureLimits, Robot

START_HEADINGS = 36
"""Headings tried at a start point, which itself asks for none."""


def metric_of(robot: Robot, options: Options) -> str:
    """The metric that "auto" stands for: "dubins" where headings count, else "euclid".

    Raises InputError when straight moves are asked of a robot that cannot turn on the spot.
    """
    asked = options.order.metric
    if asked == "time" and isinstance(robot.mobility, Boom):
        return "euclid"  # of its stops; `Travel` has the times between them
    if asked == "euclid" and robot.heading_counts:
        raise InputError(
            f"the metric 'euclid' needs turns on the spot, which {robot.name} cannot; expected 'dubins' or 'cc'"
        )
    return asked if asked != "auto" else "dubins" if robot.heading_counts else "euclid"


class Family(NamedTuple):
    """The connectors of a robot: a metric, and what limits them."""

    metric: str
    radius: float = 0.0
    """least turning radius, m ("dubins", "cc")"""
    sharpness: float = math.inf
    """greatest change of curvature a metre, 1/m^2 ("cc")"""
    reversing: bool = False
    """whether they may be driven backwards: "dubins" then stands for Reeds-Shepp paths, "cc" for such with cusps"""
    pace: Pace | None = None
    """of "time": each connector within the limits of the speed at which it takes the least time; radius and sharpness
    are those of the slowest"""

    @property
    def headings(self) -> bool:
        """Whether headings count."""
        return self.metric != "euclid"

    def eased(self, states: FloatArray) -> FloatArray:
        """States (k, 4 or 5), curvature last, as connectors have them: curvature within the limit of transit.

        Strokes are driven as slowly as their bends ask for; where one begins or ends tighter than this limit, the robot
        stops, and its wheels turn to the other curvature while it stands.
        """
        if not self.curved:
            return states
        eased = states.copy()
        eased[:, -1] = np.clip(states[:, -1], -1 / self.radius, 1 / self.radius)
        return eased

    @property
    def curved(self) -> bool:
        """Whether curvature is continuous."""
        return self.metric in ("cc", "time")

    @property
    def unit(self) -> str:
        """Of costs: "m", or "s"."""
        return "s" if self.metric == "time" else "m"

    def costs(self, exits: FloatArray, entries: FloatArray) -> FloatArray:
        """Metres, or seconds (k,), of connectors between states (k, 5) x, y, z, heading, curvature."""
        exits, entries = self.eased(exits), self.eased(entries)
        if self.pace is not None:
            return self.pace.times(exits[:, _FLAT], entries[:, _FLAT])
        if self.metric == "cc":
            from optplan.geometry.cc import cc_lengths
            from optplan.geometry.reversing import reversing_lengths

            batch = reversing_lengths if self.reversing else cc_lengths
            return batch(exits[:, _FLAT], entries[:, _FLAT], 1 / self.radius, self.sharpness)
        if self.metric == "dubins":
            from optplan.geometry.dubins import dubins_lengths
            from optplan.geometry.reversing import reeds_shepp_lengths

            plain = reeds_shepp_lengths if self.reversing else dubins_lengths
            return plain(exits[:, _FLAT[:3]], entries[:, _FLAT[:3]], self.radius)
        lengths: FloatArray = np.linalg.norm(exits[:, :3] - entries[:, :3], axis=1)
        return lengths

    def matrix(self, exits: FloatArray, entries: FloatArray, told: Callable[[float], None] | None = None) -> FloatArray:
        """Metres, or seconds (n, m), from every exit (n, 5) to every entry (m, 5), where headings count.

        `told` is called with the share that is done.
        """
        from optplan.geometry.cc import cc_matrix
        from optplan.geometry.reversing import reeds_shepp_matrix, reversing_matrix

        exits, entries = self.eased(exits), self.eased(entries)
        if self.pace is not None:
            return self.pace.matrix(exits[:, _FLAT], entries[:, _FLAT], told)
        if self.metric == "dubins":
            return reeds_shepp_matrix(exits[:, _FLAT[:3]], entries[:, _FLAT[:3]], self.radius, told=told)
        batch = reversing_matrix if self.reversing else cc_matrix
        return batch(exits[:, _FLAT], entries[:, _FLAT], 1 / self.radius, self.sharpness, told=told)


_FLAT = [0, 1, 3, 4]
"""x, y, heading, curvature of a state."""


def family_of(robot: Robot, options: Options) -> Family:
    """The connectors that a plan has, within what the robot can drive at transit speed.

    Raises InputError when the robot cannot turn, when nothing limits its curvature or the rate of that, or when it is
    to drive backwards and cannot.
    """
    metric = metric_of(robot, options)
    reversing = options.connect.reversing
    if reversing and not robot.mobility.reverses:
        raise InputError(f"{robot.name} does not drive backwards; expected no reversing, or a robot that reverses")
    if reversing and metric == "euclid":
        raise InputError("reversing says nothing about the metric 'euclid'; expected 'dubins' or 'cc'")
    if metric == "euclid":
        return Family(metric)
    if metric == "time":
        if reversing:
            raise InputError("the metric 'time' drives forwards; expected no reversing, or the metric 'cc'")
        pace = pace_of(robot, options)
        return Family(metric, 1 / pace.tightest.curvature, pace.tightest.sharpness, pace=pace)
    speed = options.time.speeds(robot.mobility)[1]
    limits = robot.mobility.curvature_limits(speed)
    if not 0 < limits.curvature < math.inf:
        reason = "follows any curve" if limits.curvature > 0 else f"cannot turn at {speed:g} m/s"
        raise InputError(f"the metric {metric!r} needs a turning radius, but {robot.name} {reason}; expected 'euclid'")
    if metric == "cc" and not 0 < limits.sharpness < math.inf:
        raise InputError(f"the metric 'cc' needs a limit of sharpness, which {robot.name} has not; expected 'dubins'")
    return Family(metric, 1 / limits.curvature, limits.sharpness, reversing)


def start_states(
    start: tuple[float, float], heading: float | None, entries: FloatArray, family: Family
) -> tuple[FloatArray, FloatArray]:
    """Best heading (k,) at a start point for reaching entry states (k, 5), and the costs (k,), m or s.

    The robot is set down at its start by hand, so its heading there is free unless it is given; START_HEADINGS of them
    are tried, and the straight line of sight. Its wheels are straight there.
    """
    if heading is None:
        sight = np.arctan2(entries[:, 1] - start[1], entries[:, 0] - start[0])
        around = np.linspace(0, 2 * math.pi, START_HEADINGS, endpoint=False)
        tried = np.array([sight, *(np.full(len(entries), angle) for angle in around)])
    else:
        tried = np.full((1, len(entries)), heading)
    lengths = []
    for headings in tried:
        states = np.zeros((len(entries), 5))
        states[:, 0], states[:, 1], states[:, 3] = start[0], start[1], headings
        lengths.append(family.costs(states, entries))
    best = np.argmin(lengths, axis=0)
    rows = np.arange(len(entries))
    return tried[best, rows], np.array(lengths)[best, rows]


def limits_of(exits: FloatArray, entries: FloatArray, family: Family) -> list[CurvatureLimits]:
    """The limits (k,) of connectors between states (k, 4): of "time", those under which each takes the least time."""
    if family.pace is None:
        sharpness = family.sharpness
        return [CurvatureLimits(1 / family.radius if family.radius > 0 else math.inf, sharpness)] * len(exits)
    rung = family.pace.by_rung(exits, entries).argmin(axis=0)
    return [family.pace.rungs[k] for k in rung.tolist()]


def limits_between(here: FloatArray, there: FloatArray, family: Family) -> CurvatureLimits:
    """The same for one connector between two states (4,)."""
    return limits_of(here[None], there[None], family)[0]
