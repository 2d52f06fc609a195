"""Connectors by optimisation: the best of several local optima, and never worse than the path they begin with."""

from __future__ import annotations

from typing import TYPE_CHECKING, NamedTuple

import numpy as np

from optplan.connectors.around import SAG, way_around
from optplan.connectors.surroundings import Surroundings
from optplan.domain.arrays import FloatArray
from optplan.geometry.cc import cc_path
from optplan.geometry.curves import Curve, evaluate
from optplan.geometry.dubins import dubins_path

if TYPE_CHECKING:
    from optplan_models.connector import Objective, Pace

ROOM = 1.5
"""A smoother path may be so many times as long as the shortest one known."""
INTERVALS = 80
"""Of the grid between areas: a way around has several times the turns of a connector."""
ROUNDS = 5
"""Most rounds of it, each between the half-planes of the one before."""
ENOUGH = 1e-4
"""A round that gains less than this share is the last."""
ATTEMPTS = (("fatrop", 1), ("fatrop", 2), ("ipopt", 2))
"""Solver and fineness of the grid, tried in this order until one finds something: between bends at the limit, a path
may not exist on the coarse grid."""


class Optimised(NamedTuple):
    """A connector and what is known about it."""

    curve: Curve | None
    """None: forbidden areas leave no way that was found; `tried` says why"""
    value: float
    """m, s or 1/m, as asked; infinite without a curve"""
    source: str
    """who found it: "cc" or "way", the path begun with, or a solver and the guess it began with"""
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
    surroundings: Surroundings | None = None,
) -> Optimised:
    """The shortest, fastest or smoothest connector that is found from the shortest CC path and Dubins path.

    With surroundings it begins with the way around what they forbid, and is optimised between half-planes that keep
    its places out of what is nearest; what comes too near between those places is no answer.

    Parameters
    ----------
    start, end : (4,) x, y, heading, curvature: m, m, rad, 1/m
    curvature, sharpness : limits, 1/m and 1/m^2, > 0
    objective : "length", "time" (needs `pace`), or "effort": the integral of the squared curvature
    pace : what limits the speed, for "time"
    surroundings : areas to keep in and out of

    Raises
    ------
    InputError : limits that are not above 0, states that are not finite or beyond the limit
    ValueError : a time without a pace, an unknown objective
    """
    from optplan_models.connector import INTERVALS as COARSE
    from optplan_models.connector import optimise

    if surroundings is not None:
        return _among_areas(start, end, curvature, sharpness, objective, pace, surroundings)
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
        for solver, fineness in ATTEMPTS:
            found = optimise(
                np.asarray(start, dtype=np.float64),
                goal,
                curvature,
                sharpness,
                guess,
                objective=objective,
                pace=pace,
                intervals=fineness * COARSE,
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


def _among_areas(
    start: FloatArray,
    end: FloatArray,
    curvature: float,
    sharpness: float,
    objective: Objective,
    pace: Pace | None,
    surroundings: Surroundings,
) -> Optimised:
    """The way around, then optimised between half-planes, again as long as that improves it."""
    from optplan_models.connector import optimise

    way = way_around(start, end, curvature, sharpness, surroundings)
    if not way.curves:
        return Optimised(None, np.inf, "way", False, (way.source,))
    best = Optimised(way.curves[0], value_of(way.curves[0], objective, pace), "way", False, ())
    here, sag = np.asarray(start, dtype=np.float64), SAG / curvature
    longest = ROOM * way.length if objective == "effort" else np.inf
    guess, margin, tried = way.curves[0], 0.0, [f"way: {way.source}"]
    for _ in range(ROUNDS):
        turned = float(guess.end[2])
        goal = np.array([end[0], end[1], end[2] + 2 * np.pi * round((turned - end[2]) / (2 * np.pi)), end[3]])
        planes = _half_planes(guess, surroundings, margin)
        found = optimise(
            here,
            goal,
            curvature,
            sharpness,
            (guess.curvature, guess.sharpness, guess.length),
            objective=objective,
            pace=pace,
            planes=planes,
            intervals=INTERVALS,
            length_limit=longest,
        )
        tried.append(f"{found.solver}: {'converged' if found.converged else 'failed'} {found.message}".strip())
        if not found.converged:
            break
        best = best._replace(converged=True)
        made = Curve(here[:3], found.curvature, found.sharpness, np.full(len(found.curvature), found.step))
        if not surroundings.allows(made, sag):
            # between the places of the grid it comes nearer than at them
            margin = max(2 * margin, curvature * found.step**2 / 8)
            continue
        value = value_of(made, objective, pace)
        gained = value < best.value * (1 - ENOUGH)
        if value < best.value:
            best = best._replace(curve=made, value=value, source=f"{found.solver} from way")
        if not gained:
            break
        guess = made
    return best._replace(tried=tuple(tried))


def _half_planes(curve: Curve, surroundings: Surroundings, margin: float) -> FloatArray:
    """For each place of the grid the half-planes that keep it `margin` out of the nearest forbidden areas."""
    import shapely

    from optplan_models.connector import PLANES

    points = evaluate(curve, np.linspace(0, curve.total, INTERVALS + 1)).points
    places = shapely.points(points)
    parts = shapely.get_parts(surroundings.forbidden)
    distance = np.array([shapely.distance(part, places) for part in parts])
    planes = np.zeros((INTERVALS + 1, PLANES, 3))
    for rank, nearest in enumerate(np.argsort(distance, axis=0)[:PLANES]):
        for k in range(1, INTERVALS):  # the ends are given
            away = float(distance[nearest[k], k])
            if away > 1e-9:
                near, here = shapely.get_coordinates(shapely.shortest_line(parts[nearest[k]], places[k]))
                normal = (here - near) / away
                planes[k, rank] = [*normal, float(normal @ near) + min(margin, away)]
    return planes


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
