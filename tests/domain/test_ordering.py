"""The ordering problem and its answers."""

from __future__ import annotations

import math
from collections.abc import Callable
from itertools import pairwise

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from optplan.domain.errors import InputError
from optplan.domain.ordering import (
    DubinsCosts,
    EuclidCosts,
    MatrixCosts,
    Ordering,
    OrderingProblem,
    Status,
    precedence_cycle,
)
from optplan.domain.stop import StopReason
from optplan.geometry.dubins import dubins_lengths
from tests.strategies import array


def _problem(**more: object) -> OrderingProblem:
    matrix = array([[0, 1, 2], [3, 0, 4], [5, math.inf, 0]])
    given: dict[str, object] = {"cluster": [0, 1, 1], "costs": MatrixCosts(matrix)} | more
    return OrderingProblem(**given)  # type: ignore[arg-type]


def test_costs_add_up() -> None:
    problem = _problem(start_costs=[10, 20, 30], end_costs=[100, 200, 300], node_costs=[0, 0, 0.5])
    assert problem.nodes == 3
    assert problem.clusters == 2
    assert problem.first_node.tolist() == [0, 1, 3]
    assert problem.cost_of([0, 2]) == 10 + 2 + 300 + 0.5
    assert problem.cost_of([1, 0]) == 20 + 3 + 100
    assert problem.cost_of([]) == 0


def test_faults_are_named() -> None:
    problem = _problem(precedence=[[0, 1]])
    assert problem.faults([0, 1]) == []
    assert problem.faults([1, 0]) == ["cluster 0 must come before cluster 1"]
    assert problem.faults([0]) == ["cluster 1 is visited 0 times"]
    assert problem.faults([1, 2]) == ["cluster 0 is visited 0 times"]
    assert problem.faults([0, 3]) == ["nodes must be 0..2"]
    blocked = _problem(start_costs=[math.inf, 0, 0])
    assert blocked.faults([0, 1]) == ["the cost is infinite: an arc is used that does not exist"]


BROKEN: list[Callable[[], object]] = [
    lambda: _problem(cluster=[0, 2, 2]),
    lambda: _problem(cluster=[1, 1, 2]),
    lambda: _problem(cluster=[0, 1, 0]),
    lambda: _problem(cluster=[0, 1]),
    lambda: _problem(start_costs=[0, 1]),
    lambda: _problem(start_costs=[0, 1, math.nan]),
    lambda: _problem(end_costs=[0, 1, -math.inf]),
    lambda: _problem(node_costs=[0, 1, -math.inf]),
    lambda: _problem(node_costs=[0, 1, math.inf]),
    lambda: _problem(precedence=[[0, 2]]),
    lambda: _problem(precedence=[[-1, 0]]),
    lambda: _problem(precedence=[[0, 1], [1, 0]]),
    lambda: _problem(precedence=[[1, 1]]),
    lambda: MatrixCosts(array([[0, -math.inf], [0, 0]])),
    lambda: MatrixCosts(array([[0, math.nan], [0, 0]])),
    lambda: MatrixCosts(array([[0, 1]])),
    lambda: EuclidCosts(np.zeros((2, 2)), np.zeros((3, 2))),
    lambda: DubinsCosts(np.zeros((2, 3)), np.zeros((2, 3)), 0.0, dubins_lengths),
]


@pytest.mark.parametrize("make", BROKEN, ids=range(len(BROKEN)))
def test_broken_problems(make: Callable[[], object]) -> None:
    with pytest.raises(InputError):
        make()


def test_a_cycle_is_named() -> None:
    with pytest.raises(InputError, match="0 before 1 before 0"):
        _problem(precedence=[[0, 1], [1, 0]])


@given(st.integers(1, 7), st.lists(st.tuples(st.integers(0, 6), st.integers(0, 6)), max_size=12))
def test_cycles_are_found_exactly_when_there_are_any(count: int, pairs: list[tuple[int, int]]) -> None:
    pairs = [(a % count, b % count) for a, b in pairs]
    cycle = precedence_cycle(count, np.array(pairs, dtype=np.int64).reshape(-1, 2))
    reach = np.zeros((count, count), dtype=bool)
    for a, b in pairs:
        reach[a, b] = True
    for middle in range(count):  # transitive closure
        reach |= np.outer(reach[:, middle], reach[middle])
    assert bool(cycle) == bool(reach.diagonal().any())
    if cycle:
        assert cycle[0] == cycle[-1]
        assert all(step in pairs for step in pairwise(cycle))


def test_euclid_costs() -> None:
    costs = EuclidCosts(array([[0, 0, 0], [1, 1, 1]]), array([[3, 4, 0], [1, 1, 3]]))
    assert costs.pairs(np.array([0, 1]), np.array([0, 1])).tolist() == [5, 2]


def _answer(cost: float, bound: float, status: Status = Status.FEASIBLE) -> Ordering:
    return Ordering(np.array([0]), cost, bound, status, StopReason.FINISHED, "test")


def test_gaps() -> None:
    assert _answer(10, 8).gap == pytest.approx(0.2)
    assert _answer(10, 10, Status.OPTIMAL).gap == 0
    assert _answer(10, -math.inf).gap == math.inf
    assert _answer(10, -10).gap == 2
    assert _answer(0, 0, Status.OPTIMAL).gap == 0
    assert _answer(math.inf, math.inf, Status.INFEASIBLE).gap == 0
    with pytest.raises(InputError, match="optimal"):
        _answer(10, 8, Status.OPTIMAL)
    with pytest.raises(InputError, match="NaN"):
        _answer(math.nan, 8)


def test_a_closed_path_pays_for_the_way_back() -> None:
    problem = _problem(closed=True)
    assert problem.cost_of([0, 2]) == 2 + 5
    assert problem.cost_of([0, 1]) == 1 + 3
    blocked = _problem(costs=MatrixCosts(array([[0, 1, 2], [math.inf, 0, 4], [5, 0, 0]])), closed=True)
    assert blocked.faults([0, 1]) == ["the cost is infinite: an arc is used that does not exist"]
    alone = OrderingProblem(np.zeros(1, dtype=np.int64), MatrixCosts(np.ones((1, 1))), closed=True)
    assert alone.cost_of([0]) == 0
