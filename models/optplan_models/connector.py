"""Shortest, fastest or smoothest connector under limits of curvature and of its rate.

Multiple shooting on a uniform grid of free length: the rate of the curvature is constant on each of N intervals, so the
curvature is exact, and every interval is a clothoid; positions are Gauss sums. Scaled by kappa_max: lengths are
multiplied by it, curvatures divided. The problem is built once for each grid and objective; end states, limits and
half-planes that stand for obstacles are parameters or bounds.

The optimum found stays in the turning class of the guess (how often and which way it turns), so several guesses are
worth trying; and a uniform grid cannot hit the places where a bang-bang rate switches, so the result can be a little
longer than a good guess. Callers keep the better one.
"""

from __future__ import annotations

import math
from dataclasses import dataclass
from functools import lru_cache
from typing import Any, Literal

import numpy as np
import numpy.typing as npt

Floats = npt.NDArray[np.float64]
Objective = Literal["length", "time", "effort"]

INTERVALS = 40
PLANES = 2
"""Half-planes for each place of the grid when there are obstacles."""
TOLERANCE = 1e-9
"""Of the constraints, in units of the least radius."""
REACHED = 1e-6
"""m and rad: an end that is missed by more is no solution."""
_NODES, _WEIGHTS = (0.5 * (1 + x) if k == 0 else 0.5 * x for k, x in enumerate(np.polynomial.legendre.leggauss(3)))
BARRIER = 1e-3
"""of the first iteration, where paths lie at their limits: a greater one drives good guesses away from them"""
BENT = 1e-2
"""share of the sharpness limit by which guesses are bent, left and back"""
_FINE, _FINE_WEIGHTS = np.polynomial.legendre.leggauss(10)
STATE = 5
"""x, y, heading, curvature, length."""


@dataclass(frozen=True, eq=False)
class Connector:
    """A solution.

    Parameters
    ----------
    curvature, sharpness : (N,) 1/m and 1/m^2 at the beginning of each clothoid
    step : length of each of them, m
    objective : m, s, or 1/m (integral of the squared curvature), as asked
    missed : greatest distance from the end state: m, rad, or curvature as a share of its limit
    converged : the solver says that it is locally optimal, the end is reached and no limit is broken
    solver, message, iterations : who solved it and what it said
    """

    curvature: Floats
    sharpness: Floats
    step: float
    objective: float
    missed: float
    converged: bool
    solver: str
    message: str
    iterations: int

    @property
    def length(self) -> float:
        """m"""
        return self.step * len(self.curvature)


@dataclass(frozen=True)
class Pace:
    """What limits the speed along a connector: v <= top, and v (1 + |kappa| half_track) <= wheel.

    top, wheel : m/s, > 0; half_track : m, >= 0
    """

    top: float
    wheel: float
    half_track: float


