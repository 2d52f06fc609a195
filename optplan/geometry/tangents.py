"""Lines and arcs that meet tangentially, as one curve of continuous curvature."""

from __future__ import annotations

import math

import numpy as np

from optplan.domain.arrays import FloatArray
from optplan.geometry.curves import Curve
from optplan.geometry.rounding import wrapped

SAME = 1e-9
"""Curvatures that differ by less, as a share of the limit that a metre allows, are one."""
CLOSE = 1e-12
"""m: the end is where it should be."""
_ROUNDS = 12


def eased(points: FloatArray, bends: FloatArray, closed: bool, sharpness: float) -> Curve | None:
    """One curve along lines and arcs that meet tangentially; where the curvature steps it changes at `sharpness`.

    A ramp of length l instead of a step by kappa moves what follows by about kappa l^2 / 24. The lines and arcs are
    stretched by as little as makes the curve end where it should.

    Parameters
    ----------
    points : (n, 2) m; those along an arc lie on it
    bends : (n - 1,) or, closed, (n,) 1/m: curvature between each point and the next
    closed : the last joins the first, where the curvature does not step
    sharpness : limit of the change of curvature, 1/m^2; infinite: it may step

    Returns
    -------
    the curve, or None when a line or an arc is shorter than its ramps
    """
    ring = np.concatenate([points, points[:1]]) if closed else points
    steps = np.diff(ring, axis=0)
    chord = np.hypot(steps[:, 0], steps[:, 1])
    half = np.arcsin(np.clip(bends * chord / 2, -1, 1))
    with np.errstate(divide="ignore", invalid="ignore"):
        length = np.where(bends == 0, chord, 2 * half / bends)
    heading = math.atan2(steps[0, 1], steps[0, 0]) - half[0]
    # neighbours of one curvature are one piece
    first = np.flatnonzero(np.abs(np.diff(bends, prepend=np.inf)) > SAME * min(sharpness, 1.0))
    curvature, pieces = bends[first], np.add.reduceat(length, first)
    start = np.array([*points[0], heading])
    if len(first) == 1 or math.isinf(sharpness):
        return Curve(start, curvature, np.zeros(len(first)), pieces)
    ramp = np.abs(np.diff(curvature)) / sharpness
    scale = np.ones(len(first))
    for _ in range(_ROUNDS):
        bend, size = curvature / scale, pieces * scale
        ramp = np.abs(np.diff(bend)) / sharpness
        core = size - (np.append(ramp, 0.0) + np.append(0.0, ramp)) / 2
        if (core <= 0).any():
            return None
        made = _with_ramps(start, bend, core, ramp)
        miss = ring[-1] - made.end[:2]
        if np.abs(miss).max() <= CLOSE:
            break
        # stretched, a piece keeps its headings: so the end moves by as much of the piece's own displacement
        moves = np.diff(made.states[:, :2], axis=0)[::2].T
        scale = scale * (1 + np.linalg.lstsq(moves, miss, rcond=None)[0])
    return made


def _with_ramps(start: FloatArray, bend: FloatArray, core: FloatArray, ramp: FloatArray) -> Curve:
    count = 2 * len(bend) - 1
    curvature, sharpness, length = np.empty(count), np.zeros(count), np.empty(count)
    curvature[::2], curvature[1::2] = bend, bend[:-1]
    length[::2], length[1::2] = core, ramp
    sharpness[1::2] = np.diff(bend) / ramp
    return Curve(start, curvature, sharpness, length)


def meets(heading: float, other: float, tolerance: float) -> bool:
    """Whether two headings are the same within a tolerance, rad."""
    return bool(abs(float(wrapped(np.array([heading - other]))[0])) <= tolerance)
