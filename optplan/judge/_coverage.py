"""What is marked, against what should be, as areas."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any

import numpy as np

from optplan.domain.arrays import BoolArray, FloatArray, IntArray
from optplan.domain.path import RAISED, Path
from optplan.domain.report import Check
from optplan.domain.result import Area, Cover
from optplan.domain.robot import Robot
from optplan.domain.stroke import Stroke
from optplan.judge._findings import count_of, held, noted, unchecked
from optplan.judge._integrate import Samples
from optplan.judge._overlap import overlap
from optplan.judge._shapes import buffers, overlay, spot, union

NAMES = ("coverage", "area coverage", "overspill", "overlap")
Figures = list[tuple[str, float, str]]


@dataclass(frozen=True, eq=False)
class Marks:
    """Lines with a width, as areas.

    Parameters
    ----------
    shapes : (k,) shapely geometries
    lines : (k,) in the middle of each, points or lines
    width : (k,) m
    stroke : (k,) index of the stroke that each belongs to, -1 for none
    """

    shapes: Any
    lines: Any
    width: FloatArray
    stroke: IntArray


def coverage(
    path: Path,
    samples: Samples,
    cover: Cover,
    robot: Robot,
    limit: float,
    exact: BoolArray,
    requested: FloatArray | None = None,
) -> tuple[list[Check], Figures]:
    """Areas wanted, done, missed and marked besides.

    Wanted are the marks of all strokes and the areas; done is what the path marks, with round ends. A stroke's mark may
    be missed only in slivers that its allowed deviation explains; corners of areas that a round tool cannot reach are
    measured and noted.

    Parameters
    ----------
    limit : m, how far a driven stroke may be off
    exact : (n,) strokes known to be driven along their own points: their marks need not be compared
    requested : (n,) m, how wide the mark of each stroke was asked to be, where that may be less than the tool's width
    """
    heights = [stroke.points[:, 2] for stroke in cover.strokes if stroke.points.shape[1] == 3]
    if any((z != 0).any() for z in heights) or (len(path) and (samples.points[:, 2] != 0).any()):
        return unchecked(NAMES, "coverage is measured in the plane only"), []
    import shapely

    strokes = [(k, stroke) for k, stroke in enumerate(cover.strokes) if RAISED < stroke.tool < len(robot.tool.settings)]
    lines, width = _wanted_lines(shapely, strokes, robot)
    number = np.array([k for k, _ in strokes], dtype=np.int64)
    same = exact[number]
    asked = buffers(shapely, lines, width)
    driven = _driven_marks(shapely, path, samples, robot, limit, exact)
    made = np.concatenate([asked[same], driven.shapes])
    areas = union(shapely, [_area(shapely, area) for area in cover.areas])
    asked_all = union(shapely, asked)
    done = asked_all if same.all() and len(driven.shapes) == 0 else union(shapely, made)

    # What is missed and what is too much follow from three areas. Wanted and done nearly coincide, which makes overlays
    # slow; joining each stroke with its own drive first is several times faster than overlaying the whole.
    wanted, both = asked_all, asked_all
    own = _own_marks(shapely, number[~same], driven)
    if done is not asked_all:
        joined = overlay(shapely, shapely.union, asked[~same], own)
        loose = driven.shapes[~np.isin(driven.stroke, number)]
        both = union(shapely, np.concatenate([asked[same], joined, loose]))
    area_check = noted("area coverage", 1.0, "", "There are no areas to fill.")
    if cover.areas:
        wanted, both = union(shapely, [wanted, areas]), union(shapely, [both, areas])
        area_check = _area_check(shapely, areas, overlay(shapely, shapely.difference, areas, done))
    total, marked, all_in_all = float(wanted.area), float(done.area), float(both.area)
    missed, spilled = max(all_in_all - marked, 0.0), max(all_in_all - total, 0.0)

    detail = "Marked besides what was wanted."
    narrow = np.zeros(0) if requested is None else requested[number]
    if (narrow < width[: len(narrow)]).any():
        asked_for = union(shapely, buffers(shapely, lines, narrow))
        total, missed = float(asked_for.area), float(overlay(shapely, shapely.difference, asked_for, done).area)
        spilled = max(marked - (total - missed), 0.0)
        detail += f" Lines of {narrow.min() * 100:.3g} cm are marked {width[narrow.argmin()] * 100:.3g} cm wide."

    marks = _mark_check(shapely, lines[~same], width[~same], own, made, limit)
    astray = union(shapely, driven.shapes[driven.stroke < 0])
    overspill = noted("overspill", spilled, "m2", detail, spot(shapely, astray))
    middles = np.concatenate([lines[same], driven.lines])
    again, within = overlap(shapely, middles, np.concatenate([width[same], driven.width]), areas, limit * 1e-3)
    figures: Figures = [
        ("wanted area", total, "m2"),
        ("done area", marked, "m2"),
        ("missed area", missed, "m2"),
        ("overspill area", spilled, "m2"),
        ("overlap area", again.value, "m2"),
        ("coverage", 1 - missed / total if total > 0 else 1.0, ""),
    ]
    if cover.areas:
        figures += [("area coverage", area_check.value, ""), ("overlap in areas", within, "m2")]
    return [marks, area_check, overspill, again], figures


def _own_marks(shapely: Any, number: IntArray, driven: Marks) -> Any:
    """(k,) what was driven of each of these strokes, as one shape each."""
    own = np.full(len(number), shapely.Polygon(), dtype=object)
    place = {stroke: k for k, stroke in enumerate(number.tolist())}
    for stroke, group in zip(*_grouped(driven.stroke, np.arange(len(driven.stroke))), strict=True):
        if stroke in place:
            own[place[stroke]] = union(shapely, driven.shapes[group])
    return own


def _mark_check(shapely: Any, lines: Any, width: FloatArray, own: Any, made: Any, limit: float) -> Check:
    """Stroke marks that are not made, m2.

    The core of each mark, narrower by what its allowed deviation and the flat sides of round ends explain, must be made
    entirely: by the stroke's own drive as a rule, else by whatever else comes by.
    """
    core_width = np.maximum(width - 2 * (1.02 * limit + 0.003 * width), width / 10)
    cores = buffers(shapely, lines, core_width)
    bare = cores[~shapely.covers(own, cores)]
    if len(bare):
        index, near = shapely.STRtree(made).query(bare, predicate="intersects") if len(made) else np.zeros((2, 0), int)
        for k, group in zip(*_grouped(index, near), strict=True):
            bare[k] = overlay(shapely, shapely.difference, bare[k], union(shapely, made[group]))
    lost = union(shapely, bare)
    missing = int((shapely.area(bare) > 0).sum()) if len(bare) else 0
    detail = "The mark of every stroke is made."
    if missing:
        detail = f"The marks of {count_of(missing, 'stroke')} are not made entirely."
    return held("coverage", float(lost.area), 0.0, "m2", spot(shapely, lost), detail)


def _grouped(keys: IntArray, values: IntArray) -> tuple[list[int], list[IntArray]]:
    """Distinct keys, and the values of each."""
    order = np.argsort(keys, kind="stable")
    distinct, begin = np.unique(keys[order], return_index=True)
    return distinct.tolist(), np.split(values[order], begin[1:]) if len(distinct) else []


def _area_check(shapely: Any, areas: Any, bare: Any) -> Check:
    ratio = 1 - float(bare.area) / float(areas.area) if areas.area > 0 else 1.0
    detail = f"{float(bare.area):.4g} m2 of {float(areas.area):.4g} m2 of areas are not reached."
    return noted("area coverage", ratio, "", detail, spot(shapely, bare))


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
    middles = np.array([*lines, *shapely.points(path.start[stops, :2])], dtype=object)
    width = widths[tool[rows]]
    return Marks(buffers(shapely, middles, width), middles, width, path.stroke[rows])


def _area(shapely: Any, area: Area) -> Any:
    """Its rings by the even-odd rule, which also tells the inside of a ring that crosses itself."""
    whole = shapely.Polygon()
    for ring in area.rings:
        if len(ring) >= 3:
            inside = shapely.make_valid(shapely.polygons(ring))
            whole = overlay(shapely, shapely.symmetric_difference, whole, inside)
    return whole