def optimise(
    start: Floats,
    end: Floats,
    curvature: float,
    sharpness: float,
    guess: tuple[Floats, Floats, Floats],
    *,
    objective: Objective = "length",
    pace: Pace | None = None,
    planes: Floats | None = None,
    intervals: int = INTERVALS,
    solver: str = "fatrop",
    length_limit: float = math.inf,
) -> Connector:
    """The best connector near a guess.

    Parameters
    ----------
    start, end : (4,) x, y, heading, curvature: m, m, rad, 1/m. The end's heading is the one that the guess arrives
        with, whole turns included
    curvature, sharpness : limits, 1/m and 1/m^2, > 0
    guess : curvature at the beginning, sharpness and length of the pieces (k,) of a path from start towards the end;
        it need not reach it, nor keep the limits
    objective : "length", "time" (needs `pace`) or "effort": the integral of the squared curvature (`length_limit`
        keeps it from wandering)
    planes : (intervals + 1, PLANES, 3) a, b, c for each place of the grid: a x + b y >= c in m, a^2 + b^2 = 1; rows
        of zeros say nothing
    intervals : N
    solver : "fatrop" or "ipopt"
    length_limit : m

    Raises
    ------
    ValueError : limits that are not above 0, an end curvature beyond them, shapes that do not fit, or a time without
        a pace
    """
    _check(start, end, curvature, sharpness, objective, pace, planes, intervals)
    scale = float(curvature)  # lengths times, curvatures by
    turn = float(start[2])
    cos, sin = math.cos(turn), math.sin(turn)
    dx, dy = scale * (end[0] - start[0]), scale * (end[1] - start[1])
    goal = np.array([cos * dx + sin * dy, -sin * dx + cos * dy, end[2] - turn, end[3] / scale])
    rate = sharpness / scale**2
    states, rates = _resample(guess, scale, intervals)
    states[:, 3] = np.clip(states[:, 3], -1.0, 1.0)
    # a guess that is an optimum already, such as a line, leaves fatrop's line search nothing to gain, and it cycles
    bent = np.where(np.arange(intervals) < intervals / 2, BENT, -BENT)
    rates = np.clip(rates / rate + bent, -1.0, 1.0)
    states[0] = [0.0, 0.0, 0.0, start[3] / scale, states[0, 4]]
    given = pace or Pace(1.0, 1.0, 0.0)
    slow = np.array([1.0, given.top / given.wheel, given.top / given.wheel * given.half_track * scale])

    gates = np.zeros((intervals + 1, PLANES, 3))
    gates[..., 2] = -1.0
    if planes is not None:
        used = (planes[..., 0] != 0) | (planes[..., 1] != 0)
        a, b, c = planes[..., 0], planes[..., 1], planes[..., 2]
        moved = np.stack([cos * a + sin * b, -sin * a + cos * b, scale * (c - a * start[0] - b * start[1])], axis=-1)
        gates = np.where(used[..., None], moved, gates)
    with_planes = planes is not None

    program = _program(intervals, objective, with_planes, solver)
    guessed = program.pack(states, np.column_stack([rates, np.ones(intervals)])[:, : program.controls])
    parameters = np.concatenate([[start[3] / scale, rate], goal, slow, gates.ravel() if with_planes else []])
    lower, upper = program.bounds(min(scale * length_limit, 1e6))
    answer = program.solver(x0=guessed, p=parameters, lbx=lower, ubx=upper, lbg=program.least, ubg=program.most)
    found, controls = program.unpack(np.asarray(answer["x"]).ravel())
    statistics = program.solver.stats()
    step = float(found[-1, 4]) / intervals
    rates = rate * controls[:, 0]
    kappa = start[3] / scale + step * np.concatenate([[0.0], np.cumsum(rates)])
    miss = _missed(kappa, rates, step, goal, scale)
    broken = max(float(np.abs(kappa).max()), float(np.abs(controls[:, 0]).max())) - 1.0
    good = bool(statistics["success"]) and miss <= REACHED and broken <= 1e-7 and step > 0
    value = float(answer["f"]) * {"length": 1 / scale, "time": 1 / (scale * given.top), "effort": scale}[objective]
    return Connector(
        scale * kappa[:-1],
        scale**2 * rates,
        step / scale,
        value,
        miss,
        good,
        solver,
        str(statistics.get("return_status", "")),
        int(statistics.get("iter_count", 0)),
    )


def _check(
    start: Floats,
    end: Floats,
    curvature: float,
    sharpness: float,
    objective: str,
    pace: Pace | None,
    planes: Floats | None,
    intervals: int,
) -> None:
    if not (0 < curvature < math.inf and 0 < sharpness < math.inf):
        raise ValueError(f"the limits are {curvature} 1/m and {sharpness} 1/m^2; expected finite numbers above 0")
    for name, state in (("start", start), ("end", end)):
        if np.shape(state) != (4,) or not np.isfinite(state).all():
            raise ValueError(f"the {name} is {state}; expected four finite numbers x, y, heading, curvature")
        if abs(state[3]) > curvature * (1 + 1e-9):
            raise ValueError(f"the {name} has a curvature of {state[3]} 1/m; the limit is {curvature}")
    if objective not in ("length", "time", "effort"):
        raise ValueError(f"there is no objective {objective!r}; expected length, time or effort")
    if objective == "time" and pace is None:
        raise ValueError("the least time needs a pace: what limits the speed")
    if intervals < 3:
        raise ValueError(f"{intervals} intervals; expected 3 or more")
    if planes is not None and np.shape(planes) != (intervals + 1, PLANES, 3):
        raise ValueError(f"half-planes have the shape {np.shape(planes)}; expected {(intervals + 1, PLANES, 3)}")


