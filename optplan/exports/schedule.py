"""The time table of a plan: what is done when."""

from __future__ import annotations

import csv
import io
from typing import NamedTuple

import numpy as np

from optplan.domain.errors import InputError
from optplan.domain.path import RAISED
from optplan.domain.result import Plan
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


def schedule_text(plan: Plan) -> str:
    """The time table as CSV: s and m. Raises like `schedule_of`."""
    out = io.StringIO()
    writer = csv.writer(out, lineterminator="\n")
    writer.writerow(COLUMNS)
    strokes = () if plan.cover is None else plan.cover.strokes
    for order, entry in enumerate(schedule_of(plan), start=1):
        known = 0 <= entry.stroke < len(strokes)
        writer.writerow(
            [
                order,
                f"{entry.begin:.3f}",
                f"{entry.end:.3f}",
                "transit" if not known else "stop" if strokes[entry.stroke].is_stop else "mark",
                strokes[entry.stroke].id if known else "",
                strokes[entry.stroke].element if known else "",
                f"{entry.metres:.3f}",
                ("backwards" if entry.reverse else "forwards") if known and not strokes[entry.stroke].is_stop else "",
                plan.robot.tool.settings[entry.tool].name,
            ]
        )
    return out.getvalue()
