"""Distance of connectors from areas to keep out of, and from the border of those to keep in."""

from __future__ import annotations

from typing import Any

import numpy as np

from optplan.domain.arrays import FloatArray
from optplan.domain.options import Options
from optplan.domain.path import Path
from optplan.domain.report import Check
from optplan.domain.result import Cover
from optplan.judge._findings import GAP, RELATIVE, Place, count_of, held, noted, place_of
from optplan.judge._integrate import Samples

NAME = "areas"


def areas(path: Path, samples: Samples, cover: Cover, options: Options) -> Check:
    """By how much connectors come nearer than the clearance to what is forbidden, m; inside it, by the depth too."""
    import shapely

    asked = options.connect
    rings = [np.array(ring) for ring in asked.keep_out]
    room = None if asked.keep_in is None else np.array(asked.keep_in)
    if room is None and asked.on_canvas and cover.canvas is not None:
        width, height = cover.canvas.width, cover.canvas.height
        room = np.array([[0.0, 0.0], [width, 0.0], [width, height], [0.0, height]])
    if room is None and not rings:
        return noted(NAME, 0.0, "m", "No areas are forbidden.")
    outlines = [(shapely.Polygon(ring), True) for ring in rings]
    if room is not None:
        outlines.append((shapely.Polygon(room), False))
    worst, place, wrong = 0.0, None, 0
    between = (path.stroke < 0) & (path.length > 0)
    for row in np.flatnonzero(between).tolist():
        points = samples.points[samples.first[row] : samples.first[row + 1], :2]
        near, spot = _nearness(shapely, outlines, points, asked.clearance)
        wrong += near > _slack(asked.clearance)
        if near > worst:
            worst, place = near, spot
    detail = "Connectors keep out of forbidden areas."
    if wrong:
        detail = f"{count_of(wrong, 'piece')} of connectors enter a forbidden area or its clearance."
    return held(NAME, worst, 0.0, "m", place, detail, slack=_slack(asked.clearance))


def _slack(clearance: float) -> float:
    return GAP + RELATIVE * clearance


def _nearness(
    shapely: Any, outlines: list[tuple[Any, bool]], points: FloatArray, clearance: float
) -> tuple[float, Place | None]:
    """How much nearer than the clearance a chain of samples comes, m, and where."""
    line = shapely.LineString(points) if len(points) > 1 else shapely.Point(points[0])
    worst, place = 0.0, None
    for polygon, outside in outlines:
        kept = not shapely.intersects(polygon, line) if outside else shapely.contains_properly(polygon, line)
        if kept:
            near = clearance - shapely.distance(polygon.exterior, line)
            spot = shapely.get_coordinates(shapely.shortest_line(line, polygon.exterior))[0]
        else:
            places = shapely.points(points)
            wrong = shapely.intersects(polygon, places) == outside
            depth = np.where(wrong, shapely.distance(polygon.exterior, places), 0.0)
            near, spot = clearance + depth.max(), points[int(np.argmax(depth))]
        if near > worst:
            worst, place = float(near), place_of(spot)
    return worst, place
