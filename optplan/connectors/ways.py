"""How one stroke is driven: states at its ends, lengths, and the pieces of its path.

A robot with limits of curvature drives curves of continuous curvature and stops between them; one without follows the
polyline, its gentle vertices rounded by arcs.
"""

from __future__ import annotations

import math
from typing import NamedTuple

import numpy as np

from optplan.coverage.beside import Beside, beside
from optplan.coverage.stops import curves_of, tolerance_of
from optplan.domain.arrays import FloatArray, IntArray
from optplan.domain.errors import InputError
from optplan.domain.options import Options
from optplan.domain.robot import Robot
from optplan.domain.stroke import Stroke
from optplan.geometry.curves import Curve, evaluate, part, reversed_curve
from optplan.geometry.rounding import Pieces, inner_vertices, rounded, wrapped
from optplan.geometry.smoothing import Smoothed

SAME = 1e-9
"""m: an entry nearer than this to where a curve begins is there."""
_PROJECTIONS = 8


class Ends(NamedTuple):
    """What the ways of driving a stroke begin and end with, one a row."""

    entry: FloatArray
    """(k, 5) x, y, z, heading, curvature"""
    exit: FloatArray
    """(k, 5)"""
    length: FloatArray
    """(k,) m"""
    turned: FloatArray
    """(k,) rad turned on the spot on the way"""


def ends_of(stroke: Stroke, vertex: IntArray, reverse: bool, robot: Robot, options: Options) -> Ends:
    """The ways that enter a stroke at these vertices (k,) in one direction; an open one has two."""
    count = len(vertex)
    if stroke.is_stop:
        # headed east, with the tool at the place
        state = np.zeros((count, 5))
        state[:, : stroke.points.shape[1]] = stroke.points[0]
        state[:, :2] += (-robot.offset.ahead, robot.offset.right)
        return Ends(state, state, np.zeros(count), np.zeros(count))
    if stroke.headings > 1:
        lines = [ends_of(stroke.facing(k), np.zeros(1, dtype=np.int64), reverse, robot, options) for k in vertex]
        return Ends(*(np.concatenate(column) for column in zip(*lines, strict=True)))
    curves, way = curves_of(stroke, robot, options), _drivable(stroke, reverse, robot, options)
    if curves is None or way is None:
        made = _polyline_ends(stroke, vertex, robot, options)
    else:
        made = _curve_ends(stroke, curves, way, vertex)
    return _turned_round(made) if reverse else made


def driven(stroke: Stroke, vertex: int, reverse: bool, robot: Robot, options: Options) -> Pieces:
    """The path of one way: clothoids, lines and arcs, and stops with turns, along a stroke of two points or more."""
    if stroke.headings > 1:
        return driven(stroke.facing(vertex), 0, reverse, robot, options)
    curves, way = curves_of(stroke, robot, options), _drivable(stroke, reverse, robot, options)
    if curves is not None and way is not None:
        return _curve_pieces(stroke, curves, way, vertex, reverse)
    points = stroke.points[:, :2]
    if stroke.closed:
        points = np.roll(points, -vertex, axis=0)
        points = np.concatenate([points, points[:1]])
    if reverse:
        points = points[::-1]
    return rounded(points, tolerance_of(options.page, robot.tool), 0.0, options.connect.corner)


def _drivable(stroke: Stroke, reverse: bool, robot: Robot, options: Options) -> Beside | None:
    """The robot's curves in one direction, None where it has none; InputError where it cannot drive them."""
    way = beside(stroke, reverse, robot, options)
    if way is not None and way.refused:
        direction = "backwards" if reverse else "forwards"
        raise InputError(f"stroke {stroke.id!r} cannot be driven {direction}: {way.refused}")
    return way


def _turned_round(ends: Ends) -> Ends:
    """The same ways driven from their ends to their beginnings."""
    entry, leave = ends.exit.copy(), ends.entry.copy()
    for state in (entry, leave):
        state[:, 3] += math.pi
        state[:, 4] *= -1
    return Ends(entry, leave, ends.length, ends.turned)


def _polyline_ends(stroke: Stroke, vertex: IntArray, robot: Robot, options: Options) -> Ends:
    """Of the ways forwards along the polyline with rounded vertices."""
    points, count = stroke.points, len(vertex)
    tolerance = tolerance_of(options.page, robot.tool)
    vertices = inner_vertices(points[:, :2], stroke.closed, tolerance, 0.0, options.connect.corner)
    # rounding a vertex saves two tangents and costs an arc
    half = np.where(vertices.tangent > 0, np.abs(vertices.deflection) / 2, 1.0)
    saved = np.where(vertices.tangent > 0, 2 * vertices.tangent * (1 - half / np.tan(half)), 0.0)
    turns = np.where(vertices.corner, np.abs(vertices.deflection), 0.0)
    steps = np.diff(stroke.closed_points, axis=0)
    headings = np.arctan2(steps[:, 1], steps[:, 0])
    length, turned = np.full(count, stroke.length - saved.sum()), np.full(count, turns.sum())
    first, last = np.zeros_like(vertex), np.full(count, len(points) - 1)
    out, into = headings[first], headings[first - 1]  # of an open stroke: of its first and its last step
    if stroke.closed:
        first = last = vertex
        out, into = headings[vertex], headings[vertex - 1]
        # where it begins and ends, a ring is not rounded
        length, turned = length + saved[vertex], turned - turns[vertex]
    entry, leave = np.zeros((count, 5)), np.zeros((count, 5))
    entry[:, : points.shape[1]], leave[:, : points.shape[1]] = points[first], points[last]
    entry[:, 3], leave[:, 3] = out, into
    return Ends(entry, leave, length, turned)


