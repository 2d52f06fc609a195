"""Ways before and after strokes in their own direction, as older planners have them. Stops have none."""

from __future__ import annotations

import math

import numpy as np

from optplan.domain.arrays import FloatArray
from optplan.domain.errors import InputError
from optplan.domain.options import ConnectOptions, Options
from optplan.domain.stroke import Traversals
from optplan.geometry.clothoids import clothoid_displacement
from optplan.geometry.rounding import Pieces


def padded(ways: Traversals, options: Options) -> tuple[FloatArray, FloatArray]:
    """Entry and exit states (m, 5) of ways with their padding. Raises InputError under the metric "time"."""
    asked = options.connect
    if asked.padding == 0:
        return ways.entry, ways.exit
    if options.order.metric == "time":
        raise InputError("padding is there to compare lengths with; expected the metric 'cc' or 'dubins'")
    moves = (ways.length > 0)[:, None]
    entry = np.where(moves, _moved(ways.entry, -asked.pad_before, asked.curved_padding), ways.entry)
    leave = np.where(moves, _moved(ways.exit, asked.pad_after, asked.curved_padding), ways.exit)
    return entry, leave


def padding_of(ways: Traversals, asked: ConnectOptions) -> FloatArray:
    """(m,) m of padding of each way; empty when there is none at all."""
    return np.where(ways.length > 0, asked.padding, 0.0) if asked.padding > 0 else np.zeros(0)


def pieces_between(state: FloatArray, length: float, curved: bool) -> Pieces:
    """The padding that begins at a state (4,) x, y, heading, curvature."""
    count = 1 if length > 0 else 0
    bend = state[3] if curved else 0.0
    zero = np.zeros(count)
    full = [np.full(count, value) for value in (state[2], bend, length)]
    return Pieces(np.tile(state[:2], (count, 1)), full[0], full[1], full[2], zero, zero)


def _moved(states: FloatArray, distance: float, curved: bool) -> FloatArray:
    if distance == 0:
        return states
    made = states.copy()
    bend = states[:, 4] if curved else np.zeros(len(states))
    # backwards is forwards the other way round
    sign = math.copysign(1.0, distance)
    heading = states[:, 3] + (math.pi if sign < 0 else 0.0)
    size = np.full(len(states), abs(distance))
    dx, dy = clothoid_displacement(heading, sign * bend, np.zeros(len(states)), size)
    made[:, 0] += dx
    made[:, 1] += dy
    made[:, 3] += bend * distance
    made[:, 4] = bend
    return made
