"""`noon-bean`: a generalised path as an asymmetric travelling-salesman problem, and back."""

from __future__ import annotations

from dataclasses import replace

import numpy as np

from optplan.domain.arrays import FloatArray
from optplan.domain.ordering import MatrixCosts, OrderingProblem
from optplan.domain.stop import StopReason
from optplan.ordering.arrays import dense_costs
from optplan.ordering.exact import MAX_ARCS, mtz_by_highs
from optplan.ordering.method import Run

SAFETY = 1e-9
"""Relative amount taken off a bound for rounding: the big M's are many times larger than the costs."""


def refuse_precedence_or_many_cities(problem: OrderingProblem) -> str | None:
    """Why the transformation cannot take this problem."""
    if len(problem.precedence):
        return "the transformation knows no precedence"
    arcs = problem.nodes * (problem.nodes - 1)
    return None if arcs <= MAX_ARCS else f"it has {arcs} arcs between cities; at most {MAX_ARCS}"


def noon_bean(run: Run) -> StopReason:
    """Transform, let the lifted model prove the travelling-salesman problem, and project its tour back.

    Incumbent and bound are those of the given problem: the big M's are taken off. Iterations are those of the search
    for a start.
    """
    from optplan_models.ordering import noon_bean as cities

    problem = run.problem
    parts = (dense_costs(problem), problem.cluster, problem.start_costs, problem.end_costs, problem.node_costs)
    if not all(np.isfinite(costs).any() for costs in parts):
        run.prove(np.inf)
        return StopReason.FINISHED
    big = cities.sufficient(*parts)
    weights = cities.weight_shifted(*parts, big=big, back=0.0)
    extra = (problem.clusters - 1) * big
    tour = Run(
        OrderingProblem(np.arange(problem.nodes), MatrixCosts(weights[1:, 1:]), weights[0, 1:], weights[1:, 0]),
        replace(run.rule, seconds=max(run.clock.remaining, 1e-3), target=run.rule.target + extra).start(),
        run.seed,
        progress=lambda seen: run.progress(replace(seen, cost=run.cost, bound=min(run.bound, run.cost))),
    )
    if run.start is not None:
        tour.start = cities.tour_of(run.start, problem.cluster)[1:-1] - 2
        tour.offer(tour.start)
    stopped = mtz_by_highs(tour)
    run.iterations, run.message = tour.iterations, tour.message
    if len(tour.nodes):
        nodes = cities.nodes_of([1, *(tour.nodes + 2).tolist()], problem.cluster)
        if len(nodes) == problem.clusters:
            run.offer(nodes)
    least, most = _range(problem, parts[0])
    run.prove(least)
    # a dearer tour has one big M too many: it splits a cluster, and so does every other
    dearer = tour.bound > (most + extra) * (1.0 + SAFETY)
    run.prove(np.inf if dearer else tour.bound - extra - SAFETY * (abs(tour.bound) + extra))
    return stopped


def _range(problem: OrderingProblem, costs: FloatArray) -> tuple[float, float]:
    """No path costs less than the first, none that exists more than the second."""
    between = np.where(problem.cluster[:, None] != problem.cluster, costs, np.inf) + problem.node_costs
    bounds = []
    for extreme in (np.min, np.max):
        ends = [problem.start_costs + problem.node_costs, problem.end_costs]
        inner, start, end = (float(extreme(values[np.isfinite(values)])) for values in (between, *ends))
        bounds.append(start + (problem.clusters - 1) * inner + end)
    return bounds[0], bounds[1]
