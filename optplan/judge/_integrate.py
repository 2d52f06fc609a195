"""The judge's own dense integration of a path.

Every piece is integrated on its own from its stated start, so that where it ends can be held against where the next one
says it begins. Headings are known in closed form; positions are Gauss-Legendre sums over steps so short (`STEP_ANGLE`)
that the rule is exact to rounding.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from optplan.domain.arrays import FloatArray, IntArray
from optplan.domain.errors import LimitError
from optplan.domain.path import Path

STEP_ANGLE = 0.1
"""rad that the heading may change within one step."""
MAX_SAMPLES = 5_000_000
"""Most samples of one path; more curling than this is refused instead of eating all memory."""
_NODES, _WEIGHTS = np.polynomial.legendre.leggauss(8)
_CHUNK = 200_000


@dataclass(frozen=True, eq=False)
class Samples:
    """A path, sampled and integrated.

    Parameters
    ----------
    points : (k, 3) m, in driving order; each moving piece has its start and its end, a stop one point
    row : (k,) piece that a point belongs to
    along : (k,) arc length from the start of that piece, m
    first : (n + 1,) the points of piece i are first[i] .. first[i + 1] - 1
    ends : (n, 3) m, where each piece ends
    end_heading : (n,) rad, after the turn of a stop
    end_curvature : (n,) 1/m
    """

    points: FloatArray
    row: IntArray
    along: FloatArray
    first: IntArray
    ends: FloatArray
    end_heading: FloatArray
    end_curvature: FloatArray


def largest_curvature(path: Path) -> FloatArray:
    """(n,) largest |kappa| on each piece, 1/m: kappa is linear along a piece, so it is that of an end."""
    with np.errstate(over="ignore"):  # infinite is as good as enormous here
        return np.maximum(np.abs(path.curvature), np.abs(path.curvature + path.sharpness * path.length))


def integrate(path: Path, chord: float) -> Samples:
    """Sample a path.

    Parameters
    ----------
    path : what is driven
    chord : largest distance between the path and the polyline of its samples, m

    Raises
    ------
    LimitError : a path that curls so much that it would need more than `MAX_SAMPLES` samples
    """
    steps = _steps(path, chord)
    count = len(path)
    first = np.concatenate([[0], np.cumsum(steps + 1)])
    row = np.repeat(np.arange(count), steps + 1)
    number = np.arange(first[-1]) - first[row]
    along = path.length[row] * number / np.maximum(steps, 1)[row]

    increments = _increments(path, row, along, number)
    running = np.cumsum(increments, axis=0)
    at_start = running[first[:-1]]  # the increment of a piece's first sample is zero
    points = path.start[row] + running - at_start[row]
    ends = points[first[1:] - 1]
    end_curvature = path.curvature + path.sharpness * path.length
    end_heading = path.heading + (path.curvature + path.sharpness * path.length / 2) * path.length + path.turn
    return Samples(points, row, along, first, ends, end_heading, end_curvature)


def _steps(path: Path, chord: float) -> IntArray:
    """(n,) steps of each piece: 0 for a stop, 1 for a straight one."""
    bend = largest_curvature(path)
    with np.errstate(over="ignore"):
        by_angle = bend * path.length / STEP_ANGLE
        by_chord = path.length * np.sqrt(bend / (8 * chord))
    wanted = np.ceil(np.maximum(by_angle, by_chord))
    least = np.where(path.is_stop, 0, 1)
    steps = np.maximum(wanted, least)
    total = float(steps.sum()) + len(path)
    if not total <= MAX_SAMPLES:
        worst = int(np.argmax(steps))
        raise LimitError(
            f"path piece {worst} curls too much to be judged: the path would need {total:.3g} samples, "
            f"the limit is {MAX_SAMPLES}"
        )
    return steps.astype(np.int64)


def _increments(path: Path, row: IntArray, along: FloatArray, number: IntArray) -> FloatArray:
    """(k, 3) m from the sample before on the same piece; 0 for the first of a piece."""
    increments = np.zeros((len(row), 3))
    moving = np.flatnonzero(number > 0)
    for begin in range(0, len(moving), _CHUNK):
        at = moving[begin : begin + _CHUNK]
        piece = row[at]
        half = (along[at] - along[at - 1]) / 2
        s = along[at - 1][:, None] + half[:, None] * (_NODES + 1)
        theta = (
            path.heading[piece][:, None] + (path.curvature[piece][:, None] + path.sharpness[piece][:, None] * s / 2) * s
        )
        level = half * np.cos(path.elevation[piece])
        increments[at, 0] = level * (np.cos(theta) @ _WEIGHTS)
        increments[at, 1] = level * (np.sin(theta) @ _WEIGHTS)
        increments[at, 2] = 2 * half * np.sin(path.elevation[piece])
    return increments
