"""Stops on the way where the tank is filled again."""

from __future__ import annotations

import math
from dataclasses import replace

import numpy as np

from optplan.connectors.families import family_of
from optplan.connectors.padding import padded
from optplan.domain.arrays import FloatArray
from optplan.domain.errors import InputError
from optplan.domain.options import Options
from optplan.domain.ordering import Ordering, OrderingProblem, Status
from optplan.domain.path import RAISED
from optplan.domain.result import Cover
from optplan.domain.robot import Robot
from optplan.domain.stroke import Stroke, Traversals
from optplan.ordering.arrays import dense_costs

NAME = "refill "
"""Beginning of the ids of such stops."""


def with_refills(
    found: Ordering, problem: OrderingProblem, ways: Traversals, cover: Cover, robot: Robot, options: Options
) -> tuple[Ordering, Traversals, Cover]:
    """An order with stops at the start point, so that no tank is asked for more marks than it holds.

    The order of the strokes stays; where it is left for the start point is chosen so that the detours cost least (a
    dynamic programme over the strokes, as in C. Prins, A simple and effective evolutionary algorithm for the vehicle
    routing problem, 2004). Connectors are shortest ways, so that stops only add to the cost: the bound stays one.

    Parameters
    ----------
    found : an order that was found
    problem, ways, cover, robot, options : what was solved; `options.order.refill` is how many metres a tank lasts

    Returns
    -------
    the order, the ways of driving strokes and stops, of which it chooses, and the strokes with the stops behind them

    What cannot be is refused by `check_refills` before there is an order.
    """
    lasts = options.order.refill
    start = options.order.start or cover.start
    if lasts is None or start is None or not math.isfinite(found.cost) or len(found.nodes) == 0:
        return found, ways, cover
    nodes = found.nodes
    marks = _marks(cover)[ways.stroke[nodes]]
    entry, leave = padded(ways, options)
    family = family_of(robot, options)
    stop = np.zeros(5)
    # as at the beginning, the robot's middle is where it starts; it stands there facing east
    stop[:2] = start
    tool = (start[0] + robot.offset.ahead, start[1] - robot.offset.right)
    here = np.tile(stop, (len(nodes), 1))
    to_stop, from_stop = family.costs(leave[nodes], here), family.costs(here, entry[nodes])
    arcs = dense_costs(problem)[nodes[:-1], nodes[1:]]
    detour = to_stop[:-1] + from_stop[1:] - arcs
    cuts = _cheapest(marks, detour, lasts)
    return _inserted(found, ways, cover, cuts, stop, tool, options, detour)


def check_refills(cover: Cover, options: Options) -> None:
    """InputError, before any order is looked for, when the tank cannot be filled as asked: there is no start point, or
    a stroke is longer than a tank lasts."""
    lasts = options.order.refill
    if lasts is None or not cover.strokes:
        return
    if (options.order.start or cover.start) is None:
        raise InputError("the tank is filled where the robot starts; expected a start point (--start)")
    marks = _marks(cover)
    worst = int(np.argmax(marks))
    if marks[worst] > lasts * (1 + 1e-9):
        name = cover.strokes[worst].id
        raise InputError(f"stroke {name!r} takes {marks[worst]:.4g} m of marks, a tank lasts {lasts:.4g} m")


def _marks(cover: Cover) -> FloatArray:
    """(n,) metres of marks of each stroke"""
    return np.array([stroke.length if stroke.tool > RAISED else 0.0 for stroke in cover.strokes])


def fills_tank(stroke: Stroke) -> bool:
    """Whether a stroke is such a stop."""
    return stroke.is_stop and stroke.id.startswith(NAME)


def without_refills(cover: Cover) -> Cover:
    """The strokes alone, to be ordered again."""
    kept = tuple(stroke for stroke in cover.strokes if not fills_tank(stroke))
    return cover if len(kept) == len(cover.strokes) else replace(cover, strokes=kept)


def _cheapest(marks: FloatArray, detour: FloatArray, lasts: float) -> list[int]:
    """After which strokes to fill up: the cheapest choice in which no stretch takes more than a tank lasts."""
    count = len(marks)
    gone = np.concatenate([[0.0], np.cumsum(marks)])
    best = np.full(count + 1, math.inf)
    best[0] = 0.0
    back = np.zeros(count + 1, dtype=np.int64)
    for end in range(1, count + 1):
        for begin in range(end - 1, -1, -1):
            if gone[end] - gone[begin] > lasts * (1 + 1e-9):
                break
            value = best[begin] + (detour[begin - 1] if begin > 0 else 0.0)
            if value < best[end]:
                best[end], back[end] = value, begin
    cuts: list[int] = []
    at = int(back[count])
    while at > 0:
        cuts.append(at - 1)
        at = int(back[at])
    return cuts[::-1]


def _inserted(
    found: Ordering,
    ways: Traversals,
    cover: Cover,
    cuts: list[int],
    stop: FloatArray,
    tool: tuple[float, float],
    options: Options,
    detour: FloatArray,
) -> tuple[Ordering, Traversals, Cover]:
    if not cuts:
        text = f"{found.message}; one tank suffices"
        return replace(found, message=text.removeprefix("; ")), ways, cover
    first = len(cover.strokes)
    dwell = options.order.refill_time
    stops = tuple(Stroke(f"{NAME}{k}", np.array([tool]), tool=RAISED, dwell=dwell) for k in range(1, len(cuts) + 1))
    count = len(cuts)
    more = Traversals(
        np.concatenate([ways.stroke, np.arange(first, first + count)]),
        np.concatenate([ways.entry_vertex, np.zeros(count, dtype=np.int64)]),
        np.concatenate([ways.reverse, np.zeros(count, dtype=np.bool_)]),
        np.concatenate([ways.entry, np.tile(stop, (count, 1))]),
        np.concatenate([ways.exit, np.tile(stop, (count, 1))]),
        np.concatenate([ways.length, np.zeros(count)]),
        np.concatenate([ways.duration, np.full(count, dwell)]),
    )
    nodes: list[int] = []
    for k, node in enumerate(found.nodes.tolist()):
        nodes.append(node)
        if k in cuts:
            nodes.append(len(ways) + cuts.index(k))
    added = float(detour[cuts].sum())
    message = f"{found.message}; {count} stops to fill the tank add {added:.4g} {found.unit}"
    status = Status.FEASIBLE if added > 1e-9 else found.status
    ordering = replace(
        found,
        nodes=np.array(nodes),
        cost=found.cost + added,
        status=status,
        message=message.removeprefix("; "),
    )
    return ordering, more, replace(cover, strokes=(*cover.strokes, *stops))
