"""Drawn polylines as curves of continuous curvature (G2), within a tolerance and the limits of who drives them.

Between corners a polyline is sampled at equal steps, each sample moves sideways by at most the tolerance so that the
curvature changes as little as possible (a quadratic programme), and a spline of clothoids is put through them. Where no
such curve exists within the limits, the polyline is cut: there the robot has to stop.
"""

from __future__ import annotations

import math
from functools import lru_cache
from itertools import pairwise
from typing import Any, NamedTuple

import numpy as np

from optplan.domain.arrays import FloatArray, IntArray
from optplan.geometry.curves import Curve, evaluate, sampled_curve
from optplan.geometry.rounding import STRAIGHT, wrapped
from optplan.geometry.splines import OVERLAP, euler_splines

SHARE = 0.8
"""Of the tolerance that samples may use: between them a curve strays a little more."""
MARGIN = 0.97
"""Of the limits that turning angles may use, for the same reason."""
MORE = 1.05
"""What was too much by a share is lowered by so much more."""
LEAST, MOST = 6, 20_000
"""Samples of a run."""
PENALTY = 1e4
"""Of a broken limit, against the square of all change of curvature in units of what is allowed between samples."""
BROKEN = 1e-4
"""A limit broken by less, as a share of it, is rounding of the solver."""
FEW = 8
"""Up to so many stretches that break a limit are cut one after the other; more of them all at once, to save time."""
_ROUNDS = 5
"""Attempts to make a curve keep between its samples what it keeps at them."""


class Smoothed(NamedTuple):
    """A polyline made drivable."""

    curves: tuple[Curve, ...]
    """in driving order, each G2 and within the limits; between two of them the robot stops, and turns where they differ
    in heading"""
    stops: IntArray
    """(k,) the vertex at which each curve begins; empty for a ring without a stop: its one curve begins at vertex 0 and
    ends as it begins"""


def smoothed(
    points: FloatArray, closed: bool, tolerance: float, kappa_max: float, sigma_max: float, corner: float
) -> Smoothed:
    """A polyline as G2 curves within the limits, with few stops between them.

    Parameters
    ----------
    points : (n, 2) m, consecutive ones apart, n >= 2 (3 when closed)
    closed : whether the last joins the first. A ring with corners begins at the first of them
    tolerance : greatest distance between the polyline and the curves, m
    kappa_max, sigma_max : 1/m and 1/m^2; infinite where nothing limits them
    corner : deflection above which a vertex is a corner, rad
    """
    count = len(points)
    ring = np.concatenate([points[-1:], points, points[:1]]) if closed else points
    steps = np.diff(ring, axis=0)
    bend = np.abs(wrapped(np.diff(np.arctan2(steps[:, 1], steps[:, 0]))))
    corners: list[int] = (np.flatnonzero(bend > corner) + (0 if closed else 1)).tolist()
    if closed and not corners:
        made, cut = _run(ring[1:], True, tolerance, kappa_max, sigma_max)
        if made is not None:
            return Smoothed((made,), np.zeros(0, dtype=np.int64))
        corners = sorted(k % count for k in cut)
    if closed:
        points = np.concatenate([points, points, points[:1]])
        ends = [*corners, corners[0] + count]
    else:
        ends = [0, *corners, count - 1]
    curves: list[Curve] = []
    stops: list[int] = []
    waiting = list(pairwise(ends))[::-1]
    while waiting:
        low, high = waiting.pop()
        made, cut = _run(points[low : high + 1], False, tolerance, kappa_max, sigma_max)
        if made is None:
            waiting += list(pairwise([low, *(low + k for k in cut), high]))[::-1]
        else:
            curves.append(made)
            stops.append(low % count)
    return Smoothed(tuple(curves), np.array(stops, dtype=np.int64))


