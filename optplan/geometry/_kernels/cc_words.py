"""Words of three parts by Newton's method, in compiled code. Lengths are in least radii (see `spiral`).

A word is CSC, a turn, a line and a turn back to the end's curvature, or CCC, three extrema of the curvature in turn:
up, down, up (or the mirror image). The valley of a CCC may stay above 0 (a dip), or reach -1 and hold there. A turn is
given by its extended extremum t: the curvature climbs to min(t, 1), and for t > 1 an arc of 2 (t - 1) / s is driven.

To lengthen a path by dl where its curvature is k, at place J with heading u, moves its end E by
(u + k perp(E - J)) dl and turns it by k dl: the columns of Newton's matrix, for peaks and lines alike.
"""

from __future__ import annotations

import math

from optplan.compiled import njit
from optplan.domain.arrays import FloatArray
from optplan.geometry._kernels.clothoid import clothoid_end
from optplan.geometry._kernels.spiral import spiral

CSC, CCC = 0, 1
TWO_PI = 2.0 * math.pi
STEPS = 12
CLOSE = 1e-12
"""An end this close, in units of the path's length, is reached."""


@njit(
    "int64(int64, float64, float64, float64, float64, float64, float64, float64, float64, float64[:, ::1])",
    cache=True,
    nogil=True,
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


@njit("UniTuple(float64, 4)(float64[:, ::1], int64, float64)", cache=True, nogil=True)
def drive(pieces: FloatArray, n: int, a: float) -> tuple[float, float, float, float]:
    """The exact end of pieces that start in the origin, and the length driven; the least piece decides on its sign."""
    x = y = theta = 0.0
    length = 0.0
    for i in range(n):
        x, y, theta, _ = clothoid_end(x, y, theta, pieces[i, 0], pieces[i, 1], pieces[i, 2])
        length += pieces[i, 2]
    return x, y, theta, length


@njit(
    "UniTuple(float64, 3)(float64[:, ::1], float64, float64, float64, float64, float64, float64, float64)",
    cache=True,
    nogil=True,
)
def _clothoid(
    table: FloatArray, s: float, x: float, y: float, theta: float, k0: float, k1: float, rate: float
) -> tuple[float, float, float]:
    """Place and heading after the clothoid from curvature k0 to k1 at sharpness `rate` (s or -s)."""
    x0, y0 = spiral(table, k0)
    x1, y1 = spiral(table, k1)
    turned = 0.5 * k0 * k0 / rate
    c = math.cos(theta - turned)
    sn = math.sin(theta - turned)
    dx = x1 - x0
    dy = y1 - y0
    if rate < 0.0:
        dx = -dx
    return x + c * dx - sn * dy, y + sn * dx + c * dy, theta - turned + 0.5 * k1 * k1 / rate


@njit(
    "Tuple((boolean, float64, float64, float64, float64))(int64, float64, float64, float64, float64, float64, "
    "float64, float64, float64, float64, float64, float64, float64[:, ::1], float64)",
    cache=True,
    nogil=True,
)
def newton(
    kind: int,
    d1: float,
    d2: float,
    t1: float,
    m: float,
    t2: float,
    a: float,
    b: float,
    s: float,
    x_end: float,
    y_end: float,
    theta_end: float,
    table: FloatArray,
    longest: float,
) -> tuple[bool, float, float, float, float]:
    """Solves a word for its end: whether it is one, its three numbers, its length. Stops above length `longest`."""
    unit = 2.0 / s
    for step in range(STEPS):
        t1 = max(t1, -1.0)
        t2 = max(t2, -1.0)
        # the first extremum
        p1 = d1 * min(t1, 1.0)
        x, y, theta = _clothoid(table, s, 0.0, 0.0, 0.0, a, p1, d1 * s)
        jx1, jy1, jt1 = x, y, theta
        c1 = math.cos(theta)
        s1 = math.sin(theta)
        if t1 > 1.0:
            arc = (t1 - 1.0) * unit
            theta += d1 * arc
            x += d1 * (math.sin(theta) - s1)
            y -= d1 * (math.cos(theta) - c1)
        if kind == CSC:
            x, y, theta = _clothoid(table, s, x, y, theta, p1, 0.0, -d1 * s)
            jx2, jy2 = x, y
            c2 = math.cos(theta)
            s2 = math.sin(theta)
            k2 = 0.0
            x += m * c2
            y += m * s2
            p2 = d2 * min(t2, 1.0)
            x, y, theta = _clothoid(table, s, x, y, theta, 0.0, p2, d2 * s)
            length = (2.0 * t1 - d1 * a) / s + m + (2.0 * t2 - d2 * b) / s
            rise = min(t1, 1.0) - d1 * a
            fall = min(t2, 1.0) - d2 * b
            rise2 = min(t1, 1.0)
            fall2 = min(t2, 1.0)
        else:
            m = max(m, -1.0)
            k2 = -d1 * min(m, 1.0)
            x, y, theta = _clothoid(table, s, x, y, theta, p1, k2, -d1 * s)
            jx2, jy2 = x, y
            c2 = math.cos(theta)
            s2 = math.sin(theta)
            if m > 1.0:
                arc = (m - 1.0) * unit
                theta -= d1 * arc
                x -= d1 * (math.sin(theta) - s2)
                y += d1 * (math.cos(theta) - c2)
            p2 = d2 * min(t2, 1.0)
            x, y, theta = _clothoid(table, s, x, y, theta, k2, p2, d2 * s)
            length = (2.0 * (t1 + m + t2) - d1 * a - d2 * b) / s
            rise = min(t1, 1.0) - d1 * a
            fall = min(t2, 1.0) - d2 * b
            rise2 = min(t1, 1.0) + min(m, 1.0)
            fall2 = min(t2, 1.0) + min(m, 1.0)
        jx3, jy3 = x, y
        c3 = math.cos(theta)
        s3 = math.sin(theta)
        if t2 > 1.0:
            arc = (t2 - 1.0) * unit
            theta += d2 * arc
            x += d2 * (math.sin(theta) - s3)
            y -= d2 * (math.cos(theta) - c3)
        x, y, theta = _clothoid(table, s, x, y, theta, p2, b, -d2 * s)
        ex = x_end - x
        ey = y_end - y
        et = theta_end - theta
        et -= TWO_PI * math.floor(et / TWO_PI + 0.5)
        size = 1.0 + abs(length)
        error = abs(ex) + abs(ey) + size * abs(et)
        if error <= CLOSE * size:
            good = min(min(rise, fall), min(rise2, fall2)) >= -1e-11 and (kind == CCC or m >= -1e-11 * size)
            return good, t1, m, t2, length
        if step > 2 and error > 0.5 * size:
            break
        if step > 2 and length - 2.0 * (abs(ex) + abs(ey)) > longest:
            break
        # columns: what a metre more at each place does to the end
        q11 = c1 - p1 * (y - jy1)
        q21 = s1 + p1 * (x - jx1)
        q12 = c2 - k2 * (y - jy2)
        q22 = s2 + k2 * (x - jx2)
        q13 = c3 - p2 * (y - jy3)
        q23 = s3 + p2 * (x - jx3)
        m1 = q22 * p2 - q23 * k2
        m2 = q23 * p1 - q21 * p2
        m3 = q21 * k2 - q22 * p1
        det = q11 * m1 + q12 * m2 + q13 * m3
        if abs(det) < 1e-14:
            return False, t1, m, t2, math.inf
        g1 = (ex * m1 + q12 * (q23 * et - ey * p2) + q13 * (ey * k2 - q22 * et)) / det
        g2 = (q11 * (ey * p2 - q23 * et) + ex * m2 + q13 * (q21 * et - ey * p1)) / det
        g3 = (q11 * (q22 * et - ey * k2) + q12 * (ey * p1 - q21 * et) + ex * m3) / det
        # a step of more than about a radian, or most of the way to the limit, is not to be trusted
        cap = 1.0 + 0.6 * unit
        largest = max(abs(g1), abs(g3))
        if kind == CCC:
            largest = max(largest, abs(g2))
        if largest > cap:
            g1 *= cap / largest
            g2 *= cap / largest
            g3 *= cap / largest
        t1 += g1 / unit
        t2 += g3 / unit
        m += g2 if kind == CSC else g2 / unit
    return False, t1, m, t2, math.inf
