"""Driving with the tool up over work that is finished, in the order in which things happen."""

from __future__ import annotations

from typing import Any

import numpy as np

from optplan.domain.arrays import IntArray
from optplan.domain.path import RAISED, Path
from optplan.domain.report import Check
from optplan.domain.result import Cover
from optplan.domain.robot import Robot
from optplan.judge._findings import Place, count_of, noted
from optplan.judge._integrate import Samples

NAME = "over finished work"


def over_finished(path: Path, samples: Samples, cover: Cover, robot: Robot) -> Check:
    """Metres that the tool is carried over the marks of strokes driven before, and where the most are.

    A mark is its stroke with a round end, as wide as its tool setting. Around the place where a stroke is left its
    width does not count: the tool is there anyhow.
    """
    import shapely

    strokes = cover.strokes
    widths = np.array([setting.width for setting in robot.tool.settings])
    marks, made = finished_marks(path, cover, robot)
    tree = shapely.STRtree(marks)

    total, worst, place, times = 0.0, 0.0, None, 0
    for first, end in _carried(path):
        points = samples.points[samples.first[first] : samples.first[end], :2]
        if len(points) < 2 or not np.ptp(points, axis=0).any():
            continue
        line = shapely.linestrings(points)
        near = tree.query(line, predicate="intersects")
        over = shapely.intersection(line, shapely.union_all(marks[near[made[near] < first]]))
        if first > 0 and 0 <= path.stroke[first - 1] < len(strokes):
            own = widths[min(strokes[path.stroke[first - 1]].tool, len(widths) - 1)]
            over = shapely.difference(over, shapely.buffer(shapely.points(points[0]), own))
        metres = float(over.length)
        total += metres
        times += metres > 0
        if metres > worst:
            worst, place = metres, middle(shapely, over)
    return noted(NAME, total, "m", f"The tool is carried over finished work on {count_of(times, 'way')}.", place)


def finished_marks(path: Path, cover: Cover, robot: Robot) -> tuple[Any, IntArray]:
    """The marks (k,) of the strokes that are driven, as areas, and the last row (k,) of the path that makes each."""
    import shapely

    strokes = cover.strokes
    widths = np.array([setting.width for setting in robot.tool.settings])
    last = np.full(len(strokes), len(path))
    driven = np.flatnonzero((path.stroke >= 0) & (path.stroke < len(strokes)))
    last[path.stroke[driven]] = driven  # later rows overwrite earlier ones
    marked = [k for k, stroke in enumerate(strokes) if RAISED < stroke.tool < len(widths) and last[k] < len(path)]
    marks = [_mark(shapely, strokes[k].closed_points, widths[strokes[k].tool]) for k in marked]
    return np.array(marks, dtype=object), last[np.array(marked, dtype=np.int64)]


def _carried(path: Path) -> list[tuple[int, int]]:
    """Rows first..end - 1 of each stretch with the tool up that moves; turns within it belong to it."""
    up = np.concatenate([[False], (path.tool == RAISED), [False]])
    edges = np.flatnonzero(up[1:] != up[:-1]).reshape(-1, 2)
    return [(first, end) for first, end in edges.tolist() if path.length[first:end].any()]


def _mark(shapely: Any, points: Any, width: float) -> Any:
    line = shapely.points(points[0, :2]) if len(points) == 1 else shapely.linestrings(points[:, :2])
    return shapely.buffer(line, width / 2)


def middle(shapely: Any, over: Any) -> Place:
    part = max(shapely.get_parts(over), key=lambda line: line.length)
    point = shapely.line_interpolate_point(part, 0.5, normalized=True)
    return float(point.x), float(point.y)
