"""All words at full sharpness, in compiled code. Lengths are in least radii (see `spiral`)."""

from __future__ import annotations

import math

import numpy as np

from optplan.compiled import njit
from optplan.domain.arrays import FloatArray
from optplan.geometry._kernels.cc_scan import FACTOR, LINES, lines
from optplan.geometry._kernels.cc_turns import Limits, Side, from_least, limits_of, side_of
from optplan.geometry._kernels.cc_words import CCC, CSC, three_extrema
from optplan.geometry._kernels.spiral import spiral

TWO_PI = 2.0 * math.pi
LONG = 0.15
"""sharpness limit from which on a turn by more than two circles is tried"""
WIDE = 24
"""rows of valleys down to the limit, and as many of arcs there"""
SLIGHT = 0.12
"""guess of the valley of a slight counter-turn"""
HARD = 0.5
"""sharpness limit from which on words are so long that slight counter-turns pay"""


@njit("float64[:, ::1](float64, float64[:, ::1])", cache=True, nogil=True, error_model="numpy")
def middle_table(s: float, table: FloatArray) -> FloatArray:
    """Rows w, reach, turned of the half of a CCC's middle, from the circle at the limit to its extremum (n, 3).

    w is the extended valley, from -1 (curvature stays at the limit) past 1 (arc against the turn). Seen from the
    middle, where the heading is 0, `reach` is how far ahead the middle is of the first circle's centre, and `turned` by
    how much the heading grows from the limit's end to the middle.
    """
    n = WIDE
    rows = np.empty((2 * n, 3))
    ex1, ey1 = spiral(table, 1.0)
    for i in range(2 * n):
        w = -1.0 + 2.0 * i / (n - 1) if i < n else 1.0 + 0.5 * s * TWO_PI * (i - n + 1) / n
        k = -min(w, 1.0)
        arc = max(w - 1.0, 0.0) / s
        turned = 0.5 * (1.0 - k * k) / s
        # start at the limit, heading 0, centre (0, 1); down to k, half the arc
        exk, eyk = spiral(table, k)
        c = math.cos(0.5 / s)
        sn = math.sin(0.5 / s)
        dx = ex1 - exk
        dy = -(ey1 - eyk)
        x = c * dx - sn * dy
        y = sn * dx + c * dy - 1.0
        if arc > 0.0:
            x -= math.sin(turned - arc) - math.sin(turned)
            y += math.cos(turned - arc) - math.cos(turned)
            turned -= arc
        rows[i, 0] = w
        rows[i, 1] = x * math.cos(turned) + y * math.sin(turned)
        rows[i, 2] = turned
    return rows


@njit(
    "void(float64[:, ::1], int64, int64, float64, float64, float64, float64, float64, float64)",
    cache=True,
    nogil=True,
    error_model="numpy",
)
def _keep(
    best: FloatArray, row: int, kind: int, d1: float, d2: float, t1: float, m: float, t2: float, length: float
) -> None:
    if length < best[row, 0]:
        best[row, 0] = length
        best[row, 1] = kind
        best[row, 2] = d1
        best[row, 3] = d2
        best[row, 4] = t1
        best[row, 5] = m
        best[row, 6] = t2


@njit("float64(float64, float64)", cache=True, nogil=True, error_model="numpy")
def _extended(t: float, s: float) -> float:
    """Angle turned between curvatures 0 around an extended extremum."""
    return (t * t if t < 1.0 else 2.0 * t - 1.0) / s


@njit(
    "void(int64, float64, float64, float64, float64, float64, float64, UniTuple(float64, 9), UniTuple(float64, 9),"
    "UniTuple(float64, 6), float64[:, ::1], float64, float64[:, ::1], float64)",
    cache=True,
    nogil=True,
    error_model="numpy",
)
def _try(
    row: int,
    t1: float,
    m: float,
    t2: float,
    x: float,
    y: float,
    theta: float,
    side1: Side,
    side2: Side,
    limits: Limits,
    table: FloatArray,
    distance: float,
    best: FloatArray,
    bound: float,
) -> None:
    """Starts Newton's method unless the guess is much too long, or too short to come this far."""
    guess = (2.0 * (t1 + m + t2) - side1[1] - side2[1]) / limits[0]
    if guess > FACTOR * bound or 1.2 * guess < distance:
        return
    length, t1, m, t2 = three_extrema(t1, m, t2, x, y, theta, side1, side2, limits, table, bound)
    _keep(best, row, CCC, side1[0], side1[0], t1, m, t2, length)


