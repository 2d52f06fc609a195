"""The stops of a facade's plan: where the boom lift stands, what it faces, when and for how long."""

from __future__ import annotations

import csv
import io
import json
from typing import Any

import numpy as np

from optplan.domain.errors import InputError
from optplan.domain.facade import Facade
from optplan.domain.result import Plan
from optplan.domain.robot import Boom
from optplan.geometry.walls import unrolled

COLUMNS = (
    *("number", "stop", "wall", "wall_x", "wall_y", "x", "y", "z", "nx", "ny", "nz", "standoff", "radius"),
    *("move", "arrive", "leave", "dwell", "water"),
)


def stop_rows(plan: Plan) -> list[dict[str, Any]]:
    """One record a stop, in the order of visiting; m, s, l. `move` is the way to it from the stop before.

    Raises
    ------
    InputError : the plan is of no facade, or has no speeds yet
    """
    job, cover, path, robot = plan.job, plan.cover, plan.path, plan.robot.mobility
    if not isinstance(job, Facade) or not isinstance(robot, Boom):
        raise InputError("stops are those of a facade; expected csv or txt for anything else")
    if cover is None or path is None or plan.trajectory is None:
        raise InputError("the plan has no speeds yet; run the stage time first")
    walls = {wall.name: wall for wall in job.walls}
    flow = 0.0 if plan.robot.supplies is None else 1000 * plan.robot.supplies.flow
    rows = np.flatnonzero(path.stroke >= 0)
    knots, made, moved = 0, [], 0.0
    s, t = plan.trajectory.s, plan.trajectory.t
    for number, row in enumerate(rows.tolist(), start=1):
        stop = int(path.stroke[row])
        stroke = cover.strokes[stop]
        # a stop is two knots at one place; those of earlier ones are behind
        at = float(path.offsets[row])
        knots = next(k for k in range(knots, len(s)) if abs(s[k] - at) < 1e-9)
        while knots + 1 < len(s) and s[knots + 1] - at < 1e-9 and t[knots + 1] == t[knots]:
            knots += 1
        foot, wall = stroke.points, walls[stroke.element]
        normal = np.zeros((1, 3)) if stroke.normals is None else stroke.normals
        place = unrolled(wall, foot, normal, robot.standoff)[0]
        values = (
            *(number, stroke.id, wall.name, *place.tolist(), *foot[0].tolist(), *normal[0].tolist()),
            *(robot.standoff, cover.radii[stop] if cover.radii else job.radius or robot.radius, at - moved),
            *(float(t[knots]), float(t[knots]) + float(path.dwell[row]), float(path.dwell[row])),
            float(path.dwell[row]) * flow,
        )
        moved = at
        made.append(dict(zip(COLUMNS, values, strict=True)))
    return made


def stops_text(plan: Plan) -> str:
    """CSV with one header line; raises like `stop_rows`."""
    out = io.StringIO()
    writer = csv.DictWriter(out, COLUMNS, lineterminator="\n")
    writer.writeheader()
    for row in stop_rows(plan):
        writer.writerow({key: f"{v:.6f}" if isinstance(v, float) else v for key, v in row.items()})
    return out.getvalue()


def stops_json(plan: Plan) -> str:
    """The same as JSON, with the units; raises like `stop_rows`."""
    head = {"version": "1.0", "job": plan.job.name, "robot": plan.robot.name, "units": "m, s, l"}
    return json.dumps({**head, "stops": stop_rows(plan)}, indent=1, allow_nan=False) + "\n"
