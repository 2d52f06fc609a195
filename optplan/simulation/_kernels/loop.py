"""The control loop: measure, decide, let the wheels answer, move; a hundred times a second."""

from __future__ import annotations

import math

from optplan.compiled import njit
from optplan.domain.arrays import FloatArray, IntArray
from optplan.simulation._kernels.machine import (
    BELIEF_H,
    BELIEF_X,
    BELIEF_Y,
    CLOCK,
    LEFT,
    PHASE,
    RIGHT,
    ROW,
    STATUS,
    STEP,
    SUM,
    TIME,
    TIMED,
    Machine,
    S,
    move,
)
from optplan.simulation._kernels.record import write
from optplan.simulation._kernels.route import (
    BODY,
    FIRST,
    GEAR,
    KIND,
    KNOT,
    KNOT_S,
    LAST_KNOT,
    LEG,
    SPAN,
    TURN,
    Route,
    nearest,
    place,
    scheduled,
)
from optplan.simulation._kernels.trackers import path_frame, pure_pursuit, turned_to

RUNNING, FINISHED, LOST, LATE = range(4)
"""What became of the drive."""
ARRIVED = 5e-4
"""m before the end of a leg that count as its end."""
AIMED = 2e-3
"""rad beside the heading to be turned to that count as it."""
PATIENCE = 2.0
"""s given to both beyond the schedule."""
OVERDUE = 30.0
"""s beyond its schedule, and for a leg beyond as long again, after which the drive is given up."""
NEAR = 0.1
"""m before the end of a leg from which patience may run out."""
DIRECT = 4.0
"""1/s: turn rate on the spot for every rad beside the heading wanted."""
REST = 2e-3
"""m/s at a wheel's rim that counts as rest."""


@njit(cache=True, nogil=True)
def _turned(turn: float, rate: float, acceleration: float, t: float) -> tuple[float, float, float]:
    """Turning on the spot: angle and rate after t seconds, and how long it takes."""
    size = abs(turn)
    top = min(rate, math.sqrt(size * acceleration))
    if top <= 0.0:
        return turn, 0.0, 0.0
    ramp = top / acceleration
    whole = size / top + ramp
    if t >= whole:
        return turn, 0.0, whole
    if t < ramp:
        angle, now = 0.5 * acceleration * t * t, acceleration * t
    elif t < whole - ramp:
        angle, now = top * (t - 0.5 * ramp), top
    else:
        left = whole - t
        angle, now = size - 0.5 * acceleration * left * left, acceleration * left
    return math.copysign(angle, turn), math.copysign(now, turn), whole


@njit(cache=True, nogil=True)
def _next_phase(route: Route, state: FloatArray, whole: IntArray) -> None:
    whole[PHASE] += 1
    state[CLOCK] = state[SUM] = 0.0
    if whole[PHASE] < len(route.phases):
        p = route.phases[whole[PHASE]]
        whole[ROW], whole[TIMED] = p[FIRST], p[KNOT]
        state[S] = route.knots[p[KNOT], KNOT_S]


@njit(cache=True, nogil=True)
def _pass_by(route: Route, m: Machine, state: FloatArray, whole: IntArray) -> bool:
    """Go on to the next phase where this one is done; False when there is none left."""
    while whole[PHASE] < len(route.phases):
        p, q = route.phases[whole[PHASE]], route.turns[whole[PHASE]]
        clock = state[CLOCK]
        calm = max(abs(state[LEFT]), abs(state[RIGHT])) * m.radius < REST
        if p[KIND] == LEG:
            left = route.knots[p[LAST_KNOT], KNOT_S] - state[S]
            done = left < ARRIVED or (clock > q[SPAN] + PATIENCE and left < NEAR)
            if clock < q[SPAN] or not (calm and done):
                return True
        elif q[TURN] != 0.0 or q[SPAN] > 0.0:
            _, _, turning = _turned(q[TURN], m.turn_rate, m.turn_acceleration, clock)
            astray = abs(turned_to(q[BODY] + q[TURN] - state[BELIEF_H]))
            settled = astray < AIMED or q[TURN] == 0.0 or clock > turning + q[SPAN] + PATIENCE
            if clock < turning + q[SPAN] or not (calm and settled):
                return True
        _next_phase(route, state, whole)
    return False


