"""Facades from points measured with a total station: CSV of id, x, y, z and perhaps code and wall."""

from __future__ import annotations

import csv
import io
import math
from pathlib import Path
from typing import Any, NamedTuple

import numpy as np

from optplan.domain.arrays import BoolArray, FloatArray
from optplan.domain.errors import InputError, LimitError, located
from optplan.domain.facade import Facade, Wall
from optplan.domain.job import Note
from optplan.geometry.planes import fit_plane
from optplan.jobs.outside import Flat, Station, joined_ring, outward_sign, refuse_strangers

COLUMNS = ("id", "x", "y", "z", "code", "wall")
OUTLINE = ("", "outline", "wall", "facade")
"""Codes of corners of the outline; points of any other code are corners of the no-go area of that name."""
STATION = "station"
"""Code of a place from where walls are seen: the one of its column wall, or all; without any, (0, 0, 0)."""
BUILDING = "building"
"""Code of the corners of the building's ground plan, in their order."""
MOST_OUTLIERS = 0.25
"""Share of a wall's points that may lie outside of its plane."""
LOST = 0.01
"""Share of an area that may depend on points that are left out."""
ROUGH = 0.1
"""m, standard deviation beyond which points lie in no plane; a point that is no further off is still a corner."""
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
    stations = [Station(point.place, point.wall, point.line) for point in points if point.code == STATION]
    ground = [point.place[:2] for point in points if point.code == BUILDING]
    corners = [point for point in points if point.code not in (STATION, BUILDING)]
    if not corners:
        raise InputError("holds no points; expected lines of id, x, y, z", where)
    names = list(dict.fromkeys(point.wall for point in corners))
    notes: list[Note] = []
    with located(where):
        refuse_strangers(stations, names)
        fitted = [_fitted(name or "wall", [p for p in corners if p.wall == name], notes) for name in names]
        if len(names) == 1:  # a station that names the only wall, or none, is of that wall
            stations = [station._replace(wall="") for station in stations]
        building = _ground(ground)
        if building is None:
            building = joined_ring([flat for flat, _ in fitted], stations)
            if building is not None:
                notes.append(Note("notice", "", "the walls close around a building: what lies in it is inside"))
        walls = [_wall(flat, outward_sign(flat, stations, building), kept) for flat, kept in fitted]
        around = None if building is None else np.array(building.exterior.coords)[:-1]
        return Facade(file.stem, tuple(walls), building=around, notes=tuple(notes))


def _ground(points: list[FloatArray]) -> Any | None:
    """The ground plan (shapely) of its corners; None where there are none."""
    import shapely

    if not points:
        return None
    if len(points) < 3:
        raise InputError(f"the building has {len(points)} points; expected 3 or more corners of its ground plan")
    ring = shapely.Polygon(points)
    if not ring.is_valid:
        raise InputError("the building crosses itself; expected the corners of its ground plan in their order")
    return ring


def _parsed(text: str, where: str) -> list[Measured]:
    head = text.splitlines()[0] if text.strip() else ""
    separator = ";" if head.count(";") > head.count(",") else ","
    try:
        rows = list(csv.reader(io.StringIO(text), delimiter=separator, skipinitialspace=True))
    except csv.Error as error:
        raise InputError(f"is no CSV: {error}", where) from None
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
            unknown = [cell for cell in cells if cell.lower() not in COLUMNS]
            if unknown:
                raise InputError(
                    f"has a column {unknown[0]!r}; expected {', '.join(COLUMNS)}", f"{where}: line {number}"
                )
            continue
        if len(cells) > len(columns):
            raise InputError(
                f"has {len(cells)} cells, {','.join(cells)[:60]!r}; expected at most {len(columns)}: "
                f"{', '.join(columns)} (decimal commas need ; between cells)",
                f"{where}: line {number}",
            )
        table = dict(zip(columns, cells, strict=False))
        try:
            # between semicolons a comma is a decimal one
            place = np.array([float(table[axis].replace(",", ".")) for axis in "xyz"])
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


