"""The dynamic programme over order ideals, its bounds, beams and branch and bound."""

from __future__ import annotations

import itertools
import json
import math
from pathlib import Path

import numpy as np
import pytest

from optplan.domain.arrays import IntArray
from optplan.domain.ordering import EuclidCosts, MatrixCosts, OrderingProblem, Status
from optplan.domain.stop import StopReason, StopRule
from optplan.ordering import SOLVERS, ideals_layers, solve
from optplan.ordering.cutoff import cutoff
from optplan.ordering.ideals import prove_by_ideals
from optplan.ordering.ideals_bound import Relaxation
from optplan.ordering.ideals_layers import sweep
from optplan.ordering.ideals_network import Reduced, Side, bit_sets, closure, sides
from optplan.ordering.method import Run
from optplan.ordering.tsplib import read_tsplib
from tests.ordering_cases import KINDS, optimum, random_problem, strokes

DATA = Path(__file__).parents[3] / "shared" / "data"
NEW = pytest.mark.parametrize("solver", ["dp", "beam", "bnb"])


def run_of(problem: OrderingProblem, rule: StopRule | None = None) -> Run:
    return Run(problem, (rule or StopRule()).start())


def small(seed: int) -> OrderingProblem:
    kind = KINDS[seed % len(KINDS)]
    ends = {"start": seed % 3 == 0, "end": seed % 2 == 0}
    return random_problem(kind, 6, seed, precedence=seed % 5 != 0, **ends)


def ordered(count: int, density: float, seed: int, nodes: int = 1) -> OrderingProblem:
    """Whole numbers, and that share of pairs of clusters ordered before closure."""
    rng = np.random.default_rng(seed)
    pairs = [(a, b) for a, b in itertools.combinations(range(count), 2) if rng.random() < density]
    costs = MatrixCosts(rng.integers(0, 1000, (count * nodes, count * nodes)).astype(float))
    precedence = np.array(pairs, dtype=np.int64).reshape(-1, 2)
    return OrderingProblem(np.repeat(np.arange(count), nodes), costs, precedence=precedence)


def feasible_paths(problem: OrderingProblem, rng: np.random.Generator, wanted: int) -> list[IntArray]:
    """Random paths that obey precedence; some may use arcs that do not exist."""
    before = closure(problem.clusters, problem.precedence)
    paths = []
    for _ in range(wanted):
        left, nodes = set(range(problem.clusters)), []
        while left:
            ready = [c for c in left if not any(before[b, c] for b in left)]
            c = int(rng.choice(ready))
            left.remove(c)
            nodes.append(int(rng.integers(problem.first_node[c], problem.first_node[c + 1])))
        paths.append(np.array(nodes))
    return paths


def bounds_along(relaxation: Relaxation, direction: int, path: IntArray) -> list[float]:
    """The bound of every beginning of a path, seen from one of its ends."""
    problem = relaxation.problem
    guide = relaxation.guide(direction, run_of(problem))
    assert guide is not None
    nodes = path[::-1] if direction else path
    spent = guide.base + guide.start[nodes[0]]
    bounds = []
    for place, node in enumerate(nodes):
        if place:
            spent += guide.arcs[nodes[place - 1], node]
        done = set(problem.cluster[nodes[: place + 1]].tolist())
        table = guide.second if guide.following[place, node] in done else guide.best
        bounds.append(float(spent + table[place, node]))
    return bounds


@pytest.mark.parametrize("seed", range(24))
def test_no_beginning_of_a_path_is_bounded_above_its_cost(seed: int) -> None:
    problem = small(seed)
    rng = np.random.default_rng(seed)
    relaxation = Relaxation(problem)
    best = optimum(problem)
    for _ in range(3):
        for path in feasible_paths(problem, rng, 10):
            cost = problem.cost_of(path)
            for direction in (0, 1):
                bounds = bounds_along(relaxation, direction, path)
                assert max(bounds) <= cost + 1e-9 * max(1.0, abs(cost))
                if math.isfinite(cost):
                    assert bounds[-1] == pytest.approx(cost)
        relaxation.ascend(run_of(problem), 7)
        assert relaxation.bound <= best + relaxation.rounding


@pytest.mark.parametrize("seed", range(24))
def test_no_path_below_the_cutoff_is_eliminated(seed: int) -> None:
    problem = small(seed)
    relaxation = Relaxation(problem)
    relaxation.ascend(run_of(problem), 30)
    paths = feasible_paths(problem, np.random.default_rng(seed), 200)
    costs = np.array([problem.cost_of(path) for path in paths])
    if not np.isfinite(costs).any():
        pytest.skip("no path of existing arcs was drawn")
    limit = float(np.quantile(costs[np.isfinite(costs)], 0.3, method="nearest"))
    relaxation.eliminate(run_of(problem), limit + 1e-9 * abs(limit))
    for path, cost in zip(paths, costs, strict=True):
        if cost <= limit:
            for direction in (0, 1):
                assert max(bounds_along(relaxation, direction, path)) == pytest.approx(cost)


