"""Metres that connectors drive over work that is finished by then.

They depend on the whole order, so they are no arc cost; see `optplan.avoiding` for how they are lowered all the same.
"""

from __future__ import annotations

from collections.abc import Sequence
from typing import Any

import numpy as np

from optplan.connectors.driving import connector
from optplan.connectors.families import Family
from optplan.domain.arrays import FloatArray, IntArray
from optplan.domain.path import RAISED
from optplan.domain.robot import Robot
from optplan.domain.stroke import Stroke
from optplan.geometry.clothoids import clothoid_displacement

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


def connector_lines(exits: FloatArray, entries: FloatArray, family: Family) -> Any:
    """Shapely lines (k,) that connectors between states (k, 5) x, y, z, heading, curvature follow."""
    import shapely

    if not family.headings:
        return shapely.linestrings(np.stack([exits[:, :2], entries[:, :2]], axis=1))
    made = []
    for here, there in zip(exits[:, [0, 1, 3, 4]], entries[:, [0, 1, 3, 4]], strict=True):
        pieces = connector(here, there, family, turns=False).pieces
        points = [here[None, :2]]
        for k in range(len(pieces.length)):
            length, bend = pieces.length[k], pieces.curvature[k]
            turned = length * max(abs(bend), abs(bend + pieces.sharpness[k] * length))
            along = length * np.linspace(0, 1, 1 + max(1, int(np.ceil(turned / BIT))))[1:]
            heading, curvature, sharpness = (
                np.full(len(along), column[k]) for column in (pieces.heading, pieces.curvature, pieces.sharpness)
            )
            points.append(
                pieces.start[k] + np.column_stack(clothoid_displacement(heading, curvature, sharpness, along))
            )
        line = np.concatenate([*points, there[None, :2]])
        made.append(shapely.LineString(line))
    return np.array(made, dtype=object)
