"""Washing circles row by row: a model of segments, which are driven from end to end, instead of circles.

Rows are found by y and split where the gap between two circles exceeds 1.04 times their usual spacing. A segment is a
cluster of two traversals, left to right and right to left; what it costs inside is its length. As published, rows are
done strictly from the lowest to the highest: arcs from a higher row to a lower one do not exist. Segments that may be
split are also cut where their circles' precedence changes, e.g. below the edges of a window, and the order between the
pieces is that of their circles. Either way the paths are some of those through the circles: the least cost is no lower
bound for the circles.
"""

from __future__ import annotations

from typing import NamedTuple

import numpy as np
import numpy.typing as npt
import pyomo.environ as pyo
from scipy.spatial import cKDTree

from optplan_models.ordering import mtz

Floats = npt.NDArray[np.float64]
Ints = npt.NDArray[np.int64]

GAP = 1.04
"""A row is split where the gap exceeds this many times the smallest."""
LEVEL = 0.25
"""Circles within this share of the distance between rows are in the same row."""


class Segments(NamedTuple):
    """Circles in rows.

    circles (n,) row by row from the lowest, each from left to right; first (k + 1,): segment s consists of
    circles[first[s]:first[s + 1]]; row (k,) of each segment.
    """

    circles: Ints
    first: Ints
    row: Ints

    @property
    def segment(self) -> Ints:
        """(n,) segment of each circle."""
        segment: Ints = np.empty(len(self.circles), dtype=np.int64)
        segment[self.circles] = np.repeat(np.arange(len(self.row)), np.diff(self.first))
        return segment

    @property
    def ends(self) -> int:
        """Points that are left of the problem: both ends of each segment, one where these are the same."""
        return int(np.minimum(np.diff(self.first), 2).sum())


class Restricted(NamedTuple):
    """A path through segments, as arrays for `mtz.build`.

    cluster (w,) segment of each traversal; enter, leave (w,) its first and last circle; costs (w, w) between
    traversals, infinite where there is no arc; inner (w,) their lengths; precedence (p, 2) between segments.
    """

    segments: Segments
    cluster: Ints
    enter: Ints
    leave: Ints
    costs: Floats
    inner: Floats
    precedence: Ints

    def circles_of(self, nodes: Ints) -> Ints:
        """(n,) the circles along a path of traversals."""
        circles, first = self.segments.circles, self.segments.first
        pieces = []
        for node in nodes.tolist():
            piece = circles[first[self.cluster[node]] : first[self.cluster[node] + 1]]
            pieces.append(piece if piece[0] == self.enter[node] else piece[::-1])
        return np.concatenate(pieces)


def rows_of(points: Floats) -> Ints:
    """(n,) row of each point (n, 2), from the lowest: those within a quarter of the distance between rows."""
    order = np.argsort(points[:, 1], kind="stable")
    steps = np.diff(points[order, 1])
    places = np.unique(points, axis=0)
    if len(places) < 2:
        return np.zeros(len(points), dtype=np.int64)
    distances = np.asarray(cKDTree(places).query(places, 2)[0])
    spacing = float(distances[:, 1].min())
    between = steps[steps > LEVEL * spacing]
    apart = steps > LEVEL * float(np.median(between)) if len(between) else np.zeros(len(steps), dtype=np.bool_)
    rows: Ints = np.empty(len(points), dtype=np.int64)
    rows[order] = np.concatenate([[0], np.cumsum(apart)])
    return rows


def segments(points: Floats) -> Segments:
    """The segments of points (n, 2), m: rows split at their gaps."""
    rows = rows_of(points)
    circles = np.lexsort((points[:, 0], rows)).astype(np.int64)
    steps = np.diff(points[circles, 0])
    new_row = np.diff(rows[circles]) != 0
    inside = steps[~new_row & (steps > 1e-9 * np.ptp(points[:, 0]))]
    cut = new_row | (steps > GAP * inside.min(initial=np.inf))
    return _cut(circles, cut, rows)


