"""Control laws: speed along the path and turn rate from where the robot believes to be.

Both are given the place s on the path (m), the offset to the left of it (m), the heading against it (rad), the lag
behind the schedule (m), and the schedule's speed one control step ahead (m/s). Both return the speed in the direction
of travel (m/s, 0 or more), the turn rate (rad/s), and what of both follows from the plan alone.
"""

from __future__ import annotations

import math

from optplan.compiled import njit
from optplan.simulation._kernels.route import FIRST, HEADING, KAPPA, LAST, LENGTH, OFFSET, SIGMA, Route, place, seek

CATCH_UP = 2.0
"""1/s: speed for every metre behind the schedule."""
SOFTENED = 0.05
"""s; a step of the curvature is spread over this time to both sides: a ramp that wheels can follow."""
STEPPED = 1e-6
"""1/m; a change of curvature between two pieces that is a step."""
SPEED_P = 0.5
"""Share of the lacking speed that pure pursuit adds."""
CROSS_P, CROSS_I, CROSS_D = 0.5, 0.2, 0.3
"""1/m^2, 1/(m^2 s), 1/m: curvature of pure pursuit for the offset, its integral over time, and the heading across."""


@njit(cache=True, nogil=True)
def turned_to(angle: float) -> float:
    """An angle within -pi..pi, rad."""
    return angle - 2.0 * math.pi * math.floor((angle + math.pi) / (2.0 * math.pi))


@njit(cache=True, nogil=True)
def _heading(route: Route, row: int, s: float) -> float:
    p = route.pieces[row]
    into = s - p[OFFSET]
    return float(p[HEADING] + into * (p[KAPPA] + 0.5 * p[SIGMA] * into))


@njit(cache=True, nogil=True)
def _soft_curvature(route: Route, phase: int, row: int, low: float, high: float) -> float:
    """Curvature in the middle of low..high (m); its mean over them where it steps on the way."""
    first, last = route.phases[phase, FIRST], route.phases[phase, LAST]
    before = seek(route.pieces, first, last, row, low)
    after = seek(route.pieces, first, last, row, high)
    turned = _heading(route, after, high) - _heading(route, before, low)
    steps = False
    for k in range(before, after):
        p, following = route.pieces[k], route.pieces[k + 1]
        steps |= abs(following[KAPPA] - p[KAPPA] - p[SIGMA] * p[LENGTH]) > STEPPED
        # pieces may count the same heading with whole turns between them
        jump = following[HEADING] - _heading(route, k, following[OFFSET])
        turned -= jump - turned_to(jump)
    if steps:
        return float(turned / (high - low))
    middle = 0.5 * (low + high)
    p = route.pieces[seek(route.pieces, first, last, row, middle)]
    return float(p[KAPPA] + p[SIGMA] * (middle - p[OFFSET]))


@njit(cache=True, nogil=True)
def path_frame(
    route: Route,
    phase: int,
    row: int,
    s: float,
    end: float,
    offset: float,
    astray: float,
    lag: float,
    speed: float,
    step: float,
    reach: float,
) -> tuple[float, float, float, float]:
    """Feed-forward of speed and curvature, and steering back along a line of sight that falls with the offset.

    In the path's frame, after C. Samson, Control of chained systems, application to path following and time-varying
    point-stabilization of mobile robots, IEEE Transactions on Automatic Control 40 (1995): the offset obeys
    d'' + 2 d' / reach + d / reach^2 = 0 over the way driven; far away the robot turns square to the path, no further.
    """
    along = max(speed + CATCH_UP * lag, 0.0)
    begin = route.pieces[route.phases[phase, FIRST], OFFSET]
    ahead = s + along * step
    half = max(SOFTENED * along, 1e-6)
    low, high = max(ahead - half, begin), min(ahead + half, end)
    if high - low < 1e-9:
        low, high = max(begin, end - half), end
    kappa = _soft_curvature(route, phase, row, low, high)
    away = turned_to(astray)
    shortened = max(1.0 - kappa * offset, 0.2)  # a place further in drives a shorter way
    v = along * shortened / max(math.cos(away), 0.3)
    back = 2.0 / reach * (away + math.atan(0.5 * offset / reach))
    return v, along * kappa - v * back, speed, speed * kappa


@njit(cache=True, nogil=True)
def pure_pursuit(
    route: Route,
    phase: int,
    row: int,
    s: float,
    end: float,
    x: float,
    y: float,
    heading: float,
    offset: float,
    summed: float,
    lag: float,
    driven: float,
    speed: float,
    lookahead: float,
) -> tuple[float, float, float, float]:
    """The circle through a point ahead on the path, curvature 2 sin(alpha) / L; PID on the offset, PI on the speed.

    After R. C. Coulter, Implementation of the pure pursuit path tracking algorithm, CMU-RI-TR-92-01 (1992). `heading`
    is that of travel; `summed` is the integral of the offset, m s. Beyond the end of a leg the path goes straight on.
    """
    first, last = route.phases[phase, FIRST], route.phases[phase, LAST]
    aim = s + lookahead
    tx, ty, _, _ = place(route.pieces, seek(route.pieces, first, last, row, min(aim, end)), aim)
    dx, dy = tx - x, ty - y
    distance = max(math.hypot(dx, dy), 1e-9)
    alpha = turned_to(math.atan2(dy, dx) - heading)
    _, _, tangent, _ = place(route.pieces, row, s)
    across = math.sin(heading - tangent)
    kappa = 2.0 * math.sin(alpha) / distance - (CROSS_P * offset + CROSS_I * summed + CROSS_D * across)
    v = max(speed + SPEED_P * (speed - driven) + CATCH_UP * lag, 0.0)
    return v, kappa * v, 0.0, 0.0
