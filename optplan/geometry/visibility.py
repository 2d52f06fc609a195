"""Shortest ways among polygons: lines between corners that see each other."""

from __future__ import annotations

from functools import cached_property
from typing import Any

import numpy as np
from scipy.sparse.csgraph import shortest_path

from optplan.domain.arrays import BoolArray, FloatArray, IntArray
from optplan.domain.errors import LimitError

HAIR = 1e-7
"""Share of the size of things by which obstacles are made smaller: on their border, the last digit decides."""
MOST_CORNERS = 600
"""Of all obstacles together."""


class Ways:
    """Shortest ways that do not enter an obstacle.

    Parameters
    ----------
    obstacle : shapely area; ways may run along its border
    most : corners; None where only `seen` is asked for, which any number does

    Raises
    ------
    LimitError : more than MOST_CORNERS corners
    """

    def __init__(self, obstacle: Any, most: int | None = MOST_CORNERS) -> None:
        import shapely

        size = max(float(np.abs(obstacle.bounds).max()), 1.0) if not obstacle.is_empty else 1.0
        self.inner = obstacle.buffer(-HAIR * size, join_style="mitre")
        shapely.prepare(self.inner)
        corners = np.unique(shapely.get_coordinates(obstacle), axis=0).reshape(-1, 2)
        if most is not None and len(corners) > most:
            raise LimitError(f"areas to go around have {len(corners)} corners; at most {most}: simplify them")
        self.corners = corners[~self._inside(corners)] if len(corners) else corners

    def _inside(self, points: FloatArray) -> BoolArray:
        import shapely

        inside: BoolArray = shapely.contains_xy(self.inner, points[:, 0], points[:, 1])
        return inside

    def seen(self, starts: FloatArray, ends: FloatArray) -> BoolArray:
        """(k,) whether the line between starts (k, 2) and ends (k, 2) enters no obstacle."""
        import shapely

        if self.inner.is_empty or len(starts) == 0:
            return np.ones(len(starts), dtype=np.bool_)
        blocked: BoolArray = shapely.intersects(self.inner, shapely.linestrings(np.stack([starts, ends], axis=1)))
        return ~blocked

    def seen_by_all(self, starts: FloatArray, ends: FloatArray) -> BoolArray:
        """(n, m) the same from every start (n, 2) to every end (m, 2)."""
        i, j = (index.ravel() for index in np.indices((len(starts), len(ends))))
        return self.seen(starts[i], ends[j]).reshape(len(starts), len(ends))

    @cached_property
    def between_corners(self) -> tuple[FloatArray, IntArray]:
        """Lengths (v, v) m of the shortest ways between corners, and the corner before the last (v, v)."""
        seen = self.seen_by_all(self.corners, self.corners)
        lengths = np.where(seen, np.linalg.norm(self.corners[:, None] - self.corners, axis=2), 0.0)
        found, before = shortest_path(lengths, method="D", directed=False, return_predecessors=True)
        return found, before.astype(np.int64)

    def way(self, start: FloatArray, end: FloatArray) -> FloatArray | None:
        """(k, 2) the corners of the shortest way from start to end, both included; None when there is none."""
        if self.seen(start[None], end[None])[0]:
            return np.array([start, end])
        if len(self.corners) == 0:
            return None
        lengths, before = self.between_corners
        first, last = (
            np.where(
                self.seen(np.broadcast_to(place, self.corners.shape), self.corners),
                np.hypot(*(self.corners - place).T),
                np.inf,
            )
            for place in (start, end)
        )
        total = first[:, None] + lengths + last
        a, b = (int(k) for k in np.unravel_index(int(np.argmin(total)), total.shape))
        if not np.isfinite(total[a, b]):
            return None
        chain = [b]
        while chain[-1] != a:
            chain.append(int(before[a, chain[-1]]))
        return np.concatenate([start[None], self.corners[chain[::-1]], end[None]])
