"""Where the tool is while the robot drives: its place in the robot's frame, carried along."""

from __future__ import annotations

from dataclasses import replace

import numpy as np

from optplan.domain.arrays import FloatArray, IntArray
from optplan.domain.options import Options
from optplan.domain.path import RAISED, Path
from optplan.domain.report import Check
from optplan.domain.robot import DiffDrive, Robot
from optplan.judge._findings import RELATIVE, held, place_of, work_and_transit_speed
from optplan.judge._integrate import Samples
from optplan.judge._speeds import Speeds

_PROBES = 9
"""Places on a stretch of constant acceleration at which the tool's speed is looked at."""


def offset_of(robot: Robot) -> tuple[float, float]:
    """How far the tool is ahead of the robot's reference point and to its left, m; robots without wheels do not turn
    with their path."""
    if not isinstance(robot.mobility, DiffDrive):
        return 0.0, 0.0
    return robot.tool.ahead, -robot.tool.right


def of_tool(path: Path, samples: Samples, robot: Robot) -> tuple[Path, Samples]:
    """The path and its samples, with the places of the tool instead of the robot's."""
    offset = offset_of(robot)
    if offset == (0.0, 0.0):
        return path, samples
    row, s = samples.row, samples.along
    travel = path.heading[row] + (path.curvature[row] + path.sharpness[row] * s / 2) * s
    points = samples.points + _carried(travel, path.gear[row], offset)
    start = path.start + _carried(path.heading, path.gear, offset)
    ends = samples.ends + _carried(samples.end_heading, path.gear, offset)
    return replace(path, start=start), replace(samples, points=points, ends=ends)


def _carried(travel: FloatArray, gear: IntArray, offset: tuple[float, float]) -> FloatArray:
    """(k, 3) m from the reference point to the tool; backwards, the body points against the travel."""
    ahead, left = offset
    cosine, sine = gear * np.cos(travel), gear * np.sin(travel)
    return np.column_stack([ahead * cosine - left * sine, ahead * sine + left * cosine, np.zeros(len(travel))])


def swirls(path: Path, robot: Robot) -> list[Check]:
    """Metres that a tool draws while the robot turns on the spot: it must be up then. No check of one in the middle."""
    if offset_of(robot) == (0.0, 0.0):
        return []
    swept = np.abs(path.turn) * np.hypot(*offset_of(robot))
    metres = np.where((path.tool > RAISED) & path.is_stop, swept, 0.0)
    worst = int(np.argmax(metres)) if len(path) else 0
    total = float(metres.sum())
    detail = "The tool is up while the robot turns on the spot."
    if total > 0:
        detail = f"The tool draws arcs while the robot turns on the spot, the longest at piece {worst}."
    return [held("swirls", total, 0.0, "m", place_of(path.start[worst]) if total > 0 else None, detail)]


def speed(path: Path, profile: Speeds, robot: Robot, options: Options) -> Check:
    """Largest speed, m/s, as a share of its limit: that of the tool when it is down, of the robot when it is up.

    The tool moves sqrt((1 + kappa right)^2 + (kappa ahead)^2) times as fast as the robot's reference point. One speed
    everywhere is that of the reference point.
    """
    work, transit = work_and_transit_speed(robot, options)
    if len(profile.row) == 0:
        return held("speed", 0.0, transit, "m/s", detail="Nothing moves.")
    row = profile.row
    down = path.tool[row] > RAISED
    limit = np.where(down, work, transit)
    v = np.maximum(profile.before, profile.after)
    ahead, left = offset_of(robot)
    if (ahead, left) != (0.0, 0.0) and options.time.constant_speed is None:
        length = profile.end - profile.begin
        share = np.linspace(0, 1, _PROBES)
        kappa = path.curvature[row] + path.sharpness[row] * (profile.begin + share[:, None] * length)
        kappa = kappa * path.gear[row]
        square = profile.before**2 + share[:, None] * (profile.after**2 - profile.before**2)
        ratio = (1 - kappa * left) ** 2 + (kappa * ahead) ** 2
        v = np.where(down, np.sqrt(square * ratio).max(axis=0), v)
    worst = int(np.argmax(v / limit))
    piece, top = int(row[worst]), float(limit[worst])
    state = "down" if path.tool[piece] > RAISED else "up"
    detail = f"Piece {piece} is driven closest to its limit, with the tool {state}."
    return held("speed", float(v[worst]), top, "m/s", place_of(path.start[piece]), detail, slack=RELATIVE * top)