def _fitted(name: str, points: list[Measured], notes: list[Note]) -> tuple[Flat, list[Measured]]:
    """The plane of a wall's points, its normal to either side, and the points that are its corners."""
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
    kept = [point for k, point in enumerate(points) if not plane.outlier[k]]
    rest = plane.away[~plane.outlier]
    worst = kept[int(np.argmax(np.abs(rest)))].id
    most = 1000 * float(np.abs(rest).max())
    text = f"{len(kept)} points, {1000 * spread:.1f} mm off their plane (rms), {most:.1f} mm at point {worst}"
    notes.append(Note("notice", name, text))
    normal = _upright(plane.normal, name, notes)
    flat = Flat(name, plane.centre, normal, _ends(places, plane.centre, normal))
    # what is off by no more than a wall may be rough is a corner all the same, though it says nothing about the plane
    far = plane.outlier & (np.abs(plane.away) > ROUGH)
    lost = _refuse_lost(flat, points, far) if far.any() else ""
    for k in wrong.tolist():
        text = f"is {abs(float(plane.away[k])):.3f} m off the plane of wall {name!r}: "
        text += f"left out{lost}" if far[k] else "taken where it lies on the plane"
        where = f"point {points[k].id} (line {points[k].line})"
        notes.append(Note("ignored" if far[k] else "changed", where, text))
    return flat, [point for k, point in enumerate(points) if not far[k]]


def _ends(places: FloatArray, centre: FloatArray, normal: FloatArray) -> FloatArray:
    """(2, 2) m, where a wall begins and ends in the plan."""
    across = np.array([-normal[1], normal[0], 0.0]) / math.hypot(normal[0], normal[1])
    along = (places - centre) @ across
    ends: FloatArray = (centre + np.array([[along.min()], [along.max()]]) * across)[:, :2]
    return ends


def _frame(normal: FloatArray) -> tuple[FloatArray, FloatArray]:
    """Unit vectors across and up a wall with this normal."""
    up = np.array([0.0, 0.0, 1.0]) - normal[2] * normal
    up /= np.linalg.norm(up)
    return np.cross(up, normal), up


def _refuse_lost(flat: Flat, points: list[Measured], outlier: BoolArray) -> str:
    """What leaving points out does to the areas of a wall, in words; InputError when that is more than LOST of one."""
    across, up = _frame(flat.normal)
    told = ""
    for code in dict.fromkeys(point.code for point in points):
        own = np.array([k for k, point in enumerate(points) if point.code == code])
        ring = np.array([points[k].place - flat.centre for k in own.tolist()]) @ np.column_stack([across, up])
        gone = outlier[own]
        if not gone.any():
            continue
        what = "the outline" if code in OUTLINE else f"area {code!r}"
        all_of, left = _area(ring), _area(ring[~gone])
        if abs(all_of - left) > LOST * all_of:
            first = points[int(own[gone][0])]
            raise InputError(
                f"point {first.id} is off the plane of wall {flat.name!r}, and without it {what} has {left:.4g} m2 "
                f"instead of {all_of:.4g} m2; expected it measured again, or taken out where it is no corner",
                f"line {first.line}",
            )
        told += f"; without it {what} has {left:.4g} m2, with it {all_of:.4g} m2"
    return told


def _area(ring: FloatArray) -> float:
    x, y = ring.T
    return abs(float(x @ np.roll(y, -1) - y @ np.roll(x, -1))) / 2


def _wall(flat: Flat, sign: float, kept: list[Measured]) -> Wall:
    """A wall whose normal, times this sign, points outside."""
    name = flat.name
    across, up = _frame(sign * flat.normal)
    apart = np.array([point.place - flat.centre for point in kept])
    places = apart @ np.column_stack([across, up])
    codes = np.array([point.code for point in kept])
    areas = {code: places[codes == code] for code in dict.fromkeys(codes.tolist())}
    rings = [areas[code] for code in OUTLINE if code in areas]
    if len(rings) != 1:
        raise InputError(
            f"wall {name!r} has {len(rings)} outlines among its codes {', '.join(map(repr, areas))}; "
            f"expected one code of {', '.join(OUTLINE[1:])}, or none, for it"
        )
    low = rings[0].min(axis=0)
    holes = [(code, ring - low) for code, ring in areas.items() if code not in OUTLINE]
    few = [code for code, ring in holes if len(ring) < 3]
    if few:
        raise InputError(f"area {few[0]!r} of wall {name!r} has fewer than 3 points; expected its corners in order")
    origin = flat.centre + low[0] * across + low[1] * up
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
