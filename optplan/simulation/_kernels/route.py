"""The plan as a simulated robot reads it: places along the path, the schedule, the nearest place."""

from __future__ import annotations

import math
from typing import NamedTuple

from optplan.compiled import njit
from optplan.domain.arrays import FloatArray, IntArray
from optplan.geometry._kernels.clothoid import clothoid_end

X, Y, HEADING, KAPPA, SIGMA, LENGTH, OFFSET = range(7)
"""Columns of a piece; the heading is that of travel."""
KNOT_S, KNOT_T, KNOT_V = range(3)
"""Columns of a knot."""
LEG, STOP = 0, 1
"""Kinds of a phase: driven without a rest, or stood."""
KIND, FIRST, LAST, KNOT, LAST_KNOT = range(5)
"""Integer columns of a phase: its kind, its pieces FIRST..LAST - 1, its knots KNOT..LAST_KNOT."""
BODY, TURN, SPAN, GEAR = range(4)
"""Other columns of a phase: heading of the body at its beginning, rad turned, seconds, and 1 or -1 (backwards)."""


class Route(NamedTuple):
    """A plan in arrays."""

    pieces: FloatArray
    """(n, 7)"""
    tools: IntArray
    """(n,) tool setting"""
    knots: FloatArray
    """(k, 3)"""
    phases: IntArray
    """(m, 5)"""
    turns: FloatArray
    """(m, 4)"""


@njit(cache=True, nogil=True)
def seek(pieces: FloatArray, first: int, last: int, row: int, s: float) -> int:
    """The piece of a leg on which the arc length s (m) lies; `row` is where to begin to look."""
    while row > first and s < pieces[row, OFFSET]:
        row -= 1
    while row < last - 1 and s >= pieces[row + 1, OFFSET]:
        row += 1
    return row


@njit(cache=True, nogil=True)
def place(pieces: FloatArray, row: int, s: float) -> tuple[float, float, float, float]:
    """x, y, heading and curvature at arc length s of a piece; straight on beyond the piece's end."""
    p = pieces[row]
    into = s - p[OFFSET]
    beyond = into - p[LENGTH]
    if beyond > 0:
        into = p[LENGTH]
    x, y, heading, kappa = clothoid_end(p[X], p[Y], p[HEADING], p[KAPPA], p[SIGMA], into)
    if beyond > 0:
        x += beyond * math.cos(heading)
        y += beyond * math.sin(heading)
    return x, y, heading, kappa


@njit(cache=True, nogil=True)
def scheduled(knots: FloatArray, first: int, last: int, knot: int, t: float) -> tuple[float, float, int]:
    """Arc length and speed t seconds after the beginning of a leg, and the knot before; at rest from its end on."""
    begun = knots[first, KNOT_T]
    while knot < last - 1 and t >= knots[knot + 1, KNOT_T] - begun:
        knot += 1
    span = knots[knot + 1, KNOT_T] - knots[knot, KNOT_T]
    into = t - (knots[knot, KNOT_T] - begun)
    if into >= span:
        return knots[last, KNOT_S], 0.0, knot
    before = knots[knot, KNOT_V]
    rate = (knots[knot + 1, KNOT_V] - before) / span
    return knots[knot, KNOT_S] + into * (before + 0.5 * rate * into), before + rate * into, knot


@njit(cache=True, nogil=True)
def nearest(
    route: Route,
    phase: int,
    row: int,
    s: float,
    low: float,
    high: float,
    x: float,
    y: float,
    right: float,
    ahead: float,
) -> tuple[float, int]:
    """Arc length of the place nearest to (x, y), found by steps from s within low..high, and its piece.

    `right`, `ahead`: of the point that is meant, seen in the direction of travel; its line runs with the velocity
    (1 + kappa right, kappa ahead). Steps follow that velocity, so that a path crossing itself nearby is no matter.
    """
    first, last = route.phases[phase, FIRST], route.phases[phase, LAST]
    for _ in range(4):
        row = seek(route.pieces, first, last, row, s)
        px, py, heading, kappa = place(route.pieces, row, s)
        c, z = math.cos(heading), math.sin(heading)
        ex = x - (px + ahead * c + right * z)
        ey = y - (py + ahead * z - right * c)
        along, across = 1.0 + kappa * right, kappa * ahead
        square = along * along + across * across
        if square < 1e-6:
            break
        step = (along * (ex * c + ey * z) + across * (ey * c - ex * z)) / square
        moved = min(max(s + step, low), high)
        if abs(moved - s) < 1e-12:
            break
        s = moved
    return s, seek(route.pieces, first, last, row, s)
