"""How a boom lift moves from stop to stop before the walls of a building, and what that costs.

On one wall it moves along it at its stand-off, in straight lines: across no-go areas, around them, or further away from
the wall where it passes them. From wall to wall it moves around the building. On the way its height changes evenly.
"""

from __future__ import annotations

import itertools
import math
from functools import cached_property
from typing import Any, NamedTuple

import numpy as np

from optplan.coverage.room import ground_of, lowest
from optplan.domain.arrays import FloatArray, IntArray
from optplan.domain.costs import ArcCosts, EuclidCosts, MatrixCosts
from optplan.domain.errors import InputError
from optplan.domain.facade import Facade
from optplan.domain.options import Options
from optplan.domain.result import Cover
from optplan.domain.robot import Boom, Robot
from optplan.geometry.building import SAME, ways_around
from optplan.geometry.visibility import MOST_CORNERS, Ways
from optplan.geometry.walls import edge_before, lifted, normals, places, unrolled, vertices_of

MOST_BESIDE = 100.0
"""m beside or above the first wall at which a lift may start."""


class AxisLimits(NamedTuple):
    """What a boom can do along straight lines."""

    speed: FloatArray
    """(n,) m/s"""
    acceleration: FloatArray
    """(n,) m/s^2"""


def axis_limits(steps: FloatArray, normal: FloatArray, up: FloatArray, boom: Boom, most: float) -> AxisLimits:
    """Limits along lines: every axis keeps to its own, and all of them begin and end together.

    steps : (n, 3) m, not zero; normal, up : (n, 3) of the wall; most : m/s along the line
    """
    unit = steps / np.linalg.norm(steps, axis=1)[:, None]
    high, away = np.abs((unit * up).sum(axis=1)), np.abs((unit * normal).sum(axis=1))
    across = np.sqrt(np.maximum(1 - high**2 - away**2, 0.0))
    share = np.column_stack([across, high, away])
    share[share < 1e-9] = 0.0
    with np.errstate(divide="ignore"):
        speed = (np.array(boom.speeds) / share).min(axis=1)
    return AxisLimits(np.minimum(speed, most), boom.acceleration / share.max(axis=1))


def rest_to_rest(length: FloatArray, limits: AxisLimits) -> FloatArray:
    """(n,) s for lines of these lengths (n,) m from rest to rest."""
    speed, rate = limits
    short = length * rate < speed**2
    times: FloatArray = np.where(short, 2 * np.sqrt(length / rate), length / speed + speed / rate)
    return times