def split(given: Segments, precedence: Ints) -> Segments:
    """Segments cut wherever their circles differ in the segments that come directly before or behind them.

    precedence (p, 2): pairs of circles, the first before the second; whether it is closed transitively is no matter.
    """
    count = len(given.circles)
    before = mtz.closure(count, precedence)
    paths = before.astype(np.float32)
    direct = before & ~(paths @ paths > 0)
    member = np.zeros((count, len(given.row)), dtype=np.float32)
    member[np.arange(count), given.segment] = 1.0
    # which segments are directly before and behind each circle
    touched = np.column_stack([direct.T @ member > 0, direct @ member > 0])[given.circles]
    cut = (touched[1:] != touched[:-1]).any(axis=1)
    cut[given.first[1:-1] - 1] = True
    rows = np.empty(count, dtype=np.int64)
    rows[given.circles] = np.repeat(given.row, np.diff(given.first))
    return _cut(given.circles, cut, rows)


def _cut(circles: Ints, cut: npt.NDArray[np.bool_], rows: Ints) -> Segments:
    first = np.concatenate([[0], np.flatnonzero(cut) + 1, [len(circles)]]).astype(np.int64)
    return Segments(circles, first, rows[circles[first[:-1]]])


def restrict(points: Floats, precedence: Ints, *, may_split: bool = False, horizontal: float = 1.0) -> Restricted:
    """The path through segments.

    Parameters
    ----------
    points : (n, 2) m, centres of circles
    precedence : (p, 2) pairs of circles, the first before the second
    may_split : cut segments where precedence changes, and order the pieces by precedence alone; otherwise rows are done
        strictly from the lowest to the highest
    horizontal : weight of horizontal distances between segments: above 1 it favours going straight up

    Raises
    ------
    ValueError : precedence that no path of this kind obeys; says why
    """
    found = split(segments(points), precedence) if may_split else segments(points)
    segment = found.segment
    rows = found.row[segment]
    pairs = np.column_stack([segment[precedence[:, 0]], segment[precedence[:, 1]]])
    if not may_split and (rows[precedence[:, 0]] > rows[precedence[:, 1]]).any():
        a, b = precedence[rows[precedence[:, 0]] > rows[precedence[:, 1]]][0].tolist()
        raise ValueError(f"precedence asks for circle {a} before circle {b}, which lies in a lower row")
    within = precedence[pairs[:, 0] == pairs[:, 1]]
    rightwards = points[within[:, 0], 0] < points[within[:, 1], 0]
    nodes = []
    for s in range(len(found.row)):
        left, right = int(found.circles[found.first[s]]), int(found.circles[found.first[s + 1] - 1])
        allowed = [not (~rightwards & (segment[within[:, 0]] == s)).any()]
        allowed += [left != right and not (rightwards & (segment[within[:, 0]] == s)).any()]
        if not any(allowed):
            raise ValueError(
                f"precedence inside the segment from circle {left} to circle {right} allows neither direction"
            )
        nodes += [way for way, good in zip([(s, left, right), (s, right, left)], allowed, strict=True) if good]
    cluster, enter, leave = np.array(nodes, dtype=np.int64).T
    step = points[leave][:, None] - points[enter][None]
    costs = np.hypot(horizontal * step[..., 0], step[..., 1])
    if not may_split:
        costs[found.row[cluster][:, None] > found.row[cluster]] = np.inf
    lengths = [np.linalg.norm(np.diff(points[piece], axis=0), axis=1).sum() for piece in _pieces(found)]
    outside = np.unique(pairs[pairs[:, 0] != pairs[:, 1]], axis=0).reshape(-1, 2)
    return Restricted(found, cluster, enter, leave, costs, np.array(lengths)[cluster], outside)


def _pieces(given: Segments) -> list[Ints]:
    return np.split(given.circles, given.first[1:-1])


def rows_in_order(given: Segments) -> Ints:
    """(p, 2) segments of each row before those of the next: what forbidding to go down comes to."""
    return np.argwhere(given.row[:, None] + 1 == given.row).astype(np.int64)


def build(restricted: Restricted, start_costs: Floats, end_costs: Floats, *, lifted: bool = False) -> pyo.ConcreteModel:
    """The model with positions over segments, see `mtz.build`; start_costs, end_costs (n,) are those of the circles."""
    return mtz.build(
        restricted.costs,
        restricted.cluster,
        start_costs[restricted.enter],
        end_costs[restricted.leave],
        restricted.inner,
        restricted.precedence,
        lifted=lifted,
    )
