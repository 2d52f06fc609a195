"""The control loop: measure, decide, let the wheels answer, move; a hundred times a second."""

from __future__ import annotations

import math
from typing import NamedTuple

from optplan.compiled import njit
from optplan.domain.arrays import FloatArray, IntArray
from optplan.simulation._kernels.route import (
    BODY,
    FIRST,
    GEAR,
    KIND,
    KNOT,
    KNOT_S,
    LAST,
    LAST_KNOT,
    LEG,
    SPAN,
    TURN,
    Route,
    X,
    Y,
    nearest,
    place,
    scheduled,
    seek,
)
from optplan.simulation._kernels.trackers import path_frame, pure_pursuit, turned_to
from optplan.simulation._kernels.wheels import advance, answered

STEP = 0.01
"""Control period, s."""
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

TRUE_X, TRUE_Y, TRUE_H, BELIEF_X, BELIEF_Y, BELIEF_H = 0, 1, 2, 3, 4, 5
LEFT, RIGHT, SLIP_L, SLIP_R, CLOCK, S, SUM, LEAD_L, LEAD_R, TIME = range(6, 16)
"""Numbers of the state: poses, wheel speeds, slip, seconds in this phase, arc length, and so on."""
PHASE, ROW, TIMED, STATUS = range(4)
"""Whole numbers of the state: phase, piece, knot, what became of it."""

T, PX, PY, H, V, OMEGA, WL, WR, AL, AR, TX, TY, CROSS, LAG = range(14)
"""Columns of what is written."""


class Machine(NamedTuple):
    """The robot in numbers, and how it is steered."""

    track: float
    radius: float
    wheel_speed: float
    wheel_acceleration: float
    share: float
    """of a lacking wheel speed made up in a step"""
    turn_rate: float
    turn_acceleration: float
    right: float
    ahead: float
    pursuit: bool
    lookahead: float
    reach: float
    """m, least distance over which an offset is steered away"""
    reach_time: float
    """s, the same as driving time"""
    lost: float
    blend: float
    """of a measured pose into the believed one, 0..1"""
    slipping: float
    """share of a slip that stays a step longer"""


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
def _move(
    m: Machine, state: FloatArray, noise: FloatArray, v: float, omega: float, lead_v: float, lead_w: float
) -> None:
    """Let the wheels answer and the robot move for a step."""
    half = 0.5 * m.track
    left, right = (v - omega * half) / m.radius, (v + omega * half) / m.radius
    fastest = max(abs(left), abs(right))
    if fastest > m.wheel_speed:  # slower along the same curve
        left *= m.wheel_speed / fastest
        right *= m.wheel_speed / fastest
    planned_l, planned_r = (lead_v - lead_w * half) / m.radius, (lead_v + lead_w * half) / m.radius
    # what a lag will eat of the planned change is asked for beforehand, within what a motor can be asked for
    excess = 1.0 / m.share - 1.0
    most = m.wheel_acceleration * STEP
    asked_l = left + excess * min(max(planned_l - state[LEAD_L], -most), most)
    asked_r = right + excess * min(max(planned_r - state[LEAD_R], -most), most)
    state[LEAD_L], state[LEAD_R] = planned_l, planned_r
    # short of acceleration, the robot steers first and speeds up or brakes with what is left
    change_l, change_r = m.share * (asked_l - state[LEFT]), m.share * (asked_r - state[RIGHT])
    steer = min(max(0.5 * (change_r - change_l), -most), most)
    left_over = most - abs(steer)
    gain = min(max(0.5 * (change_l + change_r), -left_over), left_over)
    asked_l = min(max(state[LEFT] + (gain - steer) / m.share, -m.wheel_speed), m.wheel_speed)
    asked_r = min(max(state[RIGHT] + (gain + steer) / m.share, -m.wheel_speed), m.wheel_speed)
    next_l = answered(state[LEFT], asked_l, m.share, m.wheel_speed, most)
    next_r = answered(state[RIGHT], asked_r, m.share, m.wheel_speed, most)
    state[SLIP_L] = m.slipping * state[SLIP_L] + noise[0]
    state[SLIP_R] = m.slipping * state[SLIP_R] + noise[1]
    for at, grip_l, grip_r in ((TRUE_X, 1.0 - state[SLIP_L], 1.0 - state[SLIP_R]), (BELIEF_X, 1.0, 1.0)):
        l0, r0 = state[LEFT] * grip_l * m.radius, state[RIGHT] * grip_r * m.radius
        l1, r1 = next_l * grip_l * m.radius, next_r * grip_r * m.radius
        state[at], state[at + 1], state[at + 2] = advance(
            state[at],
            state[at + 1],
            state[at + 2],
            0.5 * (l0 + r0),
            (r0 - l0) / m.track,
            0.5 * (l1 + r1 - l0 - r0) / STEP,
            (r1 - l1 - r0 + l0) / (m.track * STEP),
            STEP,
        )
    state[LEFT], state[RIGHT] = next_l, next_r
    for k in range(3):
        measured = state[TRUE_X + k] + noise[2 + k]
        state[BELIEF_X + k] += m.blend * (measured - state[BELIEF_X + k])


