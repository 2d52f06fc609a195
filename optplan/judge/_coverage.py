"""What is marked, against what should be, as areas."""

from __future__ import annotations

import math
from collections.abc import Callable
from dataclasses import dataclass
from typing import Any

import numpy as np

from optplan.domain.arrays import BoolArray, FloatArray, IntArray
from optplan.domain.path import RAISED, Path
from optplan.domain.report import Check
from optplan.domain.result import Area, Cover
from optplan.domain.robot import Robot
from optplan.domain.stroke import Stroke
from optplan.judge._findings import Place, count_of, held, noted, unchecked
from optplan.judge._integrate import Samples

NAMES = ("coverage", "area coverage", "overspill", "overlap")
QUADRANT = 8
"""Segments of a quarter circle around the end of a mark; both sides of a comparison are drawn alike."""
_BIT = 8
"""Segments that are outlined in one go where a line curls."""
_CURLED = 20 * math.pi
"""rad of turning below which a line is outlined in one go."""
_MOST_PAIRS = 2000
"""Marks that overlap, up to which the place where most of it is is looked for."""
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

    strokes = [(k, stroke) for k, stroke in enumerate(cover.strokes) if RAISED < stroke.tool < len(robot.tool.settings)]
    lines, width = _wanted_lines(shapely, strokes, robot)
    number = np.array([k for k, _ in strokes], dtype=np.int64)
    same = exact[number]
    asked = _buffers(shapely, lines, width)
    driven = _driven_marks(shapely, path, samples, robot, limit, exact)
    made = np.concatenate([asked[same], driven.shapes])
    areas = _union(shapely, [_area(shapely, area) for area in cover.areas])
    asked_all = _union(shapely, asked)
    done = asked_all if same.all() and len(driven.shapes) == 0 else _union(shapely, made)

    # What is missed and what is too much follow from three areas. Wanted and done nearly coincide, which makes overlays
    # slow; joining each stroke with its own drive first is several times faster than overlaying the whole.
    wanted, both = asked_all, asked_all
    own = _own_marks(shapely, number[~same], driven)
    if done is not asked_all:
        joined = _overlay(shapely, shapely.union, asked[~same], own)
        loose = driven.shapes[~np.isin(driven.stroke, number)]
        both = _union(shapely, np.concatenate([asked[same], joined, loose]))
    area_check = noted("area coverage", 1.0, "", "There are no areas to fill.")
    if cover.areas:
        wanted, both = _union(shapely, [wanted, areas]), _union(shapely, [both, areas])
        area_check = _area_check(shapely, areas, _overlay(shapely, shapely.difference, areas, done))
    total, marked, all_in_all = float(wanted.area), float(done.area), float(both.area)
    missed, spilled = max(all_in_all - marked, 0.0), max(all_in_all - total, 0.0)

    marks = _mark_check(shapely, lines[~same], width[~same], own, made, limit)
    astray = _union(shapely, driven.shapes[driven.stroke < 0])
    overspill = noted("overspill", spilled, "m2", "Marked besides what was wanted.", _spot(shapely, astray))
    overlap = _overlap_check(shapely, made, marked)
    figures: Figures = [
        ("wanted area", total, "m2"),
        ("done area", marked, "m2"),
        ("missed area", missed, "m2"),
        ("overspill area", spilled, "m2"),
        ("overlap area", overlap.value, "m2"),
        ("coverage", 1 - missed / total if total > 0 else 1.0, ""),
    ]
    if cover.areas:
        figures.append(("area coverage", area_check.value, ""))
    return [marks, area_check, overspill, overlap], figures


def _overlap_check(shapely: Any, made: Any, marked: float) -> Check:
    """Area that is marked more than once, counted once for each time beyond the first, and where most of it is."""
    twice = max(float(shapely.area(made).sum()) - marked, 0.0) if len(made) else 0.0
    place: Place | None = None
    if twice > 0:
        one, other = shapely.STRtree(made).query(made, predicate="intersects")
        pair = np.flatnonzero(one < other)
        if 0 < len(pair) <= _MOST_PAIRS:
            common = [_overlay(shapely, shapely.intersection, made[one[k]], made[other[k]]) for k in pair.tolist()]
            place = _spot(shapely, common[int(np.argmax(shapely.area(common)))])
    return noted("overlap", twice, "m2", "Marked more than once, by strokes that meet or lie side by side.", place)


def _own_marks(shapely: Any, number: IntArray, driven: Marks) -> Any:
    """(k,) what was driven of each of these strokes, as one shape each."""
    own = np.full(len(number), shapely.Polygon(), dtype=object)
    place = {stroke: k for k, stroke in enumerate(number.tolist())}
    for stroke, group in zip(*_grouped(driven.stroke, np.arange(len(driven.stroke))), strict=True):
        if stroke in place:
            own[place[stroke]] = _union(shapely, driven.shapes[group])
    return own


