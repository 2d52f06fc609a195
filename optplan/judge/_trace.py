"""How far a driven line is from the stroke it should be.

Being near the stroke is not enough: a line driven twice, backwards or with a loop left out is near it too. So both are
walked in step. A point at some share of the driven length is compared only with the part of the stroke around the same
share of its length; what rounding corners saves is small, and bounds how far the two may be out of step.
"""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass

import numpy as np

from optplan.domain.arrays import BoolArray, FloatArray
from optplan.domain.stroke import Stroke

_CHUNK = 128
_MOST_STARTS = 6


@dataclass(frozen=True, eq=False)
class Trace:
    """A driven line held against its stroke.

    Parameters
    ----------
    deviation : largest distance, both ways, m
    place : (3,) m, where it is
    reverse : driven against the order of the points
    begin : arc length along the stroke where it was begun, m (0 for an open stroke)
    """

    deviation: float
    place: FloatArray
    reverse: bool
    begin: float


def trace(driven: FloatArray, stroke: Stroke, tolerance: float) -> Trace:
    """The best reading of a driven line as this stroke.

    Parameters
    ----------
    driven : (n, 3) m, n >= 1
    stroke : what it should be; one of its allowed directions wins over a forbidden one
    tolerance : m; the first reading within it is taken
    """
    if stroke.headings > 1:
        lines = [trace(driven, stroke.facing(k), tolerance) for k in range(stroke.headings)]
        return min(lines, key=lambda found: found.deviation)
    line = in_space(stroke.closed_points)
    if len(line) == 1:
        away = np.linalg.norm(driven - line[0], axis=1)
        worst = int(np.argmax(away))
        return Trace(float(away[worst]), driven[worst], False, 0.0)
    best: Trace | None = None
    for reverse, begin, target in _readings(driven[0], line, stroke, tolerance):
        deviation, place = deviation_between(driven, target, tolerance)
        if best is None or deviation < best.deviation:
            best = Trace(deviation, place, reverse, begin)
        if deviation <= tolerance:
            break
    assert best is not None
    return best


def in_space(points: FloatArray) -> FloatArray:
    """(n, 3) from (n, 2 or 3), z 0 in the plane, m."""
    return points if points.shape[1] == 3 else np.column_stack([points, np.zeros(len(points))])


def arc_lengths(line: FloatArray) -> FloatArray:
    """(n,) arc length at the points of a polyline, m."""
    return np.concatenate([[0.0], np.cumsum(np.linalg.norm(np.diff(line, axis=0), axis=1))])


def deviation_between(driven: FloatArray, wanted: FloatArray, tolerance: float) -> tuple[float, FloatArray]:
    """Largest distance (m), both ways and in step, between two polylines (n, 3) and (m, 3), and its place (3,)."""
    if driven.shape == wanted.shape:
        # point by point is an upper bound, and exact for a robot that drives the polyline itself
        away = np.linalg.norm(driven - wanted, axis=1)
        worst = int(np.argmax(away))
        if away[worst] <= tolerance:
            return float(away[worst]), driven[worst]
    driven_at, wanted_at = arc_lengths(driven), arc_lengths(wanted)
    length, goal = float(driven_at[-1]), float(wanted_at[-1])
    # rounding corners only saves length, so nowhere are the two more out of step than by what it saved in all
    slip = 8 * tolerance
    band = min(abs(length - goal), goal / 20 + tolerance * len(wanted) / 2) + slip
    scale = goal / length if length > 0 else 0.0
    there, there_place = _farthest(driven, driven_at * scale, wanted, wanted_at, band)
    dense, dense_at = _with_inner_points(wanted, wanted_at)
    back, back_place = _farthest(dense, dense_at, driven, driven_at * scale, band)
    return (there, there_place) if there >= back else (back, back_place)


def _readings(
    start: FloatArray, line: FloatArray, stroke: Stroke, tolerance: float
) -> Iterator[tuple[bool, float, FloatArray]]:
    """Direction, place of beginning and polyline of each way it may have been driven, likely first."""
    if not stroke.closed:
        forwards = np.linalg.norm(start - line[0]) <= np.linalg.norm(start - line[-1])
        ways = [False, True] if forwards or stroke.directed else [True, False]
        for reverse in ways:
            yield reverse, 0.0, line[::-1] if reverse else line
        return
    for reverse in (False, True):
        for begin, segment, point in _starts(start, line, tolerance):
            ring = np.concatenate([[point], line[segment + 1 :], line[1 : segment + 1], [point]])
            keep = np.concatenate([[True], np.any(np.diff(ring, axis=0) != 0, axis=1)])
            ring = ring[keep]
            yield reverse, begin, ring[::-1] if reverse else ring


