"""Words of three parts by Newton's method, in compiled code. Lengths are in least radii (see `spiral`).

A word is CSC, a turn, a line and a turn back to the end's curvature, or CCC, three extrema of the curvature in turn:
up, down, up (or the mirror image). The valley of a CCC may stay above 0 (a dip), or reach -1 and hold there. A turn is
given by its extended extremum t: the curvature climbs to min(t, 1), and for t > 1 an arc of 2 (t - 1) / s is driven.

To lengthen a path by dl where its curvature is k, at place J with heading u, moves any later place E by
(u + k perp(E - J)) dl and turns it by k dl: the columns of Newton's matrix.
"""

from __future__ import annotations

import math

from optplan.compiled import njit
from optplan.domain.arrays import FloatArray
from optplan.geometry._kernels.cc_turns import Limits, Side
from optplan.geometry._kernels.spiral import spiral

CSC, CCC = 0, 1
TWO_PI = 2.0 * math.pi
STEPS = 40
PATIENCE = 10
"""steps after which the error must halve each time, as it does where two extrema are about to merge"""
CLOSE = 1e-12
"""An end this close, in units of the path's length, is reached."""


@njit(
    "int64(int64, float64, float64, float64, float64, float64, float64, float64, float64, float64[:, ::1])",
    cache=True,
    nogil=True,
    error_model="numpy",
)
def word_pieces(
    kind: int, d1: float, d2: float, t1: float, m: float, t2: float, a: float, b: float, s: float, pieces: FloatArray
) -> int:
    """Writes rows curvature, sharpness, length of a word from curvature a to b; returns their number.

    d1, d2: 1 or -1, the side of the first and last turn (d2 = d1 in CCC).
    """
    n = 0
    k = a
    for i in range(3):
        if i == 1 and kind == CSC:
            if k != 0.0:
                pieces[n, 0], pieces[n, 1], pieces[n, 2] = k, -math.copysign(s, k), abs(k) / s
                n += 1
            pieces[n, 0], pieces[n, 1], pieces[n, 2] = 0.0, 0.0, m
            n += 1
            k = 0.0
            continue
        t = t1 if i == 0 else (m if i == 1 else t2)
        side = d1 if i == 0 else (-d1 if i == 1 else d2)
        top = min(t, 1.0)
        # an extremum that is not one: the clothoids' lengths come out negative, and the word is refused
        pieces[n, 0], pieces[n, 1], pieces[n, 2] = k, side * s, (top - side * k) / s
        n += 1
        k = side * top
        pieces[n, 0], pieces[n, 1], pieces[n, 2] = k, 0.0, 2.0 * max(t - 1.0, 0.0) / s
        n += 1
    pieces[n, 0], pieces[n, 1], pieces[n, 2] = k, -d2 * s, (d2 * k - d2 * b) / s
    return n + 1


@njit(
    "UniTuple(float64, 8)(float64, float64, UniTuple(float64, 9), UniTuple(float64, 6), float64[:, ::1])",
    cache=True,
    nogil=True,
    error_model="numpy",
)
def _half(
    t: float, m: float, side: Side, limits: Limits, table: FloatArray
) -> tuple[float, float, float, float, float, float, float, float]:
    """From an end over its peak to the middle of a CCC word, from the origin and with the peak to the left.

    Place, heading, its cosine and sine; and how a metre more at the peak (curvature top) moves the place: x, y, top.
    """
    _, a, _, ox, oy, ca, sa, _, _ = side
    s, ex, ey, half, g_held, h_held = limits
    # exp(i half) of the limit itself
    limit_c = -ey - h_held
    limit_s = ex - g_held
    top = min(t, 1.0)
    pc = limit_c
    ps = limit_s
    if t < 1.0:
        ex, ey = spiral(table, top)
        pc = math.cos(half * top * top)
        ps = math.sin(half * top * top)
    x = ca * ex - sa * ey + ox
    y = sa * ex + ca * ey + oy
    c = ca * pc - sa * ps
    sn = sa * pc + ca * ps
    theta = half * (2.0 * top * top - a * a)
    jx, jy, jc, js = x, y, c, sn
    if t > 1.0:
        arc = 2.0 * (t - 1.0) / s
        theta += arc
        ac = math.cos(arc)
        as_ = math.sin(arc)
        c = jc * ac - js * as_
        sn = js * ac + jc * as_
        x += sn - js
        y -= c - jc
    # down to the middle: the chord is seen from the heading at which the clothoid would come back to 0
    c, sn = c * pc - sn * ps, sn * pc + c * ps
    k = -min(m, 1.0)
    kx = -limits[1]
    ky = -limits[2]
    kc = limit_c
    ks = limit_s
    if m < 1.0:
        kx, ky = spiral(table, k)
        kc = math.cos(half * k * k)
        ks = math.sin(half * k * k)
    dx = ex - kx
    dy = ky - ey
    x += c * dx - sn * dy
    y += sn * dx + c * dy
    c, sn = c * kc + sn * ks, sn * kc - c * ks
    theta -= half * k * k
    if m > 1.0:
        arc = (m - 1.0) / s
        theta -= arc
        ac = math.cos(arc)
        as_ = math.sin(arc)
        bx = sn
        by = c
        c, sn = c * ac + sn * as_, sn * ac - c * as_
        x -= sn - bx
        y += c - by
    return x, y, theta, c, sn, jc - top * (y - jy), js + top * (x - jx), top


