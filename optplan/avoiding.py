"""Driving less over finished work: what depends on the whole order, lowered by solving again with changed costs."""

from __future__ import annotations

import math
from dataclasses import replace

import numpy as np

from optplan.connectors.families import family_of
from optplan.connectors.finished import Marks, connector_lines, stroke_lines
from optplan.connectors.padding import padded
from optplan.domain.arrays import FloatArray, IntArray
from optplan.domain.options import Options
from optplan.domain.ordering import MatrixCosts, Ordering, OrderingProblem, Status
from optplan.domain.progress import Progress, ProgressCallback
from optplan.domain.result import Cover
from optplan.domain.robot import DiffDrive, Robot
from optplan.domain.stop import RunningStop, StopRule
from optplan.domain.stroke import Traversals
from optplan.ordering import solve
from optplan.ordering.arrays import DENSE_NODES, dense_costs
from optplan.ordering.history import History, annealed

MOST = 40_000_000
"""Numbers that the table of what arcs meet may hold: 320 MB."""
NEAREST, ALIKE = 100, 20
"""Arcs from each node that are offered where finished work is avoided, and how many of them to one stroke."""
PART = 500
"""Arcs looked at between two looks at the clock."""
TABLE = 0.4
"""Share of the time in which these arcs are looked at; farther ones are then left out."""
COOLINGS, ENDLESS = 6, 10_000
"""How often it is annealed without and with a time limit."""
TWIN = 1e-6
ROUNDS = 30
"""Most times that it is solved again."""
EACH = 40
"""Iterations of the search a stroke and round, besides `LEAST`."""
LEAST = 2000
ARCS = 200
"""Ways between two strokes that become dearer together: the shortest ones."""


def avoid_finished(
    found: Ordering,
    problem: OrderingProblem,
    ways: Traversals,
    cover: Cover,
    robot: Robot,
    options: Options,
    clock: RunningStop,
    progress: ProgressCallback,
) -> Ordering:
    """An order that trades metres between strokes for metres over finished work: of the wheels, where there are some.

    Small problems of robots on wheels are annealed with exactly these costs; see `_annealed`. What follows is for other
    robots, for large problems and for such with enforced connections.

    Sought is the least cost + weight x metres over finished work. Connectors that cross finished work become dearer by
    what they cross, with other ways between the same two strokes (by the mean of what was added before and what they
    cross now, as the order keeps changing); the search solves that, and so on, until nothing is crossed, the limits are
    reached, or after `ROUNDS`. The best order seen is returned. Its cost and bound
    are those of the problem as stated, so that the gap shows what the avoiding costs at most.

    Parameters
    ----------
    found : the order without this wish
    problem, ways, cover, robot, options : what was solved; `options.order.avoid` is the weight
    clock : time limit and cancel
    progress : called after each round
    """
    if problem.nodes > DENSE_NODES:
        more = f"finished work is not avoided: {problem.nodes} ways of driving, at most {DENSE_NODES}"
        return replace(found, message=f"{found.message}; {more}")
    family, count = family_of(robot, options), problem.clusters
    # a metre is worth what it takes to drive it
    weight = options.order.avoid / (family.pace.numbers[2] if family.pace is not None else 1.0)
    entry, leave = padded(ways, options)
    ways = replace(ways, entry=entry, exit=leave)
    wheeled = isinstance(robot.mobility, DiffDrive)
    if wheeled and len(problem.enforced) == 0 and problem.nodes**2 * count <= MOST:
        return _annealed(found, problem, ways, cover, robot, options, weight, clock, progress)
    marks, stroke = Marks(cover.strokes, robot), problem.cluster
    costs = dense_costs(problem)
    extra = np.zeros_like(costs)

    def crossed(tails: IntArray, heads: IntArray, rank: IntArray) -> FloatArray:
        lines = connector_lines(ways.exit[tails], ways.entry[heads], family)
        return marks.metres(lines, stroke[tails], rank, rank[stroke[heads]])

    def rank_of(nodes: IntArray) -> IntArray:
        rank = np.empty(count, dtype=np.int64)
        rank[stroke[nodes]] = np.arange(count)
        return rank

    best, best_over, current = found.nodes, math.inf, found.nodes
    before = 0.0
    for rounds in range(ROUNDS):
        rank = rank_of(current)
        over = crossed(current[:-1], current[1:], rank)
        if rounds == 0:
            before = float(over.sum())
        if problem.cost_of(current) + weight * over.sum() < problem.cost_of(best) + weight * best_over:
            best, best_over = current, float(over.sum())
        progress(Progress("order", (rounds + 1) / ROUNDS, problem.cost_of(best), found.bound))
        if not over.any() or clock.reason() is not None:
            break
        for k in np.flatnonzero(over).tolist():
            pair = [np.flatnonzero(stroke == stroke[current[k + side]]) for side in (0, 1)]
            tails, heads = np.repeat(pair[0], len(pair[1])), np.tile(pair[1], len(pair[0]))
            if len(tails) > ARCS:
                near = np.argpartition(costs[tails, heads], ARCS)[:ARCS]
                tails, heads = np.append(tails[near], current[k]), np.append(heads[near], current[k + 1])
            extra[tails, heads] = (extra[tails, heads] + crossed(tails, heads, rank)) / 2
        dearer = replace(problem, costs=MatrixCosts(costs + weight * extra))
        limits = StopRule(max(clock.remaining, 1e-3), LEAST + EACH * count, cancelled=clock.rule.cancelled)
        answer = solve(dearer, "search", limits, rounds, start=best)
        current = answer.nodes if len(answer.nodes) else best
    cost = problem.cost_of(best)
    message = f"{found.message}; over finished work {best_over:.3g} m instead of {before:.3g} m"
    status = found.status if cost <= found.cost else Status.FEASIBLE
    return replace(found, nodes=best, cost=cost, status=status, message=message.removeprefix("; "))


