"""A building's walls to wash from stops."""

from __future__ import annotations

import math
from dataclasses import dataclass
from typing import TYPE_CHECKING

import numpy as np

from optplan.domain.arrays import FloatArray, frozen_floats
from optplan.domain.errors import InputError, located

if TYPE_CHECKING:
    from optplan.domain.job import Note

SHARPEST = math.radians(60)
"""Where the plan of one wall turns by more, it is two walls."""
SAME = 1e-9
"""m within which two vertices are one."""
MEETS = 1e-6
"""m within which a plan meets itself."""
MOST_CORNERS = 3000
"""Of a polygon, or a plan."""


@dataclass(frozen=True, eq=False)
class Wall:
    """A wall that can be unrolled: flat, or curved around lines along `up`.

    On it x runs along the wall and y along `up`, both in metres; seen from outside x runs to the right. A point (x, y)
    of a flat wall is in space at origin + x across + y up. A curved one has a plan, and x is the length along it.

    Parameters
    ----------
    name : unique in its facade
    outline : (n, 2) m polygon on the wall
    no_go : polygons (n, 2) m in it that are not washed: windows, balconies
    stops : (k, 2) m, where they are given; None leaves them to the cover
    origin : (3,) m, where (0, 0) of the wall is
    across, up : (3,) unit vectors at right angles; `across x up` points away from the building
    plan : (k, 2) m, the wall seen along `up`: a polyline whose coordinates are along `across` and away from the
        building, from (0, 0) on; None for a flat wall

    Raises
    ------
    InputError : polygons that cross themselves or each other's outline, a frame that is none, a plan with corners
    """

    name: str
    outline: FloatArray
    no_go: tuple[FloatArray, ...] = ()
    stops: FloatArray | None = None
    origin: FloatArray = (0.0, 0.0, 0.0)  # type: ignore[assignment]
    across: FloatArray = (1.0, 0.0, 0.0)  # type: ignore[assignment]
    up: FloatArray = (0.0, 0.0, 1.0)  # type: ignore[assignment]
    plan: FloatArray | None = None

    def __post_init__(self) -> None:
        with located(f"wall {self.name!r}"):
            object.__setattr__(self, "outline", _ring(self.outline, "the outline"))
            holes = tuple(_ring(ring, f"no-go area {k}") for k, ring in enumerate(self.no_go))
            object.__setattr__(self, "no_go", holes)
            for k, hole in enumerate(holes):
                if _cross(self.outline, hole):
                    raise InputError(f"no-go area {k} crosses the outline; expected it inside, or cut off there")
            if self.stops is not None:
                if len(self.stops) == 0:
                    raise InputError("stops is an empty list; expected stops, or no such list to have them found")
                object.__setattr__(self, "stops", frozen_floats(self.stops, "stops", (None, 2)))
            for name in ("origin", "across", "up"):
                object.__setattr__(self, name, frozen_floats(getattr(self, name), name, (3,)))
            lengths = [float(np.linalg.norm(axis)) for axis in (self.across, self.up)]
            if max(abs(length - 1) for length in lengths) > 1e-6 or abs(float(self.across @ self.up)) > 1e-6:
                raise InputError("across and up are no axes; expected two vectors of length 1 at right angles")
            if self.plan is not None:
                object.__setattr__(self, "plan", self._checked_plan(self.plan))

    def _checked_plan(self, given: FloatArray) -> FloatArray:
        plan = frozen_floats(given, "plan", (None, 2))
        if len(plan) < 2 or np.abs(plan[0]).max() > SAME:
            raise InputError("the plan is no line from (0, 0) on; expected two points or more, the first (0, 0)")
        steps = np.diff(plan, axis=0)
        length = np.hypot(*steps.T)
        if length.min() <= SAME:
            raise InputError("the plan repeats a point; expected consecutive points apart")
        bend = np.abs(np.diff(np.unwrap(np.arctan2(steps[:, 1], steps[:, 0]))))
        if len(bend) and bend.max() > SHARPEST:
            raise InputError(
                f"the plan turns by {math.degrees(float(bend.max())):.0f} degrees at a corner; expected at most "
                f"{math.degrees(SHARPEST):.0f}: make it two walls, or give more points"
            )
        meets = _self_meeting(plan)
        if meets is not None:
            x, away = plan[meets].tolist()
            raise InputError(f"the plan meets itself at ({x:g}, {away:g}); expected a line that does not")
        low, high = float(self.outline[:, 0].min()), float(self.outline[:, 0].max())
        if low < -1e-6 or high > length.sum() + 1e-6:
            raise InputError(
                f"the outline reaches from x = {low:g} to {high:g} m; expected 0 to {length.sum():g} m, along the plan"
            )
        return plan

    @property
    def flat(self) -> bool:
        """Whether it is a plane."""
        return self.plan is None or len(self.plan) == 2