class Travel:
    """Moves between the stops of a facade.

    Parameters
    ----------
    job, cover, robot, options : whose stops, and how they are moved between

    Raises
    ------
    InputError : a robot without a boom, or a wall that faces into its building
    """

    def __init__(self, job: Facade, cover: Cover, robot: Robot, options: Options) -> None:
        if not isinstance(robot.mobility, Boom):
            raise InputError(f"a facade is washed by a boom lift, which {robot.name} is not; expected boom-washer")
        if options.order.metric not in ("auto", "euclid", "time"):
            raise InputError(
                f"the metric {options.order.metric!r} says nothing about a boom lift; expected 'euclid' or 'time'"
            )
        self.job, self.boom, self.options = job, robot.mobility, options
        names = {wall.name: k for k, wall in enumerate(job.walls)}
        missing = next((stroke.element for stroke in cover.strokes if stroke.element not in names), None)
        if missing is not None:
            raise InputError(f"a stop belongs to wall {missing!r}, which the facade does not have")
        self.wall = np.array([names[stroke.element] for stroke in cover.strokes], dtype=np.int64)
        self.feet = np.array([stroke.points[0] for stroke in cover.strokes]).reshape(-1, 3)
        self.normal = np.array(
            [np.zeros(3) if stroke.normals is None else stroke.normals[0] for stroke in cover.strokes]
        ).reshape(-1, 3)
        self.start: int | None = None
        if options.order.start is not None:
            wall = job.walls[0]
            place = np.array([options.order.start])
            _refuse_start(job, place[0], self.boom.standoff)
            self.start = len(self.wall)
            self.wall = np.append(self.wall, 0)
            self.feet = np.concatenate([self.feet, places(wall, place, self.boom.standoff)])
            self.normal = np.concatenate([self.normal, normals(wall, place[:, 0])])
        self.up = np.array([job.walls[k].up for k in self.wall.tolist()]).reshape(-1, 3)
        self.flat = np.zeros((len(self.wall), 2))
        for k, wall in enumerate(job.walls):
            own = self.wall == k
            self.flat[own] = unrolled(wall, self.feet[own], self.normal[own], self.boom.standoff)
        self._around: dict[tuple[int, tuple[int, ...]], Ways] = {}
        self._plans: dict[tuple[tuple[float, float], tuple[float, float]], FloatArray | None] = {}
        if len(job.walls) > 1 or job.building is not None:
            self._refuse_inside()

    @property
    def timed(self) -> bool:
        """Whether costs are seconds."""
        return self.options.order.metric == "time"

    def costs(self) -> ArcCosts:
        """Costs between all stops, m or s: of the moves as they will be made."""
        count = len(self.wall) if self.start is None else self.start
        weight = self.options.wash.horizontal
        plain = len(self.job.walls) == 1 and self.job.walls[0].flat
        nowhere = self.options.wash.travel == "straight" or not self.job.walls[0].no_go
        if plain and nowhere and not self.timed:
            points = self.flat[:count] * np.array([weight, 1.0])
            return EuclidCosts(points, points)
        return MatrixCosts(self._matrix(np.arange(count)))

    def start_costs(self) -> FloatArray:
        """(n,) from where the robot stands to every stop; empty when it stands nowhere."""
        if self.start is None:
            return np.zeros(0)
        return np.array([self.cost(self.start, k) for k in range(self.start)])

    def _matrix(self, stops: IntArray) -> FloatArray:
        count = len(stops)
        i, j = (index.ravel() for index in np.indices((count, count)))
        steps = self.feet[j] - self.feet[i]
        moving = np.linalg.norm(steps, axis=1) > SAME
        costs = np.zeros(count * count)
        costs[moving] = self._of_steps(steps[moving], i[moving])
        other = np.flatnonzero(~self._straight(i, j))
        for k in other.tolist():
            costs[k] = self.cost(int(i[k]), int(j[k]))
        return costs.reshape(count, count)

    def _straight(self, i: IntArray, j: IntArray) -> Any:
        """(k,) whether a move is one straight line."""
        straight = self.wall[i] == self.wall[j]
        for number, wall in enumerate(self.job.walls):
            own = np.flatnonzero(straight & (self.wall[i] == number))
            if not wall.flat:
                at = vertices_of(wall)[0][1:-1]
                low, high = np.sort(np.stack([self.flat[i[own], 0], self.flat[j[own], 0]]), axis=0)
                between = np.searchsorted(at, low, side="right") < np.searchsorted(at, high, side="left")
                straight[own[between]] = False
            if wall.no_go and self.options.wash.travel != "straight":
                seen = self._ways(number, ()).seen(self._scaled(self.flat[i[own]]), self._scaled(self.flat[j[own]]))
                straight[own[~seen]] = False
        return straight

    def cost(self, i: int, j: int) -> float:
        """Of the move from stop i to stop j, m or s; infinite when there is none."""
        way = self.waypoints(i, j)
        if way is None:
            return math.inf
        steps = np.diff(way, axis=0)
        steps = steps[np.linalg.norm(steps, axis=1) > SAME]
        # where it stands at first no axis points anywhere yet: those of the wall it goes to count
        origin = np.full(len(steps), j if i == self.start else i)
        return float(self._of_steps(steps, origin).sum()) if len(steps) else 0.0

    def _of_steps(self, steps: FloatArray, origin: IntArray) -> FloatArray:
        """(k,) costs of straight lines (k, 3) of moves that begin at these stops (k,)."""
        if self.timed:
            return rest_to_rest(np.linalg.norm(steps, axis=1), self.limits(steps, origin))
        high = (steps * self.up[origin]).sum(axis=1)
        beside = np.maximum((steps**2).sum(axis=1) - high**2, 0.0)
        costs: FloatArray = np.sqrt(self.options.wash.horizontal**2 * beside + high**2)
        return costs

    def limits(self, steps: FloatArray, origin: IntArray) -> AxisLimits:
        """What the boom can do along lines (k, 3) of moves that begin at these stops, whose walls give its axes."""
        most = self.options.time.transit_speed or math.inf
        return axis_limits(steps, self.normal[origin], self.up[origin], self.boom, most)

    def waypoints(self, i: int, j: int) -> FloatArray | None:
        """(k, 3) m, the corners of the move from stop i to stop j, both included; None when there is no way."""
        a, b = int(self.wall[i]), int(self.wall[j])
        if a != b:
            return self._from_wall_to_wall(i, j)
        wall, away = self.job.walls[a], self.boom.standoff
        line = np.array([self.flat[i], self.flat[j]])
        if wall.no_go and self.options.wash.travel == "around":
            found = self._ways(a, self._before(a, i, j)).way(*self._scaled(line))
            if found is None:
                return None
            line = found / np.array([self.options.wash.horizontal, 1.0])
        over = False
        if wall.no_go and self.options.wash.travel == "lift":
            over = not self._ways(a, self._before(a, i, j)).seen(*(end[None] for end in self._scaled(line)))[0]
            away += self.options.wash.lift if over else 0.0
        moved = _mapped(a, self.job, line, away) if len(line) > 2 or not wall.flat else places(wall, line, away)
        ends = (self.feet[i], self.feet[j])
        if over:
            return np.concatenate([ends[:1], moved, ends[1:]])
        moved[0], moved[-1] = ends
        return moved

    def _scaled(self, points: FloatArray) -> FloatArray:
        scaled: FloatArray = points * np.array([self.options.wash.horizontal, 1.0])
        return scaled

    def _before(self, wall: int, i: int, j: int) -> tuple[int, ...]:
        """The no-go areas that stop i or j stands before: they are no obstacle to its moves."""
        import shapely

        both = np.array([self.flat[i], self.flat[j]])
        parts = self._obstacles[wall]
        return tuple(k for k, part in enumerate(parts) if shapely.contains_xy(part, both[:, 0], both[:, 1]).any())

    @cached_property
    def _obstacles(self) -> list[list[Any]]:
        """The no-go areas of each wall; those that touch are one."""
        import shapely

        joined = [shapely.union_all([shapely.make_valid(shapely.Polygon(r)) for r in w.no_go]) for w in self.job.walls]
        parts = [list(shapely.get_parts(area)) for area in joined]
        for part in (part for row in parts for part in row):
            shapely.prepare(part)
        return parts

    def _ways(self, wall: int, without: tuple[int, ...]) -> Ways:
        import shapely
        from shapely import affinity

        if (wall, without) not in self._around:
            parts = [part for k, part in enumerate(self._obstacles[wall]) if k not in without]
            area = affinity.scale(shapely.union_all(parts), xfact=self.options.wash.horizontal, origin=(0, 0))
            most = MOST_CORNERS if self.options.wash.travel == "around" else None
            self._around[wall, without] = Ways(area, most)
        return self._around[wall, without]

    def _from_wall_to_wall(self, i: int, j: int) -> FloatArray | None:
        start, end = self.feet[i], self.feet[j]
        key = tuple((round(float(p[0]), 9), round(float(p[1]), 9)) for p in (start, end))
        pair = (key[0], key[1])
        if pair not in self._plans:
            self._plans[pair] = self._building.way(start[:2], end[:2])
        flat = self._plans[pair]
        if flat is None:
            return None
        gone = np.concatenate([[0.0], np.cumsum(np.hypot(*np.diff(flat, axis=0).T))])
        share = gone / gone[-1] if gone[-1] > SAME else np.linspace(0, 1, len(flat))
        way = np.column_stack([flat, start[2] + share * (end[2] - start[2])])
        way[0], way[-1] = start, end
        return way

    @cached_property
    def _building(self) -> Ways:
        """What the robot travels around from wall to wall: the ground plan and the stand-off before it."""
        return ways_around(self.job, self.boom.standoff)

    def _refuse_inside(self) -> None:
        import shapely

        inside = shapely.contains_xy(self._building.inner, self.feet[:, 0], self.feet[:, 1])
        if inside.any():
            name = self.job.walls[int(self.wall[int(np.argmax(inside))])].name
            raise InputError(
                f"wall {name!r} has stops inside the building, or too near another wall; expected walls in their order "
                "around it, `across` to the right as seen from outside; an inner corner needs the ground plan as "
                "`building`",
                self.job.name,
            )


