"""The search: valid, repeatable, and optimal where every path can be looked at."""

from __future__ import annotations

import csv
import math
import time
from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest

from optplan.domain.costs import EuclidCosts, MatrixCosts
from optplan.domain.ordering import OrderingProblem
from optplan.domain.stop import StopReason, StopRule
from optplan.ordering import SOLVERS, solve
from optplan.ordering.graph import circular_graph
from optplan.ordering.population import neighbours
from optplan.ordering.tsplib import read_tsplib
from tests.ordering_cases import Case, cases, strokes

LIBRARY = Path(__file__).parents[2].parent / "shared" / "data" / "ordering"
LONG = StopRule(iterations=10**9)


def rings(count: int, corners: int, seed: int = 0) -> OrderingProblem:
    """Closed strokes, entered and left at any corner, and open ones in turn."""
    rng = np.random.default_rng(seed)
    entries, exits, cluster = [], [], []
    for c in range(count):
        centre = rng.uniform(size=2) * math.sqrt(count)
        if c % 2:
            angle = np.sort(rng.uniform(0, 2 * math.pi, corners))
            points = centre + 0.3 * np.column_stack([np.cos(angle), np.sin(angle)])
            entries.append(points)
            exits.append(points)
        else:
            ends = centre + rng.normal(0, 0.2, (2, 2))
            entries.append(ends)
            exits.append(ends[::-1])
        cluster += [c] * len(entries[-1])
    return OrderingProblem(np.array(cluster), EuclidCosts(np.concatenate(exits), np.concatenate(entries)))


def random_matrix(count: int, seed: int, density: float) -> OrderingProblem:
    """One node a cluster, random asymmetric costs, and that share of all pairs as precedence."""
    rng = np.random.default_rng(seed)
    names = rng.permutation(count)
    pairs = [(names[a], names[b]) for a in range(count) for b in range(a + 1, count) if rng.random() < density]
    matrix = MatrixCosts(rng.integers(0, 1000, (count, count)).astype(np.float64))
    return OrderingProblem(np.arange(count), matrix, precedence=np.array(pairs, dtype=np.int64).reshape(-1, 2))


@pytest.mark.parametrize("case", list(cases()), ids=lambda c: c.name)
def test_finds_every_small_optimum(case: Case) -> None:
    answer = solve(case.problem, "search", StopRule(iterations=300))
    if math.isfinite(case.optimum):
        assert case.problem.faults(answer.nodes) == []
        assert answer.cost == pytest.approx(case.optimum, abs=1e-9 * max(1.0, abs(case.optimum)))
    else:
        assert len(answer.nodes) == 0


@pytest.mark.parametrize("file", ["atsp/ftv33.atsp", "sop/ry48p.3.sop", "gtsp/20kroa100.gtsp", "pcgtsp/ESC25.pcglns"])
def test_reaches_the_known_values_of_libraries(file: str) -> None:
    path = LIBRARY / file
    if not path.exists():
        pytest.skip("the libraries are not here")
    with (LIBRARY / "best_known.csv").open() as table:
        known = {(row["class"], row["instance"]): float(row["best_known"]) for row in csv.DictReader(table)}
    problem = read_tsplib(path).problem
    answer = solve(problem, "search", StopRule(iterations=20_000))
    assert problem.faults(answer.nodes) == []
    assert answer.cost <= known[path.parent.name, path.stem] + 1e-6


def test_a_symmetric_tour_may_be_closed_anywhere() -> None:
    problem = replace(rings(12, 6), closed=True)
    first = solve(problem, "search", StopRule(iterations=3000))
    turned = replace(problem, start_costs=np.where(problem.cluster == 7, 0.0, math.inf))
    second = solve(turned, "search", StopRule(iterations=3000))
    assert problem.cluster[second.nodes[0]] == 7
    assert first.cost == pytest.approx(second.cost)


@pytest.mark.parametrize("closed", [False, True])
@pytest.mark.parametrize("problem", [rings(40, 8), random_matrix(60, 1, 0.05)], ids=["rings", "matrix"])
def test_same_seed_and_iterations_same_answer(problem: OrderingProblem, closed: bool) -> None:
    problem = replace(problem, closed=closed)
    answers = [solve(problem, "search", StopRule(seconds, 700), seed=3) for seconds in (60.0, 600.0)]
    assert answers[0].nodes.tolist() == answers[1].nodes.tolist()
    assert answers[0].iterations >= 700


@pytest.mark.parametrize("closed", [False, True])
def test_several_annealings_keep_to_their_limit(closed: bool) -> None:
    problem, limit = replace(rings(25, 8), closed=closed), 25 * 1000 + 7
    answers = [solve(problem, "search", StopRule(iterations=limit), seed=seed) for seed in (3, 3, 4)]
    assert answers[0].nodes.tolist() == answers[1].nodes.tolist()
    assert all(answer.iterations == limit and problem.faults(answer.nodes) == [] for answer in answers)
    assert answers[0].cost == pytest.approx(answers[2].cost, rel=1e-9)


