"""Corners for robots that cannot turn on the spot: rounded inside, or looped around outside with the tool up.

Everything is made of turns that begin and end straight: a clothoid of full sharpness up to a peak, an arc where the
peak is the curvature limit, and the same clothoid back. Such a turn by theta is its own mirror image, so it leads along
its half angle: its displacement is w(theta) (cos theta / 2, sin theta / 2).
"""

from __future__ import annotations

import math
from typing import NamedTuple

import numpy as np

from optplan.domain.arrays import BoolArray, FloatArray, frozen_floats
from optplan.domain.errors import InputError, SolverError
from optplan.geometry.clothoids import clothoid_displacement
from optplan.geometry.curves import Curve, moved, positive
from optplan.geometry.rounding import STRAIGHT, wrapped

_GRID = 2881
"""Swings tried before roots and minima are refined: steps of a quarter of a degree."""


class Turns(NamedTuple):
    """Turns from straight to straight; arrays (k,)."""

    peak: FloatArray
    """1/m, curvature in the middle, signed"""
    clothoid: FloatArray
    """m, length of each of the two clothoids"""
    arc: FloatArray
    """m, length of the arc between them"""
    width: FloatArray
    """m, displacement along the half angle; may be negative for turns beyond pi"""

    @property
    def length(self) -> FloatArray:
        """(k,) m"""
        return 2 * self.clothoid + self.arc


class Rounded(NamedTuple):
    """A polyline with rounded corners."""

    curves: tuple[Curve, ...]
    """in driving order, each G2; a corner that was kept lies between two of them"""
    deviation: FloatArray
    """(k,) m, distance of the curve from each inner vertex; 0 where the corner was kept"""
    kept: BoolArray
    """(k,) whether the corner was kept: it would have taken more deviation, or more of its edges, than there is"""


def turns(angle: FloatArray, kappa_max: float, sigma_max: float) -> Turns:
    """Shortest turns by angles (k,) rad, any number of times round, left positive, under both limits (1/m, 1/m^2)."""
    size = np.abs(angle)
    peak = np.minimum(kappa_max, np.sqrt(sigma_max * size))
    clothoid = peak / sigma_max
    arc = np.maximum(0.0, size - peak * clothoid) / np.where(peak > 0, peak, 1.0)
    # half a turn seen from its middle, which is mirrored by the other half
    zero = np.zeros_like(size)
    dx, dy = clothoid_displacement(zero, zero, zero + sigma_max, clothoid)
    ax, ay = clothoid_displacement(peak * clothoid / 2, peak, zero, arc / 2)
    width = 2 * ((dx + ax) * np.cos(size / 2) + (dy + ay) * np.sin(size / 2))
    return Turns(np.copysign(peak, angle), clothoid, arc, width)


def inner_rounding(points: FloatArray, deviation: float, kappa_max: float, sigma_max: float) -> Rounded:
    """Round the corners of an open polyline on the inside, G2, as tightly as the limits allow.

    A corner of deflection theta takes the tangent w / (2 cos(theta / 2)) from both edges. Where that or its deviation
    is too much, the corner is kept; so the result is bounded for every deflection, a reversal included. Of two corners
    that share too short an edge the one that takes more of it is kept.

    Parameters
    ----------
    points : (n, 2) m, n >= 2, consecutive ones apart
    deviation : greatest distance between a vertex and the curve, m
    kappa_max, sigma_max : 1/m, 1/m^2

    Raises
    ------
    InputError : points that are none, or a limit that is not above 0
    """
    points = _polyline(points)
    _limits(kappa_max, sigma_max)
    positive(deviation, "the deviation of a rounded corner")
    edges, heading, deflection = _edges(points)
    made = turns(deflection, kappa_max, sigma_max)
    half = np.abs(deflection) / 2
    cosine = np.cos(half)
    possible = cosine > 1e-9
    safe = np.where(possible, cosine, 1.0)
    tangent = made.width / (2 * safe)
    # the middle of the turn lies on the bisector, across from the vertex
    zero = np.zeros_like(half)
    x, y = clothoid_displacement(zero, zero, zero + sigma_max, made.clothoid)
    ax, ay = clothoid_displacement(np.abs(made.peak) * made.clothoid / 2, np.abs(made.peak), zero, made.arc / 2)
    away = np.hypot(tangent - x - ax, y + ay)
    kept = ~possible | (away > deviation)
    budget = edges * (1 + 1e-12)
    while True:
        used = np.where(kept, 0.0, tangent)
        taken = np.concatenate([[0.0], used]) + np.concatenate([used, [0.0]])
        over = np.flatnonzero(taken > budget)
        if len(over) == 0:
            break
        edge = int(over[0])
        pair = [k for k in (edge - 1, edge) if 0 <= k < len(used)]
        kept[max(pair, key=lambda k: used[k])] = True
    straight = np.maximum(edges - taken, 0.0)
    curves, rows, start = [], [], np.array([*points[0], heading[0]])
    for k in range(len(edges)):
        rows.append((0.0, 0.0, straight[k]))
        last = k == len(edges) - 1
        if last or kept[k]:
            curves.append(_curve(start, rows))
            rows, start = [], np.array([*points[k + 1], heading[min(k + 1, len(edges) - 1)]])
        else:
            rows += _turn_rows(deflection[k], kappa_max, sigma_max)
    return Rounded(tuple(curves), np.where(kept, 0.0, away), kept)


