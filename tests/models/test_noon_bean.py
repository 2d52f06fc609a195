"""Drawings as travelling-salesman problems: the published example, the optimum kept, and why the big M is needed."""

from __future__ import annotations

from collections.abc import Callable
from typing import Any

import numpy as np
import pytest

from optplan.domain.arrays import FloatArray, IntArray
from optplan.domain.ordering import EuclidCosts, MatrixCosts, OrderingProblem
from optplan.domain.stroke import Stroke
from optplan.ordering import solve
from optplan.problem import visits_of_tour
from optplan_models.ordering import noon_bean

inf = float("inf")
Strokes = list[tuple[FloatArray, bool]]
FORMS = [(noon_bean.weight_shifted, False), (noon_bean.double_cities, True)]


def elements(seed: int, kinds: str) -> Strokes:
    """Polygons (p) and polylines (l) in a unit square, in either sense."""
    rng = np.random.default_rng(seed)
    strokes: Strokes = []
    for kind in kinds:
        middle, turn = rng.uniform(size=2), rng.choice([-1, 1])
        angles = turn * np.sort(rng.uniform(0, 2 * np.pi, 3))
        ring = middle + 0.3 * np.column_stack([np.cos(angles), np.sin(angles)])
        strokes.append((ring, True) if kind == "p" else (ring[:2], False))
    return strokes


def parts(strokes: Strokes) -> tuple[tuple[Any, ...], OrderingProblem]:
    nodes = noon_bean.drawing(strokes)
    begin = np.linalg.norm(nodes.enter, axis=1)
    zeros = np.zeros(len(begin))
    problem = OrderingProblem(nodes.cluster, EuclidCosts(nodes.leave, nodes.enter), begin)
    return (nodes.costs(), nodes.cluster, begin, zeros, zeros), problem


def tour(weights: FloatArray) -> tuple[float, list[int]]:
    """The best tour, numbered from 1, by dynamic programming; its cost with the way back."""
    cities = len(weights) - 1
    path = OrderingProblem(np.arange(cities), MatrixCosts(weights[1:, 1:]), weights[0, 1:], weights[1:, 0])
    answer = solve(path, "brute")
    return answer.cost, [1, *(answer.nodes + 2).tolist(), -1]


def test_the_published_example() -> None:
    ends = np.array([[1717.0, 1959, 1173, 698], [1732, 1489, 467, 993]])
    costs = np.zeros((6, 6))
    # node 4 is entered at the first end and left at the second, node 5 the other way round
    costs[4, :4], costs[5, :4] = ends[1], ends[0]
    costs[:4, 4], costs[:4, 5] = ends[0], ends[1]
    cluster, zeros = np.array([0, 0, 0, 0, 1, 1]), np.zeros(6)
    begin = np.array([1812.0, 2097, 1328, 806, 156, 1127])
    weights = noon_bean.weight_shifted(costs, cluster, begin, zeros, zeros)
    assert weights.tolist() == [
        [inf, 1812, 2097, 1328, 806, 156, 1127],
        [1, inf, 0, inf, inf, 1959, 1489],
        [1, inf, inf, 0, inf, 1173, 467],
        [1, inf, inf, inf, 0, 698, 993],
        [1, 0, inf, inf, inf, 1717, 1732],
        [1, 1717, 1959, 1173, 698, inf, 0],
        [1, 1732, 1489, 467, 993, 0, inf],
    ]
    cost, best = tour(weights)
    assert (cost - 1, best) == (623, [1, 6, 7, 4, 5, 2, 3, -1])
    nodes = noon_bean.nodes_of(best, cluster)
    assert nodes.tolist() == [4, 2]
    assert noon_bean.tour_of(nodes, cluster).tolist() == best


@pytest.mark.parametrize(("form", "double"), FORMS, ids=["shifted", "double"])
@pytest.mark.parametrize("kinds", ["pp", "pl", "lpl", "p", "l"])
def test_the_optimum_is_kept(form: Callable[..., FloatArray], double: bool, kinds: str) -> None:
    for seed in range(6):
        given, problem = parts(elements(seed, kinds))
        big = noon_bean.sufficient(*given)
        cost, best = tour(form(*given, big=big))
        optimum = solve(problem, "brute").cost
        assert cost - 1 - big * (len(kinds) - 1) == pytest.approx(optimum)
        nodes = noon_bean.nodes_of(best, given[1], double=double)
        assert problem.faults(nodes) == []
        assert problem.cost_of(nodes) == pytest.approx(optimum)


@pytest.mark.parametrize(("form", "double"), FORMS, ids=["shifted", "double"])
def test_ends_node_costs_and_missing_arcs(form: Callable[..., FloatArray], double: bool) -> None:
    for seed in range(12):
        rng = np.random.default_rng(seed)
        cluster = np.array([0, 0, 1, 2, 2])
        costs = np.where(rng.random((5, 5)) < 0.2, inf, rng.uniform(-2, 5, (5, 5)))
        ends = rng.uniform(0, 3, (3, 5))
        problem = OrderingProblem(cluster, MatrixCosts(costs), *ends)
        big = noon_bean.sufficient(costs, cluster, *ends)
        cost, best = tour(form(costs, cluster, *ends, big=big, back=0.0))
        optimum = solve(problem, "brute").cost
        nodes = noon_bean.nodes_of(best, cluster, double=double)
        if np.isfinite(optimum):
            assert cost - 2 * big == pytest.approx(optimum)
            assert problem.cost_of(nodes) == pytest.approx(optimum)
        else:
            assert len(nodes) != 3 or not np.isfinite(cost)


@pytest.mark.parametrize(("form", "double", "kinds"), [(*FORMS[0], "ppppll"), (*FORMS[1], "plll")])
def test_without_a_big_m_polygons_are_split(form: Callable[..., FloatArray], double: bool, kinds: str) -> None:
    """Without it the problem is a relaxation, and its "optimal" tour no plan."""
    split = 0
    for seed in range(20):
        given, problem = parts(elements(seed, kinds))
        cost, best = tour(form(*given))
        optimum = solve(problem, "brute").cost
        assert cost - 1 <= optimum + 1e-9
        pieces = noon_bean.nodes_of(best, given[1], double=double)
        if len(pieces) > len(kinds):
            split += 1
            assert cost - 1 < optimum
    assert split > 0


def test_tours_mean_the_same_strokes_as_elsewhere() -> None:
    """Polygons are listed clockwise here; for those the numbering is that of the strokes."""
    square = np.array([[0.0, 0], [0, 1], [1, 1], [1, 0]])
    line = np.array([[3.0, 0], [4, 1], [5, 0]])
    nodes = noon_bean.drawing([(square, True), (line, False)])
    assert nodes.vertex.tolist() == [0, 1, 2, 3, 0, 2]
    visits = visits_of_tour([1, 6, 7, 4, 5, 2, 3, -1], [Stroke("a", square, closed=True), Stroke("b", line)])
    path: IntArray = noon_bean.nodes_of([1, 6, 7, 4, 5, 2, 3, -1], nodes.cluster)
    assert [(stroke, vertex) for stroke, vertex, _ in visits] == [
        (int(nodes.cluster[k]), int(nodes.vertex[k])) for k in path
    ]
    assert noon_bean.drawing([(square[::-1], True)]).vertex.tolist() == [3, 2, 1, 0]


def test_a_split_stroke_is_seen() -> None:
    cluster = np.array([0, 0, 0, 1, 1])
    assert noon_bean.nodes_of([1, 2, 5, 6, 3, 4], cluster).tolist() == [0, 3, 1]
