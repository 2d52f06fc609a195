"""Curves to polylines."""

from __future__ import annotations

import math

import numpy as np

from optplan.domain.arrays import FloatArray
from optplan.domain.errors import InputError, LimitError
from optplan.domain.job import Curve

MAX_POINTS = 5_000_000
"""points of one flattened curve"""


def flatten(curve: Curve, tolerance: float) -> FloatArray:
    """The polyline through points of a curve that is nowhere further from it than a tolerance.

    Each cubic is cut into n pieces of equal parameter length, so points lie denser where it is more curved. Between
    parameters 1/n apart a curve B is at most max |B''| / (8 n^2) from its chord, and B'' of a cubic is largest at an
    end, where it is 6 times a second difference of the control points: n follows.

    Parameters
    ----------
    curve : to flatten
    tolerance : largest distance between curve and polyline, m

    Returns
    -------
    (n, 2) m; a closed curve does not repeat its first point; no point equals its predecessor

    Raises
    ------
    InputError : the tolerance is not above 0
    LimitError : more than `MAX_POINTS` points are needed
    """
    if not (math.isfinite(tolerance) and tolerance > 0):
        raise InputError(f"the tolerance is {tolerance} m; expected a finite number above 0")
    points = curve.points
    if curve.handles is not None:
        points = _subdivided(curve.points, curve.handles, curve.closed, tolerance)
    keep = np.any(np.diff(points, axis=0) != 0, axis=1)
    points = np.concatenate([points[:1], points[1:][keep]])
    if curve.closed and len(points) > 1 and np.array_equal(points[0], points[-1]):
        points = points[:-1]
    return points


def _subdivided(vertices: FloatArray, handles: FloatArray, closed: bool, tolerance: float) -> FloatArray:
    starts = vertices if closed else vertices[:-1]
    ends = np.roll(vertices, -1, axis=0) if closed else vertices[1:]
    first, second = handles[:, 0], handles[:, 1]
    bends = np.stack([starts - 2 * first + second, first - 2 * second + ends])
    bound = 6 * np.hypot(bends[..., 0], bends[..., 1]).max(axis=0)
    with np.errstate(over="ignore"):
        wanted = np.maximum(1.0, np.ceil(np.sqrt(bound / (8 * tolerance))))
    if not wanted.sum() <= MAX_POINTS:
        raise LimitError(f"a tolerance of {tolerance:g} m takes more than {MAX_POINTS} points, which is the limit")
    counts = wanted.astype(np.int64)
    segment = np.repeat(np.arange(len(counts)), counts)
    step = np.arange(len(segment)) - np.repeat(np.cumsum(counts) - counts, counts)
    t = (step / counts[segment])[:, None]
    u = 1 - t
    inside = (
        u**3 * starts[segment] + 3 * u**2 * t * first[segment] + 3 * u * t**2 * second[segment] + t**3 * ends[segment]
    )
    # the vertices themselves, free of rounding
    inside[step == 0] = starts
    result: FloatArray = inside if closed else np.concatenate([inside, ends[-1:]])
    return result
