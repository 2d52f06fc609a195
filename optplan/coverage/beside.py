"""The robot's own curves for strokes that its tool draws beside it, ahead of it or behind it.

The two directions of a stroke are different ways of the robot: in a left bend with the tool at its right the robot is
on the inner side, driven the other way on the outer one.
"""

from __future__ import annotations

from functools import lru_cache
from typing import NamedTuple

import numpy as np

from optplan.coverage.stops import curves_of, tolerance_of, work_limits
from optplan.domain.arrays import BoolArray, FloatArray
from optplan.domain.errors import InputError, LimitError
from optplan.domain.options import Options
from optplan.domain.robot import CurvatureLimits, Robot, ToolPlace
from optplan.domain.stroke import Stroke
from optplan.geometry.curves import Curve, reversed_curve
from optplan.geometry.offsets import smooth_offset
from optplan.geometry.smoothing import Smoothed
from optplan.geometry.towing import towed

SHARE = 0.1
"""Of the tolerance, for the difference between the robot's curve and one that keeps the tool exactly on its line."""
SLACK = 1e-6
"""Share by which a limit may seem to be broken by rounding."""


class Beside(NamedTuple):
    """How the robot drives the curves of a stroke, in one direction."""

    curves: tuple[Curve, ...]
    """the robot's, in the order of the stroke's points: for a stroke driven backwards, turned round"""
    tool: tuple[FloatArray, ...]
    """arc lengths along each curve of the tool, m, ..."""
    robot: tuple[FloatArray, ...]
    """... and along the robot's there"""
    refused: str = ""
    """why the robot cannot drive this; empty when it can. Then there are no curves"""


def beside(stroke: Stroke, reverse: bool, robot: Robot, options: Options) -> Beside | None:
    """The robot's curves for a stroke in one direction; None for a robot that follows any curve, or a stop."""
    made = curves_of(stroke, robot, options)
    if made is None:
        return None
    if not robot.offset.aside:
        own = tuple(np.array([0.0, curve.total]) for curve in made.curves)
        return Beside(made.curves, own, own)
    tolerance = SHARE * tolerance_of(options.page, robot.tool)
    ring = stroke.closed and len(made.stops) == 0
    return _beside(made.curves, ring, reverse, robot.offset, tolerance, work_limits(robot, options))


def refusals(stroke: Stroke, robot: Robot, options: Options) -> tuple[str, str]:
    """Why the robot cannot drive a stroke forwards, and against the order of its points; empty where it can."""
    if stroke.is_stop:
        return "", ""
    ways = [beside(stroke, reverse, robot, options) for reverse in (False, True)]
    forwards, backwards = ("" if way is None else way.refused for way in ways)
    return forwards, backwards


# covering, ordering and connecting all ask
@lru_cache(maxsize=10000)
def _beside(
    curves: tuple[Curve, ...], ring: bool, reverse: bool, place: ToolPlace, tolerance: float, limits: CurvatureLimits
) -> Beside:
    made: list[Curve] = []
    tool: list[FloatArray] = []
    own: list[FloatArray] = []
    for curve in curves:
        driven = reversed_curve(curve) if reverse else curve
        try:
            way, along, there = _way(driven, ring, place, tolerance)
        except (InputError, LimitError) as error:
            return Beside((), (), (), str(error))
        if way.max_curvature > limits.curvature * (1 + SLACK):
            return Beside((), (), (), _too_much("curvature", way.max_curvature, limits.curvature, "1/m"))
        if way.max_sharpness > limits.sharpness * (1 + SLACK):
            return Beside((), (), (), _too_much("sharpness", way.max_sharpness, limits.sharpness, "1/m^2"))
        if reverse:
            way, along, there = reversed_curve(way), curve.total - along[::-1], way.total - there[::-1]
        made.append(way)
        tool.append(along)
        own.append(there)
    return Beside(tuple(made), tuple(tool), tuple(own))


def _way(curve: Curve, ring: bool, place: ToolPlace, tolerance: float) -> tuple[Curve, FloatArray, FloatArray]:
    """The robot's curve for one of its tool, and arc lengths along both that belong together."""
    if place.ahead != 0:
        way, _, along, there = towed(curve, place.right, place.ahead, tolerance, closed=ring)
        return way, along, there
    way = smooth_offset(curve, place.right, tolerance, closed=ring).curve
    # a parallel is longer by the distance times the turning
    there = curve.offsets - place.right * (curve.states[:, 2] - curve.start[2])
    return way, curve.offsets, there * (way.total / there[-1])


def _too_much(what: str, value: float, limit: float, unit: str) -> str:
    return f"the robot would need a {what} of {value:.3g} {unit}, of which it has {limit:.3g}"


def tight(made: Smoothed, reverse: bool, robot: Robot, options: Options) -> list[BoolArray]:
    """For each curve of a tool, at the ends of its pieces: whether the robot's limits are broken there (k,) bool."""
    place, limits = robot.offset, work_limits(robot, options)
    sign = -1.0 if reverse else 1.0
    found: list[BoolArray] = []
    for curve in made.curves:
        kappa = sign * np.append(curve.curvature, curve.end_curvature[-1:])
        sigma = np.abs(np.append(curve.sharpness, curve.sharpness[-1:]))
        if place.ahead != 0:  # as if the bend went on for ever
            slip = np.clip(place.ahead * kappa, -1, 1)
            stretch = np.sqrt(1 - slip**2) - place.right * kappa
        else:
            stretch = 1 - place.right * kappa
        room = np.maximum(stretch, 1e-9)
        broken = (np.abs(kappa) > limits.curvature * room) | (sigma > limits.sharpness * room**3)
        found.append(broken)
    return found
