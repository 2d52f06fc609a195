"""Whether a field's lines are marked as its segments ask, whatever the plan's strokes say."""

from __future__ import annotations

import math
from typing import Any

import numpy as np

from optplan.domain.arrays import FloatArray, IntArray
from optplan.domain.job import ACTUATIONS, Field, FieldSegment
from optplan.domain.path import RAISED, Path
from optplan.domain.report import Check
from optplan.domain.result import Cover
from optplan.domain.robot import Robot
from optplan.judge._findings import GAP, Place, count_of, held
from optplan.judge._integrate import Samples
from optplan.judge._shapes import union

NAME = "field"
SAG = 0.02
"""Between an arc and its chords, as a share of the deviation that is allowed."""
NEAR = 1.05
"""The same for what counts as on a line: chords of both sides, and rounding."""
HALF = 0.5
"""Share of a pass that may be missing before passes count as too few."""


def requested_widths(job: Field, cover: Cover, robot: Robot) -> FloatArray:
    """(n,) m, how wide the mark of each stroke is asked to be: by its segment, but not wider than the tool makes it."""
    tool = [setting.width for setting in robot.tool.settings]
    asked = {segment.id: segment.width or job.line_width or math.inf for segment in job.segments}
    return np.array(
        [min(asked.get(s.element, math.inf), tool[s.tool] if s.tool < len(tool) else math.inf) for s in cover.strokes]
    )


def field(job: Field, path: Path, marks: Samples, cover: Cover, robot: Robot, limit: float) -> Check:
    """Metres of the field's lines that are not marked as asked, and of marks where the field has no line.

    Lines of strokes that another plan does count as marked. A line wider than the tool is marked along both its borders
    and everywhere between them; a spot across its middle.

    Parameters
    ----------
    path, marks : what the robot drives, and where it carries its tool
    limit : m, how far a mark may be off
    """
    import shapely

    driven, tool = _driven(shapely, path, marks, cover, limit)
    faults: list[tuple[float, str, Place]] = []
    asked: list[tuple[int, Any]] = []  # setting, where its marks may be
    for segment in job.segments:
        setting = _setting(segment, robot)
        if setting is None or setting >= len(robot.tool.settings):
            continue
        made = driven[tool == setting]
        width = robot.tool.settings[setting].width
        spread = max((segment.width or job.line_width or width) - width, 0.0)
        spread = 0.0 if segment.spot > 0 else spread
        line = _middle(shapely, segment, limit)
        room = segment.spot / 2 if segment.spot > 0 else spread / 2
        asked.append((setting, shapely.buffer(line, room + NEAR * limit)))
        near = made[shapely.dwithin(made, line, room + NEAR * limit)] if len(made) else made
        lost = _missing(shapely, segment, line, spread, width, near, limit)
        if lost > GAP:
            first = shapely.get_coordinates(line)[0]
            faults.append((lost, f"{segment.id} is not marked as asked", (float(first[0]), float(first[1]))))
    for setting in np.unique(tool).tolist():
        allowed = union(shapely, [shape for number, shape in asked if number == setting] or [shapely.Polygon()])
        shapely.prepare(allowed)
        for line in driven[tool == setting]:
            if shapely.covers(allowed, line):
                continue
            beside = shapely.difference(line, allowed)
            if beside.length > GAP:
                first = shapely.get_coordinates(beside)[0]
                faults.append((float(beside.length), "marks lie where there is no line", tuple(first.tolist())))
    wanted = sum(segment.actuation != "NONE" for segment in job.segments)
    detail = f"{count_of(wanted, 'segment')}, all marked as asked, and nothing else."
    if cover.elsewhere:
        detail += f" {count_of(len(cover.elsewhere), 'stroke')} of them are left to other plans."
    place = None
    if faults:
        told = list(dict.fromkeys(text for _, text, _ in faults))
        detail = "; ".join(told[:3]) + (f"; and {len(told) - 3} more." if len(told) > 3 else ".")
        place = max(faults)[2]
    return held(NAME, sum(length for length, _, _ in faults), 0.0, "m", place, detail, slack=GAP)


