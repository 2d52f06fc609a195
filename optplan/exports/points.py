"""A plan as equally spaced points: CSV for people and programs, and the plain text that point-following robots read."""

from __future__ import annotations

import csv
import io
from typing import NamedTuple

import numpy as np

from optplan.domain.arrays import BoolArray, FloatArray, IntArray
from optplan.domain.errors import InputError, LimitError
from optplan.domain.path import RAISED
from optplan.domain.result import Plan
from optplan.geometry.paths import States, sampled
from optplan.geometry.tools import tool_positions
from optplan.timing.sampling import moments

SPACING = 0.05
"""Greatest distance between points unless asked otherwise, m."""
MAX_POINTS = 5_000_000
"""Most points that an export may have."""
COLUMNS = (
    *("s", "t", "x", "y", "z", "heading", "curvature", "speed", "tool", "code", "stroke", "stop", "gear"),
    *("tool_x", "tool_y"),
)


class ToolPoints(NamedTuple):
    """Points for a controller that follows them one by one."""

    points: FloatArray
    """(n, 2) m, x to the right, y down from the top of the field"""
    codes: IntArray
    """(n,) tool byte on the way to the next point, 0..127"""
    turns: BoolArray
    """(n,) whether the robot turns on the spot here"""


def csv_text(plan: Plan, spacing: float = SPACING) -> str:
    """Equally spaced points as CSV, one header line; m, s, rad, 1/m, m/s. `tool` holds from this point to the next.

    x, y, heading and curvature are those of the robot's reference point, in the direction of travel; where `gear` is -1
    it drives backwards. tool_x and tool_y are where its tool is.

    Raises
    ------
    InputError : the plan has no path yet, or the spacing is not above 0
    """
    states, tool = _states(plan, spacing)
    path = plan.path
    assert path is not None  # _states has made sure
    s = path.offsets[states.piece] + states.distance
    stop = path.is_stop[states.piece]
    if plan.trajectory is None:
        t = speed = np.full(len(s), np.nan)
    else:
        arriving = stop.copy()
        arriving[-1] = False
        t, speed = moments(plan.trajectory, s, arriving)
    strokes = [] if plan.cover is None else [stroke.id for stroke in plan.cover.strokes]
    tools = tool_positions(states.position, states.heading, path.gear[states.piece], plan.robot.offset)
    out = io.StringIO()
    writer = csv.writer(out, lineterminator="\n")
    writer.writerow(COLUMNS)
    settings = plan.robot.tool.settings
    for k in range(len(s)):
        piece = states.piece[k]
        owner = path.stroke[piece]
        timed = ("", "") if np.isnan(t[k]) else (f"{t[k]:.4f}", f"{speed[k]:.5f}")
        writer.writerow(
            [
                f"{s[k]:.6f}",
                timed[0],
                *(f"{value:.6f}" for value in states.position[k]),
                f"{states.heading[k]:.8f}",
                f"{states.curvature[k]:.6f}",
                timed[1],
                settings[tool[k]].name,
                settings[tool[k]].code,
                strokes[owner] if 0 <= owner < len(strokes) else "",
                int(stop[k]),
                path.gear[piece],
                *(f"{value:.6f}" for value in tools[k, :2]),
            ]
        )
    return out.getvalue()


def points_text(plan: Plan, spacing: float = SPACING) -> str:
    """Equally spaced points as lines `x y tool`: y runs down from the top of the field, a blank line marks a turn.

    Raises
    ------
    InputError : the plan has no path yet, leaves the plane or is driven backwards, or the spacing is not above 0
    """
    return format_points(tool_points(plan, spacing))


def tool_points(plan: Plan, spacing: float = SPACING) -> ToolPoints:
    """Equally spaced points with the controller's tool byte; raises like `points_text`."""
    states, tool = _states(plan, spacing)
    path = plan.path
    assert path is not None  # _states has made sure
    if (path.gear < 0).any():
        raise InputError("the plan has pieces that are driven backwards, which bare points cannot say; expected csv")
    if (path.elevation != 0).any() or (path.start[:, 2] != 0).any():
        raise InputError("the plan leaves the plane, which bare points cannot say; expected csv, or stops for a facade")
    stop = path.is_stop[states.piece]
    stop[-1] = False
    canvas = None if plan.cover is None else plan.cover.canvas
    height = canvas.height if canvas is not None else float(states.position[:, 1].max())
    codes = np.array([setting.code for setting in plan.robot.tool.settings])[tool]
    points = np.column_stack([states.position[:, 0], height - states.position[:, 1]])
    # a stop and the piece that follows it are one point, where the robot turns
    turned = np.concatenate([[False], stop[:-1]]) & ~stop
    return ToolPoints(points[~stop], codes[~stop], turned[~stop])


def format_points(points: ToolPoints) -> str:
    """Lines `x y tool`; a blank line before a point says that the robot turns there."""
    lines = []
    for (x, y), code, turn in zip(points.points.tolist(), points.codes.tolist(), points.turns.tolist(), strict=True):
        if turn:
            lines.append("")
        lines.append(f"{x:.6f} {y:.6f} {code}")
    return "\n".join(lines) + "\n"


def parse_points(text: str, where: str = "points") -> ToolPoints:
    """Read what `format_points` wrote.

    Raises
    ------
    InputError : a line that is not two finite numbers and a tool byte of 0..127
    """
    rows: list[tuple[float, float]] = []
    codes: list[int] = []
    turns: list[bool] = []
    turn = False
    for number, line in enumerate(text.splitlines(), start=1):
        if not line.strip():
            turn = True
            continue
        parts = line.split()
        try:
            x, y, code = float(parts[0]), float(parts[1]), int(parts[2])
            good = len(parts) == 3 and "_" not in line and np.isfinite([x, y]).all() and 0 <= code <= 127
        except (ValueError, IndexError):
            good = False
        if not good:
            place = f"{where}: line {number}"
            raise InputError(f"is {line[:60]!r}; expected 'x y tool' with a tool byte of 0..127", place)
        rows.append((x, y))
        codes.append(code)
        turns.append(turn)
        turn = False
    return ToolPoints(np.array(rows).reshape(-1, 2), np.array(codes, dtype=np.int64), np.array(turns, dtype=np.bool_))


def _states(plan: Plan, spacing: float) -> tuple[States, IntArray]:
    if plan.path is None or len(plan.path) == 0:
        raise InputError("the plan has no path yet; run the stage connect first")
    if not (np.isfinite(spacing) and spacing > 0):
        raise InputError(f"the point spacing is {spacing} m; expected a finite number above 0")
    count = float(plan.path.length.sum()) / spacing + len(plan.path)
    if count > MAX_POINTS:
        raise LimitError(f"a spacing of {spacing:g} m gives {count:.0f} points; at most {MAX_POINTS} are written")
    states = sampled(plan.path, spacing)
    tool = plan.path.tool[states.piece].copy()
    tool[-1] = RAISED
    return states, tool
