"""Words turn, line, turn at full sharpness: every heading of the line that fits, in compiled code.

A turn is seen from its outer end: it starts in the origin with heading 0 and curvature a, turns left by delta and ends
with curvature 0. Its peak is t = sqrt(s delta + a^2 / 2), held on an arc where that is above 1. A turn of the end is
the same seen backwards and reflected, a turn to the right is the mirror image.

A turn tells of the line that goes on from its inner end: how far left of the origin it passes (h), how far along it
the inner end is (g), and how far along the centre C of the circle at the peak (g_c). With D the end's place,

    f(psi) = cross(u, D) + d2 h2 - d1 h1

must vanish for the heading psi of the line. Turning more swings the line about C, so f' = -(u D - g_c1 - g_c2).
"""

from __future__ import annotations

import math

from optplan.compiled import njit
from optplan.domain.arrays import FloatArray
from optplan.geometry._kernels.spiral import spiral

TWO_PI = 2.0 * math.pi
Side = tuple[float, float, float, float, float, float, float, float, float]
"""d (1: left), a seen as a left turn, least deflection, -exp(-i a^2 / 2s) E(a) (x, y), cos and sin of that
angle, centre of the circle at the limit (x, y)"""
Limits = tuple[float, float, float, float, float, float]
"""s, E(1), 1 / 2s, and g and h of a held turn's inner end seen from its circle's centre"""


@njit("float64(float64, float64)", cache=True, nogil=True, error_model="numpy", inline="always")
def from_least(angle: float, least: float) -> float:
    """The angle, by whole turns, in [least, least + 2 pi)."""
    rest = (angle - least) / TWO_PI
    return least + TWO_PI * (rest - math.floor(rest))


@njit("UniTuple(float64, 6)(float64, float64[:, ::1])", cache=True, nogil=True, error_model="numpy")
def limits_of(s: float, table: FloatArray) -> Limits:
    """What all turns at the same limits share."""
    ex, ey = spiral(table, 1.0)
    half = 0.5 / s
    return s, ex, ey, half, ex - math.sin(half), -ey - math.cos(half)


@njit(
    "UniTuple(float64, 9)(float64, float64, UniTuple(float64, 6), float64[:, ::1])",
    cache=True,
    nogil=True,
    error_model="numpy",
)
def side_of(d: float, curvature: float, limits: Limits, table: FloatArray) -> Side:
    """What all turns to side d from the same end share."""
    _, ex, ey, half, _, _ = limits
    a = d * curvature
    angle = half * a * a
    c = math.cos(angle)
    sn = -math.sin(angle)
    ax, ay = spiral(table, a)
    turned = half - angle
    cx = c * (ex - ax) - sn * (ey - ay) - math.sin(turned)
    cy = sn * (ex - ax) + c * (ey - ay) + math.cos(turned)
    # the least turn brings the curvature to 0 and no more
    return d, a, half * a * abs(a), sn * ay - c * ax, -sn * ax - c * ay, c, sn, cx, cy


@njit(
    "UniTuple(float64, 4)(float64, float64, float64, UniTuple(float64, 9), UniTuple(float64, 6), float64[:, ::1])",
    cache=True,
    nogil=True,
    error_model="numpy",
)
def turn(
    delta: float, c: float, sn: float, side: Side, limits: Limits, table: FloatArray
) -> tuple[float, float, float, float]:
    """h, g, g_c and the extended peak of a turn by delta, whose cosine and sine are c and sn."""
    _, a, _, ox, oy, ca, sa, cx, cy = side
    s, ex, ey, half, g_held, h_held = limits
    square = s * delta + 0.5 * a * a
    if square >= 1.0:
        g = c * cx + sn * cy
        return c * cy - sn * cx + h_held, g + g_held, g, 0.5 * (square + 1.0)
    peak = math.sqrt(max(square, 0.0))
    ex, ey = spiral(table, peak)
    x = ca * ex - sa * ey + ox
    y = sa * ex + ca * ey + oy
    g = c * x + sn * y
    # as the peak goes to 0, its circle's centre goes to infinity, but not along the line
    centre = math.sin(half * square) / peak if peak > 1e-9 else half * peak
    return c * y - sn * x - ey, g + ex, g + centre, peak


