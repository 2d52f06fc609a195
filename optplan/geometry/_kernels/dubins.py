"""Dubins words in compiled code. Arrays or numbers in, arrays or numbers out."""

from __future__ import annotations

import math

import numpy as np

from optplan.compiled import njit
from optplan.domain.arrays import FloatArray

TWO_PI = 2.0 * math.pi
TURNS = 1.0 / TWO_PI
# An angle this close to a full turn is a rounding error of zero: unsnapped, a straight move becomes a full circle.
SNAP = 1e-9
TOUCHING = 1e-12
"""Circles this close to touching, in radii, touch."""
LSL, RSR, LSR, RSL, RLR, LRL = range(6)


@njit("float64(float64)", cache=True, nogil=True, inline="always", error_model="numpy")
def _turn(angle: float) -> float:
    """The angle in [0, 2 pi)."""
    return angle - TWO_PI * math.floor(angle * TURNS)


@njit("float64(float64)", cache=True, nogil=True, inline="always", error_model="numpy")
def _mod(angle: float) -> float:
    angle = _turn(angle)
    if angle > TWO_PI - SNAP or angle < SNAP:
        return 0.0
    return angle


@njit(
    "UniTuple(float64, 2)(float64, float64, float64, float64)",
    cache=True,
    nogil=True,
    inline="always",
    error_model="numpy",
)
def _same_side(first: float, whole: float, straight: float, d: float) -> tuple[float, float]:
    """Both arcs of LSL or RSR: the first as computed, the second what is left of the whole turning.

    The shorter the straight part, the less its direction is known: arcs that are none but for that are snapped.
    """
    unknown = max(SNAP, 4e-15 * (1.0 + d) / straight) if straight > 1e-14 * (1.0 + d) else math.inf
    first = _turn(first)
    if first < unknown or first > TWO_PI - unknown or unknown > 1.0:
        return 0.0, whole
    second = _turn(whole - first)
    if second < unknown or second > TWO_PI - unknown:
        return whole, 0.0
    return first, second


@njit(
    "Tuple((float64, int64, float64, float64, float64))(float64, float64, float64, float64, float64, float64, float64)",
    cache=True,
    nogil=True,
    error_model="numpy",
)
def dubins_shortest(
    x0: float, y0: float, t0: float, x1: float, y1: float, t1: float, radius: float
) -> tuple[float, int, float, float, float]:
    """Length (m), word, and the three parts (arcs in rad, lines in radii) of the shortest Dubins path.

    Words join the circles that touch the start and the end. A. M. Shkel and V. Lumelsky, Classification of the Dubins
    set, Robotics and Autonomous Systems 34 (2001), section 2, give the closed forms; here the turnings come from the
    directions between the circles' centres, and a word is left out when even its straight part and the least turning
    that its headings ask for are no shorter than what is known.
    """
    dx = (x1 - x0) / radius
    dy = (y1 - y0) / radius
    d = math.sqrt(dx * dx + dy * dy)
    s0 = math.sin(t0)
    c0 = math.cos(t0)
    s1 = math.sin(t1)
    c1 = math.cos(t1)
    left = _mod(t1 - t0)
    right = _mod(t0 - t1)
    least = min(left, right)

    # from centre to centre: of the left circles, of the right circles
    lx = dx + s0 - s1
    ly = dy - c0 + c1
    rx = dx - s0 + s1
    ry = dy + c0 - c1
    ll = math.sqrt(lx * lx + ly * ly)
    rr = math.sqrt(rx * rx + ry * ry)
    best = math.inf
    word = LSL
    t = p = q = 0.0
    left_first = ll + left <= rr + right
    for side in range(2):
        if (side == 0) == left_first:
            if ll + left < best:
                bt, bq = _same_side(math.atan2(ly, lx) - t0, left, ll, d)
                if bt + ll + bq < best:
                    best, word, t, p, q = bt + ll + bq, LSL, bt, ll, bq
        elif rr + right < best:
            bt, bq = _same_side(t0 - math.atan2(ry, rx), right, rr, d)
            if bt + rr + bq < best:
                best, word, t, p, q = bt + rr + bq, RSR, bt, rr, bq
    # LSR
    vx = dx + s0 + s1
    vy = dy - c0 - c1
    apart = math.sqrt(vx * vx + vy * vy)
    if apart >= 2.0 - TOUCHING:
        bp = math.sqrt(max(0.0, (apart - 2.0) * (apart + 2.0)))
        if bp + least < best:
            angle = math.atan2(vy * bp + 2.0 * vx, vx * bp - 2.0 * vy)
            bt = _mod(angle - t0)
            bq = _mod(angle - t1)
            if bt + bp + bq < best:
                best, word, t, p, q = bt + bp + bq, LSR, bt, bp, bq
    # RSL
    vx = dx - s0 - s1
    vy = dy + c0 + c1
    apart = math.sqrt(vx * vx + vy * vy)
    if apart >= 2.0 - TOUCHING:
        bp = math.sqrt(max(0.0, (apart - 2.0) * (apart + 2.0)))
        if bp + least < best:
            angle = math.atan2(vy * bp - 2.0 * vx, vx * bp + 2.0 * vy)
            bt = _mod(t0 - angle)
            bq = _mod(t1 - angle)
            if bt + bp + bq < best:
                best, word, t, p, q = bt + bp + bq, RSL, bt, bp, bq
    # the middle circle of three turns by more than pi
    if best > math.pi:
        # RLR
        if rr <= 4.0:
            bp = TWO_PI - math.acos(1.0 - rr * rr / 8.0)
            if bp < best:
                bp = _mod(bp)
                bt = _mod(t0 - math.atan2(ry, rx) + bp / 2.0)
                bq = _mod(t0 - t1 - bt + bp)
                if bt + bp + bq < best:
                    best, word, t, p, q = bt + bp + bq, RLR, bt, bp, bq
        # LRL
        if ll <= 4.0:
            bp = TWO_PI - math.acos(1.0 - ll * ll / 8.0)
            if bp < best:
                bp = _mod(bp)
                bt = _mod(math.atan2(ly, lx) - t0 + bp / 2.0)
                bq = _mod(t1 - t0 - bt + bp)
                if bt + bp + bq < best:
                    best, word, t, p, q = bt + bp + bq, LRL, bt, bp, bq
    return best * radius, word, t, p, q


@njit(
    "float64(float64, float64, float64, float64, float64, float64, float64)",
    cache=True,
    nogil=True,
    error_model="numpy",
)
def dubins_length(x0: float, y0: float, t0: float, x1: float, y1: float, t1: float, radius: float) -> float:
    """Length of the shortest Dubins path, m."""
    return dubins_shortest(x0, y0, t0, x1, y1, t1, radius)[0]


@njit("float64[::1](float64[:, ::1], float64[:, ::1], float64)", cache=True, nogil=True, error_model="numpy")
def dubins_lengths(starts: FloatArray, ends: FloatArray, radius: float) -> FloatArray:
    """Lengths (k,) of the shortest Dubins paths between rows x, y, heading of (k, 3) arrays."""
    lengths = np.empty(len(starts))
    for i in range(len(starts)):
        lengths[i] = dubins_length(starts[i, 0], starts[i, 1], starts[i, 2], ends[i, 0], ends[i, 1], ends[i, 2], radius)
    return lengths
