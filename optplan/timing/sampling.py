"""Time and speed along a trajectory."""

from __future__ import annotations

import numpy as np

from optplan.domain.arrays import BoolArray, FloatArray
from optplan.domain.path import Trajectory


def begins(trajectory: Trajectory) -> FloatArray:
    """(n + 1,) s, when every piece of the path begins, and when the last one ends.

    Stops that follow each other at one place share the time spent there: each has its dwell, and of what is left a part
    as large as its turn.
    """
    path, count = trajectory.path, len(trajectory.path)
    if count == 0:
        return trajectory.t[-1:].copy()
    come, _ = moments(trajectory, path.offsets, np.ones(count + 1, dtype=np.bool_))
    gone, _ = moments(trajectory, path.offsets, np.zeros(count + 1, dtype=np.bool_))
    stop = path.is_stop
    found = np.append(np.where(stop, come[:-1], gone[:-1]), trajectory.t[-1])
    several = stop[:-1] & stop[1:] & ~np.append(False, stop[:-2])
    for first in np.flatnonzero(several).tolist():
        moving = np.flatnonzero(~stop[first:])
        rows = np.arange(first, first + moving[0] if len(moving) else count)
        turn = np.abs(path.turn[rows])
        rest = max(float(gone[first] - come[first] - path.dwell[rows].sum()), 0.0)
        taken = path.dwell[rows] + (rest * turn / turn.sum() if turn.any() else 0.0)
        found[rows[1:]] = np.minimum(come[first] + np.cumsum(taken)[:-1], gone[first])
    return found


def moments(trajectory: Trajectory, s: FloatArray, arriving: BoolArray) -> tuple[FloatArray, FloatArray]:
    """Time (k,) s and speed (k,) m/s at arc lengths s (k,) m.

    Where the robot waits, one arc length has two times: `arriving` (k,) picks the earlier one.
    """
    knots = trajectory.s
    late = np.searchsorted(knots, s, side="right") - 1
    early = np.searchsorted(knots, s, side="left")
    # arriving: the first knot at s when there is one; else, like leaving, the interval that s lies in
    exact = (early < len(knots)) & (knots[np.minimum(early, len(knots) - 1)] == s)
    first = np.clip(np.where(arriving & exact, early, late), 0, len(knots) - 1)
    following = np.minimum(first + 1, len(knots) - 1)
    run = knots[following] - knots[first]
    into = np.where(run > 0, s - knots[first], 0.0)
    v0, v1 = trajectory.v[first], trajectory.v[following]
    share = np.divide(into, run, out=np.zeros_like(into), where=run > 0)
    v = np.sqrt(v0**2 + share * (v1**2 - v0**2))
    mean = (v0 + v) / 2
    t = trajectory.t[first] + np.divide(into, mean, out=np.zeros_like(into), where=mean > 0)
    return t, v