def outer_loop(deflection: float, kappa_max: float, sigma_max: float) -> Curve:
    """From a vertex along the old heading round to the same vertex with the new heading, straight at both ends.

    The loop begins at (0, 0, 0) and ends at (0, 0, deflection). It is its own mirror image and the shortest of these: a
    line a, a swing to one side by e, the turn by the rest, the swing by e and the line a. The total turning M is the
    deflection, or one round less or more, and the loop closes when

        2 a cos(M / 2) + 2 w(e) cos((M - e) / 2) + w(M - 2 e) = 0.

    No swing (e = 0) is short at gentle corners and endless near a reversal, where no line (a = 0, e a scalar root) is
    short; between them e is minimised over. The shortest is bounded for all deflections.

    Parameters
    ----------
    deflection : rad, left positive; taken as in (-pi, pi]
    kappa_max, sigma_max : 1/m, 1/m^2

    Raises
    ------
    InputError : a number that is not finite, or a limit that is not above 0
    """
    _limits(kappa_max, sigma_max)
    if not math.isfinite(deflection):
        raise InputError(f"the deflection of a corner is {deflection}; expected a finite angle")
    bend = float(wrapped(np.array([deflection]))[0])
    side = -1.0 if bend < 0 else 1.0
    best: tuple[float, float, float, float] | None = None  # length, total turning, line, swing
    for total in (abs(bend) - 2 * math.pi, abs(bend), abs(bend) + 2 * math.pi):
        for length, line, swing in _closings(total, kappa_max, sigma_max):
            if best is None or length < best[0]:
                best = (length, total, line, swing)
    if best is None:
        raise SolverError(f"no loop found for a corner of {deflection:g} rad")
    _, total, line, swing = best
    rows = [(0.0, 0.0, line), *_turn_rows(side * swing, kappa_max, sigma_max)]
    rows += _turn_rows(side * (total - 2 * swing), kappa_max, sigma_max)
    rows += [*_turn_rows(side * swing, kappa_max, sigma_max), (0.0, 0.0, line)]
    return _curve(np.zeros(3), rows)


def outer_loops(points: FloatArray, threshold: float, kappa_max: float, sigma_max: float) -> dict[int, Curve]:
    """Loops at the inner vertices of a polyline (n, 2) that bend by more than `threshold` (rad), by vertex number.

    Each begins and ends at its vertex, so that both edges are driven up to it; the tool is to be raised meanwhile.
    Raises like `outer_loop`.
    """
    points = _polyline(points)
    if not threshold > STRAIGHT:
        raise InputError(f"the threshold of sharp corners is {threshold} rad; expected more than 0")
    _, heading, deflection = _edges(points)
    return {
        int(k) + 1: moved(
            outer_loop(float(deflection[k]), kappa_max, sigma_max), np.array([*points[k + 1], heading[k]])
        )
        for k in np.flatnonzero(np.abs(deflection) > threshold)
    }


