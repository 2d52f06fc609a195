"""Marks as areas: lines with a width, and overlays that do not fail."""

from __future__ import annotations

import math
from collections.abc import Callable
from typing import Any

import numpy as np

from optplan.domain.arrays import FloatArray
from optplan.judge._findings import Place

QUADRANT = 8
"""Segments of a quarter circle around the end of a mark; both sides of a comparison are drawn alike."""
_BIT = 8
"""Segments that are outlined in one go where a line curls."""
_CURLED = 20 * math.pi
"""rad of turning below which a line is outlined in one go."""
_GRID = 1e-8
"""m, of the grid that saves an overlay which fails in floating point."""


def buffers(shapely: Any, lines: Any, widths: FloatArray) -> Any:
    lines = np.array(lines, dtype=object)
    curled = np.array([_curls(shapely.get_coordinates(line), w) for line, w in zip(lines, widths, strict=True)], bool)
    made = np.full(len(lines), None, dtype=object)
    made[~curled] = shapely.buffer(lines[~curled], widths[~curled] / 2, quad_segs=QUADRANT)
    for k in np.flatnonzero(curled).tolist():
        line = shapely.get_coordinates(lines[k])
        bits = [shapely.linestrings(line[i : i + _BIT + 1]) for i in range(0, len(line) - 1, _BIT)]
        made[k] = union(shapely, shapely.buffer(bits, widths[k] / 2, quad_segs=QUADRANT))
    return made


def _curls(line: FloatArray, width: float) -> bool:
    """Whether a line turns round and round within its own mark. To outline such a mark in one go takes time that grows
    with the cube of its vertices; bit by bit it is quick."""
    if len(line) <= 2 * _BIT:
        return False
    step = np.diff(line, axis=0)
    heading = np.arctan2(step[:, 1], step[:, 0])
    turned = float(np.abs((np.diff(heading) + np.pi) % (2 * np.pi) - np.pi).sum())
    return turned > _CURLED and turned * width > float(np.linalg.norm(step, axis=1).sum())


def union(shapely: Any, shapes: Any) -> Any:
    shapes = np.array(shapes, dtype=object)
    if len(shapes) == 1:
        return shapes[0]
    try:
        return shapely.union_all(shapes)
    except shapely.errors.GEOSException:
        # snapping to a grid far below any tolerance cannot fail on nearly touching edges
        return shapely.union_all(shapely.make_valid(shapes), grid_size=_GRID)


def overlay(shapely: Any, operation: Callable[..., Any], a: Any, b: Any) -> Any:
    try:
        return operation(a, b)
    except shapely.errors.GEOSException:
        return operation(shapely.make_valid(a), shapely.make_valid(b), grid_size=_GRID)


def spot(shapely: Any, shape: Any) -> Place | None:
    """A point inside the largest part."""
    parts = shapely.get_parts(shape)
    if len(parts) == 0 or shape.area == 0:
        return None
    point = shapely.point_on_surface(parts[int(np.argmax(shapely.area(parts)))])
    return float(point.x), float(point.y)
