"""Metres that connectors drive over work that is finished by then.

They depend on the whole order, so they are no arc cost; see `optplan.avoiding` for how they are lowered all the same.
"""

from __future__ import annotations

from collections.abc import Sequence
from typing import Any

import numpy as np

from optplan.connectors.driving import connector
from optplan.connectors.families import Family, limits_of
from optplan.connectors.ways import driven
from optplan.domain.arrays import FloatArray, IntArray
from optplan.domain.options import Options
from optplan.domain.path import RAISED
from optplan.domain.result import Cover
from optplan.domain.robot import Robot
from optplan.domain.stroke import Stroke, Traversals
from optplan.geometry.clothoids import clothoid_displacement
from optplan.geometry.rounding import Pieces

BIT = 0.2
"""rad that a connector turns between two points of the line that stands for it."""


class Marks:
    """What strokes leave behind, as areas, with an index over them.

    Parameters
    ----------
    strokes : (m,); travel moves and settings without a mark leave nothing
    robot : its tool settings give the widths
    """

    def __init__(self, strokes: Sequence[Stroke], robot: Robot) -> None:
        import shapely

        widths = np.array([setting.width for setting in robot.tool.settings])
        lines = [
            shapely.Point(stroke.points[0, :2]) if stroke.is_stop else shapely.LineString(stroke.closed_points[:, :2])
            for stroke in strokes
        ]
        self.width = np.array([widths[stroke.tool] if stroke.tool > RAISED else 0.0 for stroke in strokes])
        self.shapes = shapely.buffer(np.array(lines, dtype=object), self.width / 2)
        self.tree = shapely.STRtree(self.shapes)

    def table(self, lines: Any) -> FloatArray:
        """Metres (k, m) of each line that lie on each mark, whenever it is made."""
        import shapely

        found = np.zeros((len(lines), len(self.shapes)))
        line, mark = self.tree.query(lines, predicate="intersects")
        use = self.width[mark] > 0
        line, mark = line[use], mark[use]
        found[line, mark] = shapely.length(
            shapely.intersection(np.asarray(lines, dtype=object)[line], self.shapes[mark])
        )
        return found

    def metres(self, lines: Any, source: IntArray, rank: IntArray, time: IntArray) -> FloatArray:
        """Metres (k,) of each line that lie on marks made before it is driven.

        Where it leaves its own stroke, a line is on that stroke's mark anyhow: a width around does not count.

        Parameters
        ----------
        lines : (k,) shapely lines
        source : (k,) the stroke that each line comes from, -1 for none
        rank : (m,) when each stroke is driven
        time : (k,) each line is driven after the strokes of lower rank
        """
        import shapely

        found = np.zeros(len(lines))
        line, mark = self.tree.query(lines, predicate="intersects")
        use = (rank[mark] < time[line]) & (self.width[mark] > 0)
        line, mark = line[use], mark[use]
        if not len(line):
            return found
        order = np.argsort(line, kind="stable")
        line, mark = line[order], mark[order]
        over = shapely.intersection(np.asarray(lines, dtype=object)[line], self.shapes[mark])
        first = np.flatnonzero(np.diff(line, prepend=-1))
        for begin, end in zip(first.tolist(), [*first[1:].tolist(), len(line)], strict=True):
            if end - begin > 1:  # marks overlap, and nothing is driven over twice at a time
                over[begin] = shapely.union_all(over[begin:end])
        crossing = line[first]
        around = np.where(source[crossing] >= 0, self.width[source[crossing]], 0.0)
        begins = shapely.get_point(np.asarray(lines, dtype=object)[crossing], 0)
        found[crossing] = shapely.length(shapely.difference(over[first], shapely.buffer(begins, around)))
        return found


