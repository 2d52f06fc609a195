"""All words at full sharpness, in compiled code. Lengths are in least radii (see `spiral`)."""

from __future__ import annotations

import math

import numpy as np

from optplan.compiled import njit
from optplan.domain.arrays import FloatArray
from optplan.geometry._kernels.cc_scan import FACTOR, LINES, lines
from optplan.geometry._kernels.cc_turns import from_least, limits_of, side_of
from optplan.geometry._kernels.cc_words import CCC, CSC, newton
from optplan.geometry._kernels.spiral import spiral

TWO_PI = 2.0 * math.pi
WIDE = 24


@njit("float64[:, ::1](float64, float64[:, ::1])", cache=True, nogil=True)
def middle_table(s: float, table: FloatArray) -> FloatArray:
    """Rows w, reach, turned of the half of a CCC's middle, from the circle at the limit to its extremum (n, 3).

    w is the extended valley, from -1 (curvature stays at the limit) past 1 (arc against the turn). Seen from the middle,
    where the heading is 0, `reach` is how far ahead the middle is of the first circle's centre, and `turned` by how
    much the heading grows from the limit's end to the middle.
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
    "void(float64[:, ::1], int64, int64, float64, float64, float64, float64, float64, float64)", cache=True, nogil=True
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


@njit("float64(float64, float64)", cache=True, nogil=True)
def _extended(t: float, s: float) -> float:
    """Angle turned between curvatures 0 around an extended extremum."""
    return (t * t if t < 1.0 else 2.0 * t - 1.0) / s


@njit(
    "float64(float64, float64, float64, float64, float64, float64, float64, float64[:, ::1], float64[:, ::1], "
    "float64[:, ::1], float64)",
    cache=True,
    nogil=True,
)
def _three_turns(
    x: float,
    y: float,
    theta: float,
    a: float,
    b: float,
    s: float,
    d: float,
    table: FloatArray,
    middles: FloatArray,
    best: FloatArray,
    shortest: float,
) -> float:
    """CCC words from circles at the limit: the middle must span their centres."""
    row = 4 if d > 0.0 else 5
    # centres of the circles, mirrored so that the outer turns are left
    ex1, ey1 = spiral(table, 1.0)
    ea_x, ea_y = spiral(table, d * a)
    eb_x, eb_y = spiral(table, d * b)
    ta = 0.5 * (1.0 - a * a) / s
    tb = 0.5 * (1.0 - b * b) / s
    c = math.cos(0.5 * a * a / s)
    sn = -math.sin(0.5 * a * a / s)
    cx1 = c * (ex1 - ea_x) - sn * (ey1 - ea_y) - math.sin(ta)
    cy1 = sn * (ex1 - ea_x) + c * (ey1 - ea_y) + math.cos(ta)
    c = math.cos(0.5 * b * b / s)
    sn = -math.sin(0.5 * b * b / s)
    ux = c * (ex1 - eb_x) - sn * (ey1 - eb_y) - math.sin(tb)
    uy = sn * (ex1 - eb_x) + c * (ey1 - eb_y) + math.cos(tb)
    end = d * theta
    c = math.cos(end)
    sn = math.sin(end)
    gx = x - c * ux - sn * uy - cx1
    gy = d * y - sn * ux + c * uy - cy1
    half = 0.5 * math.hypot(gx, gy)
    across = math.atan2(gy, gx)
    distance = math.hypot(x, y)
    # small outer turns, the middle turns the rest
    t1 = max(0.15, d * a + 0.05)
    t2 = max(0.15, d * b + 0.05)
    turning = _extended(t1, s) + _extended(t2, s) - 0.5 * (a * a + b * b) / s - end
    turning = from_least(turning, 0.0)
    for j in range(3):
        most = turning + j * TWO_PI
        m = math.sqrt(s * most) if s * most < 1.0 else 0.5 * (s * most + 1.0)
        guess = (2.0 * (t1 + m + t2) - d * (a + b)) / s
        if guess > FACTOR * shortest:
            break
        # three turns that are to come this far are longer
        if 1.2 * guess < distance:
            continue
        good, u1, um, u2, length = newton(CCC, d, d, t1, m, t2, a, b, s, x, y, theta, table, shortest)
        if good:
            _keep(best, row, CCC, d, d, u1, um, u2, length)
            shortest = min(shortest, length)
    n = len(middles)
    for i in range(n - 1):
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
            arc2 = from_least(end - chi - turned - tb, 0.0)
            for j in range(4):
                t1 = 1.0 + 0.5 * s * (arc1 - TWO_PI * (j & 1))
                t2 = 1.0 + 0.5 * s * (arc2 - TWO_PI * (j >> 1))
                if t1 < -w or t2 < -w or (2.0 * (t1 + w + t2) - d * (a + b)) / s > FACTOR * shortest:
                    continue
                good, u1, um, u2, length = newton(
                    CCC, d, d, max(t1, 0.1), w, max(t2, 0.1), a, b, s, x, y, theta, table, shortest
                )
                if good:
                    _keep(best, row, CCC, d, d, u1, um, u2, length)
                    shortest = min(shortest, length)
    return shortest


@njit(
    "void(float64, float64, float64, float64, float64, float64, float64[:, ::1], float64[:, ::1], float64[:, ::1])",
    cache=True,
    nogil=True,
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
        if row >= 2:
            continue
        d1 = 1.0 - 2.0 * row
        if m >= 0.0:
            continue
        # a line that would be driven backwards: a valley above 0 takes its place
        dip = max(-0.95, 0.5 * s * m)
        guess = (2.0 * (found[i, 3] + dip + found[i, 4]) - d1 * (a + b)) / s
        if guess > FACTOR * shortest or 1.2 * guess < distance:
            continue
        good, u1, um, u2, length = newton(
            CCC, d1, d1, found[i, 3], dip, found[i, 4], a, b, s, x, y, theta, table, shortest
        )
        if good:
            _keep(best, 4 + row, CCC, d1, d1, u1, um, u2, length)
            shortest = min(shortest, length)
    for row in range(2):
        shortest = min(shortest, _three_turns(x, y, theta, a, b, s, 1.0 - 2.0 * row, table, middles, best, shortest))
