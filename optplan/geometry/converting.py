"""Curves for those who drive no clothoids: as lines, as arcs, as cubic Bezier pieces; each with the error made."""

from __future__ import annotations

from collections.abc import Callable
from typing import NamedTuple, TypeVar

import numpy as np

from optplan.domain.arrays import FloatArray, IntArray
from optplan.domain.errors import LimitError
from optplan.geometry.curves import MAX_SAMPLES, Curve, cuts, evaluate, positive, sampled_curve
from optplan.geometry.offsets import Approximation
from optplan.geometry.rounding import wrapped

_PROBES = 8
_ROUNDS = 16
_Made = TypeVar("_Made")


class Lines(NamedTuple):
    """A polyline close to a curve."""

    points: FloatArray
    """(k, 2) m, on the curve"""
    error: float
    """m, largest distance found between chord and curve"""


class Beziers(NamedTuple):
    """Cubic Bezier pieces close to a curve; joined G1."""

    control: FloatArray
    """(k, 4, 2) m"""
    error: float
    """m, largest distance found on dense samples"""


def to_lines(curve: Curve, tolerance: float) -> Lines:
    """Chords within `tolerance` (m) of the curve. Raises like `sampled_curve`."""
    s = sampled_curve(curve, tolerance)
    points = evaluate(curve, s).points
    chord = np.diff(points, axis=0)
    size = np.hypot(chord[:, 0], chord[:, 1])
    fraction = np.arange(1, _PROBES) / _PROBES
    probes = evaluate(curve, (s[:-1, None] + np.diff(s)[:, None] * fraction).ravel()).points
    offset = probes.reshape(-1, _PROBES - 1, 2) - points[:-1, None]
    aside = np.abs(chord[:, None, 0] * offset[..., 1] - chord[:, None, 1] * offset[..., 0])
    return Lines(points, float((aside / np.maximum(size, 1e-300)[:, None]).max(initial=0.0)))


def to_arcs(curve: Curve, tolerance: float) -> Approximation:
    """Lines and arcs, joined G1, within `tolerance` (m) of the curve.

    A clothoid is cut evenly and every part becomes a biarc: two arcs with the ends and headings of the part, their
    control points equally far from them (Bolton, Biarc curves, 1975). Lines and arcs stay as they are.

    Raises
    ------
    InputError : a tolerance not above 0; LimitError when it takes more than `MAX_SAMPLES` arcs
    """

    def made(parts: IntArray) -> tuple[Curve, FloatArray]:
        s = cuts(curve, parts)
        piece = np.repeat(np.arange(len(curve)), parts)
        exact = curve.sharpness[piece] == 0
        at = evaluate(curve, s)
        kappa, length = _biarcs(at.points, at.heading)
        kappa[exact] = curve.curvature[piece[exact], None]
        length[exact] = np.diff(s)[exact, None] / 2
        arcs = Curve(curve.start, kappa.ravel(), np.zeros(kappa.size), length.ravel())
        fraction = np.arange(1, _PROBES) / _PROBES
        low, high = arcs.offsets[:-1:2], arcs.offsets[2::2]
        ours = evaluate(arcs, (low[:, None] + (high - low)[:, None] * fraction).ravel()).points
        true = evaluate(curve, (s[:-1, None] + np.diff(s)[:, None] * fraction).ravel()).points
        return arcs, np.hypot(*(ours - true).T).reshape(-1, _PROBES - 1).max(axis=1)

    arcs, error = _refined(curve, tolerance, made)
    same = np.concatenate([[False], (arcs.curvature[1:] == arcs.curvature[:-1])])
    first = np.flatnonzero(~same)
    length = np.add.reduceat(arcs.length, first) if len(first) else arcs.length
    return Approximation(Curve(arcs.start, arcs.curvature[first], arcs.sharpness[first], length), error)


