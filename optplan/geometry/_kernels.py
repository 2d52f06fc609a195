"""Compiled geometry: arrays or numbers in, numbers out."""

from __future__ import annotations

import math

from numba import njit

_TWO_PI = 2.0 * math.pi
_WRAP = 1e-9
"""An arc this close to a full circle is an arc of zero: rounding must not send a car once around."""


@njit(cache=True, nogil=True)
def _turn(angle: float) -> float:
    """The angle in [0, 2 pi); within 1e-9 of a full circle counts as none."""
    rest = angle - _TWO_PI * math.floor(angle / _TWO_PI)
    return 0.0 if rest >= _TWO_PI - _WRAP or rest < _WRAP else rest


@njit(cache=True, nogil=True)
def dubins_length(x0: float, y0: float, t0: float, x1: float, y1: float, t1: float, radius: float) -> float:
    """Length of the shortest forwards path between two poses with |curvature| <= 1 / radius.

    Shkel and Lumelsky, "Classification of the Dubins set", 2001, section 2: six words, in units of the radius.

    Parameters
    ----------
    x0, y0, t0, x1, y1, t1 : start and end: m, m, rad
    radius : m, > 0
    """
    dx, dy = (x1 - x0) / radius, (y1 - y0) / radius
    distance = math.hypot(dx, dy)
    direction = math.atan2(dy, dx) if distance > 0.0 else 0.0
    alpha, beta = _turn(t0 - direction), _turn(t1 - direction)
    if distance < 1e-12 and _turn(t1 - t0) == 0.0:
        return 0.0
    sa, ca, sb, cb = math.sin(alpha), math.cos(alpha), math.sin(beta), math.cos(beta)
    cab = math.cos(alpha - beta)
    best = math.inf

    # LSL and RSR; the straight's square cannot be negative but for rounding
    square = max(0.0, 2.0 + distance * distance - 2.0 * cab + 2.0 * distance * (sa - sb))
    toward = math.atan2(cb - ca, distance + sa - sb) if square > 1e-20 else alpha
    best = min(best, _turn(toward - alpha) + math.sqrt(square) + _turn(beta - toward))
    square = max(0.0, 2.0 + distance * distance - 2.0 * cab + 2.0 * distance * (sb - sa))
    toward = math.atan2(ca - cb, distance - sa + sb) if square > 1e-20 else alpha
    best = min(best, _turn(alpha - toward) + math.sqrt(square) + _turn(toward - beta))

    # LSR and RSL exist while the inner tangent does; a hair below zero is a tangent point
    square = -2.0 + distance * distance + 2.0 * cab + 2.0 * distance * (sa + sb)
    if square > -1e-12:
        straight = math.sqrt(max(0.0, square))
        toward = math.atan2(-ca - cb, distance + sa + sb) - math.atan2(-2.0, straight)
        best = min(best, _turn(toward - alpha) + straight + _turn(toward - beta))
    square = -2.0 + distance * distance + 2.0 * cab - 2.0 * distance * (sa + sb)
    if square > -1e-12:
        straight = math.sqrt(max(0.0, square))
        toward = math.atan2(ca + cb, distance - sa - sb) - math.atan2(2.0, straight)
        best = min(best, _turn(alpha - toward) + straight + _turn(beta - toward))

    # RLR and LRL exist while the outer circles are at most four radii apart
    cosine = (6.0 - distance * distance + 2.0 * cab + 2.0 * distance * (sa - sb)) / 8.0
    if abs(cosine) <= 1.0 + 1e-12:
        middle = _TWO_PI - math.acos(max(-1.0, min(1.0, cosine)))
        first = _turn(alpha - math.atan2(ca - cb, distance - sa + sb) + middle / 2.0)
        best = min(best, first + middle + _turn(alpha - beta - first + middle))
    cosine = (6.0 - distance * distance + 2.0 * cab + 2.0 * distance * (sb - sa)) / 8.0
    if abs(cosine) <= 1.0 + 1e-12:
        middle = _TWO_PI - math.acos(max(-1.0, min(1.0, cosine)))
        first = _turn(-alpha + math.atan2(cb - ca, distance + sa - sb) + middle / 2.0)
        best = min(best, first + middle + _turn(beta - alpha - first + middle))
    return best * radius
