"""Wheels on finished work, in the order in which things happen."""

from __future__ import annotations

import numpy as np

from optplan.domain.arrays import FloatArray, IntArray
from optplan.domain.options import Options
from optplan.domain.path import Path, Trajectory
from optplan.domain.report import Check
from optplan.domain.result import Cover
from optplan.domain.robot import DiffDrive, Robot
from optplan.judge._findings import Place, count_of, noted
from optplan.judge._finished import finished_marks, middle
from optplan.judge._integrate import Samples

NAME = "wheels over finished work"


def wheels_over_finished(
    path: Path, samples: Samples, cover: Cover, robot: Robot, options: Options, trajectory: Trajectory | None
) -> Check:
    """Metres that both wheels together drive over marks of strokes finished before, and where the most are.

    With a drying time, marks that were finished longer ago when a stretch begins do not count. What a stroke does to
    itself is not looked at. A wheel is as thin as a line; where the robot turns on the spot, it takes the
    chord.
    """
    import shapely

    mobility = robot.mobility
    if not isinstance(mobility, DiffDrive):
        return noted(NAME, 0.0, "m", "The robot has no wheels.")
    marks, made = finished_marks(path, cover, robot)
    tree = shapely.STRtree(marks)
    # without speeds nothing is known to be dry
    dry = options.order.drying if trajectory is not None else None
    times = np.zeros(len(path) + 1) if trajectory is None else np.interp(path.offsets, trajectory.s, trajectory.t)
    total, worst, count = 0.0, 0.0, 0
    place: Place | None = None
    for first, end in _stretches(path):
        points, rows = _points(samples, first, end)
        if len(points) < 2 or not np.ptp(points, axis=0).any():
            continue
        along = samples.along[samples.first[first] : samples.first[end]]
        heading = path.heading[rows] + along * (path.curvature[rows] + along * path.sharpness[rows] / 2)
        left = np.column_stack([-np.sin(heading), np.cos(heading)]) * mobility.track / 2
        tracks = shapely.multilinestrings(shapely.linestrings(np.stack([points + left, points - left])))
        near = tree.query(tracks, predicate="intersects")
        near = near[made[near] < first]
        if dry is not None:
            near = near[times[first] - times[made[near] + 1] < dry]
        over = shapely.intersection(tracks, shapely.union_all(marks[near]))
        metres = float(over.length)
        total += metres
        count += metres > 0
        if metres > worst:
            worst, place = metres, middle(shapely, over)
    fresh = "finished" if dry is None else f"finished less than {dry:g} s ago"
    return noted(NAME, total, "m", f"Wheels drive over work {fresh} on {count_of(count, 'way')}.", place)


def _stretches(path: Path) -> list[tuple[int, int]]:
    """Rows first..end - 1 of each stroke, and of each way between two."""
    edges = np.flatnonzero(np.diff(path.stroke, prepend=-2, append=-2))
    return list(zip(edges[:-1].tolist(), edges[1:].tolist(), strict=True))


def _points(samples: Samples, first: int, end: int) -> tuple[FloatArray, IntArray]:
    part = slice(samples.first[first], samples.first[end])
    return samples.points[part, :2], samples.row[part]
