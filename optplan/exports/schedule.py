"""The time table of a plan: what is done when."""

from __future__ import annotations

import csv
import io
from collections.abc import Sequence
from typing import NamedTuple

import numpy as np

from optplan.domain.errors import InputError
from optplan.domain.path import RAISED
from optplan.domain.result import Plan
from optplan.domain.stroke import Stroke
from optplan.domain.units import shown, unit_name
from optplan.refilling import fills_tank
from optplan.timing.sampling import begins

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
    """What is done: "mark", "transit", "travel" along a stroke driven with the tool up, "stop", or "fill tank"."""
    if not 0 <= entry.stroke < len(strokes):
        return "transit"
    if fills_tank(strokes[entry.stroke]):
        return "fill tank"
    if strokes[entry.stroke].is_stop:
        return "stop"
    return "mark" if strokes[entry.stroke].tool > RAISED else "travel"


def schedule_of(plan: Plan) -> list[Entry]:
    """Stretches in driving order. Raises InputError when the plan has no speeds yet."""
    path, trajectory = plan.path, plan.trajectory
    if path is None or trajectory is None:
        raise InputError("the plan has no speeds yet; run the stage time first")
    edges = np.flatnonzero(np.diff(path.stroke, prepend=-2))
    made: list[Entry] = []
    ends = [*edges[1:].tolist(), len(path)]
    visit = 0
    times = begins(trajectory)
    for first, end in zip(edges.tolist(), ends, strict=True):
        stroke = int(path.stroke[first])
        reverse = False
        if stroke >= 0 and plan.visits is not None and visit < len(plan.visits):
            reverse = bool(plan.visits.reverse[visit])
            visit += 1
        down = path.tool[first:end][path.tool[first:end] != RAISED]
        tool = int(down[0]) if len(down) else RAISED
        metres = float(path.length[first:end].sum())
        made.append(Entry(float(times[first]), float(times[end]), stroke, metres, reverse, tool))
    return made


def schedule_text(plan: Plan, unit: str = "m") -> str:
    """The time table as CSV: s, and lengths in m, ft or yd. Raises like `schedule_of`."""
    out = io.StringIO()
    writer = csv.writer(out, lineterminator="\n")
    writer.writerow(unit_name(unit) if name == "metres" else name for name in COLUMNS)
    strokes = () if plan.cover is None else plan.cover.strokes
    for order, entry in enumerate(schedule_of(plan), start=1):
        known = 0 <= entry.stroke < len(strokes)
        writer.writerow(
            [
                order,
                f"{entry.begin:.3f}",
                f"{entry.end:.3f}",
                what_of(entry, strokes),
                strokes[entry.stroke].id if known else "",
                strokes[entry.stroke].element if known else "",
                f"{shown(entry.metres, 'm', unit)[0]:.3f}",
                ("backwards" if entry.reverse else "forwards") if known and not strokes[entry.stroke].is_stop else "",
                plan.robot.tool.settings[entry.tool].name,
            ]
        )
    return out.getvalue()
