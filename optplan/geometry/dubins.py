"""Dubins paths: the shortest way of a car that only drives forwards with a least turning radius."""

from __future__ import annotations

import math
from typing import NamedTuple

import numpy as np

from optplan.domain.arrays import FloatArray
from optplan.domain.errors import InputError

WORDS = ("LSL", "RSR", "LSR", "RSL", "RLR", "LRL")
_SIGN = {"L": 1.0, "S": 0.0, "R": -1.0}


class DubinsPath(NamedTuple):
    """A shortest path: its word and up to three parts that are not empty."""

    word: str
    length: float
    curvatures: tuple[float, ...]
    """1/m, of each part"""
    lengths: tuple[float, ...]
    """m, of each part"""


def dubins_path(start: FloatArray, end: FloatArray, radius: float) -> DubinsPath:
    """The shortest of all six words.

    Parameters
    ----------
    start, end : (3,) x, y, heading: m, m, rad
    radius : least turning radius, m, > 0

    Raises
    ------
    InputError : a radius that is not above 0, or a state that is not finite
    """
    from optplan.geometry._kernels.dubins import dubins_shortest

    _checked(start, end, radius)
    x0, y0, t0 = map(float, start)
    x1, y1, t1 = map(float, end)
    length, word, *parts = dubins_shortest(x0, y0, t0, x1, y1, t1, float(radius))
    name = WORDS[word]
    rows = [(_SIGN[letter] / radius, part * radius) for letter, part in zip(name, parts, strict=True) if part > 0]
    return DubinsPath(name, length, tuple(row[0] for row in rows), tuple(row[1] for row in rows))


def dubins_lengths(starts: FloatArray, ends: FloatArray, radius: float) -> FloatArray:
    """Lengths (k,) m of shortest paths between rows x, y, heading of (k, 3) arrays. Raises like `dubins_path`."""
    from optplan.geometry._kernels import dubins as _kernels

    _checked(starts, ends, radius)
    lengths: FloatArray = _kernels.dubins_lengths(
        np.ascontiguousarray(starts, dtype=np.float64), np.ascontiguousarray(ends, dtype=np.float64), float(radius)
    )
    return lengths


def _checked(start: FloatArray, end: FloatArray, radius: float) -> None:
    if not (math.isfinite(radius) and radius > 0):
        raise InputError(f"the turning radius is {radius} m; expected a finite number above 0")
    if not (np.isfinite(start).all() and np.isfinite(end).all()):
        raise InputError("a state of a Dubins path is not finite; expected x, y, heading")
