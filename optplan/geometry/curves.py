"""Curves of clothoid pieces: evaluated, cut, turned round and joined.

A `Curve` is continuous in place and heading because it cannot say otherwise: it holds one start, and what pieces add.
"""

from __future__ import annotations

import math
from dataclasses import dataclass
from functools import cached_property
from itertools import pairwise
from typing import NamedTuple

import numpy as np

from optplan.domain.arrays import BoolArray, FloatArray, IntArray, frozen_floats
from optplan.domain.errors import InputError, LimitError
from optplan.domain.path import Path
from optplan.geometry.clothoids import clothoid_displacement
from optplan.geometry.rounding import wrapped

MAX_SAMPLES = 5_000_000
"""Most points that one curve is sampled at."""


@dataclass(frozen=True, eq=False)
class Curve:
    """A plane curve of clothoid pieces, continuous in place and heading. Lines and arcs are clothoids too.

    Parameters
    ----------
    start : (3,) x, y, heading at the beginning: m, m, rad
    curvature : (n,) kappa at the beginning of each piece, 1/m, left positive
    sharpness : (n,) sigma = dkappa/ds of each piece, 1/m^2
    length : (n,) m, > 0

    Raises
    ------
    InputError : a number that is not finite, arrays of different lengths, or a length that is not above 0
    """

    start: FloatArray
    curvature: FloatArray
    sharpness: FloatArray
    length: FloatArray

    def __post_init__(self) -> None:
        object.__setattr__(self, "start", frozen_floats(self.start, "curve start", (3,)))
        object.__setattr__(self, "length", frozen_floats(self.length, "curve length", (None,)))
        for name in ("curvature", "sharpness"):
            object.__setattr__(self, name, frozen_floats(getattr(self, name), f"curve {name}", (len(self.length),)))
        if (self.length <= 0).any():
            row = int(np.argmin(self.length))
            raise InputError(f"piece {row} of a curve has length {self.length[row]:g} m; expected more than 0")

    def __len__(self) -> int:
        return len(self.length)

    @cached_property
    def offsets(self) -> FloatArray:
        """(n + 1,) arc length at the beginning of every piece, and the total, m."""
        return _read_only(np.concatenate([[0.0], np.cumsum(self.length)]))

    @cached_property
    def states(self) -> FloatArray:
        """(n + 1, 3) x, y, heading at the beginning of every piece, and at the end."""
        turn = self.length * (self.curvature + self.length * self.sharpness / 2)
        heading = self.start[2] + np.concatenate([[0.0], np.cumsum(turn)])
        dx, dy = clothoid_displacement(heading[:-1], self.curvature, self.sharpness, self.length)
        x = self.start[0] + np.concatenate([[0.0], np.cumsum(dx)])
        y = self.start[1] + np.concatenate([[0.0], np.cumsum(dy)])
        return _read_only(np.column_stack([x, y, heading]))

    @property
    def total(self) -> float:
        """Length, m."""
        return float(self.offsets[-1])

    @property
    def end(self) -> FloatArray:
        """(3,) x, y, heading at the end."""
        last: FloatArray = self.states[-1]
        return last

    @property
    def end_curvature(self) -> FloatArray:
        """(n,) kappa at the end of each piece, 1/m."""
        return self.curvature + self.sharpness * self.length

    @property
    def max_curvature(self) -> float:
        """Largest |kappa|, 1/m: kappa is linear on a piece, so it is that of an end."""
        return float(np.abs([self.curvature, self.end_curvature]).max(initial=0.0))

    @property
    def max_sharpness(self) -> float:
        """Largest |sigma| within pieces, 1/m^2; jumps of curvature at joints are `joints`' business."""
        return float(np.abs(self.sharpness).max(initial=0.0))


class CurveStates(NamedTuple):
    """Places along a curve; arrays (k,)."""

    x: FloatArray
    y: FloatArray
    heading: FloatArray
    curvature: FloatArray

    @property
    def points(self) -> FloatArray:
        """(k, 2) m"""
        return np.column_stack([self.x, self.y])


class Joints(NamedTuple):
    """How well pieces meet; arrays (k,), one entry a joint."""

    position: FloatArray
    """m, gap"""
    heading: FloatArray
    """rad, gap, >= 0"""
    curvature: FloatArray
    """1/m, gap, >= 0"""
    order: IntArray
    """-1 apart, 0 a corner (G0), 1 a jump of curvature (G1), 2 neither (G2)"""


