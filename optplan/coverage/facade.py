"""A facade's stops: circles that wash its walls, and what the water asks of their order."""

from __future__ import annotations

import math
from typing import Any

import numpy as np

from optplan.coverage.circles import Circles, bare_parts, fewest_circles
from optplan.coverage.room import UPRIGHT, Room, rooms_of
from optplan.domain.arrays import FloatArray, IntArray
from optplan.domain.errors import InputError, LimitError, located
from optplan.domain.facade import Facade, Wall
from optplan.domain.job import Note
from optplan.domain.options import Options
from optplan.domain.ordering import precedence_cycle
from optplan.domain.progress import Progress, ProgressCallback
from optplan.domain.result import Cover
from optplan.domain.robot import Boom, Robot
from optplan.domain.stroke import Stroke
from optplan.domain.washing import WashOptions
from optplan.geometry.visibility import MOST_CORNERS
from optplan.geometry.walls import normals, places, reach_radius
from optplan.ordering.circles import lower_first

LEVEL = 0.25
"""Stops within this share of the distance between rows are in the same row."""
SLACK = 1e-9
"""Share by which a radius may exceed the reach by rounding."""


def boom_of(job: Facade, robot: Robot) -> Boom:
    """The robot's boom; InputError for a robot that has none."""
    if not isinstance(robot.mobility, Boom):
        raise InputError(
            f"a facade is washed by a boom lift, which {robot.name} is not; expected boom-washer", job.name
        )
    return robot.mobility


def cover_facade(job: Facade, robot: Robot, options: Options, progress: ProgressCallback) -> Cover:
    """Stops, their radii and the rule of order. Raises InputError; see `cover`."""
    boom, wash = boom_of(job, robot), options.wash
    strokes: list[Stroke] = []
    rules: list[tuple[int, int]] = []
    radii: list[float] = []
    notes: list[Note] = []
    _refuse_floors(job, wash)
    _refuse_many_corners(job, wash)
    sizes = [radius_of(job, wall, boom) for wall in job.walls]
    with located(job.name):
        rooms = rooms_of(job, boom.standoff, sizes)
    for number, (wall, radius) in enumerate(zip(job.walls, sizes, strict=True)):
        progress(Progress("cover", number / len(job.walls), message=wall.name))
        with located(f"wall {wall.name!r}"):
            points = _stops(wall, radius, wash, rooms[number], notes)
            pairs = precedence_of(points, radius, wash, job)
        with located(job.name):
            _refuse_cycle(pairs, len(points), wall)
        before = f"{wall.name}-" if len(job.walls) > 1 else ""
        first, feet = len(strokes), places(wall, points, boom.standoff)
        facing = normals(wall, points[:, 0])
        strokes += [
            Stroke(f"{before}{k + 1}", feet[k : k + 1], normals=facing[k : k + 1], dwell=boom.dwell, element=wall.name)
            for k in range(len(points))
        ]
        radii += [radius] * len(points)
        rules += [(a + first, b + first) for a, b in pairs.tolist()]
    progress(Progress("cover", 1.0, message=f"{len(strokes)} stops"))
    return Cover(tuple(strokes), precedence=tuple(rules), notes=tuple(notes), radii=tuple(radii))


def radius_of(job: Facade, wall: Wall, boom: Boom) -> float:
    """Of the circles of a wall, m.

    Raises InputError when the arm does not reach so far, or when the job asks for more than its largest wall.
    """
    with located(f"wall {wall.name!r}"):
        most = reach_radius(wall, boom.reach, boom.standoff)
        radius = most if job.radius is None else job.radius
        if job.radius is not None:
            largest = max((np.ptp(one.outline, axis=0) for one in job.walls), key=lambda size: math.hypot(*size))
            if radius > math.hypot(*largest):
                raise InputError(
                    f"a circle radius of {radius:g} m is more than the wall of {largest[0]:g} x {largest[1]:g} m; "
                    "expected less"
                )
        if not 0 < radius <= most * (1 + SLACK):
            bent = "" if wall.flat else " everywhere on this bent wall"
            raise InputError(
                f"circles of {radius:g} m: an arm that reaches {boom.reach:g} m from {boom.standoff:g} m before the "
                f"wall washes {most:.4g} m{bent}; expected no more, or a nearer stand-off"
            )
        return radius


def _refuse_floors(job: Facade, wash: WashOptions) -> None:
    """Raises InputError where water does not run down a wall, so that no rule of order makes sense."""
    for wall in job.walls:
        if wash.rule != "none" and float(wall.up[2]) < UPRIGHT:
            up = ", ".join(f"{value:g}" for value in wall.up.tolist())
            raise InputError(
                f"its up ({up}) does not point upwards, from where the water runs; expected a positive third number, "
                "or the rule 'none'",
                f"wall {wall.name!r}",
            )