@njit(
    "void(int64, float64, float64, float64, UniTuple(float64, 9), UniTuple(float64, 9), UniTuple(float64, 6),"
    "float64[:, ::1], float64[:, ::1], float64[:, ::1], float64)",
    cache=True,
    nogil=True,
    error_model="numpy",
)
def _three_turns(
    row: int,
    x: float,
    y: float,
    theta: float,
    side1: Side,
    side2: Side,
    limits: Limits,
    table: FloatArray,
    middles: FloatArray,
    best: FloatArray,
    bound: float,
) -> None:
    """CCC words of two guesses: small outer turns, and circles at the limit whose centres the middle spans.

    Mirrored for RLR. Guesses much above `bound` are left out; it does not change on the way, so that a reversed query
    tries the same ones.
    """
    s = limits[0]
    a = side1[1]
    b = side2[1]
    distance = math.hypot(x, y)
    # wiggles about the mean of the ends' curvatures, as long as the chord: the ways of short moves along a curve
    wiggle = 0.25 * s * distance
    loose = 0.01 + 0.3 * s * distance * distance
    off = theta - 0.5 * (a + b) * distance
    off -= TWO_PI * math.floor(off / TWO_PI + 0.5)
    if wiggle < 2.0 and abs(off) < loose:
        k = max(0.5 * (a + b) - wiggle, -1.0)
        t1 = max(a + 0.5 * wiggle, k)
        t2 = max(b + 0.5 * wiggle, k)
        _try(row, t1, -k, t2, x, y, theta, side1, side2, limits, table, distance, best, bound)
    t1 = max(0.15, a + 0.05)
    t2 = max(0.15, b + 0.05)
    turning = from_least(_extended(t1, s) + _extended(t2, s) - 0.5 * (a * a + b * b) / s - theta, 0.0)
    for j in range(3 if s < LONG else 2):
        most = turning + j * TWO_PI
        m = math.sqrt(s * most) if s * most < 1.0 else 0.5 * (s * most + 1.0)
        _try(row, t1, m, t2, x, y, theta, side1, side2, limits, table, distance, best, bound)
    c = math.cos(theta)
    sn = math.sin(theta)
    gx = x - c * side2[7] - sn * side2[8] - side1[7]
    gy = y - sn * side2[7] + c * side2[8] - side1[8]
    half = 0.5 * math.hypot(gx, gy)
    across = math.atan2(gy, gx)
    ta = 0.5 * (1.0 - a * a) / s
    tb = 0.5 * (1.0 - b * b) / s
    for i in range(len(middles) - 1):
        for way in range(2):
            sign = 1.0 - 2.0 * way
            f0 = sign * middles[i, 1] - half
            f1 = sign * middles[i + 1, 1] - half
            if f0 * f1 > 0.0:
                continue
            u = f0 / (f0 - f1) if f0 != f1 else 0.5
            w = middles[i, 0] + u * (middles[i + 1, 0] - middles[i, 0])
            turned = middles[i, 2] + u * (middles[i + 1, 2] - middles[i, 2])
            chi = across + math.pi * way
            arc1 = from_least(chi - turned - ta, 0.0)
            arc2 = from_least(theta - chi - turned - tb, 0.0)
            for j in range(4):
                t1 = 1.0 + 0.5 * s * (arc1 - TWO_PI * (j & 1))
                t2 = 1.0 + 0.5 * s * (arc2 - TWO_PI * (j >> 1))
                if t1 >= -w and t2 >= -w:
                    t1 = max(t1, 0.1)
                    t2 = max(t2, 0.1)
                    _try(row, t1, w, t2, x, y, theta, side1, side2, limits, table, distance, best, bound)


@njit(
    "void(float64, float64, float64, float64, float64, float64, float64[:, ::1], float64[:, ::1], float64[:, ::1])",
    cache=True,
    nogil=True,
    error_model="numpy",
)
def full_words(
    x: float,
    y: float,
    theta: float,
    a: float,
    b: float,
    s: float,
    table: FloatArray,
    middles: FloatArray,
    best: FloatArray,
) -> None:
    """Improves rows length, kind, d1, d2, t1, m, t2 of the shortest LSL, RSR, LSR, RSL, LRL, RLR (6, 7).

    From the origin with heading 0 and curvature a to x, y, theta with curvature b. Rows above the sixth are only looked
    at: what is much longer than the shortest of all is not searched for.
    """
    limits = limits_of(s, table)
    sides = (
        side_of(1.0, a, limits, table),
        side_of(-1.0, a, limits, table),
        side_of(1.0, b, limits, table),
        side_of(-1.0, b, limits, table),
    )
    found = np.empty((LINES, 5))
    shortest = best[:, 0].min()
    count = lines(x, y, theta, sides, limits, table, FACTOR * shortest, found)
    for i in range(count):
        if found[i, 2] >= -1e-10 and found[i, 1] > 0.0:
            row = int(found[i, 0])
            d1 = 1.0 if row == 0 or row == 2 else -1.0
            d2 = 1.0 if row == 0 or row == 3 else -1.0
            _keep(best, row, CSC, d1, d2, found[i, 3], max(found[i, 2], 0.0), found[i, 4], found[i, 1])
            shortest = min(shortest, found[i, 1])
    distance = math.hypot(x, y)
    for i in range(count):
        row = int(found[i, 0])
        m = found[i, 2]
        if row < 2 and (m < 0.0 or s < HARD):
            # a line that would be driven backwards: a valley above 0 takes its place; and a short one may do better
            # as a slight turn the other way
            d = 1.0 - 2.0 * row
            m = max(-0.95, 0.5 * s * m) if m < 0.0 else SLIGHT
            _try(
                4 + row,
                found[i, 3],
                m,
                found[i, 4],
                x,
                d * y,
                d * theta,
                sides[0] if row == 0 else sides[1],
                sides[2] if row == 0 else sides[3],
                limits,
                table,
                distance,
                best,
                shortest,
            )
    for row in range(2):
        d = 1.0 - 2.0 * row
        _three_turns(
            4 + row,
            x,
            d * y,
            d * theta,
            sides[0] if row == 0 else sides[1],
            sides[2] if row == 0 else sides[3],
            limits,
            table,
            middles,
            best,
            shortest,
        )
