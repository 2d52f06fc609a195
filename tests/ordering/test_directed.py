"""Exact ordering of directed and precedence-constrained problems by cuts."""

from __future__ import annotations

import itertools
import json
import math
from pathlib import Path

import numpy as np
import pytest
from scipy.sparse import csr_array
from scipy.sparse.csgraph import maximum_flow

from optplan.domain.arrays import IntArray
from optplan.domain.ordering import EuclidCosts, MatrixCosts, OrderingProblem, Status
from optplan.domain.stop import StopReason, StopRule
from optplan.ordering._kernels.maxflow import SINK_SIDE, SOURCE_SIDE, max_flow, network
from optplan.ordering.cutting.directed import Root, directed_bound, root, solve_directed
from optplan.ordering.cutting.directed_branching import Choice
from optplan.ordering.cutting.directed_graph import rooted_tour, takes_closed
from optplan.ordering.cutting.directed_root import CutLoop
from optplan.ordering.cutting.lp import Solution
from optplan.ordering.method import Method
from optplan.ordering.tsplib import read_tsplib
from tests.ordering_cases import Case, cases, random_problem


@pytest.mark.parametrize("seed", range(60))
def test_both_minimum_cuts_have_the_value_of_the_flow(seed: int) -> None:
    rng = np.random.default_rng(seed)
    count = int(rng.integers(2, 30))
    arcs = rng.integers(0, count, (int(rng.integers(1, 6 * count)), 2))
    arcs = np.ascontiguousarray(arcs[arcs[:, 0] != arcs[:, 1]])
    capacity = rng.integers(0, 6, len(arcs)).astype(np.float64)
    closed = (rng.random(count) < 0.2).astype(np.int64)
    closed[[0, count - 1]] = 0
    tails, heads = arcs[:, 0].copy(), arcs[:, 1].copy()
    net = network(count, tails, heads)
    residual = np.zeros(2 * len(arcs))
    residual[net.slot] = capacity
    side = np.zeros(count, dtype=np.int64)
    value = max_flow(net, residual, closed, 0, count - 1, math.inf, side)

    capacity[(closed[tails] == 1) | (closed[heads] == 1)] = 0.0
    matrix = csr_array((capacity.astype(np.int32), (tails, heads)), shape=(count, count))
    assert value == maximum_flow(matrix, 0, count - 1).flow_value
    reached, reaching = side == SOURCE_SIDE, side == SINK_SIDE
    assert capacity[reached[tails] & ~reached[heads]].sum() == value
    assert capacity[~reaching[tails] & reaching[heads]].sum() == value


METHOD = Method("cuts", "by cuts", solve_directed, closed=True)
CASES = list(cases())
DATA = Path(__file__).resolve().parents[2].parent / "shared" / "data"


@pytest.mark.parametrize("case", CASES[::2], ids=lambda c: c.name)
def test_the_optimum_is_proved(case: Case) -> None:
    answer = METHOD.solve(case.problem, StopRule(), seed=0)
    assert answer.stopped is StopReason.FINISHED
    if math.isinf(case.optimum):
        assert answer.status is Status.INFEASIBLE
    else:
        assert answer.status is Status.OPTIMAL
        assert answer.cost == pytest.approx(case.optimum, abs=1e-6 * max(1.0, abs(case.optimum)))
        assert case.problem.faults(answer.nodes) == []


def reduced_cost(found: Root, problem: OrderingProblem, nodes: IntArray) -> float:
    """What the root says that a solution costs at least."""
    total = found.bound + float(found.arcs[nodes[:-1], nodes[1:]].sum())
    if problem.closed:
        return total + float(found.arcs[nodes[-1], nodes[0]])
    return total + float(found.start[nodes[0]] + found.end[nodes[-1]])


@pytest.mark.parametrize("seed", range(12))
@pytest.mark.parametrize("closed", [False, True])
def test_the_root_holds_for_every_solution(seed: int, closed: bool) -> None:
    kind = ("matrix", "holes", "negative", "ties")[seed % 4]
    problem = random_problem(kind, 4, seed, precedence=seed % 3 > 0, start=False, end=seed % 5 == 0, closed=closed)
    if closed and not takes_closed(problem):
        return
    solutions = [
        np.array(nodes)
        for order in itertools.permutations(range(problem.clusters))
        for nodes in itertools.product(*(np.flatnonzero(problem.cluster == c).tolist() for c in order))
        if not problem.faults(nodes)
    ]
    costs = [problem.cost_of(nodes) for nodes in solutions]
    incumbent = float(np.median(costs)) if costs else math.inf
    slack = 1e-6 * max(1.0, abs(incumbent)) if costs else 0.0
    free, limited = root(problem), root(problem, incumbent)
    assert (free.arcs >= 0).all()
    assert (free.start >= 0).all()
    assert (free.end >= 0).all()
    for nodes, cost in zip(solutions, costs, strict=True):
        assert cost >= reduced_cost(free, problem, nodes) - 1e-9
        if cost < incumbent - slack:
            assert cost >= reduced_cost(limited, problem, nodes) - 1e-9
    assert directed_bound(problem) <= min(costs, default=math.inf) + 1e-9


