"""Lines of a field that the robot cannot mark without coming too near an obstacle, or the border of where it may be."""

from __future__ import annotations

import math
from dataclasses import replace
from typing import Any

import numpy as np

from optplan.coverage.beside import beside
from optplan.domain.arrays import FloatArray
from optplan.domain.errors import InputError
from optplan.domain.job import Field, Note
from optplan.domain.options import Options
from optplan.domain.robot import DiffDrive, Robot
from optplan.domain.stroke import Stroke
from optplan.geometry.curves import evaluate, sampled_curve

SAG = 1e-4
"""Between the robot's curve and the chords that it is checked by, m: kept in addition to the clearance."""
TOUCHES = 1e-9
"""m by which rounding may make a robot seem too near."""


def marking_clearance(robot: Robot, options: Options) -> float:
    """What the robot's middle keeps from areas while it marks, m: half its track, or the clearance if that is less.

    Lines are where they are: a greater clearance is for the ways between them.
    """
    half = robot.mobility.track / 2 if isinstance(robot.mobility, DiffDrive) else math.inf
    return min(options.connect.clearance, half)


def refuse_bad_areas(job: Field, options: Options) -> None:
    """InputError for polygons that are none, or cross themselves, and for a start that the robot cannot stand on."""
    import shapely

    asked = options.connect
    if asked.on_canvas:
        raise InputError("connectors are to stay on the canvas, which a field does not have; expected keep_in instead")
    start = options.order.start or job.start
    rooms = [("keep_in", np.array(ring)) for ring in (job.keep_in, asked.keep_in) if ring is not None]
    rings = [(f"keep_out[{k}]", np.array(ring)) for k, ring in enumerate((*job.keep_out, *asked.keep_out))]
    for name, ring in (*rooms, *rings):
        if len(ring) < 3:
            raise InputError(f"{name} has {len(ring)} corners; expected 3 or more")
        polygon = shapely.Polygon(ring)
        if not polygon.is_valid or polygon.area == 0:
            reason = "its area is 0" if polygon.is_valid else shapely.is_valid_reason(polygon)
            raise InputError(f"{name} is no simple polygon: {reason}; expected a border that does not cross itself")
        if start is not None and shapely.intersects_xy(polygon, *start) == (not name.startswith("keep_in")):
            side = "outside" if name.startswith("keep_in") else "inside"
            raise InputError(
                f"the start ({start[0]:g}, {start[1]:g}) lies {side} {name}; expected a place that is free"
            )


def with_free_ways(strokes: list[Stroke], robot: Robot, options: Options) -> tuple[list[Stroke], list[Note]]:
    """Strokes that offer only directions in which the robot keeps clear of areas; a notice for each that lost one.

    A line or an arc is left with the end at which it must be entered, a ring is turned round if need be, and a spot has
    as many evenly spread headings as are free.

    Raises
    ------
    InputError : a stroke of which no direction is free, by name
    """
    made, notes = [], []
    for stroke, found in zip(strokes, _reasons(strokes, robot, options), strict=True):
        kept, note = _left(stroke, found)
        made.append(kept)
        notes += note
    return made, notes


def stuck(strokes: list[Stroke], robot: Robot, options: Options) -> list[bool]:
    """Whether no direction of each stroke keeps clear of areas, though there are some that can be steered."""
    return [bool(found) and all(found.values()) for found in _reasons(strokes, robot, options)]


def _reasons(strokes: list[Stroke], robot: Robot, options: Options) -> list[dict[int, str]]:
    """For each stroke why each of its directions is none; empty where it is one."""
    areas = _Areas(robot, options)
    if not areas.polygons:
        return [{} for _ in strokes]
    ways: list[tuple[int, int, FloatArray]] = []
    for k, stroke in enumerate(strokes):
        ways += [(k, number, points) for number, points in _ways(stroke, robot, options)]
    reasons = areas.reasons([points for _, _, points in ways])
    own: list[dict[int, str]] = [{} for _ in strokes]
    for (k, number, _), reason in zip(ways, reasons, strict=True):
        own[k][number] = reason
    return own


def _ways(stroke: Stroke, robot: Robot, options: Options) -> list[tuple[int, FloatArray]]:
    """The directions that a stroke is offered in, and the robot's line (n, 2) in each: 0 forwards, 1 backwards, or the
    number of a heading. What the robot cannot steer is none."""
    if stroke.headings > 1:
        faced = [(k, _line(stroke.facing(k), False, robot, options)) for k in range(stroke.headings)]
        return [(k, points) for k, points in faced if points is not None]
    sides = [False] if stroke.directed or stroke.is_stop else [False, True]
    lines = [(int(reverse), _line(stroke, reverse, robot, options)) for reverse in sides]
    return [(k, points) for k, points in lines if points is not None]


