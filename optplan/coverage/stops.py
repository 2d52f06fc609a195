"""Where a robot has to stop along its strokes: as curves that it can follow, and split where it may not turn."""

from __future__ import annotations

import math
from dataclasses import replace
from functools import lru_cache
from itertools import pairwise

import numpy as np

from optplan.domain.arrays import IntArray
from optplan.domain.job import Note
from optplan.domain.options import Options, PageOptions
from optplan.domain.progress import Progress, ProgressCallback, silent
from optplan.domain.robot import CurvatureLimits, Robot, Tool
from optplan.domain.stroke import Stroke
from optplan.geometry.rounding import inner_vertices, wrapped
from optplan.geometry.smoothing import Smoothed, smoothed

CREEP = 0.25
"""Share of the work speed to which a robot slows down for a tight curve before it gives up following it."""


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
    return _curves(stroke, tolerance, *work_limits(robot, options), options.connect.corner)


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


def split_at_stops(strokes: list[Stroke], robot: Robot, options: Options) -> tuple[list[Stroke], list[int]]:
    """Strokes without stops, for a robot that cannot turn on the spot; other robots get them as they are.

    Returns
    -------
    parts : what the strokes are split into, in their order
    source : of each part, the index of the stroke that it is a part of
    """
    if robot.mobility.turns_on_spot:
        return strokes, list(range(len(strokes)))
    parts = [_split(stroke, stops_of(stroke, robot, options)) for stroke in strokes]
    return [part for own in parts for part in own], [k for k, own in enumerate(parts) for _ in own]


def tight_notes(
    strokes: list[Stroke], robot: Robot, options: Options, progress: ProgressCallback = silent
) -> list[Note]:
    """A notice for each element with curves too tight to be driven without stopping, or splitting, in between.

    `progress` is told how many strokes have been made curves, which takes a while where there are many.
    """
    limits, corner = work_limits(robot, options), options.connect.corner
    counts: dict[str, int] = {}
    for done, stroke in enumerate(strokes):
        progress(Progress("cover", done / len(strokes), message="curves that the robot can follow"))
        stops = stops_of(stroke, robot, options)
        ring = np.concatenate([stroke.points[-1:], stroke.closed_points])[:, :2]
        steps = np.diff(ring, axis=0)
        bend = np.abs(wrapped(np.diff(np.arctan2(steps[:, 1], steps[:, 0]))))
        counts[stroke.element] = counts.get(stroke.element, 0) + int((bend[stops] <= corner).sum())
    does = "stops and turns" if robot.mobility.turns_on_spot else "lifts the tool and comes back"
    text = f"bends more than a radius of {1 / limits.curvature:.2g} m and a sharpness of {limits.sharpness:.2g} 1/m^2"
    return [
        Note("notice", element, f"{text} allow: the robot {does} along it", n) for element, n in counts.items() if n
    ]


def _split(stroke: Stroke, stops: IntArray) -> list[Stroke]:
    if len(stops) == 0:
        return [stroke]
    if stroke.closed:  # begin at a stop, and come back to it
        points = np.roll(stroke.points, -int(stops[0]), axis=0)
        points = np.concatenate([points, points[:1]])
        cuts = [0, *(stops[1:] - stops[0]).tolist(), len(points) - 1]
    else:
        points = stroke.points
        cuts = [0, *stops.tolist(), len(points) - 1]
    return [
        replace(stroke, id=f"{stroke.id}~{k}", points=points[a : b + 1], closed=False, entry=None)
        for k, (a, b) in enumerate(pairwise(cuts), start=1)
    ]