@dataclass(frozen=True, eq=False)
class Facade:
    """Walls of one building to wash.

    Parameters
    ----------
    name : for people
    walls : one or more
    radius : of a washing circle, m; None: what the robot reaches at its stand-off
    tau, width : the rule of order: i before j when y_j - y_i >= tau * radius and |x_i - x_j| < width * radius
    building : (n, 2) m, its ground plan, which the robot travels around; None: the walls' own, joined in their order
    ground : m, its height, below which no stop is; None: the lowest corner of the walls
    notes : the load report
    """

    name: str
    walls: tuple[Wall, ...]
    radius: float | None = None
    tau: float = 0.75
    width: float = 2.0
    building: FloatArray | None = None
    notes: tuple[Note, ...] = ()
    ground: float | None = None

    def __post_init__(self) -> None:
        if not self.walls:
            raise InputError("a facade has no walls; expected one or more")
        names = [wall.name for wall in self.walls]
        if len(set(names)) != len(names):
            raise InputError("two walls share a name")
        if self.radius is not None and not (math.isfinite(self.radius) and self.radius > 0):
            raise InputError(f"the circle radius is {self.radius} m; expected a finite number above 0")
        if not (math.isfinite(self.tau) and math.isfinite(self.width)):
            raise InputError(f"the rule of order has tau {self.tau} and width {self.width}; expected finite numbers")
        if self.ground is not None and not math.isfinite(self.ground):
            raise InputError(f"the ground is at {self.ground} m; expected a finite height")
        if self.building is not None:
            object.__setattr__(self, "building", _ring(self.building, "the building"))
        if len(self.walls) > 1 and any(abs(float(wall.up[2]) - 1) > 1e-6 for wall in self.walls):
            raise InputError("a wall leans; expected upright walls where there are several (up = 0, 0, 1)")


def _ring(given: FloatArray, what: str) -> FloatArray:
    """A simple polygon that does not repeat its first point."""
    ring = frozen_floats(given, what, (None, 2))
    if len(ring) > 1 and np.abs(ring[0] - ring[-1]).max() <= SAME:
        ring = frozen_floats(ring[:-1], what, (None, 2))
    if len(ring) < 3:
        raise InputError(f"{what} has {len(ring)} corners; expected a polygon of 3 or more")
    steps = np.roll(ring, -1, axis=0) - ring
    if (np.hypot(*steps.T) <= SAME).any():
        raise InputError(f"{what} repeats corner {int(np.argmin(np.hypot(*steps.T)))}; expected corners apart")
    found = _crossing(ring)
    if found is not None:
        raise InputError(f"{what} crosses itself: side {found[0]} meets side {found[1]}; expected a simple polygon")
    area = float(ring[:, 0] @ np.roll(ring[:, 1], -1) - ring[:, 1] @ np.roll(ring[:, 0], -1)) / 2
    if abs(area) <= SAME:
        raise InputError(f"{what} encloses no area; expected a polygon")
    return ring


