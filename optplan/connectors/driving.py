"""From chosen traversals to the path that is driven."""

from __future__ import annotations

import math
from typing import NamedTuple

import numpy as np

from optplan.connectors.around import Roads, roads_of
from optplan.connectors.families import Family, family_of, limits_between, start_states
from optplan.connectors.padding import padded, pieces_between
from optplan.connectors.ways import driven
from optplan.domain.arrays import FloatArray
from optplan.domain.options import Options
from optplan.domain.path import RAISED, Path
from optplan.domain.result import Cover
from optplan.domain.robot import CurvatureLimits, Robot
from optplan.domain.stroke import Traversals
from optplan.geometry.cc import cc_path
from optplan.geometry.clothoids import clothoid_displacement
from optplan.geometry.curves import Curve
from optplan.geometry.dubins import dubins_path
from optplan.geometry.reversing import reeds_shepp_path, reversing_path
from optplan.geometry.rounding import Pieces, wrapped

COINCIDENT = 1e-9
"""Two places nearer than this are one, m: no connector is driven between them."""


class _Rows(NamedTuple):
    """Columns of a path under construction: lists of arrays, one entry a run of pieces."""

    start: list[FloatArray]
    heading: list[FloatArray]
    curvature: list[FloatArray]
    length: list[FloatArray]
    turn: list[FloatArray]
    sharpness: list[FloatArray]
    dwell: list[FloatArray]
    tool: list[FloatArray]
    stroke: list[FloatArray]
    gear: list[FloatArray]

    def add(
        self, pieces: Pieces, tool: FloatArray | int, stroke: int, dwell: float = 0.0, gear: FloatArray | int = 1
    ) -> None:
        count = len(pieces.length)
        self.start.append(np.column_stack([pieces.start, np.zeros(count)]))
        self.heading.append(pieces.heading)
        self.curvature.append(pieces.curvature)
        self.length.append(pieces.length)
        self.turn.append(pieces.turn)
        self.sharpness.append(pieces.sharpness)
        self.dwell.append(np.full(count, dwell))
        self.tool.append(np.broadcast_to(tool, count))
        self.stroke.append(np.full(count, stroke))
        self.gear.append(np.broadcast_to(gear, count))


def connect(visits: Traversals, cover: Cover, robot: Robot, options: Options | None = None) -> Path:
    """The path that drives traversals in the order given, with connectors between them.

    A robot that turns on the spot moves straight from stroke to stroke; one that does not drives Dubins paths of its
    least radius at transit speed, or paths of continuous curvature within its limits at that speed; with reversing,
    such as change gear. The tool is raised on connectors, and while it turns at a corner.

    Parameters
    ----------
    visits : (m,) chosen traversals in driving order
    cover : the strokes they belong to, and the start point when the options name none
    robot, options : who drives, and how

    Raises
    ------
    InputError : a metric that this robot cannot have
    """
    options = options or Options()
    asked = options.connect
    entry, _ = padded(visits, options)
    family, roads = family_of(robot, options), roads_of(cover, robot, options)
    turns = not math.isinf(robot.mobility.turn_rate)
    rows = _Rows([], [], [], [], [], [], [], [], [], [])
    start = options.order.start or cover.start
    here: FloatArray | None = None  # x, y, heading, curvature
    behind = -1  # the stroke that ends here
    if start is not None and len(visits):
        first = entry[:1]
        heading = options.order.heading
        if family.headings:
            heading = start_states(start, heading, first, family)[0][0]
        elif heading is None:
            heading = math.atan2(first[0, 1] - start[1], first[0, 0] - start[0])
        here = np.array([*start, heading, 0.0])
    for row in range(len(visits)):
        visit = visits[row]
        stroke = cover.strokes[visit.stroke]
        if stroke.is_stop:
            # where headings count, the ordering problem has given the stop one
            given = here is None or family.headings or robot.offset.aside
            facing = visit.entry[3] if given or here is None else here[2]
            there = np.array([*visit.entry[:2], facing, 0.0])
            pieces = _pieces([_turn(there, 0.0)])
        else:
            pieces = driven(stroke, visit.entry_vertex, visit.reverse, robot, options)
            there = np.array([*pieces.start[0], pieces.heading[0], pieces.curvature[0]])
        lead_in, lead_out = (0.0, 0.0) if stroke.is_stop else (asked.pad_before, asked.pad_after)
        lead = entry[row][[0, 1, 3, 4]] if lead_in > 0 else there
        if here is not None:
            begun, ended = family.eased(np.array([here, lead]))
            if begun[3] != here[3]:
                rows.add(_pieces([_turn(here, 0.0)]), RAISED, behind)
            joined = connector(begun, ended, family, turns, roads)
            rows.add(joined.pieces, RAISED, -1, gear=joined.gear)
            if ended[3] != lead[3]:
                rows.add(_pieces([_turn(lead, 0.0)]), RAISED, -1 if lead_in > 0 else visit.stroke)
        rows.add(pieces_between(lead, lead_in, asked.curved_padding), RAISED, -1)
        # pins that stay down while the robot turns sharply would draw a swirl
        sharp = (pieces.length == 0) & (np.abs(pieces.turn) > options.connect.corner) & turns
        tool = np.where(sharp, RAISED, stroke.tool)
        if not (turns or stroke.is_stop):
            tool, pieces = tool[pieces.length > 0], _without_turns(pieces)
        rows.add(pieces, tool, visit.stroke, stroke.dwell)
        here, behind = _end(pieces), visit.stroke
        if lead_out > 0:
            tail = pieces_between(here, lead_out, asked.curved_padding)
            rows.add(tail, RAISED, -1)
            here, behind = _end(tail), -1
    return _path(rows)


