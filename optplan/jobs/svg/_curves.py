"""From subpaths in an element's coordinates to curves in metres: transform, tidy up, close what is nearly closed."""

from __future__ import annotations

from typing import NamedTuple

import numpy as np
import numpy.typing as npt

from optplan.domain.arrays import FloatArray
from optplan.domain.errors import InputError
from optplan.domain.job import Curve
from optplan.jobs.svg._path import Subpath
from optplan.jobs.svg._transform import Matrix

Complexes = npt.NDArray[np.complex128]
SAME = 1e-10
"""points closer than this part of the largest coordinate are one: rounding of relative commands"""
SNAP = 0.01
"""a gap of this part of what may be closed vanishes; a larger one becomes a line"""
GAP_PART = 0.05
"""a gap of this part of a subpath's length, or more, is meant"""


class Made(NamedTuple):
    """The curves of one element.

    Parameters
    ----------
    curves : those that have a length
    dropped : number of subpaths without a length
    joined : number of subpaths closed because their ends nearly met
    """

    curves: tuple[Curve, ...]
    dropped: int
    joined: int


def make_curves(subpaths: list[Subpath], matrix: Matrix, close_gap: float) -> Made:
    """Curves in metres.

    Parameters
    ----------
    subpaths : in the element's coordinates
    matrix : from there to metres
    close_gap : ends at most this far apart are joined, m

    Raises
    ------
    InputError : the transform makes coordinates infinite
    """
    curves, dropped, joined = [], 0, 0
    for subpath in subpaths:
        made = _curve(subpath, matrix, close_gap)
        if made is None:
            dropped += 1
            continue
        curves.append(made[0])
        joined += made[1]
    return Made(tuple(curves), dropped, joined)


def _curve(subpath: Subpath, matrix: Matrix, close_gap: float) -> tuple[Curve, bool] | None:
    count = len(subpath.handles)
    if count == 0:
        return None
    pairs = [pair for pair in subpath.handles if pair is not None]
    flat = [*subpath.points, *(point for pair in pairs for point in pair)]
    placed = _placed(np.array(flat, dtype=np.complex128), matrix)
    points = placed[: count + 1]
    # `inner` holds the two inner control points of each segment; those of lines at thirds
    inner = placed[count + 1 :].reshape(-1, 2) if pairs else None
    if inner is not None and len(pairs) < count:
        given, inner = inner, _thirds(points, closed=False)
        inner[[pair is not None for pair in subpath.handles]] = given
    small = SAME * float(np.abs(points).max())
    points, inner = _without_duplicates(points, inner, small)
    if len(points) < 2:
        return None
    closed, joined = subpath.closed, False
    ends_meet = bool(abs(points[0] - points[-1]) <= small)
    if not closed and (len(points) > 3 or inner is not None):
        joined = not ends_meet and _nearly_closed(points, inner, close_gap)
        closed = joined or ends_meet
        # a rounding error of the file needs no segment of its own
        ends_meet = ends_meet or (joined and bool(abs(points[0] - points[-1]) <= SNAP * close_gap))
    if closed and ends_meet and len(points) > 2:
        points = points[:-1]
    elif closed and inner is not None:
        a, b = points[-1], points[0]
        inner = np.concatenate([inner, [[(2 * a + b) / 3, (a + 2 * b) / 3]]])
    if inner is not None and len(pairs) < count and np.abs(inner - _thirds(points, closed)).max() <= small:
        # the only curves had no length
        inner = None
    handles = None if inner is None else _pairs(inner)
    return Curve(_pairs(points), handles, closed), joined


def _placed(values: Complexes, matrix: Matrix) -> Complexes:
    a, b, c, d, e, f = matrix
    with np.errstate(over="ignore", invalid="ignore"):
        x, y = values.real, values.imag
        placed: Complexes = (a * x + c * y + e) + 1j * (b * x + d * y + f)
    if not np.isfinite(placed).all():
        raise InputError("the transforms make its coordinates infinite; expected finite ones")
    return placed


def _pairs(values: Complexes) -> FloatArray:
    """Complex numbers as a last axis of x and y."""
    return np.ascontiguousarray(values).view(np.float64).reshape(*values.shape, 2)


def _thirds(points: Complexes, closed: bool) -> Complexes:
    starts = points if closed else points[:-1]
    ends = np.roll(points, -1) if closed else points[1:]
    thirds: Complexes = np.column_stack([(2 * starts + ends) / 3, (starts + 2 * ends) / 3])
    return thirds


def _without_duplicates(points: Complexes, inner: Complexes | None, small: float) -> tuple[Complexes, Complexes | None]:
    """Drop segments without a length; a loop that returns to where it began is cut in two, which keeps its shape."""
    if inner is None:
        keep = np.abs(np.diff(points)) > small
        return np.concatenate([points[:1], points[1:][keep]]), None
    starts, ends = points[:-1], points[1:]
    apart = np.abs(ends - starts) > small
    if apart.all():
        return points, inner
    loop = ~apart & (np.max(np.abs(inner - starts[:, None]), axis=1) > small)
    if not loop.any():
        return np.concatenate([points[:1], ends[apart]]), inner[apart]
    places, pairs = [points[0]], []
    for p, (q, r), s, moves, loops in zip(starts, inner, ends, apart, loop, strict=True):
        if loops:
            first, middle, last = (p + q) / 2, (p + 3 * q + 3 * r + s) / 8, (r + s) / 2
            pairs += [[first, (first + (q + r) / 2) / 2], [((q + r) / 2 + last) / 2, last]]
            places += [middle, s]
        elif moves:
            pairs.append([q, r])
            places.append(s)
    return np.array(places), np.array(pairs).reshape(-1, 2)


def _nearly_closed(points: Complexes, inner: Complexes | None, close_gap: float) -> bool:
    gap = abs(points[0] - points[-1])
    if gap > close_gap:
        return False
    chord = float(np.sum(np.abs(np.diff(points))))
    if inner is not None:
        polygon = np.column_stack([points[:-1], inner, points[1:]])
        # a Bezier is longer than its chord and shorter than its control polygon
        chord = (chord + float(np.sum(np.abs(np.diff(polygon, axis=1))))) / 2
    return bool(gap < GAP_PART * chord)


def is_area(curves: tuple[Curve, ...]) -> bool:
    """Whether filling the curves could paint anything: some vertex or handle is off a straight line."""
    return any(curve.handles is not None or len(curve.points) > 2 for curve in curves)