def _sides(a: FloatArray, b: FloatArray) -> tuple[FloatArray, FloatArray]:
    """On which side of each side of ring a the corners of ring b lie: (n, m), and of b those of a: (m, n)."""

    def of(ring: FloatArray, points: FloatArray) -> FloatArray:
        step = np.roll(ring, -1, axis=0) - ring
        away = points[None] - ring[:, None]
        cross = step[:, None, 0] * away[..., 1] - step[:, None, 1] * away[..., 0]
        size = np.hypot(*step.T)[:, None] * SAME
        return np.where(np.abs(cross) <= size, 0.0, np.sign(cross))

    return of(a, b), of(b, a)


def _cross(a: FloatArray, b: FloatArray) -> bool:
    """Whether the sides of two rings cross properly, or b has a corner outside a."""
    of_a, of_b = _sides(a, b)
    over = (of_a * np.roll(of_a, -1, axis=1) < 0) & (of_b * np.roll(of_b, -1, axis=1) < 0).T
    if over.any():
        return True
    middles = np.concatenate([b, (b + np.roll(b, -1, axis=0)) / 2])
    return not all(_inside(a, point) for point in middles)


def _inside(ring: FloatArray, point: FloatArray) -> bool:
    """Whether a point is in a polygon or on its border."""
    step = np.roll(ring, -1, axis=0) - ring
    away = point - ring
    square = (step**2).sum(axis=1)
    share = np.clip((away * step).sum(axis=1) / square, 0, 1)
    if (np.hypot(*(away - share[:, None] * step).T) <= 1e-7).any():
        return True
    above = ring[:, 1] > point[1]
    passed = above != np.roll(above, -1)
    with np.errstate(divide="ignore", invalid="ignore"):
        x = ring[:, 0] + away[:, 1] / step[:, 1] * step[:, 0]
    return bool((passed & (point[0] < x)).sum() % 2)


def _self_meeting(line: FloatArray) -> int | None:
    """A vertex of a polyline at which, or behind which, it meets itself, or None; its ends may be one place."""
    count = len(line)
    if count > MOST_CORNERS:
        raise InputError(f"the plan has {count} points; at most {MOST_CORNERS} are taken")
    begin, step = line[:-1], np.diff(line, axis=0)
    square = (step**2).sum(axis=1)
    side = np.arange(count - 1)
    closed = np.abs(line[0] - line[-1]).max() <= MEETS
    for k in range(count):
        away = line[k] - begin
        share = np.clip((away * step).sum(axis=1) / square, 0, 1)
        touched = np.hypot(*(away - share[:, None] * step).T) <= MEETS
        touched &= (side != k) & (side != k - 1)
        if closed and k in (0, count - 1):
            touched[[0, -1]] = False
        if k < count - 1:
            ends_apart = _turn(step[k], away) * _turn(step[k], away - step) < 0
            own_apart = _turn(step, away) * _turn(step, line[k + 1] - begin) < 0
            touched |= ends_apart & own_apart & (np.abs(side - k) > 1)
        if touched.any():
            return k
    return None


def _turn(one: FloatArray, other: FloatArray) -> FloatArray:
    made: FloatArray = one[..., 0] * other[..., 1] - one[..., 1] * other[..., 0]
    return made


def _crossing(ring: FloatArray) -> tuple[int, int] | None:
    """Two sides of a ring that meet though they are not neighbours, or None."""
    count = len(ring)
    if count > MOST_CORNERS:
        raise InputError(f"a polygon has {count} corners; at most {MOST_CORNERS} are taken")
    sides, _ = _sides(ring, ring)
    after = np.roll(sides, -1, axis=1)
    apart = sides * after < 0
    meet = apart & apart.T
    for k in range(count):
        meet[k, [k, (k + 1) % count, k - 1]] = False
    if not meet.any():
        return None
    first, second = np.argwhere(meet)[0].tolist()
    return first, second
