"""Curves parallel to a curve."""

from __future__ import annotations

from typing import NamedTuple

import numpy as np

from optplan.domain.arrays import FloatArray, IntArray
from optplan.domain.errors import InputError, LimitError
from optplan.geometry.curves import Curve, CurveStates, cuts, evaluate, positive, sampled_curve
from optplan.geometry.hermite import hermite_clothoids
from optplan.geometry.splines import through

_PROBES = 8
_ROUNDS = 14


class Approximation(NamedTuple):
    """A curve close to another one."""

    curve: Curve
    error: float
    """m, largest distance found between the two on dense samples"""


def offset_states(curve: Curve, distance: float, s: FloatArray) -> CurveStates:
    """States of the parallel curve, `distance` (m) to the left, beside arc lengths s (k,) of the curve; exact.

    Its curvature is kappa / (1 - kappa d) and its heading that of the curve; it moves on by 1 - kappa d.

    Raises
    ------
    InputError : an arc length off the curve, or a centre of curvature within the distance: a cusp
    """
    at = evaluate(curve, s)
    stretch = 1 - at.curvature * distance
    _no_cusp(stretch, distance)
    x, y = at.x - distance * np.sin(at.heading), at.y + distance * np.cos(at.heading)
    return CurveStates(x, y, at.heading, at.curvature / stretch)


def offset_points(curve: Curve, distance: float, tolerance: float) -> FloatArray:
    """Points (k, 2) of the parallel curve whose chords stay within about `tolerance` (m) of it."""
    stretch = 1 + abs(distance) * curve.max_curvature
    return offset_states(curve, distance, sampled_curve(curve, tolerance / stretch)).points


def offset(curve: Curve, distance: float, tolerance: float = 1e-4) -> Approximation:
    """The parallel curve, `distance` (m) to the left.

    Lines and arcs are exact. The parallel of a clothoid is none: it is cut into pieces, each replaced by the clothoid
    with the same ends and headings, until all are within `tolerance` (m). Curvature then jumps a little at the cuts.

    Raises
    ------
    InputError : a distance that is not finite, a tolerance not above 0, or a centre of curvature within the distance
    """
    positive(tolerance, "the tolerance of a parallel curve")
    if not np.isfinite(distance):
        raise InputError(f"the distance of a parallel curve is {distance}; expected a finite number")
    stretch = 1 - distance * np.array([curve.curvature, curve.end_curvature])
    _no_cusp(stretch, distance)
    x, y, heading = curve.start
    start = np.array([x - distance * np.sin(heading), y + distance * np.cos(heading), heading])
    if distance == 0 or not curve.sharpness.any():
        return Approximation(Curve(start, curve.curvature / stretch[0], curve.sharpness, curve.length * stretch[0]), 0)
    parts = np.ones(len(curve), dtype=np.int64)
    bent = curve.sharpness != 0
    turn = np.maximum(np.abs(curve.curvature), np.abs(curve.end_curvature)) * curve.length
    parts[bent] = np.maximum(1, np.ceil(turn[bent])).astype(np.int64)
    for _ in range(_ROUNDS):
        made, error = _fitted(curve, distance, parts, start)
        if error.max() <= tolerance:
            return Approximation(made, float(error.max()))
        parts[error > tolerance] *= 2
    raise LimitError(f"a parallel curve does not come within {tolerance:g} m; {error.max():g} m reached")


def smooth_offset(curve: Curve, distance: float, tolerance: float, *, closed: bool = False) -> Approximation:
    """The parallel curve, `distance` (m) to the left, of continuous curvature where that of the curve is.

    Lines and arcs are exact. Else a spline of clothoids is put through places beside the ends of all pieces, with the
    curve's headings at both ends; pieces are halved until it is within `tolerance` (m).

    Parameters
    ----------
    closed : the curve ends as it begins, and so does its parallel

    Raises
    ------
    InputError, LimitError : as `offset`
    """
    if distance == 0 or not curve.sharpness.any():
        return offset(curve, distance, tolerance)
    _no_cusp(1 - distance * np.array([curve.curvature, curve.end_curvature]), distance)
    turn = np.maximum(np.abs(curve.curvature), np.abs(curve.end_curvature)) * curve.length
    parts = np.maximum(1, np.ceil(turn)).astype(np.int64)
    error = np.full(len(curve), np.inf)
    for _ in range(_ROUNDS):
        s = cuts(curve, parts)
        at = offset_states(curve, distance, s)
        made = through(at.points, at.heading, closed)
        if made is None:
            parts *= 2
            continue
        error = np.maximum.reduceat(_aside(made, curve, distance, s), np.cumsum(parts) - parts)
        if error.max() <= tolerance:
            return Approximation(made, float(error.max()))
        parts[error > tolerance] *= 2
    raise LimitError(f"a parallel curve does not come within {tolerance:g} m; {error.max():g} m reached")


def _fitted(curve: Curve, distance: float, parts: IntArray, start: FloatArray) -> tuple[Curve, FloatArray]:
    """The candidate with so many parts a piece, and its greatest error on each piece, m."""
    s = cuts(curve, parts)
    piece = np.repeat(np.arange(len(curve)), parts)
    at = offset_states(curve, distance, s)
    fit = hermite_clothoids(at.points[:-1], at.heading[:-1], at.points[1:], at.heading[1:])
    kappa, sigma, length = fit.curvature, fit.sharpness, fit.length
    exact = curve.sharpness[piece] == 0
    stretch = (1 - curve.curvature * distance)[piece]
    kappa = np.where(exact, curve.curvature[piece] / stretch, kappa)
    sigma = np.where(exact, 0.0, sigma)
    length = np.where(exact, np.diff(s) * stretch, length)
    made = Curve(start, kappa, sigma, length)
    worst = _aside(made, curve, distance, s)
    worst[~fit.converged & ~exact] = np.inf
    return made, np.maximum.reduceat(worst, np.cumsum(parts) - parts)


def _aside(made: Curve, curve: Curve, distance: float, s: FloatArray) -> FloatArray:
    """Greatest distance (k,) between pieces of a candidate and the parallel of the parts between s (k + 1,), m."""
    # beside equal fractions of a part the two are nearly abreast; what is left along the curve is no distance
    fraction = np.arange(1, _PROBES) / _PROBES
    ours = evaluate(made, (made.offsets[:-1, None] + made.length[:, None] * fraction).ravel())
    true = offset_states(curve, distance, (s[:-1, None] + np.diff(s)[:, None] * fraction).ravel())
    aside = (ours.x - true.x) * -np.sin(true.heading) + (ours.y - true.y) * np.cos(true.heading)
    worst: FloatArray = np.abs(aside).reshape(-1, _PROBES - 1).max(axis=1)
    return worst


def _no_cusp(stretch: FloatArray, distance: float) -> None:
    if (stretch <= 0).any():
        raise InputError(f"a curve turns within {distance:g} m of its parallel, which would have a cusp there")
