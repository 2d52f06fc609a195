"""A speed profile laid over the pieces of a path."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from optplan.domain.arrays import FloatArray, IntArray
from optplan.domain.path import Path, Trajectory
from optplan.judge._findings import SAME_PLACE


@dataclass(frozen=True, eq=False)
class Speeds:
    """Stretches of one piece and one constant acceleration.

    Parameters
    ----------
    row : (k,) the piece
    begin, end : (k,) arc length on that piece, m
    before, after : (k,) speed at begin and end, m/s; its square is linear in between
    joints : (n + 1,) speed at the beginning of every piece and at the end of the last, m/s
    knots : (m,) arc length of the trajectory's knots, moved onto the joint they stand for, m
    """

    row: IntArray
    begin: FloatArray
    end: FloatArray
    before: FloatArray
    after: FloatArray
    joints: FloatArray
    knots: FloatArray


def speeds(path: Path, trajectory: Trajectory) -> Speeds:
    """Cut the profile at every knot and every joint."""
    offsets = path.offsets
    knots = _snapped(trajectory.s, offsets)
    cuts = np.unique(np.concatenate([knots, offsets])) if len(knots) else np.unique(offsets)
    cuts = cuts[(cuts >= 0) & (cuts <= offsets[-1])]
    squares = np.interp(cuts, knots, trajectory.v**2) if len(knots) else np.zeros(len(cuts))
    v = np.sqrt(squares)
    middle = (cuts[:-1] + cuts[1:]) / 2
    # stops take no length, so the last piece that begins before the middle is the moving one
    row = np.clip(np.searchsorted(offsets, middle, side="right") - 1, 0, max(len(path) - 1, 0))
    base = offsets[row]
    joints = v[np.searchsorted(cuts, offsets)]
    return Speeds(row, cuts[:-1] - base, cuts[1:] - base, v[:-1], v[1:], joints, knots)


def _snapped(knots: FloatArray, offsets: FloatArray) -> FloatArray:
    """Knots that miss a joint by rounding only, put on it."""
    reach = SAME_PLACE + 1e-12 * offsets[-1]
    right = (
        np.clip(np.searchsorted(offsets, knots), 1, len(offsets) - 1) if len(offsets) > 1 else np.zeros(len(knots), int)
    )
    left = np.maximum(right - 1, 0)
    nearest = np.where(np.abs(offsets[left] - knots) <= np.abs(offsets[right] - knots), left, right)
    moved: FloatArray = np.where(np.abs(offsets[nearest] - knots) <= reach, offsets[nearest], knots)
    return moved