def _refuse_start(job: Facade, place: FloatArray, standoff: float) -> None:
    """Raises InputError for a start (x, y) on the first wall that is below the ground, or nowhere near the wall."""
    wall = job.walls[0]
    x, y = place.tolist()
    low, high = wall.outline.min(axis=0), wall.outline.max(axis=0)
    beside = float(np.maximum(np.maximum(low - place, place - high), 0.0).max())
    expected = f"expected x along the wall {wall.name!r} and the height on it, m"
    if beside > MOST_BESIDE:
        raise InputError(f"the start ({x:g}, {y:g}) is {beside:g} m beside the wall; {expected}", "--start")
    least = lowest(wall, ground_of(job), standoff)
    if y < least - SAME:
        raise InputError(f"the start ({x:g}, {y:g}) is {least - y:g} m below the ground; {expected}", "--start")


def _mapped(number: int, job: Facade, line: FloatArray, away: float) -> FloatArray:
    """(k, 3) m, a polyline on a wall (n, 2) as it is `away` m before it: it turns where the wall does."""
    wall = job.walls[number]
    corners, mitres = edge_before(wall, away)
    pieces = [places(wall, line[:1], away)]
    for here, there in itertools.pairwise(line):
        low, high = sorted((float(here[0]), float(there[0])))
        passed = np.flatnonzero((corners > low) & (corners < high))
        if there[0] < here[0]:
            passed = passed[::-1]
        if len(passed):
            share = (corners[passed] - here[0]) / (there[0] - here[0])
            pieces.append(lifted(wall, mitres[passed], here[1] + share * (there[1] - here[1])))
        pieces.append(places(wall, there[None], away))
    return np.concatenate(pieces)