def test_a_choice_parts_the_tours_in_two() -> None:
    tour = rooted_tour(random_problem("matrix", 4, 5, precedence=False, start=False, end=False))
    sizes = np.bincount(tour.cluster)
    assert sizes.max() > 1
    first = np.searchsorted(tour.cluster, np.arange(tour.clusters))
    options = [range(low, low + size) for low, size in zip(first.tolist(), sizes.tolist(), strict=True)]
    rest = [c for c in range(tour.clusters) if c != tour.root]
    nodes = [Choice(v) for v in range(tour.nodes) if sizes[tour.cluster[v]] > 1]
    pairs = [Choice(c, d) for c in range(tour.clusters) for d in range(tour.clusters) if c != d]
    for order in itertools.permutations(rest):
        for used in itertools.product(*(options[c] for c in (tour.root, *order))):
            tails = np.array(used)
            heads = np.roll(tails, -1)
            clusters = tour.cluster[tails].tolist()
            after = set(zip(clusters, [*clusters[1:], clusters[0]], strict=True))
            for choice in (*nodes, *pairs):
                with_it = not choice.excluded(tour, tails, heads, used=True).any()
                without = not choice.excluded(tour, tails, heads, used=False).any()
                assert with_it != without
                assert with_it == (
                    (choice.first, choice.second) in after if choice.second >= 0 else choice.first in used
                )


def test_a_probe_never_promises_too_much() -> None:
    problem = random_problem("matrix", 12, 2, precedence=True, start=False, end=False)
    loop = CutLoop(rooted_tour(problem), lambda: False)
    loop.start()
    loop.run()
    inner = loop.programme.programme
    one = np.array([int(np.argmax(loop.programme.primal < 0.5))])
    inner.set_bounds(one, np.ones(1), np.ones(1))
    estimates = [inner.probe(iterations) for iterations in (1, 1000)]
    solved = inner.solve()
    exact = solved.objective if isinstance(solved, Solution) else math.inf
    assert estimates[0] <= exact + 1e-6
    assert estimates[1] == pytest.approx(exact)


def test_cancel_is_heard_and_the_best_so_far_kept() -> None:
    problem = random_problem("matrix", 40, 1, precedence=True, start=False, end=False)
    calls = []

    def cancelled() -> bool:
        calls.append(1)
        return len(calls) > 60

    answer = METHOD.solve(problem, StopRule(cancelled=cancelled), seed=0)
    assert answer.stopped is StopReason.CANCELLED or answer.status is Status.OPTIMAL
    assert problem.faults(answer.nodes) == []
    assert answer.bound <= answer.cost


def test_iterations_are_nodes_of_the_tree() -> None:
    costs = MatrixCosts(np.random.default_rng(3).integers(0, 20, (30, 30)).astype(np.float64))
    pairs = np.array([(a, a + 11) for a in range(0, 18, 2)])
    problem = OrderingProblem(np.arange(30), costs, precedence=pairs)
    answers = [METHOD.solve(problem, StopRule(iterations=limit), seed=0) for limit in (0, 2, 2)]
    assert answers[0].iterations == 0
    assert answers[1].iterations <= 2
    assert answers[1].nodes.tolist() == answers[2].nodes.tolist()
    assert answers[1].bound == answers[2].bound
    bounds = [point.bound for point in answers[1].trace]
    assert bounds == sorted(bounds)


@pytest.mark.skipif(not DATA.is_dir(), reason="the benchmark data are not there")
@pytest.mark.parametrize(
    ("name", "best"),
    [("atsp/ft53.atsp", 6905), ("atsp/ftv70.atsp", 1950), ("sop/ESC25.sop", 1681), ("sop/rbg048a.sop", 351)],
)
def test_known_optima(name: str, best: float) -> None:
    answer = METHOD.solve(read_tsplib(DATA / "ordering" / name).problem, StopRule(), seed=0)
    assert (answer.status, answer.cost) == (Status.OPTIMAL, best)


@pytest.mark.skipif(not DATA.is_dir(), reason="the benchmark data are not there")
def test_a_wall_to_be_washed_is_proved() -> None:
    wall = json.loads((DATA / "washing" / "case1.json").read_text())
    places, radius, rule = np.array(wall["circles"]), wall["radius"], wall["rule"]
    aside = np.abs(places[:, None, 0] - places[:, 0]) < rule["d"] * radius
    above = places[:, 1] - places[:, None, 1] >= rule["tau"] * radius
    problem = OrderingProblem(
        np.arange(len(places)), EuclidCosts(places, places), precedence=np.argwhere(above & aside)
    )
    answer = METHOD.solve(problem, StopRule(), seed=0)
    assert answer.status is Status.OPTIMAL
    assert answer.cost == pytest.approx(wall["optimum"], abs=1e-3)


def test_nothing_is_proved_when_there_is_no_time() -> None:
    """The bound is then minus infinity, and some arcs do not exist: neither may be mistaken for the other."""
    problem = random_problem("holes", 6, 1, precedence=True, start=False, end=False)
    found = root(problem, 50.0, StopRule(cancelled=lambda: True), np.zeros(0, dtype=np.int64))
    assert found.bound == -math.inf
    assert not np.isnan(found.arcs).any()
