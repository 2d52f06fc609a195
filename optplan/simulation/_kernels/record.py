"""What is written down of a drive: a row a control step."""

from __future__ import annotations

import math

from optplan.compiled import njit
from optplan.domain.arrays import FloatArray, IntArray
from optplan.simulation._kernels.machine import (
    LEFT,
    PHASE,
    RIGHT,
    ROW,
    SLIP_L,
    SLIP_R,
    STEP,
    TIME,
    TRUE_H,
    TRUE_X,
    TRUE_Y,
    Machine,
    S,
)
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
    TURN,
    Route,
    X,
    Y,
    nearest,
    place,
    seek,
)

T, PX, PY, H, V, OMEGA, WL, WR, AL, AR, TX, TY, CROSS, LAG = range(14)
"""Columns of what is written."""


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
def write(
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
