"""Whether circles wash all of an area, decided on its border and theirs.

If anything of the area lay in no circle, the border of that part would consist of pieces of the area's border and of
circles, and these pieces would lie in no other circle. So it is enough to look at lines: the sides of the area have to
be covered by the circles' chords, and what lies in the area of every circle by the arcs that others cut out of it.
"""

from __future__ import annotations

import itertools
import math
from typing import Any

import numpy as np

from optplan.domain.arrays import FloatArray

SLIVER = 1e-6
"""m: pieces of border shorter than this say nothing: coordinates are not known better."""
ROUND = 90
"""Corners of a quarter circle where what is missed is measured."""

Spot = tuple[float, float]


def bare_spots(area: Any, centres: FloatArray, radius: FloatArray) -> list[Spot]:
    """Places on the border of what no circle washes; empty when all is washed.

    area : shapely; centres : (n, 2) m; radius : (n,) m
    """
    import shapely

    spots: list[Spot] = []
    if area.is_empty:
        return spots
    rings = [ring for part in shapely.get_parts(area) for ring in (part.exterior, *part.interiors)]
    lines = [shapely.get_coordinates(ring) for ring in rings]
    for line in lines:
        for a, b in itertools.pairwise(line):
            spots += _bare_on_side(a, b, centres, radius)
    begin = np.concatenate([line[:-1] for line in lines])
    step = np.concatenate([np.diff(line, axis=0) for line in lines])
    shapely.prepare(area)
    for k in range(len(centres)):
        spots += _bare_on_circle(area, begin, step, centres, radius, k)
    return spots


def missed_area(area: Any, centres: FloatArray, radius: FloatArray) -> float:
    """m2 that no circle washes, to within the flat sides of polygons for circles (from inside: never too little)."""
    import shapely

    made = shapely.buffer(shapely.points(centres), radius, quad_segs=ROUND)
    return float(area.difference(shapely.union_all(made)).area)


def _bare_on_side(a: FloatArray, b: FloatArray, centres: FloatArray, radius: FloatArray) -> list[Spot]:
    """Places on the line from a to b that no circle holds."""
    length = math.dist(a, b)
    if length <= SLIVER:
        return []
    way = (b - a) / length
    away = centres - a
    along, beside = away @ way, away[:, 0] * way[1] - away[:, 1] * way[0]
    meets = np.abs(beside) < radius
    half = np.sqrt(radius[meets] ** 2 - beside[meets] ** 2)
    gaps = _uncovered(along[meets] - half, along[meets] + half, 0.0, length)
    return [tuple((a + (low + high) / 2 * way).tolist()) for low, high in gaps if high - low > SLIVER]


def _bare_on_circle(
    area: Any, begin: FloatArray, step: FloatArray, centres: FloatArray, radius: FloatArray, k: int
) -> list[Spot]:
    """Places on circle k inside the area that no other circle holds."""
    import shapely

    own, place = float(radius[k]), centres[k]
    away = centres - place
    distance = np.hypot(*away.T)
    other = (distance < own + radius) & (np.arange(len(centres)) != k)
    if (other & (distance + own <= radius + 1e-12) & ((distance > 1e-12) | (np.arange(len(centres)) < k))).any():
        return []  # it lies in another one
    other &= distance + radius > own
    d, r = np.maximum(distance[other], 1e-12), radius[other]
    middle = np.arctan2(away[other, 1], away[other, 0])
    half = np.arccos(np.clip((own**2 + d**2 - r**2) / (2 * own * d), -1, 1))
    low = (middle - half) % (2 * math.pi)
    high = low + 2 * half
    over = high > 2 * math.pi
    low, high = np.append(low, np.zeros(int(over.sum()))), np.append(high, high[over] - 2 * math.pi)
    spots: list[Spot] = []
    for start, end in _uncovered(low, high, 0.0, 2 * math.pi):
        if (end - start) * own <= SLIVER:
            continue
        cuts = _crossings(begin, step, place, own)
        cuts = np.concatenate([[start], np.sort(cuts[(cuts > start) & (cuts < end)]), [end]])
        wide = np.diff(cuts) * own > SLIVER
        angle = (cuts[:-1] + cuts[1:])[wide] / 2
        points = place + own * np.column_stack([np.cos(angle), np.sin(angle)])
        inside = shapely.contains_xy(area, points[:, 0], points[:, 1])
        spots += [(float(x), float(y)) for x, y in points[inside]]
    return spots


def _crossings(begin: FloatArray, step: FloatArray, centre: FloatArray, radius: float) -> FloatArray:
    """(k,) rad in 0..2 pi, where a circle crosses the sides of the area."""
    away = begin - centre
    a, b, c = (step**2).sum(axis=1), (away * step).sum(axis=1), (away**2).sum(axis=1) - radius**2
    root = b**2 - a * c
    real = root > 0
    angles = []
    for sign in (-1.0, 1.0):
        share = (-b[real] + sign * np.sqrt(root[real])) / a[real]
        on = (share >= 0) & (share <= 1)
        point = away[real][on] + share[on, None] * step[real][on]
        angles.append(np.arctan2(point[:, 1], point[:, 0]) % (2 * math.pi))
    return np.concatenate(angles)


def _uncovered(low: FloatArray, high: FloatArray, begin: float, end: float) -> list[tuple[float, float]]:
    """What of begin..end lies in none of the intervals low..high (k,)."""
    gaps, reached = [], begin
    for k in np.argsort(low, kind="stable").tolist():
        if low[k] > reached:
            gaps.append((reached, min(float(low[k]), end)))
        reached = max(reached, float(high[k]))
        if reached >= end:
            return [gap for gap in gaps if gap[1] > gap[0]]
    gaps.append((reached, end))
    return [gap for gap in gaps if gap[1] > gap[0]]
