"""The robot in numbers, the state of its drive, and one step of it."""

from __future__ import annotations

from typing import NamedTuple

from optplan.compiled import njit
from optplan.domain.arrays import FloatArray
from optplan.simulation._kernels.wheels import advance, answered

STEP = 0.01
"""Control period, s."""
TRUE_X, TRUE_Y, TRUE_H, BELIEF_X, BELIEF_Y, BELIEF_H = 0, 1, 2, 3, 4, 5
LEFT, RIGHT, SLIP_L, SLIP_R, CLOCK, S, SUM, LEAD_L, LEAD_R, TIME = range(6, 16)
"""Numbers of the state: poses, wheel speeds, slip, seconds in this phase, arc length, and so on."""
PHASE, ROW, TIMED, STATUS = range(4)
"""Whole numbers of the state: phase, piece, knot, what became of it."""


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
def move(
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
