"""Patterns of equal circles that cover the plane, laid over an area so that few of them touch it."""

from __future__ import annotations

import math
from typing import Any, NamedTuple

import numpy as np

from optplan.domain.arrays import FloatArray

PATTERNS = ("hexagon", "square", "brick", "stretched")
OFFSETS = 8
"""Places in each direction at which a pattern is laid."""
TURNS = {"hexagon": (0, 30, 10, 20, 40, 50), "square": (0, 45, 15, 30, 60, 75), "brick": (0, 90, 30, 60, 120, 150)}
STRETCHES = np.linspace(1.3, 1.9, 25)
"""Distances in a row of the stretched pattern, in radii: narrower ones leave more room between rows."""
"""Degrees by which a pattern is turned; the first is the plain one, with level rows."""


class Cell(NamedTuple):
    """A pattern of circles of radius 1: rows of them."""

    across: float
    """between the circles of a row"""
    up: float
    """between rows"""
    shift: float
    """of every other row"""


CELLS = {
    # equilateral triangles whose corners are sqrt(3) apart: three circles meet in one point (R. Kershner, The number
    # of circles covering a set, American Journal of Mathematics 61 (1939))
    "hexagon": Cell(math.sqrt(3), 1.5, math.sqrt(3) / 2),
    "square": Cell(math.sqrt(2), math.sqrt(2), 0.0),
    # rows as in the square pattern; shifted by half a circle they may be further apart
    "brick": Cell(math.sqrt(2), 1 + math.sqrt(0.5), math.sqrt(0.5)),
}


def stretched(across: float) -> Cell:
    """The pattern with so much between the circles of a row, and rows as far apart as that allows."""
    return Cell(across, 1 + math.sqrt(1 - across**2 / 4), across / 2)


class Laid(NamedTuple):
    """A pattern laid over an area."""

    pattern: str
    turn: float
    """degrees"""
    offset: tuple[float, float]
    """shares of a cell"""
    centres: FloatArray
    """(n, 2) m, of the circles that touch the area"""
    cell: Cell = CELLS["hexagon"]

    def __str__(self) -> str:
        return self.pattern + (f" turned by {self.turn:g} degrees" if self.turn else "")


def lay(
    area: Any,
    radius: float,
    pattern: str,
    turn: float = 0.0,
    offset: tuple[float, float] = (0.0, 0.0),
    cell: Cell | None = None,
) -> Laid:
    """A pattern of circles (radius in m) over an area (shapely): those that touch it.

    turn : degrees against the clock; offset : shares of a cell, 0..1; cell : when it is not the pattern's usual one
    """
    import shapely

    cell = cell or CELLS[pattern]
    angle = math.radians(turn)
    axes = np.array([[math.cos(angle), math.sin(angle)], [-math.sin(angle), math.cos(angle)]])
    left, bottom, right, top = area.bounds
    corners = np.array([[left, bottom], [right, bottom], [right, top], [left, top]]) @ axes.T
    (low_x, low_y), (high_x, high_y) = corners.min(axis=0), corners.max(axis=0)
    dx, dy = cell.across * radius, cell.up * radius
    rows = np.arange(-2 - offset[1] * 2, (high_y - low_y) / dy + 3)
    columns = np.arange(-2 - offset[0], (high_x - low_x) / dx + 3)
    shifts = cell.shift * radius * (np.arange(len(rows)) % 2)
    x = low_x + columns[None] * dx + shifts[:, None]
    y = np.broadcast_to(low_y + rows[:, None] * dy, x.shape)
    points = np.column_stack([x.ravel(), y.ravel()]) @ axes
    points = points[shapely.dwithin(area, shapely.points(points), radius * (1 - 1e-9))]
    return Laid(pattern, turn, offset, points, cell)


def plain(area: Any, radius: float, pattern: str) -> Laid:
    """The pattern as it is usually laid: level rows, the first circle half a radius within the lower left corner."""
    cell = CELLS[pattern]
    half = (cell.across / 2, cell.up / 2)
    return lay(area, radius, pattern, 0.0, (1 - half[0] / cell.across, 1 - half[1] / (2 * cell.up)))


def placements(area: Any, radius: float, pattern: str, *, turned: bool = True) -> list[Laid]:
    """A pattern laid at many places and turns, those that touch the area with the fewest circles first.

    Without `turned` rows stay level.
    """
    import shapely

    shapely.prepare(area)
    shares = [k / OFFSETS for k in range(OFFSETS)]
    if pattern == "stretched":
        cells = [stretched(across) for across in STRETCHES.tolist()]
        made = [
            lay(area, radius, pattern, turn, (a, b), cell)
            for cell in cells
            for turn in ((0, 90) if turned else (0,))
            for a in shares
            for b in shares
        ]
        return sorted(made, key=lambda laid: len(laid.centres))
    turns = TURNS[pattern] if turned else TURNS[pattern][:1]
    made = [plain(area, radius, pattern)]
    made += [lay(area, radius, pattern, turn, (a, b)) for turn in turns for a in shares for b in shares]
    return sorted(made, key=lambda laid: len(laid.centres))
