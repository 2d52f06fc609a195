"""Connections as Euler-spiral splines: where to put the control points.

The drawing source knew three cases: states that nearly face each other take no control points; else they are the
tangent points of circles beside both ends; and where both circles overlap, points of an arc on the opposite side. Two
control points nearer than 2 R were pushed apart; here one that crowds another is left out, which cannot fail. The
source took the circles' radius once as R and once as 2 R, and a spline overshoots circles by an amount that depends on
the query. Here the radius is tried in rising steps and a curvature test decides: the first within the limit is taken,
else the flattest, flagged.
"""

from __future__ import annotations

import math
from typing import NamedTuple

import numpy as np

from optplan.domain.arrays import BoolArray, FloatArray, frozen_floats
from optplan.domain.errors import InputError
from optplan.geometry.curves import Curve, positive
from optplan.geometry.rounding import wrapped
from optplan.geometry.splines import euler_splines

RUNGS = (1.3, 1.55, 1.8, 2.2, 2.7)
"""Radii of the circles that control points lie on, in R."""
LIMIT_SLACK = 0.02
"""Share by which a curvature limit may be exceeded before a connection is flagged."""
_ARC = math.pi / 2
"""Most turning between two control points on a circle, rad."""


class Connections(NamedTuple):
    """Splines between k pairs of states."""

    curves: list[Curve | None]
    """None where no spline was found"""
    max_curvature: FloatArray
    """(k,) 1/m; infinite where there is none"""
    within: BoolArray
    """(k,) max_curvature <= 1 / R and 2 %; False: flagged"""
    rung: FloatArray
    """(k,) radius of the control points in R; 0: no control points were needed"""


def spiro_connections(starts: FloatArray, ends: FloatArray, radius: float) -> Connections:
    """Euler-spiral splines from starts to ends, G2 inside, with the given headings at both ends.

    Parameters
    ----------
    starts, ends : (k, 3) x, y, heading: m, m, rad; apart
    radius : R, least radius wanted, m

    Raises
    ------
    InputError : states that are none, a pair at one place, or a radius that is not above 0
    """
    starts = frozen_floats(starts, "start states", (None, 3))
    ends = frozen_floats(ends, "end states", (len(starts), 3))
    positive(radius, "the radius of a connection")
    if (starts[:, :2] == ends[:, :2]).all(axis=1).any():
        raise InputError("a connection starts and ends at one place; expected two places")
    limit = (1 + LIMIT_SLACK) / radius
    count = len(starts)
    best: list[Curve | None] = [None] * count
    largest, rung = np.full(count, np.inf), np.zeros(count)
    sight = np.arctan2(ends[:, 1] - starts[:, 1], ends[:, 0] - starts[:, 0])
    facing = np.abs(wrapped(np.stack([starts[:, 2], ends[:, 2]]) - sight)).max(axis=0) <= math.pi / 2
    open_rows = np.arange(count)
    for factor in (0.0, *RUNGS):
        groups: dict[int, list[tuple[int, FloatArray]]] = {}
        for row in (open_rows[facing[open_rows]] if factor == 0 else open_rows).tolist():
            points = _control_points(starts[row], ends[row], factor * radius, radius)
            groups.setdefault(len(points), []).append((row, points))
        for group in groups.values():
            rows = np.array([row for row, _ in group])
            made = euler_splines(np.stack([points for _, points in group]), starts[rows, 2], ends[rows, 2])
            bend = np.abs([made.curvature, made.curvature + made.sharpness * made.length]).max(axis=(0, 2))
            bend = np.where(made.converged, bend, np.inf)
            for k in np.flatnonzero(bend < largest[rows]).tolist():
                row = int(rows[k])
                largest[row], rung[row] = bend[k], factor
                best[row] = Curve(starts[row], made.curvature[k], made.sharpness[k], made.length[k])
        open_rows = np.flatnonzero(largest > limit)
        if len(open_rows) == 0:
            break
    return Connections(best, largest, largest <= limit, rung)


def _control_points(start: FloatArray, end: FloatArray, circle: float, radius: float) -> FloatArray:
    """(n, 2) the ends and what lies between: points along the shortest path on circles of that radius, m."""
    if circle == 0:
        return np.stack([start[:2], end[:2]])
    from optplan.geometry._kernels.dubins import dubins_shortest

    x, y, heading = start.tolist()
    to_x, to_y, to_heading = end.tolist()
    _, word, *parts = dubins_shortest(x, y, heading, to_x, to_y, to_heading, circle)
    points = [(x, y)]
    for sign, part in zip(_SIGNS[word], parts, strict=True):
        pieces = max(1, math.ceil(part / _ARC - 1e-9)) if sign else 1
        step = part / pieces
        for _ in range(pieces):
            chord = circle * step * (math.sin(step / 2) / (step / 2) if sign and step > 0 else 1.0)
            middle = heading + sign * step / 2
            x, y = x + chord * math.cos(middle), y + chord * math.sin(middle)
            heading += sign * step
            points.append((x, y))
    return _apart(np.array([*points[:-1], tuple(end[:2].tolist())]), radius)


_SIGNS = ((1, 0, 1), (-1, 0, -1), (1, 0, -1), (-1, 0, 1), (-1, 1, -1), (1, -1, 1))


def _apart(points: FloatArray, radius: float) -> FloatArray:
    """Points with those left out that crowd another; the ends stay."""
    kept = [points[0]]
    for point in points[1:-1]:
        if math.dist(point, kept[-1]) >= radius and math.dist(point, points[-1]) >= radius:
            kept.append(point)
    return np.array([*kept, points[-1]])