@njit(cache=True, nogil=True)
def _decide(route: Route, m: Machine, state: FloatArray, whole: IntArray) -> tuple[float, float, float, float, float]:
    """Speed and turn rate of the body to be reached in a step, what of them is planned, and the lag."""
    phase = whole[PHASE]
    p, q = route.phases[phase], route.turns[phase]
    x, y, heading = state[BELIEF_X], state[BELIEF_Y], state[BELIEF_H]
    if p[KIND] != LEG:
        angle, _, turning = _turned(q[TURN], m.turn_rate, m.turn_acceleration, state[CLOCK])
        late = state[CLOCK] - turning - q[SPAN]
        if late > PATIENCE:  # what it measures may never be still: this has to do
            whole[STATUS] = LATE if late > OVERDUE else whole[STATUS]
            return 0.0, 0.0, 0.0, 0.0, 0.0
        _, rate, _ = _turned(q[TURN], m.turn_rate, m.turn_acceleration, state[CLOCK] + STEP)
        return 0.0, rate + DIRECT * turned_to(q[BODY] + angle - heading), 0.0, rate, 0.0
    end = route.knots[p[LAST_KNOT], KNOT_S]
    travel = heading if q[GEAR] > 0 else heading + math.pi
    s, row = nearest(
        route, phase, whole[ROW], state[S], state[S], min(end, state[S] + 10.0 * m.track * STEP + 0.05), x, y, 0.0, 0.0
    )
    state[S], whole[ROW] = s, row
    px, py, tangent, _ = place(route.pieces, row, s)
    offset = (y - py) * math.cos(tangent) - (x - px) * math.sin(tangent)
    if math.hypot(x - px, y - py) > m.lost:
        whole[STATUS] = LOST
    elif state[CLOCK] > 2.0 * q[SPAN] + OVERDUE:
        whole[STATUS] = LATE
    wanted, _, knot = scheduled(route.knots, p[KNOT], p[LAST_KNOT], whole[TIMED], state[CLOCK])
    whole[TIMED] = knot
    _, speed, _ = scheduled(route.knots, p[KNOT], p[LAST_KNOT], knot, state[CLOCK] + STEP)
    lag = wanted - s
    if m.pursuit:
        state[SUM] = min(max(state[SUM] + offset * STEP, -1.0), 1.0)
        driven = 0.5 * m.radius * abs(state[LEFT] + state[RIGHT])
        ahead = m.lookahead if m.lookahead > 0 else max(m.track, 0.5 * driven)
        v, omega, planned_v, planned_omega = pure_pursuit(
            route, phase, row, s, end, x, y, travel, offset, state[SUM], lag, driven, speed, ahead
        )
    else:
        reach = max(m.reach, m.reach_time * speed)
        v, omega, planned_v, planned_omega = path_frame(
            route, phase, row, s, end, offset, travel - tangent, lag, speed, STEP, reach
        )
    return q[GEAR] * v, omega, q[GEAR] * planned_v, planned_omega, lag


@njit(cache=True, nogil=True)
def drive(
    route: Route, m: Machine, state: FloatArray, whole: IntArray, noise: FloatArray, out: FloatArray, tools: IntArray
) -> int:
    """Drive on for as many steps as `noise` and `out` have rows; returns how many were driven.

    Parameters
    ----------
    state, whole : numbers of the drive, kept between calls; `whole[STATUS]` says what became of it
    noise : (n, 5) changes of the two slips, and errors of the measured x, y (m) and heading (rad)
    out : (n, 14), written; tools : (n,), written
    """
    before = state[LEFT : RIGHT + 1].copy()
    for k in range(len(out)):
        if not _pass_by(route, m, state, whole):
            whole[STATUS] = FINISHED
            return k
        v, omega, planned_v, planned_omega, lag = _decide(route, m, state, whole)
        if whole[STATUS] != RUNNING:
            return k
        before[:] = state[LEFT : RIGHT + 1]
        move(m, state, noise[k], v, omega, planned_v, planned_omega)
        state[CLOCK] += STEP
        state[TIME] += STEP
        tools[k] = write(route, m, state, whole, before, lag, out[k])
    return len(out)
