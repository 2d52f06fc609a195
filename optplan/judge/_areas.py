"""Distance of the robot from areas to keep out of, and from the border of those to keep in."""

from __future__ import annotations

import math
from typing import Any

import numpy as np

from optplan.domain.job import Field, Job
from optplan.domain.options import Options
from optplan.domain.path import Path
from optplan.domain.report import Check
from optplan.domain.result import Cover
from optplan.domain.robot import DiffDrive, Robot
from optplan.judge._findings import GAP, RELATIVE, Place, count_of, held, noted, place_of
from optplan.judge._integrate import Samples

NAME = "areas"
PROBES = 64
"""Places at which the depth of a piece inside a forbidden area is measured."""


def areas(path: Path, samples: Samples, cover: Cover, options: Options, job: Job, robot: Robot) -> Check:
    """By how much the robot comes nearer than the clearance to what is forbidden, m; inside it, by the depth too.

    Connectors are held to the clearance; a field's areas bind what is marked, too, where the middle of the robot keeps
    half its track at most.
    """
    import shapely

    asked = options.connect
    field = job if isinstance(job, Field) else None
    rings = [np.array(ring) for ring in asked.keep_out]
    rooms = [] if asked.keep_in is None else [np.array(asked.keep_in)]
    if not rooms and asked.on_canvas and cover.canvas is not None:
        width, height = cover.canvas.width, cover.canvas.height
        rooms = [np.array([[0.0, 0.0], [width, 0.0], [width, height], [0.0, height]])]
    if field is not None:  # also where the options have lost them
        rings += [ring for ring in field.keep_out if tuple(map(tuple, ring.tolist())) not in asked.keep_out]
        rooms += [] if field.keep_in is None or rooms else [field.keep_in]
    if not rooms and not rings:
        return noted(NAME, 0.0, "m", "No areas are forbidden.")
    outlines = [(shapely.Polygon(ring), True) for ring in rings] + [(shapely.Polygon(room), False) for room in rooms]
    half = robot.mobility.track / 2 if isinstance(robot.mobility, DiffDrive) else math.inf
    worst, place = 0.0, None
    wrong = [0, 0]  # pieces of connectors, of marks
    judged = path.length > 0 if field is not None else (path.stroke < 0) & (path.length > 0)
    tree = shapely.STRtree([polygon for polygon, outside in outlines if outside])
    for row in np.flatnonzero(judged).tolist():
        marking = bool(path.stroke[row] >= 0)
        clearance = min(asked.clearance, half) if marking else asked.clearance
        points = samples.points[samples.first[row] : samples.first[row + 1], :2]
        line = shapely.LineString(points) if len(points) > 1 else shapely.Point(points[0])
        # what is farther away breaks nothing
        close = [outlines[k] for k in np.sort(tree.query(line, predicate="dwithin", distance=clearance)).tolist()]
        near, spot = _nearness(shapely, close + outlines[len(rings) :], line, clearance)
        wrong[marking] += near > _slack(clearance)
        if near > worst:
            worst, place = near, spot
    detail = "Connectors keep out of forbidden areas." if field is None else "The robot keeps out of forbidden areas."
    told = [f"{count_of(n, 'piece')} of {what}" for n, what in zip(wrong, ("connectors", "marks"), strict=True) if n]
    if told:
        detail = f"{' and '.join(told)} enter a forbidden area or its clearance."
    return held(NAME, worst, 0.0, "m", place, detail, slack=_slack(asked.clearance))


def _slack(clearance: float) -> float:
    return GAP + RELATIVE * clearance


def _nearness(
    shapely: Any, outlines: list[tuple[Any, bool]], line: Any, clearance: float
) -> tuple[float, Place | None]:
    """How much nearer than the clearance a chain of samples comes, m, and where."""
    worst, place = 0.0, None
    for polygon, outside in outlines:
        kept = not shapely.intersects(polygon, line) if outside else shapely.contains_properly(polygon, line)
        if kept:
            near = clearance - shapely.distance(polygon.exterior, line)
            spot = shapely.get_coordinates(shapely.shortest_line(line, polygon.exterior))[0]
        else:
            # samples of a straight piece may all lie outside, so what is wrong is cut out and sampled anew
            wrong = shapely.intersection(polygon, line) if outside else shapely.difference(line, polygon)
            wrong = shapely.boundary(polygon) if wrong.is_empty else wrong  # it touches the border
            places = shapely.get_coordinates(shapely.segmentize(wrong, wrong.length / PROBES or 1.0))
            depth = shapely.distance(polygon.exterior, shapely.points(places))
            near, spot = clearance + depth.max(), places[int(np.argmax(depth))]
        if near > worst:
            worst, place = float(near), place_of(spot)
    return worst, place
