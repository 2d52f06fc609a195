"""Words turn, line, turn at full sharpness: every heading of the line that fits, in compiled code.

A turn is seen from its outer end: it starts in the origin with heading 0 and curvature a, turns left by delta and ends
with curvature 0. Its peak is t = sqrt(s delta + a^2 / 2), held on an arc where that is above 1. A turn of the end is
the same seen backwards and reflected, a turn to the right is the mirror image.

With P1, P2 the line's ends for a heading psi, f(psi) = cross(u, P2 - P1) must vanish. Turning more swings the line about
the centre C of the circle at the peak, so f' = -u (C2 - C1).
"""

from __future__ import annotations

import math

from optplan.compiled import njit
from optplan.domain.arrays import FloatArray
from optplan.geometry._kernels.spiral import spiral

Query = tuple[float, float, float, float, float, float]
"""x, y, heading of the end seen from the start, curvatures of both, sharpness limit s"""
TWO_PI = 2.0 * math.pi


@njit("float64(float64, float64)", cache=True, nogil=True, inline="always")
def least_deflection(a: float, s: float) -> float:
    """The turn that only brings the curvature a to 0 at sharpness s; left turns turn further left."""
    return 0.5 * a * abs(a) / s


@njit("float64(float64, float64)", cache=True, nogil=True, inline="always")
def from_least(angle: float, least: float) -> float:
    """The angle, by whole turns, in [least, least + 2 pi)."""
    rest = (angle - least) / TWO_PI
    return least + TWO_PI * (rest - math.floor(rest))


@njit("UniTuple(float64, 5)(float64, float64, float64, float64[:, ::1])", cache=True, nogil=True)
def turn(delta: float, a: float, s: float, table: FloatArray) -> tuple[float, float, float, float, float]:
    """Place of a turn's inner end, its extended peak, and the centre of the circle at its peak."""
    square = max(s * delta + 0.5 * a * a, 0.0)
    peak = min(math.sqrt(square), 1.0)
    turned = 0.5 * (peak * peak - a * a) / s
    before = -0.5 * a * a / s
    ea_x, ea_y = spiral(table, a)
    ex, ey = spiral(table, peak)
    c = math.cos(before)
    sn = math.sin(before)
    jx = c * (ex - ea_x) - sn * (ey - ea_y)
    jy = sn * (ex - ea_x) + c * (ey - ea_y)
    radius = 1.0 / max(peak, 1e-12)
    cx = jx - math.sin(turned) * radius
    cy = jy + math.cos(turned) * radius
    c = math.cos(delta)
    sn = math.sin(delta)
    x = c * ex + sn * ey
    y = sn * ex - c * ey
    if square <= 1.0:
        return jx + x, jy + y, peak, cx, cy
    # on the circle for the rest: from its centre to the arc's end, then down
    down = delta - 0.5 / s
    arc = delta - (1.0 - 0.5 * a * a) / s
    return cx + math.sin(down) + x, cy - math.cos(down) + y, 1.0 + 0.5 * s * arc, cx, cy


@njit(
    "UniTuple(float64, 5)(float64, float64, float64, float64, float64, UniTuple(float64, 6), float64[:, ::1])",
    cache=True,
    nogil=True,
)
def gap(
    psi: float, shift1: float, shift2: float, d1: float, d2: float, query: Query, table: FloatArray
) -> tuple[float, float, float, float, float]:
    """f and f' at a heading psi of the line, its length along psi, and both extended peaks.

    The turns are d1 psi + shift1 and shift2 - d2 psi, and no less than the least.
    """
    x, y, theta, a, b, s = query
    delta1 = max(shift1 + d1 * psi, least_deflection(d1 * a, s))
    delta2 = max(shift2 - d2 * psi, least_deflection(d2 * b, s))
    x1, y1, t1, cx1, cy1 = turn(delta1, d1 * a, s, table)
    x2, y2, t2, cx2, cy2 = turn(delta2, d2 * b, s, table)
    c = math.cos(theta)
    sn = math.sin(theta)
    ux = math.cos(psi)
    uy = math.sin(psi)
    px = x - c * x2 - d2 * sn * y2 - x1
    py = y - sn * x2 + d2 * c * y2 - d1 * y1
    qx = x - c * cx2 - d2 * sn * cy2 - cx1
    qy = y - sn * cx2 + d2 * c * cy2 - d1 * cy1
    return ux * py - uy * px, -ux * qx - uy * qy, ux * px + uy * py, t1, t2