@njit(cache=True, nogil=True)
def _cross_track(route: Route, m: Machine, state: FloatArray, whole: IntArray, tx: float, ty: float) -> float:
    """Offset of the tool (m, left positive) from the line that the plan has for it."""
    phase = min(whole[PHASE], len(route.phases) - 1)
    p, q = route.phases[phase], route.turns[phase]
    if p[KIND] == LEG:
        right, ahead = q[GEAR] * m.right, q[GEAR] * m.ahead
        low, high = route.knots[p[KNOT], KNOT_S], route.knots[p[LAST_KNOT], KNOT_S]
        s, row = nearest(route, phase, whole[ROW], min(max(state[S], low), high), low, high, tx, ty, right, ahead)
        x, y, heading, kappa = place(route.pieces, row, s)
        along, across = 1.0 + kappa * right, kappa * ahead
        size = math.hypot(along, across)
        c, z = math.cos(heading), math.sin(heading)
        ex, ey = tx - (x + ahead * c + right * z), ty - (y + ahead * z - right * c)
        if size < 1e-3:
            along, across, size = 1.0, 0.0, 1.0
        return float((along * (ey * c - ex * z) - across * (ex * c + ey * z)) / size)
    ex, ey = tx - route.pieces[p[FIRST], X], ty - route.pieces[p[FIRST], Y]
    arm = math.hypot(m.right, m.ahead)
    if arm > 0.0 and q[TURN] != 0.0:  # on the circle that the tool draws
        return float(math.copysign(arm - math.hypot(ex, ey), q[TURN]))
    heading = q[BODY]
    left = -m.right
    return float((ey * math.cos(heading) - left) - ex * math.sin(heading))


@njit(cache=True, nogil=True)
def _write(
    route: Route, m: Machine, state: FloatArray, whole: IntArray, before: FloatArray, lag: float, out: FloatArray
) -> int:
    """Write down a moment; returns the tool setting."""
    x, y, heading = state[TRUE_X], state[TRUE_Y], state[TRUE_H]
    c, z = math.cos(heading), math.sin(heading)
    tx, ty = x + m.ahead * c + m.right * z, y + m.ahead * z - m.right * c
    over_l = state[LEFT] * (1.0 - state[SLIP_L]) * m.radius
    over_r = state[RIGHT] * (1.0 - state[SLIP_R]) * m.radius
    out[T], out[PX], out[PY], out[H] = state[TIME], x, y, heading
    out[V], out[OMEGA] = 0.5 * (over_l + over_r), (over_r - over_l) / m.track
    out[WL], out[WR] = state[LEFT], state[RIGHT]
    out[AL], out[AR] = (state[LEFT] - before[0]) / STEP, (state[RIGHT] - before[1]) / STEP
    out[TX], out[TY], out[LAG] = tx, ty, lag
    out[CROSS] = _cross_track(route, m, state, whole, tx, ty)
    phase = min(whole[PHASE], len(route.phases) - 1)
    p = route.phases[phase]
    row = seek(route.pieces, p[FIRST], p[LAST], min(max(whole[ROW], p[FIRST]), p[LAST] - 1), state[S])
    return int(route.tools[row])


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
        _move(m, state, noise[k], v, omega, planned_v, planned_omega)
        state[CLOCK] += STEP
        state[TIME] += STEP
        tools[k] = _write(route, m, state, whole, before, lag, out[k])
    return len(out)
