"""What is marked more than once."""

from __future__ import annotations

import math
from itertools import pairwise
from typing import Any

import numpy as np

from optplan.domain.arrays import BoolArray, FloatArray, IntArray
from optplan.domain.report import Check
from optplan.judge._findings import noted
from optplan.judge._shapes import buffers, overlay, spot, union

_BEND = math.pi / 2
"""rad that a stretch of a line may turn in all: it cannot come back over its own mark."""
_CORNER = math.radians(30)
"""rad of a corner from which a new stretch begins: of what a disc marks twice inside a smaller one there is less than a
hundredth of the disc."""
_SHARED, _SIDES = 1.001, 32
"""What two stretches share where one goes on from the other is a disc: its radius over half the width, such that the
flat sides (of a quarter) by which it is drawn leave nothing out."""


def overlap(shapely: Any, lines: Any, width: FloatArray, areas: Any, meet: float) -> tuple[Check, float]:
    """Area that is marked more than once, counted once for each time beyond the first; and how much of it, m^2, lies
    within areas, where rows may well lie closer than the tool is wide.

    A mark is what a disc sweeps. It marks a place again when it has left it and comes back: another stroke, the same
    one that crosses itself or goes back, and the tips inside of corners.

    Parameters
    ----------
    lines : (k,) shapely points and lines along which marks are made, each once
    width : (k,) of the marks, m
    areas : what is filled, as one geometry
    meet : m between the two ends of a line up to which it is closed
    """
    parts, line, ends = _stretches(shapely, lines, meet)
    shapes = buffers(shapely, parts, width[line])
    one, other = shapely.STRtree(shapes).query(shapes, predicate="intersects") if len(shapes) else np.zeros((2, 0), int)
    earlier = other < one
    order = np.lexsort((other[earlier], one[earlier]))
    one, other = one[earlier][order], other[earlier][order]
    # each stretch against all that was marked before it, less what it shares with those it goes on from
    groups = np.split(other, np.flatnonzero(np.diff(one)) + 1) if len(one) else []
    late = np.unique(one)
    marked = np.array([union(shapely, shapes[group]) for group in groups], dtype=object)
    again = overlay(shapely, shapely.intersection, shapes[late], marked)
    for side in range(2):
        has = ~np.isnan(ends[late, side, 0])
        rows = late[has]
        discs = shapely.buffer(shapely.points(ends[rows, side]), width[line[rows]] / 2 * _SHARED, quad_segs=_SIDES)
        again[has] = overlay(shapely, shapely.difference, again[has], discs)
    size = shapely.area(again)
    twice = float(size.sum())
    inside = float(shapely.area(overlay(shapely, shapely.intersection, again, areas)).sum()) if areas.area > 0 else 0.0
    place = spot(shapely, again[int(np.argmax(size))]) if twice > 0 else None
    detail = "Marked more than once: where strokes meet, cross, go back or lie side by side."
    if inside > 0:
        detail += f" {inside:.4g} m2 of it lies within areas that are filled."
    return noted("overlap", twice, "m2", detail, place), inside


def _stretches(shapely: Any, lines: Any, meet: float) -> tuple[Any, IntArray, FloatArray]:
    """Lines cut at corners and where they have turned by a quarter.

    (n,) parts, (n,) the line of each, and (n, 2, 2) where a part goes on from the one before, and, where a line closes,
    from the first one; NaN where it does not.
    """
    parts: list[Any] = []
    line: list[int] = []
    ends: list[FloatArray] = []
    for k, whole in enumerate(lines):
        points = shapely.get_coordinates(whole)
        cuts = [0, *_cuts(points), len(points) - 1] if len(points) > 1 else [0, 0]
        count = len(cuts) - 1
        joints = np.full((count, 2, 2), np.nan)
        joints[1:, 0] = points[cuts[1:-1]]
        if count > 1 and np.linalg.norm(points[-1] - points[0]) <= meet:
            joints[-1, 1] = points[0]
        parts += [whole] if count == 1 else [shapely.linestrings(points[a : b + 1]) for a, b in pairwise(cuts)]
        line += [k] * count
        ends.append(joints)
    made = np.array(parts, dtype=object)
    return made, np.array(line, dtype=np.int64), np.concatenate(ends) if ends else np.zeros((0, 2, 2))


def _cuts(points: FloatArray) -> list[int]:
    """Inner vertices of a line (n, 2) at which a new stretch begins."""
    step = np.diff(points, axis=0)
    moves: BoolArray = np.hypot(step[:, 0], step[:, 1]) > 0
    at, step = np.flatnonzero(moves), step[moves]
    heading = np.arctan2(step[:, 1], step[:, 0])
    turns = np.abs((np.diff(heading) + np.pi) % (2 * np.pi) - np.pi)
    cuts, turned = [], 0.0
    for vertex, turn in zip(at[1:].tolist(), turns.tolist(), strict=True):
        turned += turn
        if turned > _BEND or turn > _CORNER:
            cuts.append(vertex)
            turned = 0.0
    return cuts