def connector_lines(exits: FloatArray, entries: FloatArray, family: Family, aside: float = 0.0) -> Any:
    """Shapely lines (k,) that connectors between states (k, 5) x, y, z, heading, curvature follow.

    With `aside` (m), those of wheels so far to both sides of them, as one shape each.
    """
    import shapely

    if not family.headings and aside == 0:
        return shapely.linestrings(np.stack([exits[:, :2], entries[:, :2]], axis=1))
    flat = [0, 1, 3, 4]
    limits = limits_of(exits[:, flat], entries[:, flat], family)
    pieces = [
        connector(here, there, family, turns=False, limits=allowed).pieces
        for here, there, allowed in zip(exits[:, flat], entries[:, flat], limits, strict=True)
    ]
    return tracks(pieces, exits[:, flat], entries[:, flat], aside)


def tracks(ways: Sequence[Pieces], first: FloatArray, last: FloatArray, aside: float) -> Any:
    """Shapely lines (k,) of pieces from states to states (k, 4), or those `aside` (m) on both sides, as one shape."""
    import shapely

    owner = np.repeat(np.arange(len(ways)), [len(way.length) for way in ways])
    start, heading, curvature, length, _, sharpness = (np.concatenate(column) for column in zip(*ways, strict=True))
    turned = length * np.maximum(np.abs(curvature), np.abs(curvature + sharpness * length))
    count = np.where(length > 0, np.maximum(1, np.ceil(turned / BIT)), 0).astype(np.int64)
    piece = np.repeat(np.arange(len(owner)), count)
    number = np.arange(len(piece)) - np.repeat(np.cumsum(count) - count, count) + 1
    along = length[piece] * number / count[piece]
    angle, bend, change = heading[piece], curvature[piece], sharpness[piece]
    points = start[piece] + np.column_stack(clothoid_displacement(angle, bend, change, along))
    angle = angle + along * (bend + change * along / 2)
    # the states themselves come first and last
    line = np.concatenate([np.arange(len(ways)), owner[piece], np.arange(len(ways))])
    order = np.argsort(line, kind="stable")
    points = np.concatenate([first[:, :2], points, last[:, :2]])[order]
    angle = np.concatenate([first[:, 2], angle, last[:, 2]])[order]
    line = line[order]
    if aside == 0:
        return shapely.linestrings(points, indices=line)
    left = aside * np.column_stack([-np.sin(angle), np.cos(angle)])
    sides = [shapely.linestrings(points + side * left, indices=line) for side in (1, -1)]
    return shapely.multilinestrings(np.column_stack(sides).ravel(), indices=np.repeat(np.arange(len(ways)), 2))


def stroke_lines(ways: Traversals, cover: Cover, robot: Robot, options: Options, aside: float) -> Any:
    """Shapely lines (n,) that the robot follows along each way of driving a stroke, or `aside` (m) its wheels."""
    made: list[Pieces] = []
    for k in range(len(ways)):
        way = ways[k]
        stroke = cover.strokes[way.stroke]
        if stroke.is_stop:
            made.append(Pieces(np.zeros((0, 2)), *(np.zeros(0) for _ in range(5))))
        else:
            made.append(driven(stroke, way.entry_vertex, way.reverse, robot, options))
    flat = [0, 1, 3, 4]
    first, last = ways.entry[:, flat].copy(), ways.exit[:, flat].copy()
    for k, pieces in enumerate(made):  # with padding, a way begins before its stroke
        if len(pieces.length):
            first[k, :3] = [*pieces.start[0], pieces.heading[0]]
            last[k] = _behind(pieces)
    return tracks(made, first, last, aside)


def _behind(pieces: Pieces) -> FloatArray:
    """The state (4,) at the end of pieces."""
    last = [column[-1:] for column in (pieces.heading, pieces.curvature, pieces.sharpness, pieces.length)]
    dx, dy = clothoid_displacement(*last)
    heading, curvature, sharpness, length = (float(column[0]) for column in last)
    turned = length * (curvature + sharpness * length / 2)
    x, y = pieces.start[-1]
    return np.array([x + dx[0], y + dy[0], heading + turned, curvature + sharpness * length])