@njit(
    "UniTuple(float64, 4)(float64, float64, float64, float64, float64, float64, float64, float64,"
    "UniTuple(float64, 6), float64[:, ::1])",
    cache=True,
    nogil=True,
)
def _root(
    low: float,
    high: float,
    f_low: float,
    f_high: float,
    shift1: float,
    shift2: float,
    d1: float,
    d2: float,
    query: Query,
    table: FloatArray,
) -> tuple[float, float, float, float]:
    """A root of f between values of two signs, good enough for Newton's method in three numbers."""
    psi = low + (high - low) * f_low / (f_low - f_high)
    m = t1 = t2 = 0.0
    for _ in range(10):
        f, slope, m, t1, t2 = gap(psi, shift1, shift2, d1, d2, query, table)
        if abs(f) < 1e-4 * (high - low):
            break
        if f * f_low > 0.0:
            low = psi
        else:
            high = psi
        step = psi - f / slope if slope != 0.0 else math.nan
        psi = step if low < step < high else 0.5 * (low + high)
    return psi, m, t1, t2


@njit(
    "int64(float64, float64, float64, float64, UniTuple(float64, 6), float64[:, ::1], float64[:, ::1])",
    cache=True,
    nogil=True,
)
def lines_between(
    low: float, high: float, d1: float, d2: float, query: Query, table: FloatArray, roots: FloatArray
) -> int:
    """Between two headings without a jump of f: writes rows line's length, both peaks (2, 3); returns their number."""
    theta, a, b, s = query[2], query[3], query[4], query[5]
    middle = 0.5 * (low + high)
    shift1 = from_least(d1 * middle, least_deflection(d1 * a, s)) - d1 * middle
    shift2 = from_least(d2 * (theta - middle), least_deflection(d2 * b, s)) + d2 * middle
    f_low, slope_low, m, t1, t2 = gap(low, shift1, shift2, d1, d2, query, table)
    if abs(f_low) < 1e-13:
        roots[0, 0], roots[0, 1], roots[0, 2] = m, t1, t2
        return 1
    f_high, slope_high, m, t1, t2 = gap(high, shift1, shift2, d1, d2, query, table)
    if abs(f_high) < 1e-13:
        roots[0, 0], roots[0, 1], roots[0, 2] = m, t1, t2
        return 1
    if f_low * f_high < 0.0:
        _, m, t1, t2 = _root(low, high, f_low, f_high, shift1, shift2, d1, d2, query, table)
        roots[0, 0], roots[0, 1], roots[0, 2] = m, t1, t2
        return 1
    if f_low * slope_low >= 0.0 or f_high * slope_high <= 0.0:
        return 0
    # f comes nearer to 0 from both ends: is it beyond in between?
    left = low
    right = high
    for _ in range(6):
        share = slope_low / (slope_low - slope_high)
        psi = left + (right - left) * min(max(share, 0.05), 0.95)
        f, slope, m, t1, t2 = gap(psi, shift1, shift2, d1, d2, query, table)
        if f * f_low <= 0.0:
            _, m, t1, t2 = _root(low, psi, f_low, f, shift1, shift2, d1, d2, query, table)
            roots[0, 0], roots[0, 1], roots[0, 2] = m, t1, t2
            _, m, t1, t2 = _root(psi, high, f, f_high, shift1, shift2, d1, d2, query, table)
            roots[1, 0], roots[1, 1], roots[1, 2] = m, t1, t2
            return 2
        if slope * slope_low > 0.0:
            left = psi
            slope_low = slope
        else:
            right = psi
            slope_high = slope
    return 0