@pytest.mark.parametrize("width", [1, 3, 10, 10_000])
@pytest.mark.parametrize("seed", range(8))
def test_a_sweep_bounds_what_it_drops(seed: int, width: int) -> None:
    problem = ordered(9, 0.25, seed, nodes=2)
    best = solve(problem, "brute").cost
    relaxation = Relaxation(problem)
    relaxation.ascend(run_of(problem), 10)
    for direction in (0, 1):
        run = run_of(problem)
        guide = relaxation.guide(direction, run)
        assert guide is not None
        found = sweep(run, relaxation.sides[direction], guide, width, math.inf)
        nodes = found.nodes[::-1] if direction else found.nodes
        assert problem.faults(nodes) == []
        assert min(found.floor, problem.cost_of(nodes)) <= best + 1e-6
        assert problem.cost_of(nodes) >= best
        if math.isinf(found.floor):
            assert problem.cost_of(nodes) == best
        assert math.isinf(found.floor) or width < 10_000


def test_sets_with_the_same_name_are_kept_apart() -> None:
    problem = ordered(10, 0.15, 3)
    relaxation = Relaxation(problem)
    run = run_of(problem)
    guide = relaxation.guide(0, run)
    assert guide is not None
    side = relaxation.sides[0]
    nameless = side._replace(network=side.network._replace(name=np.zeros_like(side.network.name)))
    found = [sweep(run, which, guide, 10**6, math.inf) for which in (side, nameless)]
    assert found[0].states == found[1].states
    assert problem.cost_of(found[1].nodes) == solve(problem, "brute").cost


@NEW
@pytest.mark.parametrize("seed", range(6))
def test_agrees_with_the_programme_over_subsets(solver: str, seed: int) -> None:
    problem = ordered(11, [0.1, 0.2, 0.4][seed % 3], seed, nodes=1 + seed % 2)
    answer = solve(problem, solver)
    assert answer.status is Status.OPTIMAL
    assert answer.cost == solve(problem, "brute").cost
    assert answer.stopped is StopReason.FINISHED


@NEW
def test_more_than_64_clusters_in_a_row(solver: str) -> None:
    """Sets of two words; a chain with a few liberties."""
    chain = [(a, a + 2) for a in range(128)]
    rng = np.random.default_rng(0)
    problem = OrderingProblem(
        np.arange(130), MatrixCosts(rng.integers(1, 50, (130, 130)).astype(float)), precedence=np.array(chain)
    )
    answers = [solve(problem, name, StopRule(seconds=20)) for name in ("dp", "beam")]
    assert {a.status for a in answers} == {Status.OPTIMAL}
    assert answers[0].cost == answers[1].cost
    other = solve(problem, solver, StopRule(iterations=1000))
    assert other.bound <= answers[0].cost <= other.cost


@NEW
def test_stopped_early_the_bound_holds(solver: str) -> None:
    problem = ordered(13, 0.05, 1)
    best = solve(problem, "brute").cost
    for iterations in (0, 1, 2, 50, 1000):
        answer = solve(problem, solver, StopRule(iterations=iterations))
        assert answer.bound <= best <= answer.cost
        if solver == "bnb":
            assert answer.iterations <= iterations


@pytest.mark.parametrize("limit", [1, 5, 30, 200])
def test_a_cancelled_sweep_keeps_what_it_proved(limit: int) -> None:
    problem = ordered(40, 0.1, 2)
    asked = itertools.count()
    answer = solve(problem, "beam", StopRule(cancelled=lambda: next(asked) >= limit))
    known = solve(problem, "beam", StopRule(seconds=20))
    assert known.status is Status.OPTIMAL
    assert answer.stopped is StopReason.CANCELLED
    assert answer.bound <= known.cost <= answer.cost


def test_too_little_memory_still_bounds(monkeypatch: pytest.MonkeyPatch) -> None:
    problem = ordered(14, 0.02, 5)
    best = solve(problem, "brute").cost
    monkeypatch.setattr(ideals_layers, "MEMORY", 50_000)
    for solver in ("dp", "beam"):
        answer = solve(problem, solver)
        assert answer.bound <= best <= answer.cost
        assert answer.stopped is StopReason.FINISHED


@NEW
def test_impossible_orders_are_proved_impossible(solver: str) -> None:
    """Cluster 1 must come between 0 and 2, but no arc leads to it from 0 or beyond."""
    matrix = np.ones((4, 4))
    matrix[[0, 3], 1] = math.inf
    problem = OrderingProblem(np.arange(4), MatrixCosts(matrix), precedence=np.array([(0, 1), (1, 2), (3, 1)]))
    assert optimum(problem) == math.inf
    assert solve(problem, solver).status is Status.INFEASIBLE


