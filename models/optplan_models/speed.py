"""The fastest speed along a fixed path as a convex programme, for wheels of limited speed and acceleration.

With b = v^2 at the ends of n intervals, a = (b' - b) / (2 length) is constant on each of them; then wheels at +-r from
the middle have the accelerations a (1 +- kappa r) +- r kappa' b, linear along an interval, so that both ends suffice:

    minimise    sum 2 length / (sqrt(b) + sqrt(b'))                                     (the time)
    subject to  |a (1 +- kappa r) +- r kappa' b| <= acceleration    at both ends of every interval
                0 <= b <= cap.

D. Verscheure, B. Demeulenaere, J. Swevers, J. De Schutter and M. Diehl, Time-optimal path tracking for robots: a convex
optimization approach, IEEE Transactions on Automatic Control 54 (2009). Where the constraints have a greatest solution,
maximising the sum of b, a linear programme, has the same optimum.

Limits of jerk and power are not convex, but have convex restrictions:

    |a' - a| <= jerk distance / sqrt(b),     a <= power / sqrt(b)

between the middles of two intervals, and with the power of a unit of mass,

with the convex right-hand sides replaced by their tangents at the last solution, which lie below them. Every solution
keeps the true limits, is a feasible point of the next programme, and so is never slower than the one before.
"""

from __future__ import annotations

import math
import warnings
from dataclasses import dataclass
from typing import Any, Literal

import numpy as np
import numpy.typing as npt

Floats = npt.NDArray[np.float64]
ROUNDS = 30
"""Most programmes with moved tangents."""
CLOSE = 1e-4
"""They end when the time falls by less than this share."""
LEAST = 1e-4
"""Tangents are never taken at less than this share of the greatest b."""


@dataclass(frozen=True, eq=False)
class SpeedPath:
    """Intervals of a path and their limits, SI.

    Parameters
    ----------
    length : (n,) m, > 0
    curvature : (n, 2) 1/m at both ends, left positive
    sharpness : (n,) 1/m^2
    acceleration : (n,) limit of each wheel's rim, m/s^2; 0: the speed does not change
    cap : (n + 1,) greatest b at the ends, m^2/s^2
    half_track : r, m; 0 for robots without wheels
    """

    length: Floats
    curvature: Floats
    sharpness: Floats
    acceleration: Floats
    cap: Floats
    half_track: float


@dataclass(frozen=True, eq=False)
class SpeedProfile:
    """b (n + 1,) m^2/s^2 at the ends of the intervals, the time (s), and the solver's word."""

    square: Floats
    time: float
    status: str


def duration(length: Floats, square: Floats) -> float:
    """Time (s) of intervals (n,) m with b (n + 1,) at their ends."""
    speed = np.sqrt(np.maximum(square, 0.0))
    with np.errstate(divide="ignore"):
        return float((2 * length / (speed[:-1] + speed[1:])).sum())


def fastest_speeds(
    path: SpeedPath,
    objective: Literal["time", "squares"] = "time",
    jerk: float = math.inf,
    power: float = math.inf,
) -> SpeedProfile:
    """Solve it.

    Parameters
    ----------
    objective : "time", by Clarabel; "squares": the linear programme, by HiGHS
    jerk : limit of the change of a, m/s^3
    power : limit of a v, W/kg

    Raises
    ------
    ValueError : the solver finds no solution
    """
    # in units in which speeds and lengths are about 1; then time is in units of metre / speed
    metre, whole = float(path.length.mean()), float(path.length.sum())
    most = (
        float(path.cap.max()),
        whole * float(path.acceleration.max()),
        (whole**2 * jerk) ** (2 / 3),
        (3 * whole * power) ** (2 / 3),
    )
    speed = math.sqrt(min(most) or 1.0)
    found = _fastest(_scaled(path, metre, speed), objective, jerk * metre**2 / speed**3, power * metre / speed**3)
    return SpeedProfile(found.square * speed**2, found.time * metre / speed, found.status)


def _scaled(path: SpeedPath, metre: float, speed: float) -> SpeedPath:
    return SpeedPath(
        path.length / metre,
        path.curvature * metre,
        path.sharpness * metre**2,
        path.acceleration * metre / speed**2,
        path.cap / speed**2,
        path.half_track / metre,
    )


