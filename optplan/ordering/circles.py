"""Washing circles: places on a facade to be visited so that water runs over wall that is washed already."""

from __future__ import annotations

import numpy as np

from optplan.domain.arrays import FloatArray, IntArray, frozen_floats
from optplan.domain.errors import InputError
from optplan.domain.ordering import EuclidCosts, OrderingProblem

TAU = 0.75
"""Height, in radii, by which a circle has to be lower to come first: neighbours of a row stay free of order."""
DISTANCE = 2.0
"""Horizontal distance, in radii, within which circles overlap."""


def circle_problem(
    centres: FloatArray, radius: float, *, tau: float = TAU, distance: float = DISTANCE, downwards: bool = False
) -> OrderingProblem:
    """The shortest open path through all circles, none before the ones below it that it overlaps.

    Circle i comes before j when j is at least tau radii higher and less than `distance` radii beside it. Circles are
    nodes from the bottom up where they are given so: solvers break ties downwards.

    Parameters
    ----------
    centres : (n, 2) m
    radius : of the circles, m, > 0
    tau, distance : of the rule, in radii
    downwards : from top to bottom instead

    Raises
    ------
    InputError : centres that are no finite (n, 2) numbers, or a radius that is not above 0
    """
    places = frozen_floats(centres, "centres", (None, 2))
    if not (np.isfinite(radius) and radius > 0 and tau > 0 and distance > 0):
        raise InputError(f"radius {radius} m, tau {tau} and distance {distance} must be finite and above 0")
    pairs = lower_first(places, tau * radius, distance * radius)
    if downwards:
        pairs = pairs[:, ::-1]
    return OrderingProblem(np.arange(len(places)), EuclidCosts(places, places), precedence=pairs)


def lower_first(places: FloatArray, height: float, width: float) -> IntArray:
    """Pairs (k, 2) of places: the second at least `height` higher than the first and less than `width` beside it."""
    rows = []
    for low in range(0, len(places), 1024):
        part = places[low : low + 1024]
        higher = places[None, :, 1] - part[:, None, 1] >= height - 1e-12 * abs(height)
        beside = np.abs(places[None, :, 0] - part[:, None, 0]) < width
        rows.append(np.argwhere(higher & beside) + np.array([low, 0]))
    return np.concatenate([np.zeros((0, 2), dtype=np.int64), *rows]).astype(np.int64)
