"""Strokes that a robot can drive in one go: split at corners where it may not turn on the spot."""

from __future__ import annotations

import math
from dataclasses import replace
from itertools import pairwise

import numpy as np

from optplan.domain.job import Note
from optplan.domain.options import Options
from optplan.domain.robot import Robot
from optplan.domain.stroke import Stroke
from optplan.geometry.rounding import inner_vertices

CREEP = 0.25
"""Share of the work speed to which a robot slows down for a tight curve before it gives up following it."""


def least_radius(robot: Robot, options: Options) -> float:
    """Radius of the tightest arc the robot follows with its tool down, m."""
    speed = options.time.work_speed or robot.mobility.work_speed
    curvature = robot.mobility.curvature_limits(CREEP * speed).curvature
    return 1 / curvature if curvature > 0 else math.inf


def split_at_corners(
    strokes: list[Stroke], robot: Robot, options: Options, tolerance: float
) -> tuple[list[Stroke], list[int]]:
    """Strokes without corners, for a robot that cannot turn on the spot; other robots get them as they are.

    Returns
    -------
    parts : what the strokes are split into, in their order
    source : of each part, the index of the stroke that it is a part of
    """
    if robot.mobility.turns_on_spot:
        return strokes, list(range(len(strokes)))
    radius = least_radius(robot, options)
    parts = [_split(stroke, tolerance, radius, options.connect.corner) for stroke in strokes]
    return [part for own in parts for part in own], [k for k, own in enumerate(parts) for _ in own]


def tight_notes(strokes: list[Stroke], robot: Robot, options: Options, tolerance: float) -> list[Note]:
    """A notice for each element with curves too tight to be driven without stopping, or splitting, in between."""
    radius, corner = least_radius(robot, options), options.connect.corner
    stops: dict[str, int] = {}
    for stroke in strokes:
        if len(stroke.points) > 2:
            vertices = inner_vertices(stroke.points, stroke.closed, tolerance, radius, corner)
            count = int((vertices.corner & (np.abs(vertices.deflection) <= corner)).sum())
            stops[stroke.element] = stops.get(stroke.element, 0) + count
    does = "stops and turns" if robot.mobility.turns_on_spot else "lifts the tool and comes back"
    text = f"curves tighter than a radius of {radius:.2g} m: the robot {does} along them"
    return [Note("notice", element, text, count) for element, count in stops.items() if count]


def _split(stroke: Stroke, tolerance: float, radius: float, corner: float) -> list[Stroke]:
    if len(stroke.points) < 3:
        return [stroke]
    sharp = np.flatnonzero(inner_vertices(stroke.points, stroke.closed, tolerance, radius, corner).corner)
    if len(sharp) == 0:
        return [stroke]
    if stroke.closed:  # begin at a corner, and come back to it
        points = np.roll(stroke.points, -int(sharp[0]), axis=0)
        points = np.concatenate([points, points[:1]])
        cuts = [0, *(sharp[1:] - sharp[0]).tolist(), len(points) - 1]
    else:
        points = stroke.points
        cuts = [0, *(sharp + 1).tolist(), len(points) - 1]
    return [
        replace(stroke, id=f"{stroke.id}~{k}", points=points[a : b + 1], closed=False, entry=None)
        for k, (a, b) in enumerate(pairwise(cuts), start=1)
    ]