def to_beziers(curve: Curve, tolerance: float = 1e-3) -> Beziers:
    """Cubic Bezier pieces within `tolerance` (m) of the curve: ends and headings shared, handles a third of the arc.

    Raises
    ------
    InputError : a tolerance not above 0; LimitError when it takes more than `MAX_SAMPLES` pieces
    """

    def made(parts: IntArray) -> tuple[FloatArray, FloatArray]:
        s = cuts(curve, parts)
        at = evaluate(curve, s)
        points, ahead = at.points, np.column_stack([np.cos(at.heading), np.sin(at.heading)])
        third = (np.diff(s) / 3)[:, None]
        before, after = points[:-1] + third * ahead[:-1], points[1:] - third * ahead[1:]
        control = np.stack([points[:-1], before, after, points[1:]], axis=1)
        t = np.arange(1, _PROBES) / _PROBES
        basis = np.stack([(1 - t) ** 3, 3 * t * (1 - t) ** 2, 3 * t * t * (1 - t), t**3], axis=1)
        ours = np.einsum("tb,kbd->ktd", basis, control)
        true = evaluate(curve, (s[:-1, None] + np.diff(s)[:, None] * t).ravel()).points.reshape(ours.shape)
        return control, np.hypot(*np.moveaxis(ours - true, -1, 0)).max(axis=1)

    control, error = _refined(curve, tolerance, made)
    return Beziers(control, error)


def _refined(
    curve: Curve, tolerance: float, made: Callable[[IntArray], tuple[_Made, FloatArray]]
) -> tuple[_Made, float]:
    """Double the parts of each piece until none is off by more than the tolerance."""
    positive(tolerance, "the tolerance of a conversion")
    # a quarter turn a part at most, or the samples could miss a loop
    turn = np.maximum(np.abs(curve.curvature), np.abs(curve.end_curvature)) * curve.length
    parts = np.maximum(1, np.ceil(turn / (np.pi / 2))).astype(np.int64)
    for _ in range(_ROUNDS):
        if parts.sum() > MAX_SAMPLES:
            break
        result, each = made(parts)
        if len(curve) == 0:
            return result, 0.0
        error = np.maximum.reduceat(each, np.cumsum(parts) - parts)
        if error.max() <= tolerance:
            return result, float(error.max())
        parts = np.where(error > tolerance, 2 * parts, parts)
    raise LimitError(f"a curve needs more than {MAX_SAMPLES} pieces at {tolerance:g} m; expected a coarser tolerance")


def _biarcs(points: FloatArray, heading: FloatArray) -> tuple[FloatArray, FloatArray]:
    """(k, 2) curvatures and lengths of the two arcs between consecutive states that turn little."""
    chord = np.diff(points, axis=0)
    ahead = np.column_stack([np.cos(heading), np.sin(heading)])
    t0, t1 = ahead[:-1], ahead[1:]
    both = t0 + t1
    # d solves |v|^2 - 2 d v.(t0 + t1) - 2 d^2 (1 - t0.t1) = 0; this form has no cancellation when t0 = t1
    size, along = (chord**2).sum(axis=1), (chord * both).sum(axis=1)
    spread = 2 * (1 - (t0 * t1).sum(axis=1))
    d = size / (along + np.sqrt(along**2 + spread * size))
    join = (points[:-1] + points[1:] + d[:, None] * (t0 - t1)) / 2
    arcs = [_arc(points[:-1], heading[:-1], join), _arc(points[1:], heading[1:] + np.pi, join)]
    kappa = np.column_stack([arcs[0][0], -arcs[1][0]])  # the second is seen from its end
    return kappa, np.column_stack([arcs[0][1], arcs[1][1]])


def _arc(point: FloatArray, heading: FloatArray, to: FloatArray) -> tuple[FloatArray, FloatArray]:
    chord = to - point
    half = wrapped(np.arctan2(chord[:, 1], chord[:, 0]) - heading)
    length = np.hypot(chord[:, 0], chord[:, 1]) / np.sinc(half / np.pi)
    return 2 * half / length, length
