"""Driving less over finished work: what depends on the whole order, lowered by solving again with changed costs."""

from __future__ import annotations

import math
from dataclasses import replace

import numpy as np

from optplan.connectors.families import family_of
from optplan.connectors.finished import Marks, connector_lines
from optplan.connectors.padding import padded
from optplan.domain.arrays import FloatArray, IntArray
from optplan.domain.options import Options
from optplan.domain.ordering import MatrixCosts, Ordering, OrderingProblem, Status
from optplan.domain.progress import Progress, ProgressCallback
from optplan.domain.result import Cover
from optplan.domain.robot import Robot
from optplan.domain.stop import RunningStop, StopRule
from optplan.domain.stroke import Traversals
from optplan.ordering import solve
from optplan.ordering.arrays import DENSE_NODES, dense_costs

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
    """An order that trades metres between strokes for metres over finished work.

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
