"""Time and speed along a trajectory."""

from __future__ import annotations

import numpy as np

from optplan.domain.arrays import BoolArray, FloatArray
from optplan.domain.path import Trajectory


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