def _driven(shapely: Any, path: Path, marks: Samples, cover: Cover, limit: float) -> tuple[Any, IntArray]:
    """(k,) lines along which marks are made, by this plan and by others, and (k,) the tool setting of each."""
    down = (path.tool > RAISED) & ~path.is_stop
    rows = np.flatnonzero(down)
    lines: list[Any] = []
    tool: list[int] = []
    if len(rows):
        before, after = rows[:-1], rows[1:]
        apart = np.linalg.norm(path.start[after] - marks.ends[before], axis=1) > GAP
        # overlays would count what one line goes over twice once only: each pass is a line of its own
        broken = apart | (path.tool[before] != path.tool[after]) | (path.stroke[before] != path.stroke[after])
        label = np.full(len(path), -1)
        label[rows] = np.concatenate([[0], np.cumsum(broken)])
        use = label[marks.row] >= 0
        lines += list(shapely.linestrings(marks.points[use, :2], indices=label[marks.row[use]]))
        tool += path.tool[rows[np.concatenate([[True], broken])]].tolist()
    for stroke in cover.elsewhere:
        if stroke.tool > RAISED and not stroke.is_stop:
            lines.append(shapely.LineString(stroke.closed_points[:, :2]))
            tool.append(stroke.tool)
    made = np.full(len(lines), None, dtype=object)
    made[:] = lines
    return shapely.simplify(made, SAG * limit, preserve_topology=False), np.array(tool, dtype=np.int64)


def _setting(segment: FieldSegment, robot: Robot) -> int | None:
    """The tool setting that a segment asks for: by its code, else the only one there is; None where nothing is done."""
    code = ACTUATIONS[segment.actuation]
    if code == 0:
        return None
    codes = [setting.code for setting in robot.tool.settings]
    return codes.index(code, 1) if code in codes[1:] else 1


def _middle(shapely: Any, segment: FieldSegment, limit: float, aside: float = 0.0) -> Any:
    """The middle of a segment's mark, or a line beside it by `aside`, m to the left; of a spot, its place."""
    if segment.spot > 0:
        return shapely.Point(segment.start)
    if segment.center is None:
        step = (segment.end - segment.start) / segment.length
        shift = aside * np.array([-step[1], step[0]])
        return shapely.LineString([segment.start + shift, segment.end + shift])
    out = segment.start - segment.center
    radius = max(segment.radius - math.copysign(aside, segment.sweep), 0.0)
    bend = 2 * math.acos(max(1 - SAG * limit / max(radius, SAG * limit), 0.5))
    turn = np.linspace(0, segment.sweep, max(2, math.ceil(abs(segment.sweep) / bend) + 1))
    angle = math.atan2(out[1], out[0]) + turn
    return shapely.LineString(segment.center + radius * np.column_stack([np.cos(angle), np.sin(angle)]))


def _missing(
    shapely: Any, segment: FieldSegment, line: Any, spread: float, width: float, near: Any, limit: float
) -> float:
    """m of a segment that no mark is made for.

    Parameters
    ----------
    line : its middle
    spread : m between the outermost lines along which the tool goes
    width : m, of the tool's mark
    near : lines of marks of its setting that come near it
    """
    if segment.spot > 0:
        across = shapely.buffer(line, segment.spot / 2)
        inside = float(shapely.length(shapely.intersection(near, across)).sum()) if len(near) else 0.0
        hit = len(near) > 0 and bool((shapely.distance(near, line) <= NEAR * limit).any())
        wanted = segment.passes * (segment.spot - 2 * NEAR * limit)
        return max(wanted - inside, 0.0) if hit else segment.spot
    edges = [line] if spread == 0 else [_middle(shapely, segment, limit, side * spread / 2) for side in (1, -1)]
    lost = 0.0
    for edge in edges:
        on_line = near[shapely.dwithin(near, edge, NEAR * limit)] if len(near) else near
        covered = union(shapely, [*shapely.buffer(on_line, NEAR * limit), shapely.Polygon()])
        lost += float(shapely.difference(edge, covered).length)
    if spread > 0 and lost <= GAP:
        marked = union(shapely, shapely.buffer(near, width / 2 + NEAR * limit))
        lost += float(shapely.difference(shapely.buffer(line, spread / 2, cap_style="flat"), marked).area) / width
    if segment.passes > 1 and lost <= GAP:
        corridor = shapely.buffer(line, spread / 2 + NEAR * limit, cap_style="flat")
        lanes = segment.passes * max(math.ceil((spread + width) / width - 1e-6), 1)
        inside = float(shapely.length(shapely.intersection(near, corridor)).sum())
        short = lanes * segment.length - inside
        lost += short if short > HALF * segment.length else 0.0
    return lost