def _closings(total: float, kappa_max: float, sigma_max: float) -> list[tuple[float, float, float]]:
    """Length, line and swing of loops that turn by `total`: no swing, no line, or the best of both."""
    from scipy.optimize import brentq, minimize_scalar

    cosine = math.cos(total / 2)

    def loop(swing: FloatArray) -> tuple[FloatArray, FloatArray]:
        """What does not close without lines, m along the middle, and the length of the three turns."""
        made = turns(np.concatenate([swing, total - 2 * swing]), kappa_max, sigma_max)
        width, length = made.width.reshape(2, -1), made.length.reshape(2, -1)
        return 2 * width[0] * np.cos((total - swing) / 2) + width[1], 2 * length[0] + length[1]

    def gap(swing: float) -> float:
        return float(loop(np.array([swing]))[0][0])

    def with_lines(swing: float) -> float:
        left, length = loop(np.array([swing]))
        return float(length[0] - left[0] / cosine)

    swings = np.linspace(-2 * math.pi, 2 * math.pi, _GRID)
    gaps, lengths = loop(swings)
    tried: list[tuple[float, float]] = []  # line, swing
    crossed = np.flatnonzero(np.sign(gaps[:-1]) * np.sign(gaps[1:]) <= 0)
    real = crossed[np.abs(total - 2 * swings[crossed]) + np.abs(swings[crossed]) > 0.1]
    for k in crossed:
        if len(real) and lengths[k] > 1.2 * lengths[real].min():
            continue  # cannot be the shortest: not worth a root
        if gaps[k] == 0 or gaps[k + 1] == 0:
            swing = float(swings[k] if gaps[k] == 0 else swings[k + 1])
        else:
            swing = brentq(gap, swings[k], swings[k + 1], xtol=1e-14, rtol=1e-14)
        tried.append((0.0, swing))
    if abs(cosine) > 1e-6:
        whole = np.where(gaps * cosine <= 0, lengths - gaps / cosine, np.inf)
        least = int(np.argmin(whole))
        around = (float(swings[max(least - 1, 0)]), float(swings[min(least + 1, _GRID - 1)]))
        refined = minimize_scalar(with_lines, bounds=around, method="bounded", options={"xatol": 1e-7})
        for swing in (0.0, float(swings[least]), float(refined.x)):
            tried.append((-gap(swing) / (2 * cosine), swing))
    # no turning at all closes too, but is no loop
    loops = [(line, swing) for line, swing in tried if line >= 0 and abs(total - 2 * swing) + abs(swing) > 1e-6]
    return [(float(loop(np.array([swing]))[1][0]) + 2 * line, line, swing) for line, swing in loops]


def _turn_rows(angle: float, kappa_max: float, sigma_max: float) -> list[tuple[float, float, float]]:
    made = turns(np.array([angle]), kappa_max, sigma_max)
    peak, clothoid, arc = float(made.peak[0]), float(made.clothoid[0]), float(made.arc[0])
    sigma = math.copysign(sigma_max, angle)
    return [(0.0, sigma, clothoid), (peak, 0.0, arc), (peak, -sigma, clothoid)]


def _curve(start: FloatArray, rows: list[tuple[float, float, float]]) -> Curve:
    table = np.array(rows).reshape(-1, 3)
    keep = table[:, 2] > 1e-12 * (1 + table[:, 2].sum())
    return Curve(start, *table[keep].T)


def _edges(points: FloatArray) -> tuple[FloatArray, FloatArray, FloatArray]:
    steps = np.diff(points, axis=0)
    heading = np.arctan2(steps[:, 1], steps[:, 0])
    return np.hypot(steps[:, 0], steps[:, 1]), heading, wrapped(np.diff(heading))


def _polyline(points: FloatArray) -> FloatArray:
    points = frozen_floats(points, "polyline", (None, 2))
    if len(points) < 2 or (np.diff(points, axis=0) == 0).all(axis=1).any():
        raise InputError("a polyline repeats a point or has fewer than two; expected two or more, apart")
    return points


def _limits(kappa_max: float, sigma_max: float) -> None:
    positive(kappa_max, "the curvature limit")
    positive(sigma_max, "the sharpness limit")
