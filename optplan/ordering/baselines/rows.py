"""`rows` and `rows-split`: circles of a facade, row by row."""

from __future__ import annotations

import math
from dataclasses import replace
from typing import TYPE_CHECKING

import numpy as np

from optplan.domain.arrays import FloatArray
from optplan.domain.errors import InputError
from optplan.domain.ordering import EuclidCosts, MatrixCosts, OrderingProblem
from optplan.domain.stop import StopReason
from optplan.ordering.exact import mtz_by_highs, refuse_many_arcs
from optplan.ordering.method import Run

if TYPE_CHECKING:
    from optplan_models.ordering.segments import Restricted

MOST = 2000
"""Circles whose precedence is looked at pair by pair."""


def rows(run: Run) -> StopReason:
    """Strictly from row to row, as published: the best path of that kind. Iterations are the warm start's."""
    return _solve(run, may_split=False)


def rows_split(run: Run) -> StopReason:
    """The same with rows cut where precedence changes, so that a window need not be crossed in every row."""
    return _solve(run, may_split=True)


def refuse_rows(problem: OrderingProblem) -> str | None:
    """Why strict rows cannot be made of this problem."""
    return _refusal(problem, may_split=False)


def refuse_rows_split(problem: OrderingProblem) -> str | None:
    """Why rows that may be split cannot be made of this problem."""
    return _refusal(problem, may_split=True)


def _solve(run: Run, *, may_split: bool) -> StopReason:
    problem = run.problem
    restricted = _restricted(problem, may_split=may_split)
    path = _path_problem(problem, restricted, may_split=may_split)
    extra = float(problem.node_costs.sum())
    part = Run(
        path,
        replace(run.rule, seconds=max(run.clock.remaining, 1e-3), target=run.rule.target - extra).start(),
        run.seed,
        # a bound of these paths is none of all paths
        progress=lambda seen: run.progress(replace(seen, cost=min(run.cost, seen.cost + extra), bound=-math.inf)),
    )
    stopped = mtz_by_highs(part)
    run.iterations = part.iterations
    if len(part.nodes):
        run.offer(restricted.circles_of(part.nodes))
    found = restricted.segments
    run.message = part.message or (
        f"{len(found.row)} segments with {found.ends} ends instead of {problem.nodes} circles; no path of this kind "
        f"costs less than {part.bound + extra:.6g}, which is no bound for others"
    )
    return stopped


def _path_problem(problem: OrderingProblem, restricted: Restricted, *, may_split: bool) -> OrderingProblem:
    from optplan_models.ordering.segments import rows_in_order

    before = restricted.precedence
    if not may_split:
        before = np.concatenate([before, rows_in_order(restricted.segments)])
    return OrderingProblem(
        restricted.cluster,
        MatrixCosts(restricted.costs),
        problem.start_costs[restricted.enter],
        problem.end_costs[restricted.leave],
        restricted.inner,
        before,
    )


def _restricted(problem: OrderingProblem, *, may_split: bool) -> Restricted:
    from optplan_models.ordering.segments import restrict, rows_of

    points = _points(problem)
    pairs = problem.precedence
    row = rows_of(points)
    if len(pairs) and (row[pairs[:, 0]] >= row[pairs[:, 1]]).all():
        points = points * np.array([1.0, -1.0])  # precedence points downwards
    return restrict(points, pairs, may_split=may_split)


def _points(problem: OrderingProblem) -> FloatArray:
    """(n, 2) the circles' centres."""
    assert isinstance(problem.costs, EuclidCosts)
    return problem.costs.exits[:, :2]


def _refusal(problem: OrderingProblem, *, may_split: bool) -> str | None:
    costs = problem.costs
    if problem.nodes > problem.clusters or not isinstance(costs, EuclidCosts):
        return "it orders circles in a plane: one node a stroke, at straight-line distances"
    level = (costs.exits[:, 2:] == costs.exits[0, 2:]).all()
    if not np.array_equal(costs.exits, costs.entries) or costs.exits.shape[1] < 2 or not level:
        return "it orders circles in a plane, each left where it is entered"
    if problem.nodes > MOST:
        return f"{problem.nodes} circles; at most {MOST}"
    try:
        restricted = _restricted(problem, may_split=may_split)
        return refuse_many_arcs(_path_problem(problem, restricted, may_split=may_split))
    except (ValueError, InputError) as error:
        return str(error)