def _annealed(
    found: Ordering,
    problem: OrderingProblem,
    ways: Traversals,
    cover: Cover,
    robot: Robot,
    options: Options,
    weight: float,
    clock: RunningStop,
    progress: ProgressCallback,
) -> Ordering:
    """The order annealed with what is met of finished work by connectors and by strokes, each when it is driven.

    What arcs meet is looked up in a table, so only the `NEAREST` arcs from each node are offered, at most `ALIKE` of
    them to one stroke, besides those of the order found first.
    """
    family = family_of(robot, options)
    marks, stroke = Marks(cover.strokes, robot), problem.cluster
    assert isinstance(robot.mobility, DiffDrive)
    aside = robot.mobility.track / 2
    costs = dense_costs(problem)
    offered = np.full_like(costs, np.inf)
    apart = stroke[:, None] != stroke[None, :]
    usable = np.where(apart, costs, np.inf)
    near = [_nearest(row, stroke) for row in usable]
    tails = np.repeat(np.arange(len(costs)), [len(row) for row in near])
    heads, rank = np.concatenate(near), np.concatenate([np.arange(len(row)) for row in near])
    tails, heads = np.append(found.nodes[:-1], tails), np.append(found.nodes[1:], heads)
    # the order found comes first, then from each node the nearest
    order = np.argsort(np.append(np.full(len(found.nodes) - 1, -1), rank), kind="stable")
    order = order[np.isfinite(usable[tails[order], heads[order]])]
    tails, heads = tails[order], heads[order]
    on_arc = np.zeros((*costs.shape, len(cover.strokes)))
    until = clock.elapsed + TABLE * clock.remaining
    for begin in range(0, len(tails), PART):
        part = slice(begin, begin + PART)
        lines = connector_lines(ways.exit[tails[part]], ways.entry[heads[part]], family, aside)
        on_arc[tails[part], heads[part]] = marks.table(lines)
        offered[tails[part], heads[part]] = costs[tails[part], heads[part]]
        progress(Progress("order", begin / len(tails), message="ways over finished work"))
        if clock.elapsed > until or clock.reason() is not None:
            break
    if clock.reason() is not None:
        late = f"{found.message}; there was no time to avoid finished work"
        return replace(found, message=late.removeprefix("; "))
    on_node = marks.table(stroke_lines(ways, cover, robot, options, aside))
    on_node[np.arange(len(stroke)), stroke] = 0.0
    start, end = (side if len(side) else np.zeros(len(stroke)) for side in (problem.start_costs, problem.end_costs))
    history = History(stroke, offered, start, end, on_node, on_arc, problem.precedence)

    def proceed(share: float) -> bool:
        progress(Progress("order", share, found.cost, found.bound, message="avoiding finished work"))
        return clock.reason() is None

    limited = clock.rule.iterations is not None or math.isfinite(clock.rule.seconds)
    coolings = COOLINGS if not limited or clock.rule.iterations is not None else ENDLESS
    best = annealed(history, twins(ways), found.nodes, weight, options.order.seed, proceed, coolings)
    before, after = (history.value(nodes, 1.0) - history.value(nodes, 0.0) for nodes in (found.nodes, best))
    cost = problem.cost_of(best)
    message = f"{found.message}; wheels over finished work {after:.3g} m instead of {before:.3g} m"
    status = found.status if cost <= found.cost else Status.FEASIBLE
    return replace(found, nodes=best, cost=cost, status=status, message=message.removeprefix("; "))


def _nearest(row: FloatArray, stroke: IntArray) -> IntArray:
    """Heads of the cheapest arcs in a row of costs (n,), few of them to any one stroke."""
    order = np.argsort(row, kind="stable")
    own = stroke[order]
    # how many of the same stroke come before each
    by = np.argsort(own, kind="stable")
    first = np.searchsorted(own[by], own[by])
    rank = np.empty(len(order), dtype=np.int64)
    rank[by] = np.arange(len(order)) - first
    return order[rank < ALIKE][:NEAREST]


def twins(ways: Traversals) -> IntArray:
    """The way (n,) that drives the same stroke the other way round, -1 where there is none."""
    twins = np.full(len(ways), -1, dtype=np.int64)
    for k in range(len(ways)):
        turned = ways.exit[k, :2], ways.exit[k, 3] + math.pi
        own = np.flatnonzero(ways.stroke == ways.stroke[k])
        apart = np.abs(ways.entry[own, :2] - turned[0]).max(axis=1)
        bent = np.abs(np.sin((ways.entry[own, 3] - turned[1]) / 2))
        fits = own[(apart < TWIN) & (bent < TWIN)]
        if len(fits) == 0:  # beside the line, the other way round is somewhere else
            fits = own[(ways.reverse[own] != ways.reverse[k]) & (ways.entry_vertex[own] != ways.entry_vertex[k])]
            ring = own[(ways.reverse[own] != ways.reverse[k]) & (ways.entry_vertex[own] == ways.entry_vertex[k])]
            fits = ring if len(own) > 2 else fits
        twins[k] = fits[0] if len(fits) else -1
    return twins