def _resample(guess: tuple[Floats, Floats, Floats], scale: float, intervals: int) -> tuple[Floats, Floats]:
    """States (N + 1, 5) at equal steps along the guess, scaled, and the mean rates (N,) between them."""
    kappa, sigma, length = (np.asarray(column, dtype=np.float64) for column in guess)
    kappa, sigma, length = kappa / scale, sigma / scale**2, length * scale
    total = max(float(length.sum()), 1e-3)
    edges = np.concatenate([[0.0], np.cumsum(length)])
    # headings are exact at the fine places, positions by the midpoint rule: it is a guess
    fine = np.linspace(0.0, total, 8 * intervals + 1)
    piece = np.clip(np.searchsorted(edges, fine, side="right") - 1, 0, max(len(length) - 1, 0))
    turned = np.concatenate([[0.0], np.cumsum(length * (kappa + sigma * length / 2))])

    def heading(s: Floats, k: npt.NDArray[np.int64]) -> Floats:
        u = s - edges[k]
        angles: Floats = turned[k] + u * (kappa[k] + sigma[k] * u / 2)
        return angles

    if not len(length):
        flat = np.zeros((intervals + 1, STATE))
        flat[:, 0], flat[:, 4] = fine[::8], total
        return flat, np.zeros(intervals)
    middle = (fine[1:] + fine[:-1]) / 2
    angle = heading(middle, np.clip(np.searchsorted(edges, middle, side="right") - 1, 0, len(length) - 1))
    step = total / (8 * intervals)
    x = np.concatenate([[0.0], np.cumsum(step * np.cos(angle))])
    y = np.concatenate([[0.0], np.cumsum(step * np.sin(angle))])
    bend = kappa[piece] + sigma[piece] * (fine - edges[piece])
    states = np.column_stack([x, y, heading(fine, piece), bend, np.full(len(fine), total)])[::8]
    return states, np.diff(states[:, 3]) * intervals / total


def _missed(kappa: Floats, rates: Floats, step: float, goal: Floats, scale: float) -> float:
    """How far the chain of clothoids ends from the goal, m or rad, by a finer rule than the model's."""
    u = step * (1 + _FINE) / 2
    begin = np.concatenate([[0.0], np.cumsum(step * (kappa[:-1] + step * rates / 2))])
    angle = begin[:-1, None] + u * (kappa[:-1, None] + rates[:, None] * u / 2)
    x, y = (step / 2 * (f(angle) @ _FINE_WEIGHTS).sum() for f in (np.cos, np.sin))
    away = math.hypot(x - goal[0], y - goal[1]) / scale
    return float(max(away, abs(begin[-1] - goal[2]), abs(kappa[-1] - goal[3])))


@dataclass(frozen=True, eq=False)
class _Program:
    """A compiled problem: its solver, bounds of constraints, and how variables are laid out."""

    solver: Any
    least: Floats
    most: Floats
    intervals: int
    controls: int
    """1: the rate of the curvature as a share of its limit; 2: and the pace as a multiple of that at top speed."""

    def pack(self, states: Floats, controls: Floats) -> Floats:
        stages = np.column_stack([states[:-1], controls])
        return np.concatenate([stages.ravel(), states[-1]])

    def unpack(self, values: Floats) -> tuple[Floats, Floats]:
        stages = values[:-STATE].reshape(self.intervals, STATE + self.controls)
        return np.vstack([stages[:, :STATE], values[-STATE:]]), stages[:, STATE:]

    def bounds(self, longest: float) -> tuple[Floats, Floats]:
        """Of all variables; longest : of the scaled length."""
        states = np.full((self.intervals + 1, STATE), math.inf)
        states[:, 3], states[:, 4] = 1.0, longest
        upper = self.pack(states, np.tile([1.0, math.inf][: self.controls], (self.intervals, 1)))
        states[:, 4] = -1e-6  # the length is above 0 wherever that is possible
        lower = -self.pack(states, np.tile([1.0, math.inf][: self.controls], (self.intervals, 1)))
        lower.reshape(-1)[STATE - 1 :: STATE + self.controls] = 1e-6
        return lower, upper