@njit(
    "UniTuple(float64, 4)(float64, float64, float64, float64, float64, float64, UniTuple(float64, 9),"
    "UniTuple(float64, 9), UniTuple(float64, 6), float64[:, ::1], float64, float64)",
    cache=True,
    nogil=True,
    error_model="numpy",
)
def three_extrema(
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
    longest: float,
    near: float,
) -> tuple[float, float, float, float]:
    """Newton's method for a CCC word: its length (inf: none, or above `longest`), and its extrema.

    A guess that misses by more than `near`, in units of its length, is given up.

    Both halves are driven from their ends; how they miss each other in the middle is the residual. So a reversed query
    takes the same steps. x, y, theta are mirrored for a word whose outer turns are to the right.
    """
    s = limits[0]
    a = side1[1]
    b = side2[1]
    c_end = math.cos(theta)
    s_end = math.sin(theta)
    # a step of much more than about a radian, or than half the way to the limit, is not to be trusted
    cap = 1.0 + 1.2 / s
    before = math.inf
    for step in range(STEPS):
        length = (2.0 * (t1 + m + t2) - a - b) / s
        x1, y1, h1, c1, s1, q11, q21, p1 = _half(t1, m, side1, limits, table)
        x2, y2, h2, c2, s2, vx, vy, p2 = _half(t2, m, side2, limits, table)
        ex = x - c_end * x2 - s_end * y2 - x1
        ey = y - s_end * x2 + c_end * y2 - y1
        et = theta - h2 - h1
        et -= TWO_PI * math.floor(et / TWO_PI + 0.5)
        size = 1.0 + abs(length)
        error = abs(ex) + abs(ey) + size * abs(et)
        k = -min(m, 1.0)
        # an extremum that is not one: its clothoids would be driven backwards
        least = min(p1 - max(a, k), p2 - max(b, k))
        if error <= CLOSE * size:
            if least < -1e-11 or length <= 0.0 or length > longest:
                break
            return length, t1, m, t2
        if step >= PATIENCE and error > 0.5 * before:
            break
        before = error
        # most guesses that lead nowhere still miss by much of their length after a few steps
        hopeless = near if step == 0 else (0.9 if step < 3 else (0.5 if step < 5 else 0.15))
        if error > hopeless * size:
            break
        if step > 2 and (length - 2.0 * (abs(ex) + abs(ey)) > longest or least < -0.1 - s * error):
            break
        q13 = c_end * vx + s_end * vy
        q23 = s_end * vx - c_end * vy
        q12 = 0.5 * (c1 + c_end * c2 + s_end * s2)
        q22 = 0.5 * (s1 + s_end * c2 - c_end * s2)
        m1 = q22 * p2 - q23 * k
        m2 = q23 * p1 - q21 * p2
        m3 = q21 * k - q22 * p1
        det = q11 * m1 + q12 * m2 + q13 * m3
        if abs(det) < 1e-40:
            break
        g1 = (ex * m1 + q12 * (q23 * et - ey * p2) + q13 * (ey * k - q22 * et)) / det
        g2 = (q11 * (ey * p2 - q23 * et) + ex * m2 + q13 * (q21 * et - ey * p1)) / det
        g3 = (q11 * (q22 * et - ey * k) + q12 * (ey * p1 - q21 * et) + ex * m3) / det
        largest = max(max(abs(g1), abs(g3)), abs(g2))
        scale = 0.5 * s * (cap / largest if largest > cap else 1.0)
        t1 = max(t1 + g1 * scale, -1.0)
        m = max(m + g2 * scale, -1.0)
        t2 = max(t2 + g3 * scale, -1.0)
    return math.inf, t1, m, t2