def _curve_ends(stroke: Stroke, made: Smoothed, way: Beside, vertex: IntArray) -> Ends:
    """Of the ways forwards along the robot's curves, which are beside those that were made of the stroke."""
    curves, count = way.curves, len(vertex)
    entry, leave = np.zeros((count, 5)), np.zeros((count, 5))
    flat = np.array([0, 1, 3, 4])
    turns = np.abs(_turns(stroke, made, curves))
    turned = np.full(count, turns.sum())
    if stroke.closed:
        number, s = _places(stroke, made, way)
        for k, curve in enumerate(curves):
            own = np.flatnonzero(number[vertex] == k)
            at = evaluate(curve, s[vertex[own]])
            entry[np.ix_(own, flat)] = np.column_stack([at.points, at.heading, at.curvature])
        leave[:] = entry
        if len(made.stops):
            # at a stop the ring is left as the curve before it ends
            for row in np.flatnonzero(s[vertex] == 0):
                k = int(number[vertex[row]])
                leave[row, flat] = _last(curves[k - 1])
                turned[row] -= turns[k - 1]
    else:
        entry[:, flat] = [*curves[0].start, curves[0].curvature[0]]
        leave[:, flat] = _last(curves[-1])
    return Ends(entry, leave, np.full(count, sum(curve.total for curve in curves)), turned)


def _last(curve: Curve) -> FloatArray:
    return np.array([*curve.end, curve.end_curvature[-1]])


def _turns(stroke: Stroke, made: Smoothed, curves: tuple[Curve, ...]) -> FloatArray:
    """(k,) rad turned on the spot behind each curve; behind the last one of an open stroke 0."""
    if stroke.closed and len(made.stops) == 0:
        return np.zeros(1)
    after = np.array([curve.start[2] for curve in curves])
    turns = wrapped(np.roll(after, -1) - np.array([curve.end[2] for curve in curves]))
    if not stroke.closed:
        turns[-1] = 0.0
    return turns


def _places(stroke: Stroke, made: Smoothed, way: Beside) -> tuple[IntArray, FloatArray]:
    """For each vertex (n,) of a ring the curve on which it lies, and the robot's arc length there, m."""
    points = stroke.points[:, :2]
    count = len(points)
    first = int(made.stops[0]) if len(made.stops) else 0
    ring = np.roll(points, -first, axis=0)
    steps = np.diff(np.concatenate([ring, ring[:1]]), axis=0)
    at = np.concatenate([[0.0], np.cumsum(np.hypot(steps[:, 0], steps[:, 1]))])
    begins = [0, *((made.stops[1:] - first) % count).tolist(), count]
    number, s = np.zeros(count, dtype=np.int64), np.zeros(count)
    for k, curve in enumerate(made.curves):
        low, high = begins[k], begins[k + 1]
        inner = np.arange(low + 1, high)
        along = (at[inner] - at[low]) * curve.total / (at[high] - at[low])
        for _ in range(_PROJECTIONS):
            here = evaluate(curve, along)
            away = ring[inner] - here.points
            step = away[:, 0] * np.cos(here.heading) + away[:, 1] * np.sin(here.heading)
            along = np.clip(along + step, SAME, curve.total - SAME)
        if way.curves is not made.curves:
            along = np.clip(np.interp(along, way.tool[k], way.robot[k]), SAME, way.curves[k].total - SAME)
        number[low:high], s[inner] = k, along
    return np.roll(number, first), np.roll(s, first)


def _curve_pieces(stroke: Stroke, made: Smoothed, way: Beside, vertex: int, reverse: bool) -> Pieces:
    curves = list(way.curves)
    if stroke.closed:
        number, s = _places(stroke, made, way)
        k, here = int(number[vertex]), float(s[vertex])
        if here > 0:
            curves = [part(curves[k], here, curves[k].total), *curves[k + 1 :], *curves[:k], part(curves[k], 0.0, here)]
        else:
            curves = [*curves[k:], *curves[:k]]
    if reverse:
        curves = [reversed_curve(curve) for curve in curves[::-1]]
    rows: list[FloatArray] = []
    whole = stroke.closed and len(made.stops) == 0  # one curve, cut in two where it is entered
    for before, curve in zip([None, *curves], curves, strict=False):
        if before is not None and not whole:
            turn = float(wrapped(np.array([curve.start[2] - before.end[2]]))[0])
            rows.append(np.array([[*before.end, 0.0, 0.0, turn, 0.0]]))
        zero = np.zeros(len(curve))
        rows.append(np.column_stack([curve.states[:-1], curve.curvature, curve.length, zero, curve.sharpness]))
    table = np.concatenate(rows)
    return Pieces(table[:, :2], *table[:, 2:].T)
