"""Dubins words in compiled code. Arrays or numbers in, arrays or numbers out."""

from __future__ import annotations

import math

import numba as nb
import numpy as np

from optplan.domain.arrays import FloatArray

TWO_PI = 2.0 * math.pi
# An angle this close to a full turn is a rounding error of zero: unsnapped, a straight move becomes a full circle.
SNAP = 1e-9
# Two circles that touch leave a word with a straight part of length 0 on the edge of where it exists: rounding must not
# lose it. Square of a length, in radii; the end is missed by less than a quarter of it.
TOUCH = 1e-10
LSL, RSR, LSR, RSL, RLR, LRL = range(6)


@nb.njit("float64(float64)", cache=True, nogil=True, inline="always")
def _mod(angle: float) -> float:
    angle = angle % TWO_PI
    if angle > TWO_PI - SNAP or angle < SNAP:
        return 0.0
    return angle


@nb.njit(
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
    square = 2.0 + d * d - 2.0 * cab + 2.0 * d * (sa - sb)
    if square > 1e-18:
        angle = math.atan2(cb - ca, d + sa - sb)
        bt = _mod(angle - a)
        bq = _mod(b - angle)
        bp = math.sqrt(square)
    else:
        bt = _mod(b - a)
        bp = 0.0
        bq = 0.0
    if bt + bp + bq < best:
        best, word, t, p, q = bt + bp + bq, LSL, bt, bp, bq
    # RSR
    square = 2.0 + d * d - 2.0 * cab + 2.0 * d * (sb - sa)
    if square > 1e-18:
        angle = math.atan2(ca - cb, d - sa + sb)
        bt = _mod(a - angle)
        bq = _mod(angle - b)
        bp = math.sqrt(square)
    else:
        bt = _mod(a - b)
        bp = 0.0
        bq = 0.0
    if bt + bp + bq < best:
        best, word, t, p, q = bt + bp + bq, RSR, bt, bp, bq
    # LSR
    square = -2.0 + d * d + 2.0 * cab + 2.0 * d * (sa + sb)
    if square >= -TOUCH:
        bp = math.sqrt(max(square, 0.0))
        angle = math.atan2(-ca - cb, d + sa + sb) - math.atan2(-2.0, bp)
        bt = _mod(angle - a)
        bq = _mod(angle - b)
        if bt + bp + bq < best:
            best, word, t, p, q = bt + bp + bq, LSR, bt, bp, bq
    # RSL
    square = -2.0 + d * d + 2.0 * cab - 2.0 * d * (sa + sb)
    if square >= -TOUCH:
        bp = math.sqrt(max(square, 0.0))
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


@nb.njit("float64(float64, float64, float64, float64, float64, float64, float64)", cache=True, nogil=True)
def dubins_length(x0: float, y0: float, t0: float, x1: float, y1: float, t1: float, radius: float) -> float:
    """Length of the shortest Dubins path, m."""
    return dubins_shortest(x0, y0, t0, x1, y1, t1, radius)[0]


@nb.njit("float64[::1](float64[:, ::1], float64[:, ::1], float64)", cache=True, nogil=True)
def dubins_lengths(starts: FloatArray, ends: FloatArray, radius: float) -> FloatArray:
    """Lengths (k,) of the shortest Dubins paths between rows x, y, heading of (k, 3) arrays."""
    lengths = np.empty(len(starts))
    for i in range(len(starts)):
        lengths[i] = dubins_length(starts[i, 0], starts[i, 1], starts[i, 2], ends[i, 0], ends[i, 1], ends[i, 2], radius)
    return lengths
