"""What is marked, against what should be, as areas."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from typing import Any

import numpy as np

from optplan.domain.arrays import BoolArray, FloatArray, IntArray
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

_MOST_PAIRS = 20_000
"""Neighbours of slivers up to which they are compared one by one."""
_GRID = 1e-8
"""m, of the grid that saves an overlay which fails in floating point."""

Figures = list[tuple[str, float, str]]


@dataclass(frozen=True, eq=False)
class Marks:
    """Lines with a width, as areas.

    Parameters
    ----------
    shapes : (k,) shapely geometries
    stroke : (k,) index of the stroke that each belongs to, -1 for none
    """

    shapes: Any
    stroke: IntArray


def coverage(
    path: Path, samples: Samples, cover: Cover, robot: Robot, limit: float, exact: BoolArray
) -> tuple[list[Check], Figures]:
    """Areas wanted, done, missed and marked besides.

    Wanted are the marks of all strokes and the areas; done is what the path marks, with round ends. A stroke's mark may
    be missed only in slivers that its allowed deviation explains; corners of areas that a round tool cannot reach are
    measured and noted.

    Parameters
    ----------
    limit : m, how far a driven stroke may be off
    exact : (n,) strokes known to be driven along their own points: their marks need not be compared
    """
    heights = [stroke.points[:, 2] for stroke in cover.strokes if stroke.points.shape[1] == 3]
    if any((z != 0).any() for z in heights) or (len(path) and (samples.points[:, 2] != 0).any()):
        return unchecked(NAMES, "coverage is measured in the plane only"), []
    import shapely

    asked = _wanted_marks(shapely, cover, robot)
    same = exact[asked.stroke]
    driven = _driven_marks(shapely, path, samples, robot, limit, exact)
    rest = Marks(asked.shapes[~same], asked.stroke[~same])
    made = np.concatenate([asked.shapes[same], driven.shapes])
    areas = _union(shapely, [_area(shapely, area) for area in cover.areas])
    asked_all = _union(shapely, asked.shapes)
    done = asked_all if same.all() and len(driven.shapes) == 0 else _union(shapely, made)

    missed_marks = _left_over(shapely, rest, driven, made, done)
    spilled = _left_over(shapely, driven, rest, asked.shapes, asked_all)
    wanted, missed = asked_all, missed_marks
    if cover.areas:
        wanted = _union(shapely, [asked_all, areas])
        bare = _overlay(shapely, shapely.difference, areas, done)
        missed = _union(shapely, [missed_marks, bare])
        spilled = _overlay(shapely, shapely.difference, spilled, areas)
        area_check = _area_check(shapely, areas, bare)
    else:
        area_check = noted("area coverage", 1.0, "", "There are no areas to fill.")
    spot = _spot(shapely, spilled)
    overspill = noted("overspill", float(spilled.area), "m2", "Marked besides what was wanted.", spot)
    total = float(wanted.area)
    figures: Figures = [
        ("wanted area", total, "m2"),
        ("done area", float(done.area), "m2"),
        ("missed area", float(missed.area), "m2"),
        ("overspill area", float(spilled.area), "m2"),
        ("coverage", 1 - float(missed.area) / total if total > 0 else 1.0, ""),
    ]
    if cover.areas:
        figures.append(("area coverage", area_check.value, ""))
    return [_mark_check(shapely, asked_all, missed_marks, limit), area_check, overspill], figures


def _left_over(shapely: Any, marks: Marks, own: Marks, others: Any, whole: Any) -> Any:
    """What of `marks` lies outside `others` (whose union is `whole`).

    A mark and the one meant for it nearly coincide, and overlaying many such pairs at once is slow. So each is compared
    with its own counterpart first, and only the slivers that remain with everything else.
    """
    if len(marks.shapes) == 0:
        return shapely.Polygon()
    order = np.argsort(own.stroke, kind="stable")
    index, begin = np.unique(own.stroke[order], return_index=True)
    groups = dict(zip(index.tolist(), np.split(own.shapes[order], begin[1:]), strict=False))
    groups.pop(-1, None)
    counterparts = np.array(
        [_union(shapely, groups[k]) if k in groups else shapely.Polygon() for k in marks.stroke.tolist()], dtype=object
    )
    slivers = shapely.get_parts(_overlay(shapely, shapely.difference, marks.shapes, counterparts))
    slivers = slivers[~shapely.is_empty(slivers)]
    if len(slivers) == 0:
        return shapely.Polygon()
    near, other = shapely.STRtree(others).query(slivers, predicate="intersects")
    if len(near) > _MOST_PAIRS:
        return _overlay(shapely, shapely.difference, _union(shapely, slivers), whole)
    for k, group in zip(*_grouped(near, other), strict=True):
        slivers[k] = _overlay(shapely, shapely.difference, slivers[k], _union(shapely, others[group]))
    return _union(shapely, slivers)


def _grouped(keys: IntArray, values: IntArray) -> tuple[list[int], list[IntArray]]:
    """Distinct keys, and the values of each."""
    order = np.argsort(keys, kind="stable")
    distinct, begin = np.unique(keys[order], return_index=True)
    return distinct.tolist(), np.split(values[order], begin[1:]) if len(distinct) else []


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


def _area_check(shapely: Any, areas: Any, bare: Any) -> Check:
    ratio = 1 - float(bare.area) / float(areas.area) if areas.area > 0 else 1.0
    detail = f"{float(bare.area):.4g} m2 of {float(areas.area):.4g} m2 of areas are not reached."
    return noted("area coverage", ratio, "", detail, _spot(shapely, bare))


def _wanted_marks(shapely: Any, cover: Cover, robot: Robot) -> Marks:
    """The marks that the strokes ask for."""
    settings = robot.tool.settings
    chosen = [k for k, stroke in enumerate(cover.strokes) if RAISED < stroke.tool < len(settings)]
    strokes = [cover.strokes[k] for k in chosen]
    lines = [
        shapely.points(*stroke.points[0, :2]) if stroke.is_stop else shapely.linestrings(stroke.closed_points[:, :2])
        for stroke in strokes
    ]
    widths = [settings[stroke.tool].width for stroke in strokes]
    return Marks(_buffers(shapely, lines, np.array(widths)), np.array(chosen, dtype=np.int64))


def _driven_marks(shapely: Any, path: Path, samples: Samples, robot: Robot, limit: float, exact: BoolArray) -> Marks:
    """Stretches with the tool down, except those of exact strokes: one for each chain of pieces with one setting."""
    widths = np.array([setting.width for setting in robot.tool.settings])
    tool = np.where(path.tool < len(widths), path.tool, RAISED)
    known = np.append(exact, False)  # the last one stands for every stroke that there is not
    told = known[np.where((path.stroke >= 0) & (path.stroke < len(exact)), path.stroke, len(exact))]
    down = (tool > RAISED) & ~told
    moving = np.flatnonzero(down & ~path.is_stop)
    lines: list[Any] = []
    rows = np.zeros(0, dtype=np.int64)
    if len(moving):
        before, after = moving[:-1], moving[1:]
        # a line goes on over a stop where the robot turns, but not over anything driven with the tool up
        apart = np.linalg.norm(path.start[after] - samples.ends[before], axis=1) > limit * 1e-3
        broken = apart | (tool[before] != tool[after]) | (path.stroke[before] != path.stroke[after])
        label = np.full(len(path), -1)
        label[moving] = np.concatenate([[0], np.cumsum(broken)])
        use = label[samples.row] >= 0
        lines = list(shapely.linestrings(samples.points[use, :2], indices=label[samples.row[use]]))
        rows = moving[np.concatenate([[True], broken])]
    stops = np.flatnonzero(down & path.is_stop & ((path.dwell > 0) | (path.turn != 0)))
    rows = np.concatenate([rows, stops])
    return Marks(
        _buffers(shapely, lines + list(shapely.points(path.start[stops, :2])), widths[tool[rows]]), path.stroke[rows]
    )


def _buffers(shapely: Any, lines: list[Any], widths: FloatArray) -> Any:
    return shapely.buffer(np.array(lines, dtype=object), widths / 2, quad_segs=QUADRANT)


def _area(shapely: Any, area: Area) -> Any:
    """Its rings by the even-odd rule, which also tells the inside of a ring that crosses itself."""
    whole = shapely.Polygon()
    for ring in area.rings:
        if len(ring) >= 3:
            inside = shapely.make_valid(shapely.polygons(ring))
            whole = _overlay(shapely, shapely.symmetric_difference, whole, inside)
    return whole


def _union(shapely: Any, shapes: Any) -> Any:
    shapes = np.array(shapes, dtype=object)
    try:
        return shapely.union_all(shapes)
    except shapely.errors.GEOSException:
        # snapping to a grid far below any tolerance cannot fail on nearly touching edges
        return shapely.union_all(shapely.make_valid(shapes), grid_size=_GRID)


def _overlay(shapely: Any, operation: Callable[..., Any], a: Any, b: Any) -> Any:
    try:
        return operation(a, b)
    except shapely.errors.GEOSException:
        return operation(shapely.make_valid(a), shapely.make_valid(b), grid_size=_GRID)


def _spot(shapely: Any, shape: Any) -> Place | None:
    """A point inside the largest part."""
    parts = shapely.get_parts(shape)
    if len(parts) == 0 or shape.area == 0:
        return None
    point = shapely.point_on_surface(parts[int(np.argmax(shapely.area(parts)))])
    return float(point.x), float(point.y)