@pytest.mark.parametrize("seed", range(12))
def test_given_reduced_costs_guide_the_proof(seed: int) -> None:
    """Duals of the assignment by reduction of columns and rows: costs = bound + reduced costs."""
    problem = ordered(9, 0.2, seed, nodes=1 + seed % 2)
    side: Side = sides(problem)[0]
    arcs, start, end = (np.array(v) for v in (side.network.arcs, side.network.start, side.network.end))
    columns = np.minimum(arcs.min(axis=0), start)
    # what is taken off a cluster must be the same for all of its nodes
    least = np.minimum.reduceat(columns, problem.first_node[:-1])
    arcs, start = arcs - least[problem.cluster], start - least[problem.cluster]
    reduced = Reduced(float(least.sum()), arcs, start, end)
    run = run_of(problem)
    assert prove_by_ideals(run, reduced) is StopReason.FINISHED
    assert run.cost == run.bound == solve(problem, "brute").cost
    # and they may be weaker than the costs
    run = run_of(problem)
    prove_by_ideals(run, Reduced(reduced.bound - 5.0, 0.5 * arcs, 0.5 * start, 0.0 * end))
    assert run.cost == run.bound == solve(problem, "brute").cost


def test_cutoff() -> None:
    whole = OrderingProblem(np.arange(3), MatrixCosts(np.array([[0, 6, 9], [3, 0, 12], [6, 3, math.inf]])))
    goal, run = cutoff(whole), run_of(whole)
    assert goal.step == 3.0
    assert goal.of(run) == math.inf
    run.offer(np.array([0, 1, 2]))
    assert 15.0 < goal.of(run) < 15.1
    goal.conclude(run, 12.0001, 1e-9)
    assert run.bound == 15.0
    goal.conclude(run, math.inf, 1e-9)
    assert run.bound == run.cost == 18.0
    assert goal.closed(run)
    lines = strokes(3)
    goal, run = cutoff(lines), run_of(lines)
    assert goal.step == 0.0
    run.offer(np.array([0, 2, 4]))
    goal.conclude(run, run.cost * (1 - 1e-5), 0.0)
    assert not goal.closed(run)
    goal.conclude(run, math.inf, 1e-12)
    assert goal.closed(run)
    assert run.bound < run.cost


def test_closure_and_bit_sets() -> None:
    rng = np.random.default_rng(4)
    count = 70
    pairs = np.array([(a, b) for a, b in itertools.combinations(range(count), 2) if rng.random() < 0.03])
    names = rng.permutation(count)
    before = closure(count, names[pairs])
    reached = np.zeros((count, count), dtype=np.bool_)
    reached[names[pairs[:, 0]], names[pairs[:, 1]]] = True
    for k in range(count):
        reached |= reached[:, k : k + 1] & reached[k : k + 1, :]
    assert np.array_equal(before, reached)
    words = bit_sets(before)
    for a, b in itertools.product(range(0, count, 7), range(count)):
        assert bool(int(words[a, b // 64]) >> (b % 64) & 1) == bool(before[a, b])


def test_refusals() -> None:
    free = strokes(200)
    reason = SOLVERS["dp"].refusal(free)
    assert reason
    assert "at most" in reason
    assert SOLVERS["beam"].refusal(free) is None
    assert SOLVERS["bnb"].refusal(free) is None
    assert all(SOLVERS[name].refusal(strokes(1600)) for name in ("dp", "beam", "bnb"))
    assert SOLVERS["dp"].refusal(ordered(200, 0.05, 0)) is None


def library(name: str) -> OrderingProblem:
    file = DATA / "ordering" / "sop" / f"{name}.sop"
    if not file.exists():
        pytest.skip(f"{file.name} is not here")
    return read_tsplib(file).problem


@pytest.mark.parametrize(
    ("name", "best"),
    [
        ("ESC12", 1675),
        ("br17.12", 55),
        ("ft53.4", 14425),
        ("rbg109a", 1038),
        ("R.200.1000.30", 41196),
        ("R.400.100.60", 15228),
        ("R.500.100.30", 9665),
    ],
)
def test_library_optima(name: str, best: float) -> None:
    problem = library(name)
    for solver in ("beam", "dp"):
        answer = solve(problem, solver, StopRule(seconds=60))
        assert (answer.cost, answer.bound, answer.status) == (best, best, Status.OPTIMAL)


@pytest.mark.parametrize("name", ["case1", "case2"])
def test_washing_optima(name: str) -> None:
    """Level rows: many orders cost the same."""
    file = DATA / "washing" / f"{name}.json"
    if not file.exists():
        pytest.skip(f"{file.name} is not here")
    case = json.loads(file.read_text())
    places = np.array(case["circles"])
    above = places[None, :, 1] - places[:, None, 1] >= case["rule"]["tau"] * case["radius"]
    beside = np.abs(places[None, :, 0] - places[:, None, 0]) < case["rule"]["d"] * case["radius"]
    problem = OrderingProblem(
        np.arange(len(places)), EuclidCosts(places, places), precedence=np.argwhere(above & beside)
    )
    answer = solve(problem, "beam", StopRule(seconds=60))
    assert answer.status is Status.OPTIMAL
    assert answer.cost == pytest.approx(case["optimum"], abs=1e-3)
