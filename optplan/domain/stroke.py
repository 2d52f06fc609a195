"""Strokes, and the ways of driving them."""

from __future__ import annotations

import math
from dataclasses import dataclass, replace
from typing import Any, NamedTuple

import numpy as np

from optplan.domain.arrays import BoolArray, FloatArray, IntArray, frozen_bools, frozen_floats, frozen_ints
from optplan.domain.errors import InputError


@dataclass(frozen=True, eq=False)
class Stroke:
    """One uninterrupted piece of work, or a stop with a dwell time.

    Parameters
    ----------
    id : unique in its plan, stable over re-planning
    points : (n, 2) or (n, 3) m, consecutive points apart. One point is a *stop*. A closed stroke does not repeat its
        first point and has n >= 3 (n >= 2 is refused: there and back is an open stroke).
    tool : index of the tool setting; 0 is a travel move drawn by hand
    closed : the last point joins the first
    normals : (n, 3) unit normals of the surface, or None
    dwell : working time of a stop, s
    directed : may only be driven forwards
    entry : the vertex where it must be entered (open strokes: 0 or n - 1), or None for a free choice
    element : id of the element of the job that it came from
    layer : the layer (colour) it belongs to, "" when there are none
    bends : (n - 1,), closed (n,) 1/m, left positive: curvature of the arc or line from each point to the next. They
        meet tangentially. None: straight lines, or the polyline of a drawn curve
    headings : a spot may be driven in so many directions, evenly around the middle of its line; its entry vertex then
        counts them. 1: it is as its points say

    Raises
    ------
    InputError : anything of that violated
    """

    id: str
    points: FloatArray
    tool: int = 1
    closed: bool = False
    normals: FloatArray | None = None
    dwell: float = 0.0
    directed: bool = False
    entry: int | None = None
    element: str = ""
    layer: str = ""
    bends: FloatArray | None = None
    headings: int = 1

    def __post_init__(self) -> None:
        what = f"stroke {self.id!r}"
        points = frozen_floats(self.points, f"{what} points", (None, None))
        if points.shape[1] not in (2, 3):
            raise InputError(f"{what} has points of {points.shape[1]} coordinates; expected 2 or 3")
        object.__setattr__(self, "points", points)
        if len(points) == 0:
            raise InputError(f"{what} has no points; expected at least one")
        if self.closed and len(points) < 3:
            raise InputError(f"{what} is closed with {len(points)} points; expected at least 3")
        steps = np.diff(points, axis=0, append=points[:1]) if self.closed else np.diff(points, axis=0)
        if len(points) > 1 and not np.any(steps != 0, axis=1).all():
            place = int(np.flatnonzero(~np.any(steps != 0, axis=1))[0])
            raise InputError(f"{what} repeats point {place}; expected consecutive points apart")
        if self.normals is not None:
            normals = frozen_floats(self.normals, f"{what} normals", (len(points), 3))
            if not np.allclose(np.linalg.norm(normals, axis=1), 1, atol=1e-6):
                raise InputError(f"{what} has normals that are not of unit length")
            object.__setattr__(self, "normals", normals)
        if self.tool < 0:
            raise InputError(f"{what} uses tool setting {self.tool}; expected 0 or more")
        if not (np.isfinite(self.dwell) and self.dwell >= 0):
            raise InputError(f"{what} dwells {self.dwell} s; expected 0 or more")
        if self.entry is not None:
            allowed = range(len(points)) if self.closed else (0, len(points) - 1)
            if self.entry not in allowed:
                raise InputError(f"{what} must be entered at vertex {self.entry}, which is no place to enter it")
        if self.bends is not None:
            count = len(points) if self.closed else len(points) - 1
            object.__setattr__(self, "bends", frozen_floats(self.bends, f"{what} bends", (count,)))
        if self.headings < 1 or (self.headings > 1 and (self.closed or len(points) < 2 or self.entry is not None)):
            raise InputError(
                f"{what} has {self.headings} headings; expected 1, or more for an open line entered freely"
            )

    @property
    def is_stop(self) -> bool:
        """Whether this is a place to stop at instead of a line to draw."""
        return len(self.points) == 1

    @property
    def length(self) -> float:
        """Length along the points, m."""
        ring = self.closed_points
        return float(np.linalg.norm(np.diff(ring, axis=0), axis=1).sum())

    def facing(self, number: int) -> Stroke:
        """A spot's line in the direction of this number, 0..headings - 1."""
        if self.headings == 1:
            return self
        angle = 2 * math.pi * number / self.headings
        middle = (self.points[0] + self.points[-1])[:2] / 2
        turn = np.array([[math.cos(angle), math.sin(angle)], [-math.sin(angle), math.cos(angle)]])
        points = self.points.copy()
        points[:, :2] = middle + (points[:, :2] - middle) @ turn
        return replace(self, points=points, headings=1)

    @property
    def closed_points(self) -> FloatArray:
        """The points, with the first one again at the end of a closed stroke."""
        return np.concatenate([self.points, self.points[:1]]) if self.closed else self.points


class Traversal(NamedTuple):
    """One way of driving a stroke: a row of `Traversals`."""

    stroke: int
    entry_vertex: int
    reverse: bool
    entry: FloatArray
    exit: FloatArray
    length: float
    duration: float


@dataclass(frozen=True, eq=False)
class Traversals:
    """Ways of driving strokes, one a row, grouped by stroke.

    Parameters
    ----------
    stroke : (m,) index of the stroke
    entry_vertex : (m,) vertex where it is entered (an open stroke: 0, or n - 1 when driven backwards)
    reverse : (m,) driven against the order of its points
    entry, exit : (m, 5) states x, y, z, heading, curvature: m, m, m, rad, 1/m (z is 0 in the plane; a robot that needs
        no heading gets one all the same, that of the first and last bit of the path)
    length, duration : (m,) of the driven path, m and s
    """

    stroke: IntArray
    entry_vertex: IntArray
    reverse: BoolArray
    entry: FloatArray
    exit: FloatArray
    length: FloatArray
    duration: FloatArray

    def __post_init__(self) -> None:
        count = len(self.stroke)
        for name in ("stroke", "entry_vertex"):
            object.__setattr__(self, name, frozen_ints(getattr(self, name), f"traversals {name}", (count,)))
        object.__setattr__(self, "reverse", frozen_bools(self.reverse, "traversals reverse", (count,)))
        for name in ("entry", "exit"):
            object.__setattr__(self, name, frozen_floats(getattr(self, name), f"traversals {name}", (count, 5)))
        for name in ("length", "duration"):
            object.__setattr__(self, name, frozen_floats(getattr(self, name), f"traversals {name}", (count,)))

    def __len__(self) -> int:
        return len(self.stroke)

    def __getitem__(self, row: int) -> Traversal:
        return Traversal(
            int(self.stroke[row]),
            int(self.entry_vertex[row]),
            bool(self.reverse[row]),
            self.entry[row],
            self.exit[row],
            float(self.length[row]),
            float(self.duration[row]),
        )

    def take(self, rows: Any) -> Traversals:
        """These rows in this order."""
        rows = np.asarray(rows, dtype=np.int64)
        return Traversals(
            self.stroke[rows],
            self.entry_vertex[rows],
            self.reverse[rows],
            self.entry[rows].reshape(-1, 5),
            self.exit[rows].reshape(-1, 5),
            self.length[rows],
            self.duration[rows],
        )
