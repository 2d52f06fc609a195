"""Where the centres of a wall's circles may be: the lift needs room beside other walls, and stays above the ground."""

from __future__ import annotations

import itertools
import math
from typing import Any, NamedTuple

import numpy as np

from optplan.domain.arrays import FloatArray
from optplan.domain.errors import InputError
from optplan.domain.facade import Facade, Wall
from optplan.geometry.building import open_spans, plan_in_space, ways_around
from optplan.geometry.walls import edge_before, outward, places, vertices_of

UPRIGHT = math.sin(math.radians(10))
"""Height gained a metre up a wall, below which it is a floor or a ceiling."""
FAR = 3.0
"""m that a wall may stand from the ground plan of its building."""
INSET = 0.05
"""m within which the planes of two walls are one."""


class Room(NamedTuple):
    """A part of an unrolled wall, on which centres of circles may be."""

    spans: tuple[tuple[float, float], ...] = ((-math.inf, math.inf),)
    """stretches of x, m, from left to right"""
    low: float = -math.inf
    """least y, m"""

    def nearest(self, points: FloatArray) -> FloatArray:
        """(n, 2) m, the places of the room that are nearest to points (n, 2)."""
        ends = np.array(self.spans)
        tried = np.clip(points[:, :1], ends[:, 0], ends[:, 1])
        best = np.argmin(np.abs(tried - points[:, :1]), axis=1)
        x = tried[np.arange(len(points)), best]
        return np.column_stack([x, np.maximum(points[:, 1], self.low)])

    def along_its_border(self, area: Any, radius: float) -> FloatArray:
        """(n, 2) m, centres on the border of the room that wash what lies beyond it, if they reach so far."""
        left, bottom, right, top = area.bounds
        made: list[FloatArray] = [np.zeros((0, 2))]
        inner = [x for span in self.spans for x in span]
        gaps = [(left, inner[0]), *zip(inner[1:-1:2], inner[2:-1:2], strict=True), (inner[-1], right)]
        for k, (begin, end) in enumerate(gaps):
            width = end - begin
            sides = [x for x in (begin, end) if x in inner and left < x < right]
            # both sides of a gap in the middle wash half of it
            half = width / 2 if 0 < k < len(gaps) - 1 else width
            step = _step(half, radius)
            if width > 0 and step > 0:
                heights = _spread(max(bottom, self.low), max(top, self.low), step)
                made += [np.column_stack([np.full(len(heights), x), heights]) for x in sides]
        step = _step(self.low - bottom, radius)
        if self.low > bottom and step > 0:
            x = _spread(left, right, step)
            made.append(self.nearest(np.column_stack([x, np.full(len(x), self.low)])))
        return np.concatenate(made)


def _step(width: float, radius: float) -> float:
    """Between the centres on a line of circles that wash a strip of this width beside it; 0 where they do not."""
    return 2 * math.sqrt(radius**2 - width**2) * (1 - 1e-6) if 0 <= width < radius else 0.0


def _spread(low: float, high: float, step: float) -> FloatArray:
    """Places from low to high, no further apart than the step, their ends half a step within."""
    count = max(math.ceil((high - low) / step), 1)
    return low + (high - low) * (np.arange(count) + 0.5) / count


def rooms_of(job: Facade, standoff: float, radii: list[float]) -> list[Room]:
    """The room of every wall.

    Raises InputError for a wall that faces into its building, that is far from it, or that is there twice.
    """
    for wall in job.walls:
        _refuse_tight(wall, standoff)
    ground = ground_of(job)
    lows = [lowest(wall, ground, standoff) for wall in job.walls]
    if len(job.walls) == 1 and job.building is None:
        return [Room(low=lows[0])]
    _refuse_far(job)
    _refuse_twice(job)
    around = ways_around(job, standoff)
    rooms = []
    for number, (wall, radius) in enumerate(zip(job.walls, radii, strict=True)):
        x = wall.outline[:, 0]
        low, high = float(x.min()) - radius, float(x.max()) + radius
        spans = open_spans(job, number, around, standoff, low, high)
        if not any(end > x.min() and begin < x.max() for begin, end in spans):
            raise InputError(
                f"wall {wall.name!r} faces into the building, or stands too near another wall; expected walls in their "
                "order around it, `across` to the right as seen from outside; an inner corner needs the ground plan as "
                "`building`"
            )
        rooms.append(Room(tuple(spans), lows[number]))
    return rooms


def ground_of(job: Facade) -> float:
    """Height of the ground, m: as the job says, or the lowest corner of its walls."""
    if job.ground is not None:
        return job.ground
    return min(float(places(wall, wall.outline)[:, 2].min()) for wall in job.walls)


def lowest(wall: Wall, ground: float, standoff: float) -> float:
    """Least y of a stop before a wall, m, that is not below the ground."""
    rise = float(wall.up[2])
    if rise < UPRIGHT:
        return -math.inf
    return (ground - float(wall.origin[2]) - standoff * float(outward(wall)[2])) / rise


def _refuse_tight(wall: Wall, standoff: float) -> None:
    """Raises InputError where a wall bends towards its outside more tightly than the stand-off, or faces itself."""
    import shapely

    if wall.flat:
        return
    at, plan = vertices_of(wall)
    corners, mitres = edge_before(wall, standoff)
    step = np.diff(plan, axis=0)
    size = np.hypot(*step.T)
    side = standoff * np.column_stack([-step[:, 1], step[:, 0]]) / size[:, None]
    line = np.concatenate([plan[:1] + side[:1], mitres, plan[-1:] + side[-1:]])
    # sides of the line before the wall that run backwards
    back = np.flatnonzero((np.diff(line, axis=0) * step).sum(axis=1) <= 0)
    x = float((at[back[0]] + at[back[0] + 1]) / 2) if len(back) else None
    if x is None:
        near = shapely.distance(shapely.LineString(plan), shapely.points(line))
        if near.min() < standoff * (1 - 1e-6):
            x = float(np.concatenate([at[:1], corners, at[-1:]])[int(np.argmin(near))])
    if x is not None:
        raise InputError(
            f"the plan bends more tightly, or comes nearer to itself, than the stand-off of {standoff:g} m at x = "
            f"{x:.3g} m: the lift has no room before the wall; expected wider bends, or a smaller stand-off",
            f"wall {wall.name!r}",
        )


def _refuse_far(job: Facade) -> None:
    import shapely

    if job.building is None:
        return
    ring = shapely.Polygon(job.building)
    for number, wall in enumerate(job.walls):
        away = float(shapely.distance(ring, shapely.LineString(plan_in_space(job, number))))
        if away > FAR:
            raise InputError(
                f"wall {wall.name!r} is {away:.3g} m away from the building; expected the ground plan of its walls"
            )


def _refuse_twice(job: Facade) -> None:
    import shapely

    for one, other in itertools.combinations((wall for wall in job.walls if wall.flat), 2):
        out = outward(one)
        corners = places(other, other.outline) - one.origin
        if float(out @ outward(other)) < 1 - 1e-4 or np.abs(corners @ out).max() > INSET:
            continue
        shared = shapely.Polygon(corners @ np.column_stack([one.across, one.up])).intersection(
            shapely.Polygon(one.outline)
        )
        if shared.area > INSET**2:
            raise InputError(
                f"walls {one.name!r} and {other.name!r} are in the same place: {shared.area:.3g} m2 of both; "
                "expected every part of a wall once"
            )
