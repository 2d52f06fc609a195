"""How near robots of a fleet come to each other."""

from __future__ import annotations

import math
from collections.abc import Sequence
from itertools import combinations

import numpy as np

from optplan.domain.arrays import FloatArray
from optplan.domain.result import Plan
from optplan.judge._integrate import integrate

STEP = 0.05
"""s between the moments that are looked at."""
_CHORD = 1e-3


def nearest_approach(plans: Sequence[Plan], starts: Sequence[float]) -> tuple[float, float, tuple[float, float] | None]:
    """Least distance between two robots at one time, middle to middle (m), when (s) and where that is.

    A robot stands at its beginning until it sets off (`starts`, s), and at its end when it has finished. Infinite for
    fewer than two robots that move.
    """
    tracks = [_track(plan) for plan in plans]
    durations = [0.0 if plan.trajectory is None else plan.trajectory.duration for plan in plans]
    ends = [start + duration for start, duration in zip(starts, durations, strict=True)]
    best: tuple[float, float, tuple[float, float] | None] = (math.inf, 0.0, None)
    time = np.arange(0.0, max(ends, default=0.0) + STEP, STEP)
    places = [None if track is None else _at(track, time - start) for track, start in zip(tracks, starts, strict=True)]
    for one, other in combinations([place for place in places if place is not None], 2):
        away = np.hypot(*(one - other).T)
        k = int(np.argmin(away))
        if away[k] < best[0]:
            best = float(away[k]), float(time[k]), (float(one[k, 0]), float(one[k, 1]))
    return best


def _track(plan: Plan) -> tuple[FloatArray, FloatArray] | None:
    """Times (k,) and places (k, 2) along a plan, by the judge's own integration."""
    path, trajectory = plan.path, plan.trajectory
    if path is None or trajectory is None or len(path) == 0:
        return None
    samples = integrate(path, _CHORD)
    s = path.offsets[samples.row] + samples.along
    inner = np.concatenate([[True], np.diff(s) > 0])
    s, places = s[inner], samples.points[inner, :2]
    # times at which the samples are passed: within an interval of constant acceleration s = v t + a t^2 / 2
    knots, t, v = trajectory.s, trajectory.t, trajectory.v
    k = np.clip(np.searchsorted(knots, s, side="right") - 1, 0, len(knots) - 2)
    gone, step = s - knots[k], np.maximum(t[k + 1] - t[k], 1e-12)
    rate = (v[k + 1] - v[k]) / step
    speed = np.sqrt(np.maximum(v[k] ** 2 + 2 * rate * gone, 0))
    passed = t[k] + np.where(v[k] + speed > 0, 2 * gone / np.maximum(v[k] + speed, 1e-12), 0.0)
    return np.append(passed, t[-1]), np.concatenate([places, samples.ends[-1:, :2]])


def _at(track: tuple[FloatArray, FloatArray], time: FloatArray) -> FloatArray:
    times, places = track
    return np.column_stack([np.interp(time, times, places[:, axis]) for axis in (0, 1)])