def evaluate(curve: Curve, s: FloatArray) -> CurveStates:
    """States at arc lengths s (k,), m.

    Raises
    ------
    InputError : an arc length beyond an end by more than rounding, or that is no number
    """
    s = _within(curve, s)
    if len(curve) == 0:
        x, y, heading = (np.full(len(s), value) for value in curve.start)
        return CurveStates(x, y, heading, np.zeros(len(s)))
    piece = np.clip(np.searchsorted(curve.offsets, s, side="right") - 1, 0, len(curve) - 1)
    u = s - curve.offsets[piece]
    x, y, heading = curve.states[piece].T
    curvature, sharpness = curve.curvature[piece], curve.sharpness[piece]
    dx, dy = clothoid_displacement(heading, curvature, sharpness, u)
    return CurveStates(x + dx, y + dy, heading + u * (curvature + u * sharpness / 2), curvature + u * sharpness)


def steps_within(curve: Curve, tolerance: float) -> IntArray:
    """(n,) equal steps each piece is cut into so that chords of steps stay within `tolerance` (m) of it.

    A step h of curvature kappa at most has a sagitta of kappa h^2 / 8 at most, and turns by a right angle at most.
    """
    positive(tolerance, "the chord tolerance")
    kappa = np.maximum(np.abs(curve.curvature), np.abs(curve.end_curvature))
    count = np.ceil(np.maximum(curve.length * np.sqrt(kappa / (8 * tolerance)), kappa * curve.length / (math.pi / 2)))
    if count.sum() > MAX_SAMPLES:
        raise LimitError(f"a curve needs {count.sum():.3g} points at {tolerance:g} m; expected at most {MAX_SAMPLES}")
    return np.maximum(count, 1).astype(np.int64)


def cuts(curve: Curve, parts: IntArray) -> FloatArray:
    """Arc lengths (sum of parts + 1,) that cut piece i into parts[i] equal steps, m."""
    piece = np.repeat(np.arange(len(curve)), parts)
    within = np.arange(len(piece)) - np.repeat(np.cumsum(parts) - parts, parts)
    inner = curve.offsets[piece] + curve.length[piece] * within / np.asarray(parts)[piece]
    return np.concatenate([inner, curve.offsets[-1:]])


def sampled_curve(curve: Curve, tolerance: float) -> FloatArray:
    """Arc lengths (k,) whose chords stay within `tolerance` (m) of the curve; ends of pieces are among them.

    Raises
    ------
    InputError : a tolerance not above 0; LimitError when it takes more than `MAX_SAMPLES` points
    """
    return cuts(curve, steps_within(curve, tolerance))


def reversed_curve(curve: Curve) -> Curve:
    """The same places driven the other way: headings turn by pi, curvature changes sign, sharpness does not."""
    x, y, heading = curve.end
    start = np.array([x, y, float(wrapped(np.array([heading + math.pi]))[0])])
    return Curve(start, -curve.end_curvature[::-1], curve.sharpness[::-1], curve.length[::-1])


def part(curve: Curve, s0: float, s1: float) -> Curve:
    """The curve from arc length s0 to s1 (m), 0 <= s0 <= s1 <= its total. Raises like `evaluate`."""
    low, high = _within(curve, np.array([s0, s1]))
    if high < low:
        raise InputError(f"a part of a curve runs from {s0:g} to {s1:g} m; expected an end after the start")
    at = evaluate(curve, np.array([low]))
    begin = np.maximum(curve.offsets[:-1], low)
    length = np.minimum(curve.offsets[1:], high) - begin
    keep = length > 0
    shift = (begin - curve.offsets[:-1])[keep]
    curvature = curve.curvature[keep] + curve.sharpness[keep] * shift
    start = np.array([at.x[0], at.y[0], at.heading[0]])
    return Curve(start, curvature, curve.sharpness[keep], length[keep])


def split(curve: Curve, s: float) -> tuple[Curve, Curve]:
    """The curve before and after arc length s, m. Raises like `evaluate`."""
    return part(curve, 0.0, s), part(curve, s, curve.total)


