"""Dubins words in compiled code. Arrays or numbers in, arrays or numbers out."""

from __future__ import annotations

import math

import numpy as np

from optplan.compiled import njit
from optplan.domain.arrays import FloatArray

TWO_PI = 2.0 * math.pi
# An angle this close to a full turn is a rounding error of zero: unsnapped, a straight move becomes a full circle.
SNAP = 1e-9
TOUCHING = 1e-12
"""Circles this close to touching, in radii, touch."""
LSL, RSR, LSR, RSL, RLR, LRL = range(6)


@njit("float64(float64)", cache=True, nogil=True, inline="always")
def _mod(angle: float) -> float:
    angle = angle % TWO_PI
    if angle > TWO_PI - SNAP or angle < SNAP:
        return 0.0
    return angle


@njit("UniTuple(float64, 2)(float64, float64, float64, float64)", cache=True, nogil=True)
def _same_side(first: float, total: float, straight: float, d: float) -> tuple[float, float]:
    """Both arcs of LSL or RSR: the first as computed, the second what is left of the whole turning.

    The shorter the straight part, the less its direction is known: arcs that are none but for that are snapped.
    """
    whole = _mod(total)
    unknown = max(SNAP, 4e-15 * (1.0 + d) / straight) if straight > 1e-14 * (1.0 + d) else math.inf
    first = first % TWO_PI
    if first < unknown or first > TWO_PI - unknown or unknown > 1.0:
        return 0.0, whole
    second = (total - first) % TWO_PI
    if second < unknown or second > TWO_PI - unknown:
        return whole, 0.0
    return first, second


@njit(
    "Tuple((float64, int64, float64, float64, float64))(float64, float64, float64, float64, float64, float64, float64)",
    cache=True,
    nogil=True,
)
def dubins_shortest(
    x0: float, y0: float, t0: float, x1: float, y1: float, t1: float, radius: float
) -> tuple[float, int, float, float, float]:
    """Length (m), word, and the three parts (arcs in rad, lines in radii) of the shortest Dubins path.

    Closed forms of A. M. Shkel and V. Lumelsky, Classification of the Dubins set, Robotics and Autonomous Systems 34
    (2001), section 2, with the degenerate cases (one circle, no distance) settled first.
    """
    dx = (x1 - x0) / radius
    dy = (y1 - y0) / radius
    d = math.hypot(dx, dy)
    theta = math.atan2(dy, dx) if d > 0.0 else 0.0
    a = t0 - theta
    b = t1 - theta
    sa = math.sin(a)
    sb = math.sin(b)
    ca = math.cos(a)
    cb = math.cos(b)
    cab = math.cos(a - b)
    best = math.inf
    word = LSL
    t = p = q = 0.0

    # LSL
    bp = math.hypot(d + sa - sb, cb - ca)
    bt, bq = _same_side(math.atan2(cb - ca, d + sa - sb) - a, b - a, bp, d)
    if bt + bp + bq < best:
        best, word, t, p, q = bt + bp + bq, LSL, bt, bp, bq
    # RSR
    bp = math.hypot(d - sa + sb, ca - cb)
    bt, bq = _same_side(a - math.atan2(ca - cb, d - sa + sb), a - b, bp, d)
    if bt + bp + bq < best:
        best, word, t, p, q = bt + bp + bq, RSR, bt, bp, bq
    # LSR
    apart = math.hypot(d + sa + sb, ca + cb)
    if apart >= 2.0 - TOUCHING:
        bp = math.sqrt(max(0.0, (apart - 2.0) * (apart + 2.0)))
        angle = math.atan2(-ca - cb, d + sa + sb) - math.atan2(-2.0, bp)
        bt = _mod(angle - a)
        bq = _mod(angle - b)
        if bt + bp + bq < best:
            best, word, t, p, q = bt + bp + bq, LSR, bt, bp, bq
    # RSL
    apart = math.hypot(d - sa - sb, ca + cb)
    if apart >= 2.0 - TOUCHING:
        bp = math.sqrt(max(0.0, (apart - 2.0) * (apart + 2.0)))
        angle = math.atan2(ca + cb, d - sa - sb) - math.atan2(2.0, bp)
        bt = _mod(a - angle)
        bq = _mod(b - angle)
        if bt + bp + bq < best:
            best, word, t, p, q = bt + bp + bq, RSL, bt, bp, bq
    # RLR
    cosine = (6.0 - d * d + 2.0 * cab + 2.0 * d * (sa - sb)) / 8.0
    if abs(cosine) <= 1.0:
        bp = _mod(TWO_PI - math.acos(cosine))
        bt = _mod(a - math.atan2(ca - cb, d - sa + sb) + bp / 2.0)
        bq = _mod(a - b - bt + bp)
        if bt + bp + bq < best:
            best, word, t, p, q = bt + bp + bq, RLR, bt, bp, bq
    # LRL
    cosine = (6.0 - d * d + 2.0 * cab + 2.0 * d * (sb - sa)) / 8.0
    if abs(cosine) <= 1.0:
        bp = _mod(TWO_PI - math.acos(cosine))
        bt = _mod(-a + math.atan2(cb - ca, d + sa - sb) + bp / 2.0)
        bq = _mod(b - a - bt + bp)
        if bt + bp + bq < best:
            best, word, t, p, q = bt + bp + bq, LRL, bt, bp, bq
    return best * radius, word, t, p, q


@njit("float64(float64, float64, float64, float64, float64, float64, float64)", cache=True, nogil=True)
def dubins_length(x0: float, y0: float, t0: float, x1: float, y1: float, t1: float, radius: float) -> float:
    """Length of the shortest Dubins path, m."""
    return dubins_shortest(x0, y0, t0, x1, y1, t1, radius)[0]


@njit("float64[::1](float64[:, ::1], float64[:, ::1], float64)", cache=True, nogil=True)
def dubins_lengths(starts: FloatArray, ends: FloatArray, radius: float) -> FloatArray:
    """Lengths (k,) of the shortest Dubins paths between rows x, y, heading of (k, 3) arrays."""
    lengths = np.empty(len(starts))
    for i in range(len(starts)):
        lengths[i] = dubins_length(starts[i, 0], starts[i, 1], starts[i, 2], ends[i, 0], ends[i, 1], ends[i, 2], radius)
    return lengths
