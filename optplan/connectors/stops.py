"""The path of a boom lift: straight moves, and stops at which it works."""

from __future__ import annotations

import math

import numpy as np

from optplan.connectors.wall_travel import Travel
from optplan.domain.arrays import FloatArray
from optplan.domain.errors import InputError
from optplan.domain.facade import Facade
from optplan.domain.options import Options
from optplan.domain.path import RAISED, Path
from optplan.domain.result import Cover
from optplan.domain.robot import Robot
from optplan.domain.stroke import Traversals
from optplan.geometry.building import SAME


def connect_stops(visits: Traversals, job: Facade, cover: Cover, robot: Robot, options: Options) -> Path:
    """The path through stops in the order given. Raises InputError like `Travel`, or when there is no way."""
    travel = Travel(job, cover, robot, options)
    lines: list[FloatArray] = []
    rows: list[tuple[float, int, int]] = []  # dwell, tool, stroke
    starts: list[FloatArray] = []
    here = travel.start
    for stop in visits.stroke.tolist():
        stroke = cover.strokes[stop]
        if here is not None:
            way = travel.waypoints(here, stop)
            if way is None:
                raise InputError(f"there is no way to stop {stroke.id!r} around the no-go areas")
            for step, place in zip(np.diff(way, axis=0), way[:-1], strict=True):
                if np.linalg.norm(step) > SAME:
                    lines.append(step)
                    starts.append(place)
                    rows.append((0.0, RAISED, -1))
        lines.append(np.zeros(3))
        starts.append(stroke.points[0])
        rows.append((stroke.dwell, stroke.tool, stop))
        here = stop
    step = np.array(lines).reshape(-1, 3)
    flat = np.hypot(step[:, 0], step[:, 1])
    dwell, tool, owner = (np.array([row[k] for row in rows]) for k in range(3))
    zero = np.zeros(len(rows))
    return Path(
        np.array(starts).reshape(-1, 3),
        np.where(flat > SAME, np.arctan2(step[:, 1], step[:, 0]), 0.0),
        np.where(flat > SAME, np.arctan2(step[:, 2], flat), np.sign(step[:, 2]) * math.pi / 2),
        zero,
        zero,
        np.linalg.norm(step, axis=1),
        zero,
        dwell,
        tool.astype(np.int64),
        owner.astype(np.int64),
    )