@lru_cache(maxsize=16)
def _program(intervals: int, objective: Objective, planes: bool, solver: str) -> _Program:
    """The problem for a grid, built once."""
    import casadi as ca

    controls = 2 if objective == "time" else 1
    start, rate = ca.MX.sym("k0"), ca.MX.sym("rate")
    goal, slow = ca.MX.sym("goal", 4), ca.MX.sym("slow", 3)
    gates = ca.MX.sym("gates", 3 * PLANES * (intervals + 1)) if planes else ca.MX(0, 1)
    step = _interval(ca, intervals, controls)
    cost_of = _stage_cost(ca, objective, intervals, controls)

    variables, constraints, equal, least, most = [], [], [], [], []

    def ask(what: Any, low: float, high: float) -> None:
        constraints.append(what)
        for _ in range(what.numel()):
            equal.append(low == high)
            least.append(low)
            most.append(high)

    state = ca.MX.sym("x0", STATE)
    total = 0
    for k in range(intervals + 1):
        last = k == intervals
        variables.append(state)
        here = state
        if not last:
            control = ca.MX.sym(f"u{k}", controls)
            variables.append(control)
            state = ca.MX.sym(f"x{k + 1}", STATE)
            # gaps first, then what holds at the stage: fatrop finds its structure by this order
            ask(state - step(here, control, rate), 0.0, 0.0)
            total += cost_of(here, control, rate)
        if k == 0:
            ask(here[:4] - ca.vertcat(0, 0, 0, start), 0.0, 0.0)
        if last:
            ask(here[:4] - goal, 0.0, 0.0)
        elif objective == "time":
            # a pace as slow as the top speed, and as the outer wheel, either way round
            ask(control[1] - slow[0], 0.0, math.inf)
            ask(control[1] - slow[1] - slow[2] * here[3], 0.0, math.inf)
            ask(control[1] - slow[1] + slow[2] * here[3], 0.0, math.inf)
        if planes and 0 < k < intervals:
            for h in range(PLANES):
                a = gates[3 * (PLANES * k + h) : 3 * (PLANES * k + h) + 3]
                ask(a[0] * here[0] + a[1] * here[1] - a[2], 0.0, math.inf)
    problem = {
        "x": ca.vertcat(*variables),
        "p": ca.vertcat(start, rate, goal, slow, gates),
        "f": total,
        "g": ca.vertcat(*constraints),
    }
    options: dict[str, Any] = {"expand": True, "print_time": False, "error_on_fail": False}
    if solver == "fatrop":
        options |= {"structure_detection": "auto", "equality": equal}
        options["fatrop"] = {"print_level": 0, "tol": TOLERANCE, "max_iter": 300}
        if objective != "effort":
            options["fatrop"]["mu_init"] = BARRIER
    else:
        options["ipopt"] = {"print_level": 0, "sb": "yes", "tol": TOLERANCE, "max_iter": 500}
    return _Program(
        ca.nlpsol("connector", solver, problem, options), np.array(least), np.array(most), intervals, controls
    )


def _interval(ca: Any, intervals: int, controls: int) -> Any:
    """The state after an interval, from the state before and the controls."""
    x, u, rate = ca.SX.sym("x", STATE), ca.SX.sym("u", controls), ca.SX.sym("rate")
    h, bend = x[4] / intervals, rate * u[0]
    dx = dy = 0
    for node, weight in zip(_NODES, _WEIGHTS, strict=True):
        angle = x[2] + h * node * (x[3] + bend * h * node / 2)
        dx += weight * h * ca.cos(angle)
        dy += weight * h * ca.sin(angle)
    after = ca.vertcat(x[0] + dx, x[1] + dy, x[2] + h * (x[3] + bend * h / 2), x[3] + h * bend, x[4])
    return ca.Function("interval", [x, u, rate], [after])


def _stage_cost(ca: Any, objective: Objective, intervals: int, controls: int) -> Any:
    x, u, rate = ca.SX.sym("x", STATE), ca.SX.sym("u", controls), ca.SX.sym("rate")
    h = x[4] / intervals
    end = x[3] + rate * u[0] * h
    if objective == "effort":
        cost = h * (x[3] ** 2 + x[3] * end + end**2) / 3  # exact: the curvature is linear
    else:
        cost = h * u[1] if objective == "time" else h
    return ca.Function("cost", [x, u, rate], [cost])
