"""What is marked, against what should be, as areas."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from typing import Any

import numpy as np

from optplan.domain.arrays import FloatArray
from optplan.domain.path import RAISED, Path
from optplan.domain.report import Check
from optplan.domain.result import Area, Cover
from optplan.domain.robot import Robot
from optplan.judge._findings import Place, held, noted, unchecked
from optplan.judge._integrate import Samples

NAMES = ("coverage", "area coverage", "overspill")
QUADRANT = 8
"""Segments of a quarter circle around the end of a mark; both sides of a comparison are drawn alike."""
_SLIVER = 0.55
"""Share of the deviation limit: half of it is what a mark that is off by the limit leaves beside it on one side."""

Figures = list[tuple[str, float, str]]


@dataclass(frozen=True, eq=False)
class Marks:
    """Lines with a width: `lines` (k,) shapely geometries, `width` (k,) m."""

    lines: Any
    width: FloatArray


def coverage(path: Path, samples: Samples, cover: Cover, robot: Robot, limit: float) -> tuple[list[Check], Figures]:
    """Areas wanted, done, missed and marked besides.

    Parameters
    ----------
    limit : m, how far a driven stroke may be off

    Wanted are the marks of all strokes and the areas; done is what the path marks, with round ends. A stroke's mark may
    be missed only in slivers that its allowed deviation explains; corners of areas that a round tool cannot reach are
    measured and noted.
    """
    heights = [stroke.points[:, 2] for stroke in cover.strokes if stroke.points.shape[1] == 3]
    if any((z != 0).any() for z in heights) or (len(path) and (samples.points[:, 2] != 0).any()):
        return unchecked(NAMES, "coverage is measured in the plane only"), []
    import shapely

    grid = limit * 1e-4
    asked = _union(shapely, _buffers(shapely, _wanted_lines(shapely, cover, robot)), grid)
    areas = _union(shapely, [_area(shapely, area) for area in cover.areas], grid)
    done = _union(shapely, _buffers(shapely, _driven_lines(shapely, path, samples, robot, limit)), grid)
    wanted = _union(shapely, [asked, areas], grid) if cover.areas else asked
    missed_marks = _overlay(shapely, shapely.difference, asked, done, grid)
    missed = _overlay(shapely, shapely.difference, wanted, done, grid) if cover.areas else missed_marks
    spilled = _overlay(shapely, shapely.difference, done, wanted, grid)

    checks = [_mark_check(shapely, asked, missed_marks, limit)]
    checks.append(_area_check(shapely, areas, done, grid) if cover.areas else noted(
        "area coverage", 1.0, "", "There are no areas to fill."
    ))  # fmt: skip
    checks.append(
        noted("overspill", float(spilled.area), "m2", "Marked besides what was wanted.", _spot(shapely, spilled))
    )
    total = float(wanted.area)
    figures: Figures = [
        ("wanted area", total, "m2"),
        ("done area", float(done.area), "m2"),
        ("missed area", float(missed.area), "m2"),
        ("overspill area", float(spilled.area), "m2"),
        ("coverage", 1 - float(missed.area) / total if total > 0 else 1.0, ""),
    ]
    if cover.areas:
        figures.append(("area coverage", checks[1].value, ""))
    return checks, figures


def _mark_check(shapely: Any, asked: Any, missed: Any, limit: float) -> Check:
    """Stroke marks missed by more than slivers, m2: what is left after taking the slivers' width off all around."""
    parts = shapely.get_parts(missed)
    left = shapely.buffer(parts, -_SLIVER * limit, quad_segs=2)
    left = left[~shapely.is_empty(left)]
    lost = shapely.buffer(left, _SLIVER * limit, quad_segs=2)
    area = float(shapely.area(lost).sum())
    share = 1 - float(missed.area) / float(asked.area) if asked.area > 0 else 1.0
    detail = f"{share:.2%} of the strokes' marks are made"
    detail += "." if len(lost) == 0 else f"; {len(lost)} places are missed."
    place = _spot(shapely, shapely.multipolygons(shapely.get_parts(left))) if len(left) else None
    return held("coverage", area, 0.0, "m2", place, detail)