def _mark_check(shapely: Any, lines: Any, width: FloatArray, own: Any, made: Any, limit: float) -> Check:
    """Stroke marks that are not made, m2.

    The core of each mark, narrower by what its allowed deviation and the flat sides of round ends explain, must be made
    entirely: by the stroke's own drive as a rule, else by whatever else comes by.
    """
    core_width = np.maximum(width - 2 * (1.02 * limit + 0.003 * width), width / 10)
    cores = _buffers(shapely, lines, core_width)
    bare = cores[~shapely.covers(own, cores)]
    if len(bare):
        index, near = shapely.STRtree(made).query(bare, predicate="intersects") if len(made) else np.zeros((2, 0), int)
        for k, group in zip(*_grouped(index, near), strict=True):
            bare[k] = _overlay(shapely, shapely.difference, bare[k], _union(shapely, made[group]))
    lost = _union(shapely, bare)
    missing = int((shapely.area(bare) > 0).sum()) if len(bare) else 0
    detail = "The mark of every stroke is made."
    if missing:
        detail = f"The marks of {count_of(missing, 'stroke')} are not made entirely."
    return held("coverage", float(lost.area), 0.0, "m2", _spot(shapely, lost), detail)


def _grouped(keys: IntArray, values: IntArray) -> tuple[list[int], list[IntArray]]:
    """Distinct keys, and the values of each."""
    order = np.argsort(keys, kind="stable")
    distinct, begin = np.unique(keys[order], return_index=True)
    return distinct.tolist(), np.split(values[order], begin[1:]) if len(distinct) else []


def _area_check(shapely: Any, areas: Any, bare: Any) -> Check:
    ratio = 1 - float(bare.area) / float(areas.area) if areas.area > 0 else 1.0
    detail = f"{float(bare.area):.4g} m2 of {float(areas.area):.4g} m2 of areas are not reached."
    return noted("area coverage", ratio, "", detail, _spot(shapely, bare))


def _wanted_lines(shapely: Any, strokes: list[tuple[int, Stroke]], robot: Robot) -> tuple[Any, FloatArray]:
    """Lines (k,) of the strokes and the widths (k,) of their marks, m."""
    lines = [
        shapely.points(*stroke.points[0, :2]) if stroke.is_stop else shapely.linestrings(stroke.closed_points[:, :2])
        for _, stroke in strokes
    ]
    widths = [robot.tool.settings[stroke.tool].width for _, stroke in strokes]
    return np.array(lines, dtype=object), np.array(widths)


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
        lines = list(
            # arcs are sampled more finely than their areas need
            shapely.simplify(
                shapely.linestrings(samples.points[use, :2], indices=label[samples.row[use]]),
                limit / 50,
                preserve_topology=False,
            )
        )
        rows = moving[np.concatenate([[True], broken])]
    # a turn at the end or in the middle of a mark of its own setting lies within that mark's round ends and joints
    draws = np.concatenate([[-1], np.where(down & ~path.is_stop, tool, -1), [-1]])
    within = (draws[:-2] == tool) | (draws[2:] == tool)
    stops = np.flatnonzero(down & path.is_stop & ((path.dwell > 0) | ((path.turn != 0) & ~within)))
    rows = np.concatenate([rows, stops])
    return Marks(
        _buffers(shapely, lines + list(shapely.points(path.start[stops, :2])), widths[tool[rows]]), path.stroke[rows]
    )


def _buffers(shapely: Any, lines: Any, widths: FloatArray) -> Any:
    lines = np.array(lines, dtype=object)
    curled = np.array([_curls(shapely.get_coordinates(line), w) for line, w in zip(lines, widths, strict=True)], bool)
    made = np.full(len(lines), None, dtype=object)
    made[~curled] = shapely.buffer(lines[~curled], widths[~curled] / 2, quad_segs=QUADRANT)
    for k in np.flatnonzero(curled).tolist():
        line = shapely.get_coordinates(lines[k])
        bits = [shapely.linestrings(line[i : i + _BIT + 1]) for i in range(0, len(line) - 1, _BIT)]
        made[k] = _union(shapely, shapely.buffer(bits, widths[k] / 2, quad_segs=QUADRANT))
    return made


def _curls(line: FloatArray, width: float) -> bool:
    """Whether a line turns round and round within its own mark. To outline such a mark in one go takes time that grows
    with the cube of its vertices; bit by bit it is quick."""
    if len(line) <= 2 * _BIT:
        return False
    step = np.diff(line, axis=0)
    heading = np.arctan2(step[:, 1], step[:, 0])
    turned = float(np.abs((np.diff(heading) + np.pi) % (2 * np.pi) - np.pi).sum())
    return turned > _CURLED and turned * width > float(np.linalg.norm(step, axis=1).sum())


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
    if len(shapes) == 1:
        return shapes[0]
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