def joined(*curves: Curve, tolerance: float = 1e-6) -> Curve:
    """One curve after the other. The later ones are moved by the gap, which must be within `tolerance` (m, and rad).

    Raises
    ------
    InputError : no curve at all, or two that do not meet in place and heading
    """
    if not curves:
        raise InputError("no curves to join; expected at least one")
    for number, (before, after) in enumerate(pairwise(curves)):
        gap = math.hypot(*(after.start[:2] - before.end[:2]))
        bend = abs(float(wrapped(np.array([after.start[2] - before.end[2]]))[0]))
        if gap > tolerance or bend > tolerance:
            raise InputError(
                f"curves {number} and {number + 1} do not meet: {gap:g} m and {bend:g} rad apart; "
                f"expected at most {tolerance:g}"
            )
    columns = [[c.curvature for c in curves], [c.sharpness for c in curves], [c.length for c in curves]]
    return Curve(curves[0].start, *(np.concatenate(column) for column in columns))


def moved(curve: Curve, place: FloatArray) -> Curve:
    """The curve turned and shifted so that it begins at place (3,) x, y, heading."""
    return Curve(place, curve.curvature, curve.sharpness, curve.length)


def joints(*curves: Curve, tolerance: float = 1e-6) -> Joints:
    """Every joint, in driving order: inside the curves and between one and the next.

    Parameters
    ----------
    curves : in driving order; empty ones count for nothing
    tolerance : m, rad and 1/m within which place, heading and curvature agree
    """
    curves = tuple(curve for curve in curves if len(curve))
    if not curves:
        return Joints(np.zeros(0), np.zeros(0), np.zeros(0), np.zeros(0, dtype=np.int64))
    first = np.concatenate([curve.states[:-1] for curve in curves])
    last = np.concatenate([curve.states[1:] for curve in curves])
    begin = np.concatenate([curve.curvature for curve in curves])
    finish = np.concatenate([curve.end_curvature for curve in curves])
    position = np.hypot(*(first[1:, :2] - last[:-1, :2]).T)
    heading = np.abs(wrapped(first[1:, 2] - last[:-1, 2]))
    curvature = np.abs(begin[1:] - finish[:-1])
    met: BoolArray = position <= tolerance
    smooth = met & (heading <= tolerance)
    order = met.astype(np.int64) + smooth + (smooth & (curvature <= tolerance)) - 1
    return Joints(position, heading, curvature, order)


def from_path(path: Path, first: int = 0, last: int | None = None, tolerance: float = 1e-6) -> Curve:
    """Rows first..last - 1 of a path as one curve.

    Raises
    ------
    InputError : no row, a stop, a row out of the plane, or rows that do not meet in place and heading
    """
    rows = slice(first, len(path) if last is None else last)
    if len(path.length[rows]) == 0:
        raise InputError(f"rows {rows.start} to {rows.stop} of a path are none; expected at least one")
    if (path.length[rows] == 0).any():
        raise InputError("a stop of a path is no part of a curve; expected rows with a length")
    if (path.elevation[rows] != 0).any() or np.ptp(path.start[rows, 2]) > 0:
        raise InputError("a path leaves the plane; expected elevation 0 and one height")
    starts = np.column_stack([path.start[rows, :2], path.heading[rows]])
    columns = zip(starts, path.curvature[rows], path.sharpness[rows], path.length[rows], strict=True)
    return joined(*(Curve(at, *(np.array([value]) for value in row)) for at, *row in columns), tolerance=tolerance)


def to_path(curve: Curve, tool: int = 0, stroke: int = -1) -> Path:
    """The curve as rows of a path, driven with one tool setting as part of one stroke (-1: none)."""
    zero = np.zeros(len(curve))
    start = np.column_stack([curve.states[:-1, :2], zero])
    columns = (curve.curvature, curve.sharpness, curve.length)
    whole = np.zeros(len(curve), dtype=np.int64)
    return Path(start, curve.states[:-1, 2], zero, *columns, zero, zero, whole + tool, whole + stroke)


def positive(value: float, what: str) -> None:
    """Refuse what is not a finite number above 0."""
    if not (math.isfinite(value) and value > 0):
        raise InputError(f"{what} is {value}; expected a finite number above 0")


def _within(curve: Curve, s: FloatArray) -> FloatArray:
    s = np.atleast_1d(np.asarray(s, dtype=np.float64))
    slack = 1e-9 * (1 + curve.total)
    bad = ~((s >= -slack) & (s <= curve.total + slack))
    if bad.any():
        raise InputError(f"arc length {s[bad][0]} m is not on the curve; expected 0 to {curve.total:g} m")
    return np.clip(s, 0.0, curve.total)


def _read_only(array: FloatArray) -> FloatArray:
    array.setflags(write=False)
    return array