class Connector(NamedTuple):
    """A movement between two states."""

    pieces: Pieces
    """in the direction of travel"""
    gear: FloatArray | int = 1
    """(n,) or one for all: 1 forwards, -1 backwards"""


def connector(
    here: FloatArray,
    there: FloatArray,
    family: Family,
    turns: bool,
    roads: Roads | None = None,
    limits: CurvatureLimits | None = None,
) -> Connector:
    """The movement between two states (4,) x, y, heading, curvature.

    `turns`: with turns on the spot at both ends. With a road map it keeps out of what is forbidden, if there is a way.
    `limits`: those of `limits_between`, where they are known.
    """
    if roads is not None:
        way = roads.between(here, there)
        if way.curves and way.source != "direct":
            return Connector(_along(way.curves, here, there, turns and not family.headings), way.gear)
    if family.reversing:
        path = (
            reversing_path(here, there, 1 / family.radius, family.sharpness)
            if family.metric == "cc"
            else reeds_shepp_path(here[:3], there[:3], family.radius)
        )
        return Connector(_placed(here, path.curvatures, path.sharpnesses, path.lengths, path.gears), path.gears)
    if family.metric == "dubins":
        plain = dubins_path(here[:3], there[:3], family.radius)
        curvatures, lengths = np.array(plain.curvatures), np.array(plain.lengths)
        return Connector(_placed(here, curvatures, np.zeros(len(lengths)), lengths, np.ones(len(lengths))))
    if family.curved:
        kappa, sharpness = limits or limits_between(here, there, family)
        curve = cc_path(here, there, kappa, sharpness)
        forwards = np.ones(len(curve.lengths))
        return Connector(_placed(here, curve.curvatures, curve.sharpnesses, curve.lengths, forwards))
    dx, dy = there[:2] - here[:2]
    distance = math.hypot(dx, dy)
    if distance <= COINCIDENT:
        return Connector(_pieces([_turn(here, _short(there[2] - here[2]))] if turns else []))
    heading = math.atan2(dy, dx)
    made: list[tuple[float, ...]] = [(here[0], here[1], heading, 0.0, distance, 0.0)]
    if turns:
        made.insert(0, _turn(here, _short(heading - here[2])))
        made.append(_turn(np.array([*there[:2], heading, 0.0]), _short(there[2] - heading)))
    return Connector(_pieces(made))


def _along(curves: tuple[Curve, ...], here: FloatArray, there: FloatArray, turns: bool) -> Pieces:
    """The pieces of curves one after the other, with turns on the spot before, between and behind them."""
    rows: list[FloatArray] = []
    at = here
    for curve in curves:
        if turns:
            rows.append(np.array([[*_turn(at, _short(curve.start[2] - at[2])), 0.0]]))
        zero = np.zeros(len(curve))
        rows.append(np.column_stack([curve.states[:-1], curve.curvature, curve.length, zero, curve.sharpness]))
        at = curve.end
    if turns:
        rows.append(np.array([[*_turn(at, _short(there[2] - at[2])), 0.0]]))
    table = np.concatenate(rows)
    return Pieces(table[:, :2], *table[:, 2:].T)


def _placed(
    here: FloatArray, curvatures: FloatArray, sharpnesses: FloatArray, lengths: FloatArray, gears: FloatArray
) -> Pieces:
    """Clothoids one after the other, from a state on; all arrays (k,)."""
    turned = lengths * (curvatures + sharpnesses * lengths / 2)
    heading = here[2] + np.cumsum(turned) - turned
    # backwards, travel is where the body does not point
    heading = np.where(gears > 0, heading, heading + math.pi)
    dx, dy = clothoid_displacement(heading, curvatures, sharpnesses, lengths)
    start = here[:2] + np.column_stack([np.cumsum(dx) - dx, np.cumsum(dy) - dy])
    return Pieces(start, heading, curvatures, lengths, np.zeros(len(lengths)), sharpnesses)


def _turn(at: FloatArray, angle: float) -> tuple[float, ...]:
    return (at[0], at[1], at[2], 0.0, 0.0, angle)


def _short(angle: float) -> float:
    return float(wrapped(np.array([angle]))[0])


def _pieces(made: list[tuple[float, ...]]) -> Pieces:
    table = np.array(made, dtype=np.float64).reshape(-1, 6)
    return Pieces(table[:, :2], table[:, 2], table[:, 3], table[:, 4], table[:, 5], np.zeros(len(table)))


def _without_turns(pieces: Pieces) -> Pieces:
    keep = pieces.length > 0
    return Pieces(*(column[keep] for column in pieces))


def _end(pieces: Pieces) -> FloatArray:
    start, heading, curvature, length, turn, sharpness = (column[-1:] for column in pieces)
    dx, dy = clothoid_displacement(heading, curvature, sharpness, length)
    turned = length[0] * (curvature[0] + sharpness[0] * length[0] / 2) + turn[0]
    bend = curvature[0] + sharpness[0] * length[0]
    return np.array([start[0, 0] + dx[0], start[0, 1] + dy[0], heading[0] + turned, bend])


def _path(rows: _Rows) -> Path:
    columns = [np.concatenate(column) if column else np.zeros(0) for column in rows]
    start = columns[0].reshape(-1, 3)
    heading, curvature, length, turn, sharpness, dwell = columns[1:7]
    tool, stroke, gear = (column.astype(np.int64) for column in columns[7:])
    keep = (length > 0) | (turn != 0) | (stroke >= 0)
    zero = np.zeros(int(keep.sum()))
    return Path(
        start[keep],
        heading[keep],
        zero,
        curvature[keep],
        sharpness[keep],
        length[keep],
        turn[keep],
        dwell[keep],
        tool[keep],
        stroke[keep],
        gear=gear[keep],
    )
