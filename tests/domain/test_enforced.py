"""Enforced connections: chains, and what contradicts itself."""

from __future__ import annotations

from itertools import pairwise

import numpy as np
import pytest

from optplan.domain.enforced import chains
from optplan.domain.errors import InputError
from optplan.domain.ordering import EuclidCosts, MatrixCosts, OrderingProblem
from optplan.domain.stop import StopRule
from optplan.ordering import solve
from optplan.ordering.reduce import contracted
from tests.ordering_cases import cases

NONE = np.zeros((0, 2), dtype=np.int64)


def _rows(*rows: tuple[int, int, int]) -> np.ndarray[tuple[int, int], np.dtype[np.int64]]:
    return np.array(rows, dtype=np.int64).reshape(-1, 3)


def test_connections_that_share_a_cluster_form_a_chain() -> None:
    links = _rows((0, 3, 1), (1, 1, 4), (2, 0, 2))
    assert chains(np.arange(6), links, NONE) == [[0, 2], [3, 1, 4]]


@pytest.mark.parametrize(
    ("links", "precedence", "words"),
    [
        (_rows((0, 0, 1), (1, 1, 0)), [], "tied to"),
        (_rows((0, 0, 1), (1, 0, 2), (2, 0, 3)), [], "cluster 0 would be tied to clusters 1 and 2 and 3"),
        (_rows((0, 0, 1), (1, 1, 2), (2, 2, 0)), [], "ring"),
        (_rows((0, 0, 1), (0, 1, 2)), [], "the same two"),
        (_rows((0, 0, 0)), [], "two different clusters"),
        (_rows((1, 0, 1)), [], "without a gap"),
        (_rows((0, 0, 9)), [], "names node 9"),
        (_rows((0, 0, 1)), [(1, 0)], "clusters 0 - 1 cannot all be driven"),
        (_rows((0, 0, 1), (0, 1, 0)), [(0, 2), (2, 1)], "contradict precedence"),
    ],
)
def test_contradictions_are_named(links: object, precedence: list[tuple[int, int]], words: str) -> None:
    with pytest.raises(InputError, match=words):
        OrderingProblem(np.arange(4), MatrixCosts(np.zeros((4, 4))), precedence=np.array(precedence), enforced=links)  # type: ignore[arg-type]


def test_a_chain_must_agree_on_the_nodes_between() -> None:
    cluster = np.array([0, 1, 1, 2])
    with pytest.raises(InputError, match="different nodes"):
        OrderingProblem(cluster, MatrixCosts(np.zeros((4, 4))), enforced=_rows((0, 0, 1), (1, 2, 3)))


def test_an_enforced_arc_that_does_not_exist() -> None:
    problem = OrderingProblem(np.arange(3), MatrixCosts(np.full((3, 3), np.inf)), enforced=_rows((0, 0, 1)))
    with pytest.raises(InputError, match="infinite cost"):
        solve(problem, "nn")


@pytest.mark.parametrize("size", [2, 3, 5])
def test_long_connections_are_driven_all_the_same(size: int) -> None:
    """Pairs and chains along a line of points that no good order would follow."""
    points = np.column_stack([np.arange(10.0), np.zeros(10)])
    order = [0, 9, 1, 8, 2][:size]
    links = [(k, a, b) for k, (a, b) in enumerate(pairwise(order))]
    links += [(k, b, a) for k, a, b in links]
    problem = OrderingProblem(np.arange(10), EuclidCosts(points, points), enforced=_rows(*links))
    answer = solve(problem, "auto", StopRule(seconds=5))
    assert problem.faults(answer.nodes) == []
    free = OrderingProblem(np.arange(10), EuclidCosts(points, points))
    assert free.cost_of(answer.nodes) > solve(free, "auto", StopRule(seconds=5)).cost


@pytest.mark.parametrize("case", [c for c in cases() if len(c.problem.enforced)], ids=lambda c: c.name)
def test_a_contracted_path_costs_the_same(case: object) -> None:
    problem = case.problem  # type: ignore[attr-defined]
    smaller = contracted(problem)
    assert smaller.problem.clusters < problem.clusters
    answer = solve(smaller.problem, "brute")
    if len(answer.nodes):
        nodes = smaller.expand(answer.nodes)
        assert problem.faults(nodes) == []
        assert problem.cost_of(nodes) == pytest.approx(answer.cost)
        assert smaller.problem.cost_of(smaller.shrink(nodes)) == pytest.approx(answer.cost)
