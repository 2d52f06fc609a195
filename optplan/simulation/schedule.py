"""From a trajectory to what a simulated robot reads: legs that are driven without a rest, and stops between them."""

from __future__ import annotations

import math

import numpy as np

from optplan.domain.errors import InputError
from optplan.domain.path import Trajectory
from optplan.simulation._kernels.route import LEG, STOP, Route
from optplan.timing.motion import stations

CORNER = 1e-6
"""A direction that changes by more than this between two pieces (rad) is a corner: the robot rests and turns."""


def route_of(trajectory: Trajectory) -> Route:
    """Pieces, knots and phases of a trajectory.

    Where the body's heading jumps between two pieces, a turn on the spot is put in: whoever drives it must make one.

    Raises
    ------
    InputError : a path that is empty or leaves the plane, or speeds that do not fit it
    """
    path = trajectory.path
    if len(path) == 0:
        raise InputError("the plan has an empty path; there is nothing to drive")
    if (path.elevation != 0).any():
        raise InputError("the path leaves the plane; expected a plane one for a robot with wheels")
    at = stations(trajectory)
    if abs(float(trajectory.s[-1]) - float(path.offsets[-1])) > 1e-6 * (1 + float(path.offsets[-1])):
        raise InputError("the speeds end at another length than the path; run the stage time again")
    moving = path.length > 0
    span = trajectory.t[at.knot[1:]] - trajectory.t[at.knot[:-1]]
    if (moving & (span <= 0)).any():
        raise InputError("the plan drives a piece in no time; run the stage time again")
    phases: list[tuple[int, ...]] = []
    turns: list[tuple[float, ...]] = []
    row = 0
    while row < len(path):
        if phases:
            jump = _wrapped(float(at.begin[row] - at.end[row - 1]))
            if abs(jump) > CORNER:
                knot = int(at.knot[row])
                phases.append((STOP, row, row + 1, knot, knot))
                turns.append((float(at.end[row - 1]), jump, 0.0, at.gear[row]))
        last = row + 1
        if moving[row]:
            while last < len(path) and moving[last] and at.gear[last] == at.gear[row]:
                if abs(_wrapped(float(at.begin[last] - at.end[last - 1]))) > CORNER:
                    break
                last += 1
            begin, end = int(at.knot[row]), int(at.knot[last])
            phases.append((LEG, row, last, begin, end))
            turns.append((float(at.begin[row]), 0.0, float(trajectory.t[end] - trajectory.t[begin]), at.gear[row]))
        else:
            phases.append((STOP, row, last, int(at.knot[row]), int(at.knot[last])))
            turns.append((float(at.begin[row]), float(path.turn[row]), float(path.dwell[row]), at.gear[row]))
        row = last
    pieces = np.column_stack(
        [path.start[:, :2], path.heading, path.curvature, path.sharpness, path.length, path.offsets[:-1]]
    )
    knots = np.column_stack([trajectory.s, trajectory.t, trajectory.v])
    return Route(pieces, path.tool.copy(), knots, np.array(phases, dtype=np.int64), np.array(turns, dtype=np.float64))


def _wrapped(angle: float) -> float:
    return (angle + math.pi) % (2 * math.pi) - math.pi
