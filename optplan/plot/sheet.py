"""A job sheet: one page to take along."""

from __future__ import annotations

import io
import math
from typing import TYPE_CHECKING

import numpy as np

from optplan.domain.path import RAISED
from optplan.domain.result import Plan
from optplan.domain.units import shown
from optplan.plot.picture import figure
from optplan.refilling import fills_tank

if TYPE_CHECKING:
    from matplotlib.figure import Figure

A4 = (8.27, 11.69)
"""inches"""


def sheet(plan: Plan, unit: str = "m") -> Figure:
    """A page in A4 with the picture, what is needed, what was checked, and the order of the work; lengths in `unit`.

    Raises InputError when the plan has no strokes yet.
    """
    from matplotlib.figure import Figure

    picture = io.BytesIO()
    drawn = figure(plan, unit)
    drawn.savefig(picture, format="png", dpi=220)
    picture.seek(0)
    from PIL import Image

    image = np.asarray(Image.open(picture))
    page = Figure(figsize=A4, facecolor="white")
    width, height = 0.90, 0.90 * A4[0] / A4[1] * image.shape[0] / image.shape[1]
    height = min(height, 0.52)
    axes = page.add_axes((0.05, 0.955 - height, width, height))
    axes.imshow(image)
    axes.axis("off")
    page.text(0.06, 0.972, f"{plan.job.name}: job sheet", fontsize=15, weight="bold")
    y = 0.94 - height
    for line in _facts(plan, unit):
        page.text(0.06, y, line, fontsize=8.5)
        y -= 0.0155
    y -= 0.008
    page.text(0.06, y, "Order of the work", fontsize=10, weight="bold")
    rows = _rows(plan, unit)
    fit = max(1, int((y - 0.05) / 0.0118))
    columns = min(3, max(1, math.ceil(len(rows) / fit)))
    shown = rows[: fit * columns]
    if len(rows) > len(shown):
        shown[-1] = f"… and {len(rows) - len(shown) + 1} more: export the schedule"
    for k, text in enumerate(shown):
        column, row = divmod(k, fit)
        page.text(0.06 + column * 0.9 / columns, y - 0.017 - row * 0.0118, text, fontsize=6.5, family="monospace")
    return page


def _facts(plan: Plan, unit: str) -> list[str]:
    made = [f"Robot: {plan.robot.name}. {plan.robot.summary}."]
    if plan.trajectory is not None and plan.path is not None:
        minutes, seconds = divmod(round(plan.trajectory.duration), 60)
        down = float(plan.path.length[plan.path.tool != RAISED].sum())
        up = float(plan.path.length[plan.path.tool == RAISED].sum())
        down, up = shown(down, "m", unit)[0], shown(up, "m", unit)[0]
        made.append(f"Time {minutes}:{seconds:02d} min; {down:.1f} {unit} marking, {up:.1f} {unit} between marks.")
    if len(plan.path or ()):
        assert plan.path is not None
        x, y = (shown(float(value), "m", unit)[0] for value in plan.path.start[0, :2])
        facing = math.degrees(plan.path.heading[0]) % 360
        made.append(f"Begin at ({x:.2f}, {y:.2f}) {unit}, facing {facing:.0f} degrees from the x axis.")
    if plan.report is not None:
        made += [check.detail for check in plan.report.checks if check.name == "supplies"]
        broken = [check.name for check in plan.report.checks if check.verdict.value == "failed"]
        made.append(f"CHECKS FAILED: {', '.join(broken)}." if broken else "All checks passed.")
    if plan.ordering is not None and math.isfinite(plan.ordering.gap):
        proved = "proved to be the best" if plan.ordering.gap <= 1e-6 else f"within {plan.ordering.gap:.1%} of the best"
        made.append(f"Order of the work {proved}, counting what lies between marks.")
    return made


def _rows(plan: Plan, unit: str) -> list[str]:
    """One line a stroke: number, time of beginning, name, metres."""
    if plan.visits is None or plan.cover is None:
        return []
    path, trajectory = plan.path, plan.trajectory
    made = []
    for number in range(len(plan.visits)):
        visit = plan.visits[number]
        stroke = plan.cover.strokes[visit.stroke]
        when = ""
        if path is not None and trajectory is not None:
            first = int(np.flatnonzero(path.stroke == visit.stroke)[0])
            # where the robot stands to fill its tank, it has come at the first of two times
            come = int(np.searchsorted(trajectory.s, path.offsets[first] - 1e-6))
            seconds = float(np.interp(path.offsets[first], trajectory.s, trajectory.t))
            seconds = float(trajectory.t[come]) if fills_tank(stroke) else seconds
            when = f"{int(seconds // 60):3d}:{int(seconds % 60):02d}"
        way = "<" if visit.reverse else ">"
        text = f"{way} {stroke.id[:26]:26s} {shown(visit.length, 'm', unit)[0]:6.1f} {unit}"
        made.append(f"{number + 1:3d} {when} {'= fill tank' if fills_tank(stroke) else text}")
    return made