def _run(
    points: FloatArray, closed: bool, tolerance: float, kappa_max: float, sigma_max: float
) -> tuple[Curve | None, list[int]]:
    """A G2 curve along a polyline without corners; or None, and the vertices at which it has to be cut.

    A ring (`closed`) repeats its first point at the end.
    """
    steps = np.diff(points, axis=0)
    lengths = np.hypot(steps[:, 0], steps[:, 1])
    heading = np.arctan2(steps[:, 1], steps[:, 0])
    bend = wrapped(np.diff(heading))
    if not closed and np.abs(bend).max(initial=0.0) <= STRAIGHT:
        step = points[-1] - points[0]
        start = np.array([*points[0], math.atan2(step[1], step[0])])
        return Curve(start, np.zeros(1), np.zeros(1), np.array([math.hypot(*step)])), []
    at = np.concatenate([[0.0], np.cumsum(lengths)])
    count = _samples(bend, lengths, tolerance)
    share, bent, steep = SHARE, MARGIN * kappa_max, MARGIN * sigma_max
    for _ in range(_ROUNDS):
        s = np.linspace(0, at[-1], count + 1)
        places = np.column_stack([np.interp(s, at, points[:, k]) for k in (0, 1)])
        moved, excess = least_change(places, closed, share * tolerance, bent, steep)
        if excess.max() > BROKEN:
            return None, _cuts(at, s, excess)
        curve = _spline(moved, closed)
        if curve is not None:
            # by how much the curve between the samples breaks what holds at them
            over = [_deviation(curve, points) / tolerance, curve.max_curvature / kappa_max]
            over.append(curve.max_sharpness / sigma_max)
            if max(over) <= 1:
                return curve, []
            share, bent, steep = (x / max(1.0, MORE * y) for x, y in zip((share, bent, steep), over, strict=True))
        # finer samples leave less between them
        count = min(3 * count // 2, MOST)
    # no curve is known to exist: cut at the sharpest vertex
    return None, [int(np.argmax(np.abs(bend))) + 1]


def _samples(bend: FloatArray, lengths: FloatArray, tolerance: float) -> int:
    """How many steps resolve the shortest change of curvature that the tolerance leaves room for.

    A ramp of length l instead of a step by kappa leaves the line by kappa l^2 / 24 (twice integrated).
    """
    kappa = float((2 * np.abs(bend) / (lengths[:-1] + lengths[1:])).max(initial=0.0))
    ramp = math.sqrt(24 * tolerance / kappa) if kappa > 0 else math.inf
    return int(min(max(LEAST, math.ceil(2 * float(lengths.sum()) / ramp)), MOST))


def least_change(
    places: FloatArray, closed: bool, tolerance: float, kappa_max: float, sigma_max: float
) -> tuple[FloatArray, FloatArray]:
    """Samples moved sideways so that curvature changes least.

    With offsets e to the left, turning angles tau and the step h, the curvature is
    tau_j / h + (e_{j-1} - 2 e_j + e_{j+1}) / h^2. The sum of squares of its differences is minimised for |e| within the
    tolerance; limits may be broken at a price that no smoothness pays. The ends of an open line stay where they are.

    Parameters
    ----------
    places : (n + 1, 2) m, at equal steps; those of a ring (`closed`) repeat the first
    tolerance, kappa_max, sigma_max : m, 1/m, 1/m^2

    Returns
    -------
    moved (n + 1, 2) m, and by which share a limit is broken at each of them (n + 1,): negative where none is
    """
    step = np.diff(places, axis=0)
    h = float(np.hypot(step[:, 0], step[:, 1]).mean())
    heading = np.arctan2(step[:, 1], step[:, 0])
    if closed:
        turning, chord = wrapped(heading - np.roll(heading, 1)), np.roll(step, 1, axis=0) + step
    else:
        turning, chord = wrapped(np.diff(heading)), step[1:] + step[:-1]
    size = len(turning)  # of the offsets, and of the curvatures
    programme = _programme(size, closed, math.isfinite(kappa_max), math.isfinite(sigma_max))
    # turning in units of what the tolerance can turn, so that all numbers are near 1
    unit = tolerance / h
    base = turning / unit
    most, steepest = kappa_max * h / unit, sigma_max * h * h / unit
    begun = np.roll(base, -1) - base if closed else np.diff(base)
    offset = programme.solve(base, begun, most, steepest)
    along = np.hypot(chord[:, 0], chord[:, 1])[:, None]
    normal = np.column_stack([-chord[:, 1], chord[:, 0]]) / np.where(along > 0, along, 1.0)
    moved, broken = places.copy(), np.full(len(places), -1.0)
    own = slice(0, size) if closed else slice(1, size + 1)
    moved[own] += tolerance * offset[:, None] * normal
    broken[own] = np.abs(base + programme.second @ offset) / most - 1
    jump = np.abs(begun + programme.change @ offset) / steepest - 1
    broken[own][: len(jump)] = np.maximum(broken[own][: len(jump)], jump)
    if closed:
        moved[-1], broken[-1] = moved[0], broken[0]
    return moved, broken


class _Programme(NamedTuple):
    """min |begun + change e|^2 / 2 + PENALTY sum(excess), as matrices; all of it but `begun` and the limits is fixed.

    -1 <= e <= 1; |base + second e| <= most + x; |begun + change e| <= steepest + y; x, y >= 0
    """

    second: Any
    """(n, n) second differences of offsets"""
    change: Any
    """(c, n) third differences: what curvature changes by"""
    square: Any
    table: Any
    limited: tuple[bool, bool]
    """whether there is a limit of curvature, and of its change"""

    def solve(self, base: FloatArray, begun: FloatArray, most: float, steepest: float) -> FloatArray:
        """The offsets (n,)."""
        import clarabel

        size = len(base)
        right = [np.ones(2 * size)]
        if self.limited[0]:
            right += [most - base, most + base, np.zeros(size)]
        if self.limited[1]:
            right += [steepest - begun, steepest + begun, np.zeros(len(begun))]
        bounds = np.concatenate(right)
        price = np.full(self.table.shape[1], PENALTY)
        price[:size] = self.change.T @ begun
        settings = clarabel.DefaultSettings()
        settings.verbose = False
        cones = [clarabel.NonnegativeConeT(len(bounds))]
        answer = clarabel.DefaultSolver(self.square, price, self.table, bounds, cones, settings).solve()
        offset: FloatArray = np.clip(np.nan_to_num(np.array(answer.x)[:size]), -1, 1)
        return offset


@lru_cache(maxsize=256)
def _programme(size: int, closed: bool, bent: bool, steep: bool) -> _Programme:
    from scipy import sparse

    second = _stencil(((-1, 1.0), (0, -2.0), (1, 1.0)), size, size, closed)
    changes = size if closed else size - 1
    change = _stencil(((-1, -1.0), (0, 3.0), (1, -3.0), (2, 1.0)), changes, size, closed)
    entries = [(np.arange(2 * size), np.tile(np.arange(size), 2), np.repeat([1.0, -1.0], size))]
    row, column = 2 * size, size
    for limited, matrix in ((bent, second), (steep, change)):
        if not limited:
            continue
        count, (i, j, value) = matrix.shape[0], (matrix.row, matrix.col, matrix.data)
        own = np.arange(count)
        for part, sign in enumerate((1.0, -1.0)):
            entries.append((row + part * count + i, j, sign * value))
        entries += [(row + part * count + own, column + own, np.full(count, -1.0)) for part in range(3)]
        row, column = row + 3 * count, column + count
    rows, columns, values = (np.concatenate(part) for part in zip(*entries, strict=True))
    table = sparse.csc_matrix((values, (rows, columns)), shape=(row, column))
    third = change.tocsc()
    half = sparse.triu(third.T @ third).tocoo()
    square = sparse.csc_matrix((half.data, (half.row, half.col)), shape=(column, column))
    return _Programme(second.tocsr(), third, square, table, (bent, steep))


def _stencil(parts: tuple[tuple[int, float], ...], rows: int, columns: int, closed: bool) -> Any:
    """A sparse matrix with the same few numbers around the diagonal in every row, cut off at the ends or round them."""
    from scipy import sparse

    i = np.tile(np.arange(rows), len(parts))
    j = np.concatenate([np.arange(rows) + shift for shift, _ in parts])
    value = np.repeat([number for _, number in parts], rows)
    if closed:
        j %= columns
    keep = (j >= 0) & (j < columns)
    return sparse.coo_matrix((value[keep], (i[keep], j[keep])), shape=(rows, columns))


def _cuts(at: FloatArray, s: FloatArray, excess: FloatArray) -> list[int]:
    """The inner vertices nearest to the worst sample of each stretch on which a limit is broken, in order."""
    broken = excess > BROKEN
    edges = np.flatnonzero(np.diff(np.concatenate([[False], broken, [False]])))
    worst = [low + int(np.argmax(excess[low:high])) for low, high in edges.reshape(-1, 2).tolist()]
    if len(worst) <= FEW:  # a cut relieves its neighbours too
        worst = [max(worst, key=lambda k: excess[k])]
    return sorted({int(np.argmin(np.abs(at[1:-1] - s[k]))) + 1 for k in worst})


def _spline(places: FloatArray, closed: bool) -> Curve | None:
    """A G2 curve through samples (n + 1, 2); None when none was found."""
    n = len(places) - 1
    lap = OVERLAP if closed else 0
    along = places[np.arange(-lap, n + lap + 1) % n] if closed else places
    free = np.array([np.nan])
    made = euler_splines(along[None], free, free, round_ends=True)
    if not made.converged[0]:
        return None
    own = slice(lap, lap + n)
    start = np.array([*places[0], made.heading[0, lap]])
    return Curve(start, made.curvature[0, own], made.sharpness[0, own], made.length[0, own])


def _deviation(curve: Curve, points: FloatArray) -> float:
    """Greatest distance between a curve and its polyline, looked at from both, m."""
    import shapely

    dense = evaluate(curve, sampled_curve(curve, max(1e-9, 1e-6 * curve.total))).points
    there = shapely.distance(shapely.LineString(points), shapely.points(dense))
    back = shapely.distance(shapely.LineString(dense), shapely.points(points))
    return float(max(there.max(), back.max()))
