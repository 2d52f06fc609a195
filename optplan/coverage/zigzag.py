"""Parallel-line fill of a polygon with holes."""

from __future__ import annotations

import math
from typing import TYPE_CHECKING, NamedTuple

import numpy as np

from optplan.domain.arrays import FloatArray
from optplan.domain.errors import LimitError

if TYPE_CHECKING:
    from shapely import Polygon

MAX_LINES = 10_000
"""Most parallel lines across one polygon."""


class Fill(NamedTuple):
    """Lines that fill a polygon."""

    strokes: list[FloatArray]
    """(n, 2) m each: lines joined back and forth"""
    inset: float
    """m actually kept from the outline: less than asked where the polygon is too narrow"""


def zigzag(polygon: Polygon, direction: float, spacing: float, inset: float, border: float = 0.0) -> Fill:
    """Fill a polygon with parallel lines, joined into as few strokes as their neighbourhood allows.

    Parameters
    ----------
    polygon : valid, with or without holes, m
    direction : of the lines, rad from the x axis
    spacing : greatest distance between neighbouring lines, m, > 0. The lines are spread evenly.
    inset : of the lines from the outline, m, >= 0. A polygon that vanishes under it is filled with half of it, a
        quarter, and so on; in the end along its middle line in the given direction.
    border : width of the mark along the outline that is made already, m. Lines are spread over what it leaves, and
        there are none where it leaves nothing. With border <= inset + spacing / 2 nothing stays bare along sides that
        run with the lines.

    Raises
    ------
    LimitError : more than MAX_LINES lines
    """
    import shapely
    from shapely import affinity

    turned = affinity.rotate(polygon, -direction, origin=(0, 0), use_radians=True)
    inner, kept = turned, 0.0
    for kept in (inset, inset / 2, inset / 4, inset / 8, 0.0):
        # mitred: an inset of a straight-sided polygon stays straight-sided
        inner = turned.buffer(-kept, join_style="mitre") if kept > 0 else turned
        if not inner.is_empty or border > 0:
            break
    strokes: list[FloatArray] = []
    for part in shapely.get_parts(inner):
        if part.geom_type == "Polygon" and part.area > 0:
            strokes += _joined(_rows(part, spacing, border - kept), turned)
    back = np.array([[math.cos(direction), math.sin(direction)], [-math.sin(direction), math.cos(direction)]])
    return Fill([stroke @ back for stroke in strokes], kept)


def _rows(part: Polygon, spacing: float, done: float) -> list[FloatArray]:
    """Horizontal intervals (k, 3) of x from, x to, y for each line across the part, from the bottom up.

    done : how far from the part's border everything is marked already, m; nothing is where it is not above 0
    """
    import shapely

    left, bottom, right, top = part.bounds
    height = top - bottom - 2 * max(done, 0.0)
    gaps = math.ceil(height / spacing - 1e-9)
    count = max(gaps, 0) if done > 0 else gaps + 1
    if count > MAX_LINES:
        raise LimitError(
            f"a fill of {height:g} m at a spacing of {spacing:g} m needs {count} lines; at most {MAX_LINES} are made"
        )
    if done > 0:  # marks side by side from border to border
        levels = bottom + done + height * (np.arange(count) + 0.5) / max(count, 1)
    elif height < spacing / 10:  # two lines would all but coincide
        levels = np.array([(bottom + top) / 2])
    else:
        # The outermost lines lie on the inset outline itself; a hair inside they cut it instead of touching it.
        hair = height * 1e-7
        levels = np.linspace(bottom + hair, top - hair, count)
    rows = []
    for y in levels.tolist():
        cut = shapely.get_parts(shapely.intersection(part, shapely.LineString([(left - 1, y), (right + 1, y)])))
        pieces = [np.sort(shapely.get_coordinates(line)[[0, -1], 0]) for line in cut if line.length > 0]
        pieces.sort(key=lambda ends: float(ends[0]))
        rows.append(np.array([[a, b, y] for a, b in pieces]).reshape(-1, 3))
    return rows


def _joined(rows: list[FloatArray], within: Polygon) -> list[FloatArray]:
    """Boustrophedon strokes: a line goes on with the one above it when each is the other's only neighbour and the
    step between their ends stays inside the polygon."""
    import shapely

    strokes: list[FloatArray] = []
    shapely.prepare(within)
    open_strokes: dict[int, list[tuple[float, float]]] = {}  # interval of the row below -> its stroke so far
    below: FloatArray = np.zeros((0, 3))
    for row in rows:
        overlap = (below[:, None, 0] < row[None, :, 1]) & (row[None, :, 0] < below[:, None, 1])
        alone, ending = np.flatnonzero(~overlap.any(axis=0)), np.flatnonzero(~overlap.any(axis=1))
        if len(alone) == len(ending) == 1:  # towards the tip of a slanted corner
            overlap[ending[0], alone[0]] = True
        going_on: dict[int, list[tuple[float, float]]] = {}
        for j, (a, b, y) in enumerate(row.tolist()):
            under = np.flatnonzero(overlap[:, j])
            if len(under) == 1 and overlap[under[0]].sum() == 1:
                stroke = open_strokes.pop(int(under[0]))
                x, _ = stroke[-1]
                ends = [(a, y), (b, y)] if abs(x - a) <= abs(x - b) else [(b, y), (a, y)]
                if within.covers(shapely.LineString([stroke[-1], ends[0]])):
                    stroke += ends
                    going_on[j] = stroke
                    continue
                strokes.append(np.array(stroke))
            going_on[j] = [(a, y), (b, y)]
        strokes += [np.array(stroke) for stroke in open_strokes.values()]
        open_strokes, below = going_on, row
    return strokes + [np.array(stroke) for stroke in open_strokes.values()]