def _starts(start: FloatArray, line: FloatArray, tolerance: float) -> list[tuple[float, int, FloatArray]]:
    """Places on a ring near which it may have been begun: arc length, segment and point; the nearest first.

    A ring may pass the same place more than once. Neighbouring segments give the same place, so it is kept once.
    """
    along = arc_lengths(line)
    step = np.diff(line, axis=0)
    share = np.clip(np.einsum("ij,ij->i", start - line[:-1], step) / np.einsum("ij,ij->i", step, step), 0, 1)
    near = line[:-1] + share[:, None] * step
    away = np.linalg.norm(start - near, axis=1)
    at = along[:-1] + share * np.diff(along)
    found: list[tuple[float, int, FloatArray]] = []
    for segment in np.argsort(away, kind="stable").tolist():
        if found and away[segment] > tolerance:
            break
        apart = [min(abs(at[segment] - other), along[-1] - abs(at[segment] - other)) for other, _, _ in found]
        if all(distance > 4 * tolerance for distance in apart):
            found.append((float(at[segment]), segment, near[segment]))
        if len(found) == _MOST_STARTS:
            break
    return found


def _with_inner_points(line: FloatArray, at: FloatArray) -> tuple[FloatArray, FloatArray]:
    """The polyline with the middle of every segment: the far side of a shortcut need not be at a vertex."""
    dense = np.empty((2 * len(line) - 1, 3))
    dense_at = np.empty(len(dense))
    dense[::2], dense[1::2] = line, (line[:-1] + line[1:]) / 2
    dense_at[::2], dense_at[1::2] = at, (at[:-1] + at[1:]) / 2
    return dense, dense_at


def _farthest(
    points: FloatArray, at: FloatArray, line: FloatArray, line_at: FloatArray, band: float
) -> tuple[float, FloatArray]:
    """Largest distance of points (at these arc lengths) from the part of a line within `band` of theirs, and where."""
    if len(line) == 1:
        distance = np.linalg.norm(points - line[0], axis=1)
        worst = int(np.argmax(distance))
        return float(distance[worst]), points[worst]
    most, place = -1.0, points[0]
    for begin in range(0, len(points), _CHUNK):
        chunk, low, high = (
            points[begin : begin + _CHUNK],
            at[begin : begin + _CHUNK] - band,
            at[begin : begin + _CHUNK] + band,
        )
        first = max(int(np.searchsorted(line_at, low[0], side="right")) - 1, 0)
        last = min(int(np.searchsorted(line_at, high[-1], side="left")), len(line) - 1)
        first = min(first, last - 1) if last > 0 else 0
        last = max(last, first + 1)
        a, step = line[first:last], np.diff(line[first : last + 1], axis=0)
        size = np.maximum(np.diff(line_at[first : last + 1]), 1e-300)
        square = np.maximum(np.einsum("ij,ij->i", step, step), 1e-300)
        share = (chunk @ step.T - np.einsum("ij,ij->i", a, step)) / square
        from_share = (low[:, None] - line_at[first:last]) / size
        to_share = (high[:, None] - line_at[first:last]) / size
        share = np.clip(share, np.clip(from_share, 0, 1), np.clip(to_share, 0, 1))
        gap = np.zeros(share.shape)
        for axis in range(3):
            gap += (a[:, axis] + share * step[:, axis] - chunk[:, axis, None]) ** 2
        outside: BoolArray = (from_share > 1) | (to_share < 0)
        # the ends of a line always have something to be compared with, however it was scaled
        outside &= ~np.all(outside, axis=1, keepdims=True)
        nearest = np.where(outside, np.inf, gap).min(axis=1)
        worst = int(np.argmax(nearest))
        if nearest[worst] > most:
            most, place = float(nearest[worst]), chunk[worst]
    return float(np.sqrt(most)), place
