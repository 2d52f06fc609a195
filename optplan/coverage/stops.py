"""Where a robot has to stop along its strokes, as curves that it can follow."""

from __future__ import annotations

import math
from functools import lru_cache

import numpy as np

from optplan.domain.arrays import IntArray
from optplan.domain.job import Note
from optplan.domain.options import Options, PageOptions
from optplan.domain.progress import Progress, ProgressCallback, silent
from optplan.domain.robot import CurvatureLimits, Robot, Tool
from optplan.domain.stroke import Stroke
from optplan.geometry.rounding import inner_vertices, wrapped
from optplan.geometry.smoothing import Smoothed, smoothed
from optplan.geometry.tangents import eased

CREEP = 0.25
"""Share of the work speed to which a robot slows down for a tight curve before it gives up following it."""

EASE = 0.5
"""Share of the limit of sharpness that is used where lines meet arcs: there is room for that."""

ROOM = 0.9
"""Share of tolerance and limits that the line of a tool beside the robot may use."""


def tolerance_of(page: PageOptions, tool: Tool) -> float:
    """Greatest distance between a drawn curve and its polyline, m: as asked, or a twentieth of the narrowest mark."""
    return page.tolerance or min(setting.width for setting in tool.settings[1:]) / 20


def work_limits(robot: Robot, options: Options) -> CurvatureLimits:
    """What the robot follows with its tool down when it creeps: 1/m and 1/m^2, infinite where it follows any curve."""
    speed = options.time.speeds(robot.mobility)[0]
    return robot.mobility.curvature_limits(CREEP * speed)


def follows_curves(robot: Robot, options: Options) -> bool:
    """Whether strokes have to be made curves for this robot: something limits its curvature."""
    return not math.isinf(work_limits(robot, options).curvature)


def curves_of(stroke: Stroke, robot: Robot, options: Options) -> Smoothed | None:
    """A stroke as curves of continuous curvature; None for a robot that follows any curve, or a stop."""
    if stroke.is_stop or not follows_curves(robot, options):
        return None
    tolerance = tolerance_of(options.page, robot.tool)
    kappa_max, sigma_max = work_limits(robot, options)
    if stroke.bends is not None:
        exact = _exact(stroke, kappa_max if not robot.offset.aside else math.inf, EASE * sigma_max)
        if exact is not None:
            return exact
    if robot.offset.aside:
        # the robot's own path beside this one is not exact, and changes its curvature a little faster in places
        tolerance, kappa_max, sigma_max = ROOM * tolerance, ROOM * kappa_max, ROOM * sigma_max
    return _curves(stroke, tolerance, kappa_max, sigma_max, options.connect.corner)


@lru_cache(maxsize=5000)
def _exact(stroke: Stroke, kappa_max: float, sigma_max: float) -> Smoothed | None:
    """Lines and arcs as they are, where they are no more bent than the limit; beside them, the tool's place decides."""
    assert stroke.bends is not None
    if np.abs(stroke.bends).max() > kappa_max:
        return None
    made = eased(stroke.points[:, :2], stroke.bends, stroke.closed, sigma_max)
    return None if made is None else Smoothed((made,), np.zeros(0 if stroke.closed else 1, dtype=np.int64))


# covering, ordering and connecting all ask
@lru_cache(maxsize=5000)
def _curves(stroke: Stroke, tolerance: float, kappa_max: float, sigma_max: float, corner: float) -> Smoothed:
    return smoothed(stroke.points[:, :2], stroke.closed, tolerance, kappa_max, sigma_max, corner)


def stops_of(stroke: Stroke, robot: Robot, options: Options) -> IntArray:
    """The vertices at which the robot stops along a stroke, in order; the ends of an open one are none."""
    curves = curves_of(stroke, robot, options)
    if curves is not None:
        return np.sort(curves.stops[0 if stroke.closed else 1 :])
    if len(stroke.points) < 3:
        return np.zeros(0, dtype=np.int64)
    tolerance = tolerance_of(options.page, robot.tool)
    found = inner_vertices(stroke.points, stroke.closed, tolerance, 0.0, options.connect.corner)
    return np.flatnonzero(found.corner) + (0 if stroke.closed else 1)


def tight_notes(
    strokes: list[Stroke], robot: Robot, options: Options, progress: ProgressCallback = silent
) -> list[Note]:
    """A notice for each element with curves too tight to be driven without stopping, or splitting, in between.

    `progress` is told how many strokes have been made curves, which takes a while where there are many.
    """
    limits, corner = work_limits(robot, options), options.connect.corner
    counts: dict[str, int] = {}
    for done, stroke in enumerate(strokes):
        if stroke.is_stop:
            continue
        progress(Progress("cover", done / len(strokes), message="curves that the robot can follow"))
        stops = stops_of(stroke, robot, options)
        ring = np.concatenate([stroke.points[-1:], stroke.closed_points])[:, :2]
        steps = np.diff(ring, axis=0)
        bend = np.abs(wrapped(np.diff(np.arctan2(steps[:, 1], steps[:, 0]))))
        counts[stroke.element] = counts.get(stroke.element, 0) + int((bend[stops] <= corner).sum())
    turns = robot.mobility.turns_on_spot and not robot.offset.aside
    does = "stops and turns" if turns else "lifts the tool and comes back"
    text = f"bends more than a radius of {1 / limits.curvature:.2g} m and a sharpness of {limits.sharpness:.2g} 1/m^2"
    return [
        Note("notice", element, f"{text} allow: the robot {does} along it", n) for element, n in counts.items() if n
    ]
