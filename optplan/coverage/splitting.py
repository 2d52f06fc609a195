"""Strokes split where the robot may not turn, and where it has to come back from the other end."""

from __future__ import annotations

from dataclasses import replace
from itertools import pairwise

import numpy as np

from optplan.coverage.beside import refusals, tight
from optplan.coverage.stops import curves_of, stops_of
from optplan.domain.arrays import FloatArray, IntArray
from optplan.domain.job import Note
from optplan.domain.options import Options
from optplan.domain.robot import Robot
from optplan.domain.stroke import Stroke


def split_at_stops(strokes: list[Stroke], robot: Robot, options: Options) -> tuple[list[Stroke], list[int]]:
    """Strokes without stops, for a robot that cannot turn on the spot; other robots get them as they are.

    Where the tool is not in the robot's middle, a turn on the spot would draw an arc: such strokes are split too, and
    those with bends of which one asks for one direction and one for the other.

    Returns
    -------
    parts : what the strokes are split into, in their order
    source : of each part, the index of the stroke that it is a part of
    """
    if robot.mobility.turns_on_spot and not robot.offset.aside:
        return strokes, list(range(len(strokes)))
    parts = [_numbered(stroke, _parts(stroke, robot, options)) for stroke in strokes]
    return [part for own in parts for part in own], [k for k, own in enumerate(parts) for _ in own]


def _numbered(stroke: Stroke, parts: list[Stroke]) -> list[Stroke]:
    """Parts with one number each, however often what they are parts of was split."""
    if len(parts) == 1 and parts[0] is stroke:
        return parts
    return [replace(part, id=f"{stroke.id}~{k}") for k, part in enumerate(parts, start=1)]


def direction_notes(strokes: list[Stroke], robot: Robot, options: Options) -> list[Note]:
    """A notice for each stroke that can be driven in one direction only, because of where the tool sits."""
    if not robot.offset.aside:
        return []
    notes = []
    for stroke in strokes:
        forwards, backwards = refusals(stroke, robot, options)
        if bool(forwards) != bool(backwards):
            way = "against the order of its points" if forwards else "in the order of its points"
            text = f"stroke {stroke.id!r} is only driven {way}: the other way, {forwards or backwards}"
            notes.append(Note("notice", stroke.element, text))
    return notes


def _parts(stroke: Stroke, robot: Robot, options: Options) -> list[Stroke]:
    stops = stops_of(stroke, robot, options)
    if robot.offset.aside and not stroke.is_stop:
        if len(stops) == 0:
            stops = _changes(stroke, robot, options)
        if len(stops):
            return [part for first in _split(stroke, stops) for part in _parts(first, robot, options)]
    return _split(stroke, stops)


def _changes(stroke: Stroke, robot: Robot, options: Options) -> IntArray:
    """Vertices between bends that the robot can only drive one way and such that it can only drive the other way.

    None where one direction is fine, or where only one is allowed, or for a single line.
    """
    made = curves_of(stroke, robot, options)
    free = not stroke.directed and (stroke.entry is None or stroke.closed)
    if made is None or not free or not all(refusals(stroke, robot, options)):
        return np.zeros(0, dtype=np.int64)
    curve = made.curves[0]
    forwards, backwards = (tight(made, reverse, robot, options)[0] for reverse in (False, True))
    side = forwards.astype(np.int64) - backwards
    at = np.flatnonzero(side)
    change = at[:-1][side[at[:-1]] != side[at[1:]]] if len(at) else at
    following = at[1:][side[at[:-1]] != side[at[1:]]] if len(at) else at
    places = (curve.offsets[change] + curve.offsets[following]) / 2
    if len(places) == 0:
        places = np.array([curve.total / 2])
    return _nearest(stroke, places / curve.total)


def _nearest(stroke: Stroke, shares: FloatArray) -> IntArray:
    """The vertices nearest to shares (k,) of a stroke's length; of an open one, the inner ones only."""
    ring = stroke.closed_points
    along = np.concatenate([[0.0], np.cumsum(np.linalg.norm(np.diff(ring, axis=0), axis=1))])
    vertices = np.arange(len(stroke.points)) if stroke.closed else np.arange(1, len(stroke.points) - 1)
    if len(vertices) == 0:
        return vertices
    nearest = np.abs(along[vertices][None, :] - shares[:, None] * along[-1]).argmin(axis=1)
    return np.unique(vertices[nearest])


def _split(stroke: Stroke, stops: IntArray) -> list[Stroke]:
    if len(stops) == 0:
        return [stroke]
    points, bends = stroke.points, stroke.bends
    if stroke.closed:  # begin at a stop, and come back to it
        points = np.roll(points, -int(stops[0]), axis=0)
        points = np.concatenate([points, points[:1]])
        bends = None if bends is None else np.roll(bends, -int(stops[0]))
        cuts = [0, *(stops[1:] - stops[0]).tolist(), len(points) - 1]
    else:
        cuts = [0, *stops.tolist(), len(points) - 1]
    return [
        replace(
            stroke,
            id=f"{stroke.id}~{k}",
            points=points[a : b + 1],
            closed=False,
            entry=None,
            bends=None if bends is None else bends[a:b],
        )
        for k, (a, b) in enumerate(pairwise(cuts), start=1)
    ]
