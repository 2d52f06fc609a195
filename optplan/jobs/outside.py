"""Which side of a measured wall is its outside: seen from a station, or by the ground plan of the building."""

from __future__ import annotations

from typing import Any, NamedTuple

import numpy as np

from optplan.domain.arrays import FloatArray
from optplan.domain.errors import InputError

NEAR = 0.3
"""m within which the ends of two walls are one corner of the building."""
STEP = 0.05
"""m before a wall, and behind it, where is looked whether the building is there."""
BESIDE = 1e-3
"""m from a wall's plane within which a station is on neither side of it."""


class Station(NamedTuple):
    """A place from where walls are seen."""

    place: FloatArray
    """(3,) m"""
    wall: str
    """the wall that is seen; "": any"""
    line: int
    """of the file; 0: nobody has given it"""


class Flat(NamedTuple):
    """A measured wall before it is known which of its sides is outside."""

    name: str
    centre: FloatArray
    """(3,) m"""
    normal: FloatArray
    """(3,) unit vector, to either side"""
    ends: FloatArray
    """(2, 2) m, in the plan"""


def outward_sign(wall: Flat, stations: list[Station], building: Any | None) -> float:
    """1 when a wall's normal points outside, else -1.

    Its own station decides; without one the building (shapely), where the wall is part of it; then all other stations.

    Raises InputError where stations see a wall from both sides, or along it.
    """
    own = [station for station in stations if station.wall == wall.name]
    if not own and building is not None:
        sides = [_in(building, wall, sign) for sign in (1.0, -1.0)]
        if sides[0] != sides[1]:
            return -1.0 if sides[0] else 1.0
    seen = own or [station for station in stations if not station.wall] or [Station(np.zeros(3), "", 0)]
    away = [float((station.place - wall.centre) @ wall.normal) for station in seen]
    for station, distance in zip(seen, away, strict=True):
        if abs(distance) <= BESIDE:
            place = f"the station of line {station.line}" if station.line else "(0, 0, 0), where no station is given,"
            raise InputError(
                f"{place} lies in the plane of wall {wall.name!r}; expected a point of code station before the wall"
            )
        if distance * away[0] < 0:
            raise InputError(
                f"the stations of lines {seen[0].line} and {station.line} see wall {wall.name!r} from both sides; "
                "expected in their column wall which wall they see, or points of code building around its ground plan"
            )
    return 1.0 if away[0] > 0 else -1.0


def refuse_strangers(stations: list[Station], names: list[str]) -> None:
    """Raises InputError for a station of a wall that has no points."""
    for station in stations:
        if station.wall and station.wall not in names:
            known = ", ".join(name for name in names if name)
            raise InputError(
                f"is a station of wall {station.wall!r}, which has no points; expected one of {known or 'no wall'}",
                f"line {station.line}",
            )


def joined_ring(walls: list[Flat], stations: list[Station]) -> Any | None:
    """The building (shapely) around which walls, in their order, close; None where they do not.

    None, too, where a station that is of no one wall stands inside: then the walls are those of a courtyard.
    """
    import shapely

    if len(walls) < 3:
        return None
    corners = []
    for wall, following in zip(walls, [*walls[1:], walls[0]], strict=True):
        apart = np.linalg.norm(wall.ends[:, None] - following.ends[None], axis=2)
        if apart.min() > NEAR:
            return None
        i, j = np.unravel_index(int(np.argmin(apart)), apart.shape)
        corners.append((wall.ends[i] + following.ends[j]) / 2)
    ring = shapely.Polygon(corners)
    if not ring.is_valid or ring.area < NEAR**2:
        return None
    within = any(shapely.contains_xy(ring, *station.place[:2]) for station in stations if not station.wall)
    return None if within else ring


def _in(building: Any, wall: Flat, sign: float) -> bool:
    import shapely

    place = wall.ends.mean(axis=0) + sign * STEP * wall.normal[:2] / max(float(np.hypot(*wall.normal[:2])), 1e-9)
    return bool(shapely.contains_xy(building, *place))
