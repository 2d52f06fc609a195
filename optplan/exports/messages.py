"""Plans as the trajectory message of line-marking robots: lines and arcs within a tolerance, or clothoids."""

from __future__ import annotations

import math
from itertools import pairwise

import numpy as np

from optplan.domain.arrays import FloatArray
from optplan.domain.errors import InputError
from optplan.domain.path import Path
from optplan.domain.result import Plan
from optplan.geometry.converting import to_arcs, to_lines
from optplan.geometry.curves import Curve
from optplan.schema.messages import TrajectoryMessage

TOLERANCE = 1e-3
"""Between the path and the lines and arcs that stand for it, m: a tenth of what the robots keep to."""
STYLES = ("arcs", "lines", "clothoids")


def message_text(plan: Plan, style: str = "arcs", tolerance: float = TOLERANCE) -> str:
    """The message as JSON.

    Parameters
    ----------
    plan : with speeds
    style : what clothoids become: "arcs" (joined smoothly), "lines", or "clothoids", which not every robot knows
    tolerance : m; arc lengths of the profiles count along what was written

    Raises
    ------
    InputError : the plan has no speeds yet, or leaves the plane
    """
    return message_of(plan, style, tolerance).model_dump_json(exclude_none=True, indent=1) + "\n"


def message_of(plan: Plan, style: str = "arcs", tolerance: float = TOLERANCE) -> TrajectoryMessage:
    """The message; raises like `message_text`."""
    trajectory, path = plan.trajectory, plan.path
    if trajectory is None or path is None:
        raise InputError("the plan has no speeds yet; run the stage time first")
    if (path.elevation != 0).any() or (path.start[:, 2] != 0).any():
        raise InputError("the plan leaves the plane, which this message does not know")
    if style not in STYLES:
        raise InputError(f"there is no style {style!r}; expected one of {', '.join(STYLES)}")
    labels = [""] if plan.cover is None else [stroke.id for stroke in plan.cover.strokes]
    segments: list[dict[str, object]] = []
    written = np.zeros(len(path) + 1)
    for row in range(len(path)):
        made, length = _curves(path, row, style, tolerance)
        name = labels[int(path.stroke[row])] if 0 <= path.stroke[row] < len(labels) else "transit"
        for curve in made:
            direction = 0 if path.length[row] == 0 else int(path.gear[row])
            segments.append({"id": len(segments), "label": name, "curve": curve, "direction": {"value": direction}})
        written[row + 1] = written[row] + length
    return TrajectoryMessage.model_validate(
        {
            "path": {"segments": segments},
            "actuation_profile": {"parameters": _actuation(plan, path, written)},
            "velocity_profile": {"parameters": _velocity(plan, path, written)},
        }
    )


def _curves(path: Path, row: int, style: str, tolerance: float) -> tuple[list[dict[str, object]], float]:
    """What stands for one piece, and how long that is, m."""
    x, y = path.start[row, :2].tolist()
    heading, kappa, sigma = float(path.heading[row]), float(path.curvature[row]), float(path.sharpness[row])
    length = float(path.length[row])
    if length == 0:
        return [{"type": {"value": 0}}], 0.0
    if style == "clothoids" and sigma != 0:
        piece = {"start": (x, y), "heading": heading, "curvature": kappa, "sharpness": sigma, "length": length}
        return [{"type": {"value": 3}, "clothoid": [piece]}], length
    curve = Curve(np.array([x, y, heading]), np.array([kappa]), np.array([sigma]), np.array([length]))
    if style == "lines" and sigma != 0:
        points = to_lines(curve, tolerance).points
        lines = [_line(a, b) for a, b in pairwise(points)]
        return lines, float(np.linalg.norm(np.diff(points, axis=0), axis=1).sum())
    arcs = to_arcs(curve, tolerance).curve
    made = []
    for k in range(len(arcs)):
        start, end = arcs.states[k], arcs.states[k + 1]
        bend = float(arcs.curvature[k])
        if abs(bend) * float(arcs.length[k]) < 1e-9:
            made.append(_line(start[:2], end[:2]))
        else:
            made.append(_arc(start, bend, float(arcs.length[k])))
    return made, arcs.total


def _line(a: FloatArray, b: FloatArray) -> dict[str, object]:
    return {"type": {"value": 1}, "line": [{"start": tuple(a.tolist()), "end": tuple(b.tolist())}]}


def _arc(start: FloatArray, bend: float, length: float) -> dict[str, object]:
    x, y, heading = start.tolist()
    center = (x - math.sin(heading) / bend, y + math.cos(heading) / bend)
    return {"type": {"value": 2}, "arc": [{"start": (x, y), "center": center, "sweep_angle": bend * length}]}


def _actuation(plan: Plan, path: Path, written: FloatArray) -> list[dict[str, object]]:
    codes = np.array([setting.code for setting in plan.robot.tool.settings])[path.tool]
    made: list[dict[str, object]] = []
    for row, code in enumerate(codes.tolist()):
        if not made or made[-1]["actuation"] != {"value": code}:
            if made and made[-1]["arc_length"] == float(written[row]):
                made.pop()
            made.append({"arc_length": float(written[row]), "actuation": {"value": code}})
    if made and made[-1]["actuation"] != {"value": 0}:
        made.append({"arc_length": float(written[-1]), "actuation": {"value": 0}})
    return made


def _velocity(plan: Plan, path: Path, written: FloatArray) -> list[dict[str, object]]:
    """Linear speeds at the knots, angular ones where the robot turns on the spot."""
    trajectory = plan.trajectory
    assert trajectory is not None
    made: list[dict[str, object]] = []
    along = np.interp(trajectory.s, path.offsets, written)
    rows = np.clip(np.searchsorted(path.offsets, trajectory.s, side="right") - 1, 0, max(len(path) - 1, 0))
    turning = path.is_stop & (path.turn != 0)
    offsets = path.offsets[:-1]
    for k in range(len(along)):
        entry = {"type": {"value": 1}, "value": float(trajectory.v[k])}
        made.append({"arc_length": float(along[k]), "velocity": entry})
        standing = k + 1 < len(along) and trajectory.s[k + 1] == trajectory.s[k]
        if standing and turning[(offsets == trajectory.s[k])].any() and len(rows):
            rate = float(plan.robot.mobility.turn_rate)
            made.append({"arc_length": float(along[k]), "velocity": {"type": {"value": 2}, "value": rate}})
    return made
