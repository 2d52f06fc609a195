"""Small rooted tours, all their solutions, and random cuts."""

from __future__ import annotations

import itertools
import math
from typing import Any

import numpy as np
from scipy.optimize import Bounds, LinearConstraint, milp
from scipy.sparse import csc_array

from optplan.domain.ordering import MatrixCosts, OrderingProblem
from optplan.ordering.arrays import dense_costs
from optplan.ordering.cutting.directed_graph import RootedTour
from optplan_models.highs import compile_model, load_values
from optplan_models.ordering.rooted import Ints, Rooted, with_depot
from tests.ordering_cases import random_problem


def rooted(problem: OrderingProblem) -> Rooted:
    """An open problem as the models take it."""
    return with_depot(
        dense_costs(problem),
        problem.cluster,
        problem.start_costs,
        problem.end_costs,
        problem.node_costs,
        problem.precedence,
    )


def as_model(tour: RootedTour) -> Rooted:
    """The solvers' rooted tour as the models take it."""
    inner = tour.order[: tour.clusters, : tour.clusters].copy()
    inner[tour.root] = 0
    return Rooted(tour.costs, tour.cluster, tour.root, np.argwhere(inner))


def tours(problem: OrderingProblem) -> list[Ints]:
    """Every solution of an open problem as a tour through the depot."""
    members = [np.flatnonzero(problem.cluster == c).tolist() for c in range(problem.clusters)]
    return [
        np.array([problem.nodes, *nodes])
        for order in itertools.permutations(range(problem.clusters))
        for nodes in itertools.product(*(members[c] for c in order))
        if not problem.faults(nodes)
    ]


def small(seed: int) -> OrderingProblem:
    """Three or four clusters of several nodes, or five of one; with precedence in two of three cases."""
    count = 3 + seed % 3
    kind = ("matrix", "holes", "negative", "ties")[seed % 4]
    problem = random_problem(kind, count, seed, precedence=seed % 9 > 2, start=seed % 5 == 0, end=seed % 7 == 0)
    if count < 5:
        return problem
    costs = MatrixCosts(np.random.default_rng(seed).uniform(-1, 10, (count, count)))
    return OrderingProblem(np.arange(count), costs, precedence=problem.precedence)


def used(solutions: list[Ints], count: int) -> Ints:
    """(tours, n * n) which arcs the tours use."""
    matrix = np.zeros((len(solutions), count, count), dtype=np.int64)
    for row, nodes in zip(matrix, solutions, strict=True):
        row[nodes, np.roll(nodes, -1)] = 1
    return matrix.reshape(len(solutions), -1)


def every_arc(count: int) -> Ints:
    """(n * n, 2) the arcs that are the columns of `used`."""
    return np.stack(np.divmod(np.arange(count * count), count), axis=1)


def least(model: Any, *, relaxed: bool = False) -> float:
    """The optimum of a model, or of its relaxation; the model gets the point. Infinite when there is none."""
    form = compile_model(model.clone() if relaxed else model)
    matrix = csc_array((form.values, form.index, form.starts), shape=(len(form.row_lower), len(form.costs)))
    result = milp(
        form.costs,
        integrality=0 * form.integer if relaxed else form.integer.astype(np.int64),
        bounds=Bounds(form.column_lower, form.column_upper),
        constraints=LinearConstraint(matrix, form.row_lower, form.row_upper),
        options={"mip_rel_gap": 0.0},
    )
    if result.x is None:
        return math.inf
    load_values(form, result.x)
    return float(result.fun) + form.offset