def _area_check(shapely: Any, areas: Any, done: Any, grid: float) -> Check:
    bare = _overlay(shapely, shapely.difference, areas, done, grid)
    ratio = 1 - float(bare.area) / float(areas.area) if areas.area > 0 else 1.0
    detail = f"{float(bare.area):.4g} m2 of {float(areas.area):.4g} m2 of areas are not reached."
    return noted("area coverage", ratio, "", detail, _spot(shapely, bare))


def _wanted_lines(shapely: Any, cover: Cover, robot: Robot) -> Marks:
    settings = robot.tool.settings
    chosen = [stroke for stroke in cover.strokes if RAISED < stroke.tool < len(settings)]
    lines = [
        shapely.points(*stroke.points[0, :2]) if stroke.is_stop else shapely.linestrings(stroke.closed_points[:, :2])
        for stroke in chosen
    ]
    return Marks(np.array(lines, dtype=object), np.array([settings[stroke.tool].width for stroke in chosen]))


def _driven_lines(shapely: Any, path: Path, samples: Samples, robot: Robot, limit: float) -> Marks:
    """Stretches with the tool down, one line for each run of joined pieces with one tool setting."""
    widths = np.array([setting.width for setting in robot.tool.settings])
    tool = np.where(path.tool < len(widths), path.tool, RAISED)
    moving = np.flatnonzero((tool > RAISED) & ~path.is_stop)
    lines: list[Any] = []
    width = np.zeros(0)
    if len(moving):
        marking = np.zeros(len(path), dtype=bool)
        marking[moving] = True
        use = marking[samples.row]
        before, after = moving[:-1], moving[1:]
        # a line goes on over a stop where the robot turns, but not over anything driven with the tool up
        apart = np.linalg.norm(path.start[after] - samples.ends[before], axis=1) > limit * 1e-3
        broken = apart | (tool[before] != tool[after]) | (path.stroke[before] != path.stroke[after])
        label = np.zeros(len(path), dtype=np.int64)
        label[moving] = np.concatenate([[0], np.cumsum(broken)])
        lines = list(shapely.linestrings(samples.points[use, :2], indices=label[samples.row[use]]))
        width = widths[tool[moving[np.concatenate([[True], broken])]]]
    stops = np.flatnonzero((tool > RAISED) & path.is_stop)
    points = list(shapely.points(path.start[stops, :2]))
    return Marks(np.array(lines + points, dtype=object), np.concatenate([width, widths[tool[stops]]]))


def _buffers(shapely: Any, marks: Marks) -> Any:
    return shapely.buffer(marks.lines, marks.width / 2, quad_segs=QUADRANT)


def _area(shapely: Any, area: Area) -> Any:
    """Its rings by the even-odd rule, which also tells the inside of a ring that crosses itself."""
    rings = [shapely.make_valid(shapely.polygons(ring)) for ring in area.rings if len(ring) >= 3]
    whole = shapely.Polygon()
    for ring in rings:
        whole = _overlay(shapely, shapely.symmetric_difference, whole, ring, 1e-9)
    return whole


def _union(shapely: Any, shapes: Any, grid: float) -> Any:
    try:
        return shapely.union_all(shapes)
    except shapely.errors.GEOSException:
        # snapping to a grid far below the tolerance cannot fail on nearly touching edges
        return shapely.union_all(shapely.make_valid(np.asarray(shapes, dtype=object)), grid_size=grid)


def _overlay(shapely: Any, operation: Callable[..., Any], a: Any, b: Any, grid: float) -> Any:
    try:
        return operation(a, b)
    except shapely.errors.GEOSException:
        return operation(shapely.make_valid(a), shapely.make_valid(b), grid_size=grid)


def _spot(shapely: Any, shape: Any) -> Place | None:
    """A point inside the largest part."""
    parts = shapely.get_parts(shape)
    if len(parts) == 0 or shape.area == 0:
        return None
    point = shapely.point_on_surface(parts[int(np.argmax(shapely.area(parts)))])
    return float(point.x), float(point.y)
