"""Ways around forbidden areas in the costs of an order: looked for only where an order would use them."""

from __future__ import annotations

import math
from dataclasses import replace

import numpy as np

from optplan.connectors.around import Roads, roads_of
from optplan.connectors.families import Family, family_of, start_states
from optplan.connectors.padding import padded
from optplan.domain.options import Options
from optplan.domain.ordering import MatrixCosts, Ordering, OrderingProblem, Status
from optplan.domain.progress import Progress, ProgressCallback
from optplan.domain.result import Cover
from optplan.domain.robot import Robot
from optplan.domain.stop import RunningStop, StopRule
from optplan.domain.stroke import Traversals
from optplan.ordering import solve
from optplan.ordering.arrays import DENSE_NODES, dense_costs

ROUNDS = 100
"""Most times that an order is solved again."""


def with_detours(
    found: Ordering,
    problem: OrderingProblem,
    ways: Traversals,
    cover: Cover,
    robot: Robot,
    options: Options,
    clock: RunningStop,
    progress: ProgressCallback,
) -> tuple[Ordering, OrderingProblem]:
    """An order whose costs are those of the ways around forbidden areas, and the problem with these costs.

    The connectors that an order uses are measured with their ways around; the problem is solved again with these costs,
    until an order uses measured connectors only, or the limits are reached. A connector that heeds nothing is never
    longer than its way around: so a bound stays a bound for the problem with all ways around.

    Parameters
    ----------
    found : the order of connectors that heed nothing
    problem, ways, cover, robot, options : what was solved; nothing is done when the options forbid nothing
    clock : time limit and cancel
    progress : called after each round

    Raises
    ------
    InputError : areas that are none, or a metric without ways around
    """
    roads = roads_of(cover, robot, options)
    if roads is None or not math.isfinite(found.cost) or problem.clusters == 0:
        return found, problem
    if problem.nodes > DENSE_NODES:
        more = f"areas are not in the costs: {problem.nodes} ways of driving, at most {DENSE_NODES}"
        return replace(found, message=f"{found.message}; {more}".removeprefix("; ")), problem
    entry, leave = padded(ways, options)
    ways = replace(ways, entry=entry, exit=leave)
    costs, begin = dense_costs(problem).copy(), problem.start_costs.copy()
    start, family = options.order.start or cover.start, family_of(robot, options)
    exits, entries = family.eased(ways.exit), family.eased(ways.entry)
    measured: set[tuple[int, int]] = set()
    current, longer, blocked = found, 0, 0
    best, least, bound = found.nodes, math.inf, -math.inf
    for rounds in range(ROUNDS):
        nodes = current.nodes
        changed = False
        for tail, head in zip([-1, *nodes[:-1].tolist()], nodes.tolist(), strict=True):
            if (tail, head) in measured or (tail < 0 and start is None):
                continue
            measured.add((tail, head))
            if tail < 0:
                entry = ways.entry[head : head + 1]
                heading = 0.0
                if family.headings and start:
                    heading = start_states(start, options.order.heading, entry, family)[0][0]
                here = np.array([*(start or (0.0, 0.0)), heading, 0.0])
                before = float(begin[head])
            else:
                here, before = exits[tail, [0, 1, 3, 4]], float(costs[tail, head])
            length = _cost(roads, family, here, entries[head, [0, 1, 3, 4]])
            if length > before * (1 + 1e-9):
                changed, longer, blocked = True, longer + 1, blocked + math.isinf(length)
                if tail < 0:
                    begin[head] = length
                else:
                    costs[tail, head] = length
        problem = replace(problem, costs=MatrixCosts(costs), start_costs=begin)
        # all of its connectors are measured now; and what was proved holds for dearer connectors too
        cost, bound = problem.cost_of(nodes), max(bound, current.bound)
        if cost < least:
            best, least = nodes, cost
        progress(Progress("order", (rounds + 1) / ROUNDS, least, bound))
        if not changed or clock.reason() is not None or rounds == ROUNDS - 1:
            break
        limits = StopRule(max(clock.remaining, 1e-3), clock.rule.iterations, cancelled=clock.rule.cancelled)
        first = nodes if math.isfinite(cost) else None
        answer = solve(problem, options.order.solver, limits, options.order.seed, start=first)
        if not math.isfinite(answer.cost):
            break
        current = answer
    if math.isinf(least):
        text = "no order of the strokes was found that keeps out of forbidden areas"
        return replace(found, message=f"{found.message}; {text}".removeprefix("; ")), problem
    text = f"connectors that meet forbidden areas: {longer} were tried"
    text += f", {blocked} of them have no way around and are not used" if blocked else ""
    message = f"{current.message}; {text}".removeprefix("; ")
    if best is current.nodes and not changed:
        return replace(current, cost=least, message=message), problem
    # the last answer, or an earlier one that turned out better among the areas
    bound = min(bound, least)
    return replace(current, nodes=best, cost=least, bound=bound, status=Status.FEASIBLE, message=message), problem


def _cost(roads: Roads, family: Family, here: np.ndarray, there: np.ndarray) -> float:
    """m or s; 0 between the same places, infinite when there is no way."""
    way = roads.between(here, there)
    if way.source == "the ends are the same":
        return 0.0
    if family.pace is not None and way.curves:
        return family.pace.time_along(way.curves)
    return way.length
