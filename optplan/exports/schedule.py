"""The time table of a plan: what is done when."""

from __future__ import annotations

import csv
import io
from collections.abc import Sequence
from typing import Literal, NamedTuple

import numpy as np

from optplan.domain.errors import InputError
from optplan.domain.path import RAISED, Trajectory
from optplan.domain.result import Plan
from optplan.domain.stroke import Stroke
from optplan.domain.units import shown, unit_name
from optplan.refilling import fills_tank

COLUMNS = ("order", "begin", "end", "what", "stroke", "element", "metres", "direction", "tool")


class Entry(NamedTuple):
    """A stretch of a plan: a stroke, or the way to the next."""

    begin: float
    """s"""
    end: float
    """s"""
    stroke: int
    """-1 between strokes"""
    metres: float
    reverse: bool
    """against the order of the stroke's points"""
    tool: int


def what_of(entry: Entry, strokes: Sequence[Stroke]) -> str:
    """What is done: "mark", "transit", "travel" along a stroke that is driven with the tool up, or "fill tank"."""
    if not 0 <= entry.stroke < len(strokes):
        return "transit"
    if fills_tank(strokes[entry.stroke]):
        return "fill tank"
    return "mark" if strokes[entry.stroke].tool > RAISED or strokes[entry.stroke].is_stop else "travel"


def schedule_of(plan: Plan) -> list[Entry]:
    """Stretches in driving order. Raises InputError when the plan has no speeds yet."""
    path, trajectory = plan.path, plan.trajectory
    if path is None or trajectory is None:
        raise InputError("the plan has no speeds yet; run the stage time first")
    edges = np.flatnonzero(np.diff(path.stroke, prepend=-2))
    made: list[Entry] = []
    ends = [*edges[1:].tolist(), len(path)]
    visit = 0
    for first, end in zip(edges.tolist(), ends, strict=True):
        # where the robot stands, one place has two times: whoever only stands there has the time between them
        standing = bool(path.is_stop[first:end].all())
        sides: tuple[Literal["left", "right"], ...] = ("left" if standing else "right", "right")
        times = [
            _time_at(trajectory, float(path.offsets[k]), side) for k, side in zip((first, end), sides, strict=True)
        ]
        if made and standing:
            made[-1] = made[-1]._replace(end=times[0])
        stroke = int(path.stroke[first])
        reverse = False
        if stroke >= 0 and plan.visits is not None and visit < len(plan.visits):
            reverse = bool(plan.visits.reverse[visit])
            visit += 1
        down = path.tool[first:end][path.tool[first:end] != RAISED]
        tool = int(down[0]) if len(down) else RAISED
        metres = float(path.length[first:end].sum())
        made.append(Entry(times[0], times[1], stroke, metres, reverse, tool))
    return made


def _time_at(trajectory: Trajectory, s: float, side: Literal["left", "right"]) -> float:
    """When the robot comes to a place ("left"), or leaves it, s."""
    near = 1e-9 * max(1.0, float(trajectory.s[-1]))
    number = int(np.searchsorted(trajectory.s, s - near if side == "left" else s + near, side=side))
    knot = min(number, len(trajectory.s) - 1) if side == "left" else max(number - 1, 0)
    if abs(float(trajectory.s[knot]) - s) <= 2 * near:
        return float(trajectory.t[knot])
    return float(np.interp(s, trajectory.s, trajectory.t))


def schedule_text(plan: Plan, unit: str = "m") -> str:
    """The time table as CSV: s, and lengths in m, ft or yd. Raises like `schedule_of`."""
    out = io.StringIO()
    writer = csv.writer(out, lineterminator="\n")
    writer.writerow(unit_name(unit) if name == "metres" else name for name in COLUMNS)
    strokes = () if plan.cover is None else plan.cover.strokes
    for order, entry in enumerate(schedule_of(plan), start=1):
        known = 0 <= entry.stroke < len(strokes)
        standing = known and fills_tank(strokes[entry.stroke])
        writer.writerow(
            [
                order,
                f"{entry.begin:.3f}",
                f"{entry.end:.3f}",
                what_of(entry, strokes),
                strokes[entry.stroke].id if known else "",
                strokes[entry.stroke].element if known else "",
                f"{shown(entry.metres, 'm', unit)[0]:.3f}",
                ("backwards" if entry.reverse else "forwards") if known and not standing else "",
                plan.robot.tool.settings[entry.tool].name,
            ]
        )
    return out.getvalue()
