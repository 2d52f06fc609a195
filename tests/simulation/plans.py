"""Paths and plans made by hand."""

from __future__ import annotations

import math
from dataclasses import fields, replace
from typing import Any

import numpy as np

import optplan as op
from optplan.domain.arrays import IntArray
from optplan.domain.path import Path
from optplan.domain.result import Plan
from optplan.domain.robot import DiffDrive, Robot

Piece = tuple[float, float, float, float]
"""length m, curvature 1/m, sharpness 1/m^2, rad turned (a stop has length 0)"""


def rake(**changes: Any) -> Robot:
    """The beach rake, with other wheels or speeds if asked."""
    robot = op.load_robot("beach-rake")
    assert isinstance(robot.mobility, DiffDrive)
    return replace(robot, mobility=replace(robot.mobility, **changes))


def path_of(pieces: list[Piece], tool: list[int] | None = None, heading: float = 0.0) -> Path:
    """Pieces one after the other from the origin; places by a fine sum, not by the code that is tested."""
    rows = []
    x = y = 0.0
    for length, curvature, sharpness, turn in pieces:
        rows.append((x, y, heading, curvature, sharpness, length, turn))
        u = (np.arange(20_000) + 0.5) * length / 20_000
        angle = heading + u * (curvature + u * sharpness / 2)
        x += float(np.cos(angle).mean()) * length
        y += float(np.sin(angle).mean()) * length
        heading += length * (curvature + length * sharpness / 2) + turn
    table = np.array(rows)
    zero, count = np.zeros(len(rows)), len(rows)
    return Path(
        np.column_stack([table[:, :2], zero]),
        table[:, 2],
        zero,
        table[:, 3],
        table[:, 4],
        table[:, 5],
        table[:, 6],
        zero,
        np.array(tool if tool is not None else [1] * count),
        np.full(count, -1, dtype=np.int64),
    )


def taken(path: Path, rows: IntArray) -> Path:
    """Some pieces of a path."""
    columns: dict[str, Any] = {field.name: getattr(path, field.name) for field in fields(path)}
    chosen: dict[str, Any] = {name: None if column is None else column[rows] for name, column in columns.items()}
    return Path(**chosen)


def plan_of(path: Path, robot: Robot | None = None) -> Plan:
    """A plan with speeds along a path; its job is any drawing."""
    robot = robot or rake()
    job = op.read(op.instance("wave"))
    options = op.Options()
    return Plan(job, robot, options, path=path, trajectory=op.profile(path, robot, options))


QUARTER = math.pi / 2
LINE = path_of([(4.0, 0.0, 0.0, 0.0)])
CORNERS = path_of(
    [(2.0, 0.0, 0.0, 0.0), (0.0, 0.0, 0.0, QUARTER), (1.5, 0.0, 0.0, 0.0), (0.0, 0.0, 0.0, -2.0), (2.0, 0.0, 0.0, 0.0)],
    [1, 0, 2, 0, 3],
)
"""Lines with turns on the spot between them, each drawn with another setting."""
BEND = path_of([(1, 0, 0, 0), (0.5, 0, 1.6, 0), (2.0, 0.8, 0, 0), (0.5, 0.8, -1.6, 0), (1, 0, 0, 0)])
"""A line, a clothoid into an arc to the left, and out of it."""
EIGHT = path_of([(2, 0, 0, 0), (0.5, 0, 2, 0), (1.5 * math.pi - 0.5, 1, 0, 0), (0.5, 1, -2, 0), (2, 0, 0, 0)])
"""A loop that crosses itself."""
