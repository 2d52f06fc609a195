"""Facades from points measured with a total station: CSV of id, x, y, z and perhaps code and wall."""

from __future__ import annotations

import csv
import io
import math
from pathlib import Path
from typing import NamedTuple

import numpy as np

from optplan.domain.arrays import FloatArray
from optplan.domain.errors import InputError, LimitError, located
from optplan.domain.facade import Facade, Wall
from optplan.domain.job import Note
from optplan.geometry.planes import fit_plane

COLUMNS = ("id", "x", "y", "z", "code", "wall")
OUTLINE = ("", "outline", "wall", "facade")
"""Codes of corners of the outline; points of any other code are corners of the no-go area of that name."""
STATION = "station"
"""Code of the place from where the walls are seen; without it, (0, 0, 0)."""
MOST_OUTLIERS = 0.25
"""Share of a wall's points that may lie outside of its plane."""
ROUGH = 0.1
"""m, standard deviation beyond which points lie in no plane."""
UPRIGHT = math.radians(2)
"""A wall that leans by less is taken as upright."""
MOST_POINTS = 10_000


class Measured(NamedTuple):
    """A point."""

    id: str
    place: FloatArray
    code: str
    wall: str
    line: int


def read_measured(file: Path) -> Facade:
    """The facade of measured corners: each wall a plane through its points, its corners in the order of the file.

    Points that lie outside of their wall's plane are left out and named; residuals are in the notes.

    Raises
    ------
    InputError : no such file, a line that is no point, points in no plane, or corners that make no polygon
    """
    from optplan.schema.files import read_text

    where = str(file)
    points = _parsed(read_text(file), where)
    seen = [point.place for point in points if point.code == STATION]
    station = seen[0] if seen else np.zeros(3)
    corners = [point for point in points if point.code != STATION]
    notes: list[Note] = []
    walls = []
    for name in dict.fromkeys(point.wall for point in corners):
        with located(where):
            walls.append(_wall(name or "wall", [p for p in corners if p.wall == name], station, notes))
    if not walls:
        raise InputError("holds no points; expected lines of id, x, y, z", where)
    with located(where):
        return Facade(file.stem, tuple(walls), notes=tuple(notes))


def _parsed(text: str, where: str) -> list[Measured]:
    head = text.splitlines()[0] if text.strip() else ""
    separator = ";" if head.count(";") > head.count(",") else ","
    rows = list(csv.reader(io.StringIO(text), delimiter=separator, skipinitialspace=True))
    columns = list(COLUMNS)
    points: list[Measured] = []
    if len(rows) > MOST_POINTS:
        raise LimitError(f"holds {len(rows)} lines; at most {MOST_POINTS} points are taken", where)
    for number, row in enumerate(rows, start=1):
        cells = [cell.strip() for cell in row]
        if not any(cells) or cells[0].startswith("#"):
            continue
        if not points and {"x", "y", "z"} <= {cell.lower() for cell in cells}:
            columns = [cell.lower() for cell in cells]
            continue
        table = dict(zip(columns, cells, strict=False))
        try:
            place = np.array([float(table[axis]) for axis in "xyz"])
        except (KeyError, ValueError):
            place = np.full(3, np.nan)
        if not (np.abs(place) < 1e7).all():
            raise InputError(
                f"is {','.join(cells)[:60]!r}; expected id, x, y, z in m [, code [, wall]]", f"{where}: line {number}"
            )
        points.append(
            Measured(table.get("id", str(number)), place, table.get("code", "").lower(), table.get("wall", ""), number)
        )
    return points


def _wall(name: str, points: list[Measured], station: FloatArray, notes: list[Note]) -> Wall:
    if len(points) < 3:
        raise InputError(f"wall {name!r} has {len(points)} points; expected 3 or more")
    places = np.array([point.place for point in points])
    plane = fit_plane(places)
    wrong = np.flatnonzero(plane.outlier)
    spread = float(np.sqrt((plane.away[~plane.outlier] ** 2).mean())) if not plane.outlier.all() else math.inf
    if len(wrong) > MOST_OUTLIERS * len(points) or spread > ROUGH or not plane.normal.any():
        named = ", ".join(points[k].id for k in wrong[:5].tolist())
        off = f": {len(wrong)} of {len(points)} are off ({named})" if named else ""
        raise InputError(f"the points of wall {name!r} lie in no plane{off}")
    for k in wrong.tolist():
        text = f"is {abs(float(plane.away[k])):.3f} m off the plane of wall {name!r}: left out"
        notes.append(Note("ignored", f"point {points[k].id} (line {points[k].line})", text))
    kept = [point for k, point in enumerate(points) if not plane.outlier[k]]
    rest = plane.away[~plane.outlier]
    worst = kept[int(np.argmax(np.abs(rest)))].id
    most = 1000 * float(np.abs(rest).max())
    text = f"{len(kept)} points, {1000 * spread:.1f} mm off their plane (rms), {most:.1f} mm at point {worst}"
    notes.append(Note("notice", name, text))
    normal = plane.normal if (station - plane.centre) @ plane.normal >= 0 else -plane.normal
    normal = _upright(normal, name, notes)
    up = np.array([0.0, 0.0, 1.0]) - normal[2] * normal
    up /= np.linalg.norm(up)
    across = np.cross(up, normal)
    apart = np.array([point.place - plane.centre for point in kept])
    places = apart @ np.column_stack([across, up])
    codes = np.array([point.code for point in kept])
    flat = {code: places[codes == code] for code in dict.fromkeys(codes.tolist())}
    rings = [flat[code] for code in OUTLINE if code in flat]
    if len(rings) != 1:
        raise InputError(
            f"wall {name!r} has {len(rings)} outlines; expected one code of {', '.join(OUTLINE[1:])}, or none, for it"
        )
    low = rings[0].min(axis=0)
    holes = [(code, ring - low) for code, ring in flat.items() if code not in OUTLINE]
    few = [code for code, ring in holes if len(ring) < 3]
    if few:
        raise InputError(f"area {few[0]!r} of wall {name!r} has fewer than 3 points; expected its corners in order")
    origin = plane.centre + low[0] * across + low[1] * up
    return Wall(name, rings[0] - low, tuple(ring for _, ring in holes), None, origin, across, up)


def _upright(normal: FloatArray, name: str, notes: list[Note]) -> FloatArray:
    """The normal of a wall that leans a little, levelled."""
    lean = abs(math.asin(float(np.clip(normal[2], -1, 1))))
    if lean > math.radians(80):
        raise InputError(f"the points of wall {name!r} lie in a level plane; expected a wall")
    if not 0 < lean < UPRIGHT:
        return normal
    if lean > 1e-6:
        notes.append(Note("changed", name, f"leans by {math.degrees(lean):.2f} degrees: taken as upright"))
    level = np.array([normal[0], normal[1], 0.0])
    level /= np.linalg.norm(level)
    return level
