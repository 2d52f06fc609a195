"""Two driven wheels: their speeds under lag and limits, and where the robot gets to.

The left wheel runs at v - omega track / 2 over the ground, the right one at v + omega track / 2, omega left positive.
"""

from __future__ import annotations

import math

from optplan.compiled import njit

_NODES = (0.06943184420297371, 0.33000947820757187, 0.6699905217924281, 0.9305681557970263)
_WEIGHTS = (0.17392742256872692, 0.32607257743127307, 0.32607257743127307, 0.17392742256872692)
# Gauss nodes and weights on 0..1


@njit(cache=True, nogil=True)
def advance(
    x: float, y: float, heading: float, speed: float, turn_rate: float, gain: float, spin: float, span: float
) -> tuple[float, float, float]:
    """Place (m, m) and heading (rad) after `span` seconds of constant accelerations.

    Speed changes at `gain` (m/s^2), the turn rate at `spin` (rad/s^2). The integrals of v cos and v sin have no closed
    form that is also safe for straight motion; four Gauss nodes leave less than 1e-12 of the way while the heading
    changes by less than a quarter rad.
    """
    dx = dy = 0.0
    for i in range(4):
        t = span * _NODES[i]
        angle = heading + t * (turn_rate + 0.5 * spin * t)
        way = span * _WEIGHTS[i] * (speed + gain * t)
        dx += way * math.cos(angle)
        dy += way * math.sin(angle)
    return x + dx, y + dy, heading + span * (turn_rate + 0.5 * spin * span)


@njit(cache=True, nogil=True)
def answered(speed: float, asked: float, share: float, limit: float, most: float) -> float:
    """A wheel's speed one control step later, rad/s.

    It makes up `share` of what is lacking (1 - exp(-step / lag) of a first-order lag), changes by at most `most`
    (rad/s) and stays within `limit`.
    """
    change = min(max(share * (asked - speed), -most), most)
    return min(max(speed + change, -limit), limit)