def _refuse_many_corners(job: Facade, wash: WashOptions) -> None:
    """Raises LimitError, before the work of covering, where the ways around no-go areas would have too many corners."""
    import shapely

    if wash.travel != "around":
        return
    for wall in job.walls:
        joined = shapely.union_all([shapely.make_valid(shapely.Polygon(ring)) for ring in wall.no_go])
        count = len(np.unique(shapely.get_coordinates(joined), axis=0))
        if count > MOST_CORNERS:
            raise LimitError(
                f"its no-go areas have {count} corners, around which ways are looked for; at most {MOST_CORNERS}: "
                "simplify them, or travel 'lift' or 'straight'",
                f"wall {wall.name!r}",
            )


def region_of(wall: Wall) -> Any:
    """What is to be washed, as a shapely area. Raises InputError when nothing is left."""
    import shapely

    outline = shapely.Polygon(wall.outline)
    if not outline.is_valid:
        raise InputError(f"the outline is no simple polygon ({shapely.is_valid_reason(outline)})")
    holes = [shapely.make_valid(shapely.Polygon(ring)) for ring in wall.no_go]
    area = outline.difference(shapely.union_all(holes)) if holes else outline
    if area.area <= 1e-9 * outline.area:
        raise InputError("the no-go areas leave nothing to wash")
    return area


def _stops(wall: Wall, radius: float, wash: WashOptions, room: Room, notes: list[Note]) -> FloatArray:
    """(n, 2) m, from the bottom up and from left to right."""
    area = region_of(wall)
    if wall.stops is not None:
        points = np.asarray(wall.stops)
        bare = bare_parts(area, points, radius)
        if bare is not None:
            left, (x, y) = bare
            told = f"as they are given leave {_size(left)} unwashed, most of it near ({x:.1f}, {y:.1f})"
        else:
            told = "as they are given"
        notes.append(Note("notice", wall.name, f"{_count(len(points))} {told}"))
    else:
        if wash.tolerance >= radius:
            raise InputError(f"a tolerance of {wash.tolerance:g} m leaves nothing of circles of {radius:g} m radius")
        found = fewest_circles(area, radius - wash.tolerance, wash, room)
        points = found.centres
        notes.append(Note("notice", wall.name, _told(found)))
    # rows count as level though rounding may lift one end of them
    return points[np.lexsort((points[:, 0], np.round(points[:, 1], 6)))]


def _size(area: float) -> str:
    return f"{area:.3g} m2" if area >= 0.01 else f"{1e4 * area:.2g} cm2"


def _count(stops: int) -> str:
    return "1 stop" if stops == 1 else f"{stops} stops"


def _told(found: Circles) -> str:
    if len(found.centres) == 1:
        return "1 stop washes all of it"
    text = f"{len(found.centres)} stops, from a pattern {found.laid}"
    if found.bound >= len(found.centres):
        return f"{text}: proved the fewest of {found.candidates} candidate positions"
    if found.bound:
        return f"{text}; {found.bound} or more of {found.candidates} candidate positions are needed"
    return text


def precedence_of(points: FloatArray, radius: float, wash: WashOptions, job: Facade) -> IntArray:
    """Pairs (k, 2) of stops (n, 2): the first before the second."""
    seen = points if wash.direction == "up" else points * np.array([1.0, -1.0])
    if wash.rule == "none" or len(points) < 2:
        return np.zeros((0, 2), dtype=np.int64)
    if wash.rule == "rows":
        return _row_after_row(seen, radius)
    tau = job.tau if wash.tau is None else wash.tau
    width = job.width if wash.width is None else wash.width
    pairs = lower_first(seen, tau * radius, width * radius)
    others: IntArray = pairs[pairs[:, 0] != pairs[:, 1]]
    return others


def _row_after_row(points: FloatArray, radius: float) -> IntArray:
    """Every stop of a row before every stop of the next one; rows are apart by a quarter of the radius or more."""
    order = np.argsort(points[:, 1], kind="stable")
    new = np.diff(points[order, 1]) > LEVEL * radius
    row = np.empty(len(points), dtype=np.int64)
    row[order] = np.concatenate([[0], np.cumsum(new)])
    pairs: IntArray = np.argwhere(row[:, None] + 1 == row).astype(np.int64)
    return pairs


def _refuse_cycle(pairs: IntArray, count: int, wall: Wall) -> None:
    cycle = precedence_cycle(count, pairs)
    if cycle:
        names = " before ".join(str(k + 1) for k in cycle[:5])
        raise InputError(
            f"the rule of order contradicts itself on wall {wall.name!r}: stop {names}; expected tau above 0", "wash"
        )