@njit(
    "UniTuple(float64, 5)(float64, float64, float64, float64, float64, float64,"
    "UniTuple(float64, 9), UniTuple(float64, 9), UniTuple(float64, 6), float64[:, ::1])",
    cache=True,
    nogil=True,
    error_model="numpy",
)
def _gap(
    psi: float,
    shift1: float,
    shift2: float,
    x: float,
    y: float,
    theta: float,
    side1: Side,
    side2: Side,
    limits: Limits,
    table: FloatArray,
) -> tuple[float, float, float, float, float]:
    """f, f', the line's length along psi and both extended peaks; deflections d1 psi + shift1 and shift2 - d2 psi."""
    d1 = side1[0]
    d2 = side2[0]
    ux = math.cos(psi)
    uy = math.sin(psi)
    h1, g1, gc1, t1 = turn(max(shift1 + d1 * psi, side1[2]), ux, d1 * uy, side1, limits, table)
    off = theta - psi
    h2, g2, gc2, t2 = turn(max(shift2 - d2 * psi, side2[2]), math.cos(off), d2 * math.sin(off), side2, limits, table)
    along = ux * x + uy * y
    return ux * y - uy * x + d2 * h2 - d1 * h1, gc1 + gc2 - along, along - g1 - g2, t1, t2


@njit(
    "UniTuple(float64, 3)(float64[::1], float64, float64, float64, float64, float64, float64, float64,"
    "UniTuple(float64, 9), UniTuple(float64, 9), UniTuple(float64, 6), float64[:, ::1])",
    cache=True,
    nogil=True,
    error_model="numpy",
)
def line_root(
    bracket: FloatArray,
    shift1: float,
    shift2: float,
    x: float,
    y: float,
    theta: float,
    least: float,
    most: float,
    side1: Side,
    side2: Side,
    limits: Limits,
    table: FloatArray,
) -> tuple[float, float, float]:
    """Line's length and both peaks where f vanishes between headings at which it has two signs.

    The bracket's columns from 3 on: both headings, f at both, f' at both. The search begins at the root of the cubic
    that has these values. NaN once it is clear that the line is shorter than `least`, or line and turns longer than
    `most`.
    """
    low, high, f_low, f_high = bracket[3], bracket[4], bracket[5], bracket[6]
    width = high - low
    c1 = width * bracket[7]
    c2 = 3.0 * (f_high - f_low) - 2.0 * c1 - width * bracket[8]
    c3 = f_high - f_low - c1 - c2
    share = f_low / (f_low - f_high) if f_low != f_high else 0.0
    u = share
    for _ in range(3):
        u -= (f_low + u * (c1 + u * (c2 + u * c3))) / (c1 + u * (2.0 * c2 + 3.0 * u * c3))
    if not 0.0 <= u <= 1.0:
        u = share
    psi = low + width * u
    m = t1 = t2 = 0.0
    close = 3e-12 * (1.0 + abs(x) + abs(y))
    for _ in range(30):
        f, slope, m, t1, t2 = _gap(psi, shift1, shift2, x, y, theta, side1, side2, limits, table)
        if abs(f) < close:
            break
        # how far the root may be: generous, the slope of both is about a metre a radian
        slack = 0.2 + 4.0 * abs(f)
        if m + slack < least or m - slack + 2.0 * (t1 + t2) / limits[0] > most:
            return math.nan, t1, t2
        if f * f_low > 0.0:
            low = psi
        else:
            high = psi
        step = psi - f / slope if slope != 0.0 else math.nan
        psi = step if low < step < high else 0.5 * (low + high)
    return m, t1, t2


@njit(
    "UniTuple(float64, 3)(float64, float64, float64, float64, float64, float64, float64, float64, float64, float64,"
    "UniTuple(float64, 9), UniTuple(float64, 9), UniTuple(float64, 6), float64[:, ::1])",
    cache=True,
    nogil=True,
    error_model="numpy",
)
def crossing(
    low: float,
    high: float,
    f_low: float,
    slope_low: float,
    slope_high: float,
    shift1: float,
    shift2: float,
    x: float,
    y: float,
    theta: float,
    side1: Side,
    side2: Side,
    limits: Limits,
    table: FloatArray,
) -> tuple[float, float, float]:
    """A heading, f and f' there, at which f has passed 0 between headings from which it falls towards 0; NaN: none."""
    for _ in range(6):
        share = slope_low / (slope_low - slope_high)
        psi = low + (high - low) * min(max(share, 0.05), 0.95)
        f, slope, _, _, _ = _gap(psi, shift1, shift2, x, y, theta, side1, side2, limits, table)
        if f * f_low <= 0.0:
            return psi, f, slope
        if slope * slope_low > 0.0:
            low = psi
            slope_low = slope
        else:
            high = psi
            slope_high = slope
        # the rest of the way is too short for the slopes left
        if abs(f) > max(abs(slope_low), abs(slope_high)) * (high - low):
            break
    return math.nan, 0.0, 0.0