def test_mergers_know_only_the_arcs_of_both() -> None:
    problem = rings(6, 4)
    graph = circular_graph(problem, None, lambda: None)
    near = neighbours(graph, [np.array([0, 1, 2, 3, 4, 5, 6]), np.array([0, 2, 1, 3, 4, 5, 6])])
    assert near.shape == (2, 7, 4)
    assert near[0].tolist() == near[1].tolist()
    assert near[0][:2].tolist() == [[1, 2, 6, -1], [0, 2, 3, -1]]
    assert near[0][5].tolist() == [4, 6, -1, -1]


@pytest.mark.parametrize("density", [0.01, 0.15, 0.6])
def test_all_densities_of_precedence(density: float) -> None:
    problem = random_matrix(80, 2, density)
    answer = solve(problem, "search", StopRule(iterations=3000))
    assert problem.faults(answer.nodes) == []
    assert answer.cost <= solve(problem, "nn").cost
    assert answer.cost == pytest.approx(problem.cost_of(answer.nodes))


def test_arcs_that_do_not_exist() -> None:
    """A ring of arcs hidden among few others."""
    rng = np.random.default_rng(5)
    count = 40
    matrix = np.where(rng.random((count, count)) < 0.1, rng.uniform(1, 2, (count, count)), math.inf)
    order = rng.permutation(count)
    matrix[order, np.roll(order, -1)] = 1.5
    problem = OrderingProblem(np.arange(count), MatrixCosts(matrix), closed=True)
    answer = solve(problem, "search", StopRule(iterations=20_000))
    assert problem.faults(answer.nodes) == []
    assert answer.cost <= 1.5 * count


def test_costs_on_demand_are_those_written_out(monkeypatch: pytest.MonkeyPatch) -> None:
    problem = rings(30, 6)
    rng = np.random.default_rng(0)
    problem = replace(problem, start_costs=rng.uniform(0, 3, problem.nodes), end_costs=rng.uniform(0, 3, problem.nodes))
    written = solve(problem, "search", StopRule(iterations=3000))
    monkeypatch.setattr("optplan.ordering.graph.DENSE_NODES", 10)
    on_demand = solve(problem, "search", StopRule(iterations=3000))
    assert problem.faults(on_demand.nodes) == []
    assert on_demand.cost == pytest.approx(written.cost, rel=0.01)


def test_starts_from_the_given_path_and_stops_at_the_target() -> None:
    problem = strokes(60)
    good = solve(problem, "search", StopRule(iterations=5000))
    again = solve(problem, "search", StopRule(iterations=0), start=good.nodes)
    assert again.cost <= good.cost
    reached = solve(problem, "search", replace(LONG, target=1.05 * good.cost))
    assert reached.stopped is StopReason.TARGET
    assert reached.cost <= 1.05 * good.cost


def test_ends_by_itself() -> None:
    answer = solve(strokes(10), "search")
    assert answer.stopped is StopReason.FINISHED
    assert answer.iterations > 1000


def test_cancel_is_obeyed_at_once() -> None:
    problem = rings(1500, 8)
    solve(rings(6, 5), "search", StopRule(iterations=10))  # compiled before the clock runs
    asked: list[float] = []

    def cancelled() -> bool:
        asked.append(time.process_time())
        return len(asked) > 60

    answer = solve(problem, "search", replace(LONG, cancelled=cancelled))
    assert answer.stopped is StopReason.CANCELLED
    assert problem.faults(answer.nodes) == []
    # it asks again and again, so that a cancel at any moment is seen soon
    assert np.diff(asked)[-20:].max() < 0.5


def test_takes_closed_paths_itself() -> None:
    closed = replace(strokes(8), closed=True)
    assert SOLVERS["search"].refusal(closed) is None
    best = solve(closed, "brute").cost
    assert solve(closed, "search", StopRule(iterations=500)).cost == pytest.approx(best)


@pytest.mark.parametrize("kind", ["matrix", "line"])
def test_costs_of_nodes_do_not_mislead_reversals(kind: str) -> None:
    """What a piece costs backwards depends on its nodes' own costs, and on all coordinates."""
    rng = np.random.default_rng(15)
    cluster = np.repeat(np.arange(9), 3)
    own = rng.uniform(0, 2, len(cluster))
    if kind == "matrix":
        half = rng.uniform(0, 10, (27, 27))
        problem = OrderingProblem(cluster, MatrixCosts(half + half.T), node_costs=own)
    else:
        a, b = rng.uniform(0, 1, (2, 18, 3))
        a[1::2], b[1::2] = b[::2], a[::2]
        b[:, 2] += 1.0  # turned round in the plane, not in space
        problem = OrderingProblem(np.repeat(np.arange(9), 2), EuclidCosts(a, b))
    answer = solve(problem, "search", StopRule(iterations=2000))
    assert answer.cost == pytest.approx(solve(problem, "brute").cost)