def _fastest(path: SpeedPath, objective: str, jerk: float, power: float) -> SpeedProfile:
    if math.isinf(jerk) and math.isinf(power):
        return _solved(path, objective, [])
    tangent = np.maximum(path.cap, LEAST)
    best = _solved(path, objective, _restrictions(path, tangent, jerk, power))
    for _ in range(ROUNDS):
        tangent = np.maximum(best.square, LEAST)
        found = _solved(path, objective, _restrictions(path, tangent, jerk, power))
        gain = best.time - found.time
        if found.status != "optimal":
            break
        if gain > 0:
            best = found
        if gain < CLOSE * best.time:
            break
    return best


def fastest_model(path: SpeedPath, objective: Literal["time", "squares"] = "time") -> Any:
    """The programme itself, a `cvxpy.Problem` in one variable, b."""
    return _build(path, objective, [])


def _cvxpy() -> Any:
    import cvxpy

    return cvxpy


def _build(path: SpeedPath, objective: str, restrictions: list[Any]) -> Any:
    cp = _cvxpy()

    square = cp.Variable(len(path.cap), name="b")
    slope = cp.multiply(square[1:] - square[:-1], 0.5 / path.length)
    constraints = [square >= 0, square <= path.cap]
    for side in (path.half_track, -path.half_track):
        for end, b in ((0, square[:-1]), (1, square[1:])):
            rim = cp.multiply(slope, 1 + side * path.curvature[:, end]) + cp.multiply(b, side * path.sharpness)
            constraints.append(cp.abs(rim) <= path.acceleration)
        if path.half_track == 0:
            break
    level = np.flatnonzero(path.acceleration == 0)
    if len(level):
        constraints.append(square[level] == square[level + 1])
    constraints += [restriction(square, slope) for restriction in restrictions]
    if objective == "squares":
        return cp.Problem(cp.Maximize(cp.sum(square)), constraints)
    speed = cp.sqrt(square)
    return cp.Problem(cp.Minimize(2 * path.length @ cp.inv_pos(speed[:-1] + speed[1:])), constraints)


def _solved(path: SpeedPath, objective: str, restrictions: list[Any]) -> SpeedProfile:
    cp = _cvxpy()

    problem = _build(path, objective, restrictions)
    try:
        with warnings.catch_warnings():
            warnings.simplefilter("ignore")  # what they say is in the status; roots of -1e-12 are none
            problem.solve(solver=cp.HIGHS if objective == "squares" else cp.CLARABEL)
    except cp.SolverError as error:
        raise ValueError(f"no speed profile was found: {error}") from None
    square = problem.var_dict["b"].value
    if square is None:
        raise ValueError(f"no speed profile was found: {problem.status}")
    square = np.clip(square, 0.0, path.cap)
    return SpeedProfile(square, duration(path.length, square), str(problem.status))


def _restrictions(path: SpeedPath, tangent: Floats, jerk: float, power: float) -> list[Any]:
    """Constraints from tangents of 1 / sqrt(b) at `tangent` (n + 1,)."""
    cp = _cvxpy()

    def allowed(b: Any, at: Floats) -> Any:
        # sqrt(at) times the tangent of 1 / sqrt(b)
        return 1.5 - cp.multiply(b, 0.5 / at)

    found: list[Any] = []
    root = np.sqrt(tangent)
    if math.isfinite(jerk):
        distance = jerk * (path.length[:-1] + path.length[1:]) / 2
        moving = np.flatnonzero(path.cap[1:-1] > 0)
        joint = moving + 1
        found.append(
            lambda b, slope: (
                cp.multiply(cp.abs(slope[moving + 1] - slope[moving]), root[joint] / distance[moving])
                <= allowed(b[joint], tangent[joint])
            )
        )
        # out of rest, and into it, a is there within half of the interval's time: b / (2 s) <= jerk s / sqrt(b)
        rest = np.flatnonzero(path.cap == 0)
        before, after = rest[rest > 0], rest[rest < len(path.length)]
        near, reach = np.append(before - 1, after + 1), np.append(path.length[before - 1], path.length[after])
        if len(near):
            most = (2 * jerk * reach**2) ** (2 / 3)
            found.append(lambda b, _: b[near] <= most)
    if math.isfinite(power):
        for shift in (0, 1):
            ends = np.flatnonzero(path.cap[shift : len(path.length) + shift] > 0)
            at = ends + shift
            found.append(
                lambda b, slope, ends=ends, at=at: (
                    cp.multiply(slope[ends], root[at] / power) <= allowed(b[at], tangent[at])
                )
            )
    return found
