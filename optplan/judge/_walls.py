"""The judge's own geometry of walls: where a stop is on its wall, and how far its arm has to reach."""

from __future__ import annotations

import math
from typing import Any, NamedTuple

import numpy as np

from optplan.domain.arrays import FloatArray
from optplan.domain.facade import Facade, Wall
from optplan.domain.result import Cover


class OnWall(NamedTuple):
    """A stop before its wall."""

    wall: int
    """number of the wall; -1 when it is none of the job's"""
    x: float
    y: float
    """m, on the wall"""
    standoff: float
    """m, from the wall along its normal"""
    slant: float
    """length of the difference of the stop's normal from the wall's"""


def on_walls(job: Facade, cover: Cover) -> list[OnWall]:
    """Every stop on the wall that it names."""
    numbers = {wall.name: k for k, wall in enumerate(job.walls)}
    found = []
    for stroke in cover.strokes:
        number = numbers.get(stroke.element, -1)
        if number < 0 or stroke.normals is None or stroke.points.shape[1] != 3:
            found.append(OnWall(-1, 0.0, 0.0, math.nan, math.nan))
        else:
            found.append(_on_wall(job.walls[number], number, stroke.points[0], stroke.normals[0]))
    return found


def _sides(wall: Wall) -> list[tuple[float, FloatArray, FloatArray, float]]:
    """Sides of the plan: x where it begins, its first point, its direction, its length (infinite for a flat wall)."""
    if wall.plan is None:
        return [(0.0, np.zeros(2), np.array([1.0, 0.0]), math.inf)]
    sides, gone = [], 0.0
    for a, b in zip(wall.plan[:-1], wall.plan[1:], strict=True):
        length = float(math.dist(a, b))
        sides.append((gone, a, (b - a) / length, length))
        gone += length
    return sides


def _on_wall(wall: Wall, number: int, foot: FloatArray, facing: FloatArray) -> OnWall:
    """On the side of the plan whose normal is that of the stop."""
    out = np.cross(wall.across, wall.up)
    apart = foot - wall.origin
    flat = np.array([apart @ wall.across, apart @ out])
    best = OnWall(number, 0.0, 0.0, math.nan, math.inf)
    least = math.inf
    sides = _sides(wall)
    for k, (begin, first, way, length) in enumerate(sides):
        normal = np.array([-way[1], way[0]])
        along, away = float((flat - first) @ way), float((flat - first) @ normal)
        slant = float(np.linalg.norm(normal[0] * wall.across + normal[1] * out - facing))
        beyond = max(-along if k else 0.0, along - length if k + 1 < len(sides) else 0.0, 0.0)
        if slant * 1e3 + beyond < least:
            least = slant * 1e3 + beyond
            best = OnWall(number, begin + along, float(apart @ wall.up), away, slant)
    return best


def farthest(wall: Wall, stop: OnWall, radius: float) -> float:
    """Greatest distance (m) from a stop's foot to a point of its circle on the wall, rolled up again.

    Squared it is D(a) + radius^2 - a^2 for the points of the circle's border that are a m beside it, D the distance
    squared in the plan. D(a) - a^2 is linear along each side of the plan: its vertices have the largest.
    """
    sides = _sides(wall)
    home = max((s for s in sides if s[0] <= stop.x + 1e-9), key=lambda s: s[0], default=sides[0])
    begin, first, way, _ = home
    foot = first + (stop.x - begin) * way + stop.standoff * np.array([-way[1], way[0]])
    worst = stop.standoff**2
    for begin, first, _, _ in sides[1:]:
        beside = begin - stop.x
        if abs(beside) < radius:
            worst = max(worst, float(((first - foot) ** 2).sum()) - beside**2)
    for end in (stop.x - radius, stop.x + radius):
        for begin, first, way, length in sides:
            if begin < end < begin + length:
                place = first + (end - begin) * way
                worst = max(worst, float(((place - foot) ** 2).sum()) - radius**2)
    return math.sqrt(worst + radius**2)


def radii_of(job: Facade, cover: Cover, placed: list[OnWall], reach: float) -> FloatArray:
    """(n,) m, of the circles of stops: as the plan says, or else what the arm reaches there, and the job asks for."""
    if cover.radii:
        return np.array(cover.radii)
    most = math.inf if job.radius is None else job.radius
    return np.array([min(_reached(job.walls[p.wall], p, reach), most) if p.wall >= 0 else 0.0 for p in placed])


def _reached(wall: Wall, stop: OnWall, reach: float) -> float:
    """Greatest radius (m) of a circle around a stop's place that is within reach of its foot."""
    if not abs(stop.standoff) < reach:
        return 0.0
    low, high = 0.0, math.sqrt(reach**2 - stop.standoff**2)
    if farthest(wall, stop, high) <= reach * (1 + 1e-12):
        return high
    for _ in range(50):
        middle = (low + high) / 2
        low, high = (middle, high) if farthest(wall, stop, middle) <= reach else (low, middle)
    return low


def washable(wall: Wall) -> Any:
    """What is to be washed of a wall (shapely)."""
    import shapely

    area = shapely.Polygon(wall.outline)
    for ring in wall.no_go:
        area = area.difference(shapely.make_valid(shapely.Polygon(ring)))
    return area
