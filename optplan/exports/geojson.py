"""Plans on the map: GeoJSON."""

from __future__ import annotations

import json
import math

import numpy as np

from optplan.domain.arrays import FloatArray
from optplan.domain.errors import InputError
from optplan.domain.job import Anchor, Field
from optplan.domain.path import RAISED, Path
from optplan.domain.result import Plan
from optplan.geometry.paths import along
from optplan.geometry.tools import tool_positions

DEVIATION = 1e-3
"""Between the tool's, or the robot's, curve and the chords that are written, m."""


def geojson_text(plan: Plan) -> str:
    """Marks and ways between them as lines in WGS 84 degrees (longitude, latitude), RFC 7946, in driving order.

    Raises
    ------
    InputError : the plan has no path yet, its job has no anchor, or pyproj is not installed
    """
    if plan.path is None:
        raise InputError("the plan has no path yet; run the stage connect first")
    anchor = plan.job.anchor if isinstance(plan.job, Field) else None
    if anchor is None:
        wanted = "expected a field with an anchor (optplan field --anchor)"
        raise InputError(f"{plan.job.name} lies nowhere on earth; {wanted}")
    features = []
    path = plan.path
    strokes = [] if plan.cover is None else plan.cover.strokes
    edges = np.flatnonzero(np.diff(path.stroke * 1000 + path.tool, prepend=-(10**9)))
    for order, (first, end) in enumerate(zip(edges, [*edges[1:], len(path)], strict=True)):
        points = _line(path, int(first), int(end), plan)
        if len(points) < 2:
            continue
        stroke, down = int(path.stroke[first]), bool(path.tool[first] != RAISED)
        features.append(
            {
                "type": "Feature",
                "geometry": {"type": "LineString", "coordinates": on_earth(points, anchor).tolist()},
                "properties": {
                    "order": order,
                    "kind": "mark" if down else "transit",
                    "stroke": strokes[stroke].id if 0 <= stroke < len(strokes) else None,
                    "tool": plan.robot.tool.settings[int(path.tool[first])].name,
                    "metres": round(float(path.length[first:end].sum()), 3),
                },
            }
        )
    return json.dumps({"type": "FeatureCollection", "features": features}, indent=1) + "\n"


def on_earth(points: FloatArray, anchor: Anchor) -> FloatArray:
    """Longitude and latitude (n, 2), degrees, of points (n, 2) m in the field's frame.

    The plane touches the earth at the anchor (azimuthal equidistant): 100 m from there lengths are true to a
    thousandth of a millimetre.

    Raises
    ------
    InputError : pyproj is not installed
    """
    try:
        from pyproj import Transformer
    except ImportError:
        raise InputError("places on earth need pyproj: install optplan[geo]") from None
    angle = -math.radians(anchor.bearing)
    cosine, sine = math.cos(angle), math.sin(angle)
    east, north = (points @ np.array([[cosine, sine], [-sine, cosine]])).T
    plane = f"+proj=aeqd +lat_0={anchor.latitude!r} +lon_0={anchor.longitude!r} +datum=WGS84 +units=m"
    longitude, latitude = Transformer.from_crs(plane, "EPSG:4326", always_xy=True).transform(east, north)
    made: FloatArray = np.round(np.column_stack([longitude, latitude]), 9)
    return made


def _line(path: Path, first: int, end: int, plan: Plan) -> FloatArray:
    """Points of the tool where it marks, of the robot where it does not."""
    made: list[FloatArray] = []
    for row in range(first, end):
        length = float(path.length[row])
        if length == 0:
            continue
        bend = max(abs(float(path.curvature[row])), abs(float(path.curvature[row] + length * path.sharpness[row])))
        # where the robot turns, a tool beside it goes farther than the robot does
        reach = bend * (1 + bend * math.hypot(plan.robot.offset.ahead, plan.robot.offset.right))
        count = max(1, math.ceil(length * math.sqrt(reach / (8 * DEVIATION))))
        s = np.linspace(0, length, count + 1)
        piece = np.full(count + 1, row)
        states = along(path, piece, s)
        places = states.position
        if path.tool[row] != RAISED:
            places = tool_positions(states.position, states.heading, path.gear[piece], plan.robot.offset)
        made.append(places[:, :2] if not made else places[1:, :2])
    return np.concatenate(made) if made else np.zeros((0, 2))
