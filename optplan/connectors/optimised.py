"""Connectors by optimisation: the best of several local optima, and never worse than the path they begin with."""

from __future__ import annotations

from typing import TYPE_CHECKING, NamedTuple

import numpy as np

from optplan.domain.arrays import FloatArray
from optplan.geometry.cc import cc_path
from optplan.geometry.curves import Curve
from optplan.geometry.dubins import dubins_path

if TYPE_CHECKING:
    from optplan_models.connector import Objective, Pace

ROOM = 1.5
"""A smoother path may be so many times as long as the shortest one known."""
SOLVERS = ("fatrop", "ipopt")
"""Tried in this order: the second one only where the first finds nothing."""


class Optimised(NamedTuple):
    """A connector and what is known about it."""

    curve: Curve
    value: float
    """m, s or 1/m, as asked"""
    source: str
    """who found it: "cc", the path begun with, or a solver and the guess it began with"""
    converged: bool
    """whether any solver ended in a local optimum; if none did, the path is the one begun with"""
    tried: tuple[str, ...]
    """what each attempt said"""


def optimised_connector(
    start: FloatArray,
    end: FloatArray,
    curvature: float,
    sharpness: float,
    objective: Objective = "length",
    pace: Pace | None = None,
) -> Optimised:
    """The shortest, fastest or smoothest connector that is found from the shortest CC path and Dubins path.

    Parameters
    ----------
    start, end : (4,) x, y, heading, curvature: m, m, rad, 1/m
    curvature, sharpness : limits, 1/m and 1/m^2, > 0
    objective : "length", "time" (needs `pace`), or "effort": the integral of the squared curvature
    pace : what limits the speed, for "time"

    Raises
    ------
    InputError : limits that are not above 0, states that are not finite or beyond the limit
    ValueError : a time without a pace, an unknown objective
    """
    from optplan_models.connector import optimise

    known = cc_path(start, end, curvature, sharpness)
    curve = Curve(np.asarray(start[:3], dtype=np.float64), known.curvatures, known.sharpnesses, known.lengths)
    best = Optimised(curve, value_of(curve, objective, pace), "cc", False, ())
    if known.length == 0:
        return best
    short = dubins_path(start[:3], end[:3], 1 / curvature)
    bends, parts = np.array(short.curvatures), np.array(short.lengths)
    guesses = {"cc": (known.curvatures, known.sharpnesses, known.lengths), "dubins": (bends, 0 * bends, parts)}
    longest = ROOM * known.length if objective == "effort" else np.inf
    tried: list[str] = []
    for name, guess in guesses.items():
        kappa, sigma, length = guess
        # the end's heading with the whole turns that this guess makes
        turned = start[2] + float((length * (kappa + sigma * length / 2)).sum())
        whole = end[2] + 2 * np.pi * round((turned - end[2]) / (2 * np.pi))
        goal = np.array([end[0], end[1], whole, end[3]], dtype=np.float64)
        for solver in SOLVERS:
            found = optimise(
                np.asarray(start, dtype=np.float64),
                goal,
                curvature,
                sharpness,
                guess,
                objective=objective,
                pace=pace,
                solver=solver,
                length_limit=longest,
            )
            tried.append(
                f"{solver} from {name}: {'converged' if found.converged else 'failed'} {found.message}".strip()
            )
            if found.converged:
                break
        if found.converged:
            made = Curve(curve.start, found.curvature, found.sharpness, np.full(len(found.curvature), found.step))
            value = value_of(made, objective, pace)
            best = best._replace(converged=True)
            if value < best.value:
                best = Optimised(made, value, f"{solver} from {name}", True, ())
    return best._replace(tried=tuple(tried))


def value_of(curve: Curve, objective: Objective, pace: Pace | None = None) -> float:
    """Length (m), least time (s) under a pace, or the integral of the squared curvature (1/m) of a curve."""
    k0, length = curve.curvature, curve.length
    k1 = k0 + curve.sharpness * length
    if objective == "effort":
        return float((length * (k0**2 + k0 * k1 + k1**2)).sum() / 3)
    if objective == "length" or pace is None:
        return float(length.sum())
    # the pace is convex in the curvature: 16 parts a piece leave less than 0.1 % of its bend
    share = (np.arange(16) + 0.5) / 16
    kappa = np.abs(k0[:, None] + (k1 - k0)[:, None] * share)
    slow = np.maximum(1 / pace.top, (1 + pace.half_track * kappa) / pace.wheel)
    return float((slow.mean(axis=1) * length).sum())
