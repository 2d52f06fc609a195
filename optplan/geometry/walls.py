"""Walls in space: from places on an unrolled wall to points before it, and the circles that an arm reaches on it."""

from __future__ import annotations

import math

import numpy as np

from optplan.domain.arrays import FloatArray, IntArray
from optplan.domain.facade import Wall

FINE = 0.02
"""Step between places at which the reach on a curved wall is looked at, in reaches."""
MARGIN = 1e-3
"""Share of the radius that is given up for stops between those places."""


def vertices_of(wall: Wall) -> tuple[FloatArray, FloatArray]:
    """x (k,) m and plan (k, 2) m at the vertices of a wall's plan; a flat one has two."""
    if wall.plan is None:
        x = np.array([0.0, 1.0])
        return x, np.array([[0.0, 0.0], [1.0, 0.0]])
    steps = np.hypot(*np.diff(wall.plan, axis=0).T)
    return np.concatenate([[0.0], np.cumsum(steps)]), wall.plan


def segments_of(wall: Wall, x: FloatArray) -> IntArray:
    """(n,) segment of the plan on which each x (n,) lies; on a vertex the one behind it."""
    at, _ = vertices_of(wall)
    return np.clip(np.searchsorted(at, x, side="right") - 1, 0, len(at) - 2).astype(np.int64)


def places(wall: Wall, points: FloatArray, away: float | FloatArray = 0.0) -> FloatArray:
    """(n, 3) m, the points (n, 2) of a wall in space, or places `away` m (n,) from it along its normal."""
    points = np.asarray(points, dtype=np.float64)
    at, plan = vertices_of(wall)
    segment = segments_of(wall, points[:, 0])
    step = np.diff(plan, axis=0) / np.diff(at)[:, None]
    flat = plan[segment] + (points[:, 0] - at[segment])[:, None] * step[segment]
    out = np.asarray(away, dtype=np.float64) + np.zeros(len(points))
    flat = flat + out[:, None] * _turned(step)[segment]
    return wall.origin + _in_space(wall, flat, points[:, 1])


def normals(wall: Wall, x: FloatArray) -> FloatArray:
    """(n, 3) unit normals of a wall at x (n,), away from the building."""
    at, plan = vertices_of(wall)
    step = np.diff(plan, axis=0) / np.diff(at)[:, None]
    return _in_space(wall, _turned(step)[segments_of(wall, np.asarray(x))], np.zeros(len(x)))


def outward(wall: Wall) -> FloatArray:
    """(3,) what points away from the building where the wall begins, for a plan that begins along `across`."""
    normal: FloatArray = np.cross(wall.across, wall.up)
    return normal


def edge_before(wall: Wall, away: float) -> tuple[FloatArray, FloatArray]:
    """x (k,) of the inner vertices of a curved wall's plan and points (k, 2) on the mitre `away` m before them."""
    at, plan = vertices_of(wall)
    if len(at) < 3:
        return np.zeros(0), np.zeros((0, 2))
    step = np.diff(plan, axis=0) / np.diff(at)[:, None]
    side = _turned(step)
    mitre = (side[:-1] + side[1:]) / (1 + (side[:-1] * side[1:]).sum(axis=1))[:, None]
    return at[1:-1], plan[1:-1] + away * mitre


def lifted(wall: Wall, flat: FloatArray, y: FloatArray) -> FloatArray:
    """(n, 3) points in space of plan points (n, 2) at heights y (n,) of the wall."""
    return wall.origin + _in_space(wall, flat, y)


def reach_radius(wall: Wall, reach: float, standoff: float) -> float:
    """Greatest radius (m) of a circle on the unrolled wall that is within reach from every stop before it.

    A stop's sphere cuts a circle out of a flat wall. On a curved one let the stop be at x0 and a point of its circle of
    radius r at x0 + a, so that it is sqrt(r^2 - a^2) higher: their distance squared is D(a) - a^2 + r^2, D that of the
    plan alone. Along a side of the plan D(a) - a^2 is linear: the ends of sides count, and those of the circle. The
    stops looked at are FINE reaches apart, besides the vertices and middles of sides.
    """
    flat = math.sqrt(reach**2 - standoff**2)
    if wall.flat:
        return flat
    at, plan = vertices_of(wall)
    step = np.diff(plan, axis=0) / np.diff(at)[:, None]
    # stops may lie beside the wall, too: before its last side drawn on
    tried = np.arange(at[0] - flat, at[-1] + flat, FINE * reach)
    tried = np.unique(np.concatenate([tried, at, at[1:-1] - 1e-9, (at[1:] + at[:-1]) / 2]))

    def along(x: FloatArray) -> FloatArray:
        side = segments_of(wall, x)
        return plan[side] + (x - at[side])[:, None] * step[side]

    feet = along(tried) + standoff * _turned(step)[segments_of(wall, tried)]
    beside = at - tried[:, None]
    vertices = ((plan - feet[:, None]) ** 2).sum(axis=2) - beside**2

    def reached(radius: float) -> bool:
        worst = np.where(np.abs(beside) < radius, vertices, -np.inf).max(initial=standoff**2)
        for end in (tried - radius, tried + radius):
            worst = max(worst, float((((along(end) - feet) ** 2).sum(axis=1) - radius**2).max()))
        return bool(worst + radius**2 <= reach**2)

    low, high = 0.0, flat
    if reached(flat * (1 - 1e-12)):
        return flat
    for _ in range(40):
        middle = (low + high) / 2
        low, high = (middle, high) if reached(middle) else (low, middle)
    return low * (1 - MARGIN)


def _turned(step: FloatArray) -> FloatArray:
    """Unit vectors away from the building for directions (n, 2) along the plan: its second coordinate points there."""
    return np.column_stack([-step[:, 1], step[:, 0]])


def _in_space(wall: Wall, flat: FloatArray, y: FloatArray) -> FloatArray:
    return flat[:, :1] * wall.across + flat[:, 1:] * outward(wall) + np.asarray(y)[:, None] * wall.up


def unrolled(wall: Wall, feet: FloatArray, facing: FloatArray, away: float) -> FloatArray:
    """(n, 2) places on the wall of points (n, 3) that are `away` m before it, with these normals (n, 3)."""
    at, plan = vertices_of(wall)
    step = np.diff(plan, axis=0) / np.diff(at)[:, None]
    side = _turned(step)
    apart = feet - wall.origin
    flat = np.column_stack([apart @ wall.across, apart @ outward(wall)])
    normal = np.column_stack([facing @ wall.across, facing @ outward(wall)])
    x = np.empty(len(feet))
    for k in range(len(feet)):
        foot = flat[k] - away * normal[k]
        along = ((foot - plan[:-1]) * step).sum(axis=1)
        # how far it misses each side of the plan, whose first and last are drawn on
        low = np.maximum(-along, 0.0)
        high = np.maximum(along - np.diff(at), 0.0)
        low[0], high[-1] = 0.0, 0.0
        miss = np.abs(((foot - plan[:-1]) * side).sum(axis=1)) + low + high + 1e3 * np.abs(side - normal[k]).sum(axis=1)
        best = int(np.argmin(miss))
        x[k] = at[best] + along[best]
    return np.column_stack([x, apart @ wall.up])