def _line(stroke: Stroke, reverse: bool, robot: Robot, options: Options) -> FloatArray | None:
    way = beside(stroke, reverse, robot, options)
    if way is None:
        points = stroke.closed_points[:, :2]
        return np.repeat(points, 2, axis=0) if stroke.is_stop else points
    if way.refused:
        return None
    return np.concatenate([evaluate(curve, sampled_curve(curve, SAG)).points for curve in way.curves])


class _Areas:
    """What the robot's middle keeps away from."""

    def __init__(self, robot: Robot, options: Options) -> None:
        import shapely

        self.clearance = marking_clearance(robot, options)
        asked = options.connect
        self.polygons: list[Any] = [shapely.Polygon(ring) for ring in asked.keep_out]
        self.names = [f"obstacle {k}" for k in range(len(self.polygons))]
        if asked.keep_in is not None:
            room = shapely.Polygon(asked.keep_in)
            # all that is outside, as far as any line can lead
            frame = room.buffer(2 * self.clearance + 1, join_style="mitre").envelope
            self.polygons.append(frame.difference(room))
            self.names.append("the border of the keep-in area")
            self.room = room
        else:
            self.room = None

    def reasons(self, lines: list[FloatArray]) -> list[str]:
        """Why the robot may not drive each of these lines (n, 2); empty where it may."""
        import shapely

        chains = np.array([shapely.LineString(points) for points in lines], dtype=object)
        found = [""] * len(lines)
        tree = shapely.STRtree(chains)
        near, which = tree.query(self.polygons, predicate="dwithin", distance=self.clearance + SAG)
        for polygon, k in zip(near.tolist(), which.tolist(), strict=True):
            slack = SAG if len(lines[k]) > 2 else 0.0
            apart = float(shapely.distance(self.polygons[polygon], chains[k]))
            touched = apart == 0 and (self.clearance > 0 or not shapely.touches(self.polygons[polygon], chains[k]))
            if touched or apart < self.clearance + slack - TOUCHES:
                where = (
                    f"run into {self.names[polygon]}" if apart == 0 else f"be {apart:.3g} m from {self.names[polygon]}"
                )
                found[k] = f"its middle would {where}"
        if self.room is not None:
            for k in np.flatnonzero(~shapely.covers(self.room, chains)).tolist():
                found[k] = "its middle would leave the keep-in area"
        return [reason and f"{reason}; expected {self.clearance:.3g} m or more of room" for reason in found]


def _left(stroke: Stroke, reasons: dict[int, str]) -> tuple[Stroke, list[Note]]:
    """What is left of a stroke, given why each of the directions that it was offered in is none, and what to say."""
    free = [k for k, reason in reasons.items() if not reason]
    if len(free) == len(reasons):
        return stroke, []
    blocked = {k: reason for k, reason in reasons.items() if reason}
    if not free:
        which = "any direction" if len(reasons) > 1 else "its direction" if stroke.directed else "the one that is left"
        told = "; ".join(sorted(set(blocked.values())))
        raise InputError(f"segment {stroke.element!r} cannot be marked in {which}: the robot is beside it, and {told}")
    if stroke.headings > 1:
        reason = next(iter(blocked.values()))
        text = f"spot {stroke.id!r} is not crossed in {len(blocked)} of {stroke.headings} directions: {reason}"
        return _fewer(stroke, set(free)), [Note("notice", stroke.element, text)]
    (reason,) = blocked.values()
    way = "in the order of its points" if free == [0] else "against the order of its points"
    text = f"stroke {stroke.id!r} is only driven {way}: the other way, {reason}"
    notes = [Note("notice", stroke.element, text)]
    if not stroke.closed:
        return replace(stroke, entry=0 if free == [0] else len(stroke.points) - 1), notes
    if free == [0]:
        return replace(stroke, directed=True), notes
    bends = None if stroke.bends is None else -np.roll(stroke.bends[::-1], -1)
    return replace(stroke, points=stroke.points[::-1], bends=bends, directed=True), notes


def _fewer(stroke: Stroke, free: set[int]) -> Stroke:
    """A spot with the most evenly spread headings that are all free; they are of one kind, so any such set will do."""
    count = stroke.headings
    for step in (step for step in range(2, count + 1) if count % step == 0):
        for first in range(step):
            if free.issuperset(range(first, count, step)):
                turned = stroke.facing(first)
                if step == count:
                    return replace(turned, entry=0)
                return replace(turned, headings=count // step)
    return stroke
