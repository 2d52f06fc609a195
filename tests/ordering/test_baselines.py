"""The plain published methods."""

from __future__ import annotations

import itertools
import math
from dataclasses import replace

import numpy as np
import pytest

from optplan.domain.arrays import FloatArray
from optplan.domain.errors import InputError, SolverError
from optplan.domain.ordering import EuclidCosts, MatrixCosts, OrderingProblem, Status
from optplan.domain.stop import StopRule
from optplan.ordering import solve
from optplan.ordering.arrays import partners
from optplan.ordering.baselines.genetic import Genetic, genetic, genetic_feasible
from optplan.ordering.method import Run
from tests.ordering_cases import Case, cases, random_problem, strokes
from tests.washing import washing

FINITE = [case for case in cases() if "holes" not in case.name]


def points(places: FloatArray, pairs: list[tuple[int, int]] | None = None) -> OrderingProblem:
    before = np.array(pairs or [], dtype=np.int64).reshape(-1, 2)
    return OrderingProblem(np.arange(len(places)), EuclidCosts(places, places), precedence=before)


def test_nearest_neighbour_goes_on_to_the_nearest() -> None:
    line = points(np.array([[0.0, 0], [5, 0], [1, 0], [3, 0]]))
    assert solve(line, "nn").nodes.tolist() == [0, 2, 3, 1]
    cheap = replace(line, start_costs=np.array([3.0, 1, 2, 2]))
    assert solve(cheap, "nn").nodes.tolist() == [1, 3, 2, 0]


def test_ties_go_to_the_lowest_node_or_down() -> None:
    # both neighbours of the middle are equally far, but for rounding
    cross = points(np.array([[0.0, 0], [0, 1 - 1e-12], [0, -1]]))
    cross = replace(cross, start_costs=np.array([0.0, 1, 1]))
    assert solve(cross, "nn").nodes.tolist() == [0, 1, 2]
    assert solve(cross, "nn-feasible").nodes.tolist() == [0, 2, 1]


def test_what_ignores_precedence_says_so() -> None:
    line = points(np.array([[0.0, 0], [1, 0], [2, 0]]), [(2, 1), (2, 0)])
    for name in ("nn", "2opt"):
        answer = solve(line, name)
        assert answer.status is Status.UNKNOWN
        assert answer.message == ("as published it does not look at precedence: its order of 2 breaks 2 of 2 rules"), (
            name
        )
    assert "breaks" in solve(strokes_under_precedence(30), "ga", StopRule(iterations=5)).message
    assert solve(line, "nn-feasible").nodes.tolist() == [2, 1, 0]


def strokes_under_precedence(count: int) -> OrderingProblem:
    rng = np.random.default_rng(count)
    pairs = [(a, b) for a, b in itertools.combinations(range(count), 2) if rng.random() < 0.1]
    return replace(strokes(count), precedence=np.array(pairs))


@pytest.mark.parametrize("case", FINITE, ids=lambda c: c.name)
def test_feasible_methods_always_have_an_answer(case: Case) -> None:
    problem = case.problem
    assert problem.faults(solve(problem, "nn-feasible").nodes) == []
    assert problem.faults(solve(problem, "ga-feasible", StopRule(iterations=2)).nodes) == []


@pytest.mark.parametrize("kind", ["matrix", "euclid", "dubins", "ties"])
@pytest.mark.parametrize("closed", [False, True])
def test_two_opt_leaves_no_reversal_that_gains(kind: str, closed: bool) -> None:
    for seed in range(4):
        problem = random_problem(kind, 9, seed, precedence=False, start=False, end=False, closed=closed)
        answer = solve(problem, "2opt")
        assert answer.cost <= solve(problem, "nn").cost + 1e-12
        turned = partners(problem)
        for low, high in itertools.combinations_with_replacement(range(int(closed), 9), 2):
            nodes = answer.nodes.copy()
            nodes[low : high + 1] = turned[nodes[low : high + 1]][::-1]
            assert problem.cost_of(nodes) >= answer.cost - 1e-8


def test_two_opt_uncrosses() -> None:
    square = points(np.array([[0.0, 0], [1, 1], [1, 0.0], [0, 1]]))
    crossed = np.array([0, 1, 2, 3])
    problem = replace(square, closed=True)
    assert solve(problem, "2opt", start=crossed).cost == pytest.approx(4)
    # the two strokes of a row, the second first: reversing drives each of them the other way
    exits = np.array([[2.0, 0], [1, 0], [3, 0], [2.1, 0]])
    entries = exits[[1, 0, 3, 2]]
    row = OrderingProblem(np.array([0, 0, 1, 1]), EuclidCosts(exits, entries))
    assert solve(row, "2opt", start=np.array([2, 0])).cost == pytest.approx(0.1)


def test_two_opt_finds_a_way_out_of_missing_arcs() -> None:
    matrix = np.array([[0, 1.0, 2, 9], [1, 0, 2, math.inf], [2, 2, 0, 3], [9, math.inf, 3, 0]])
    matrix[2, 3] = math.inf
    problem = OrderingProblem(np.arange(4), MatrixCosts(matrix))
    assert "arc that does not exist" in solve(problem, "nn").message
    assert math.isfinite(solve(problem, "2opt").cost)


def run_of(problem: OrderingProblem, generations: int, seed: int = 0) -> Run:
    return Run(problem, StopRule(iterations=generations).start(), seed)


def test_elitism_never_loses_the_best() -> None:
    problem = strokes(20)
    costs = []
    for generations in (0, 5, 40, 160):
        run = run_of(problem, generations)
        genetic(run)
        costs.append(run.cost)
        assert run.iterations == generations
    assert costs == sorted(costs, reverse=True)
    assert costs[-1] < 0.7 * costs[0]


def test_the_genetic_algorithm_works_with_any_parameters() -> None:
    problem = strokes_under_precedence(12)
    for settings in (
        Genetic(population=2, generations=3),
        Genetic(elite=1.0, generations=2),
        Genetic(mutation=1.0, rivals=1),
    ):
        run = Run(problem, StopRule(iterations=10).start())
        genetic_feasible(run, settings)
        assert problem.faults(run.nodes) == []
    assert run.iterations == 10
    short = Run(problem, StopRule().start())
    genetic_feasible(short, Genetic(generations=4))
    assert short.iterations == 4
    for wrong in ({"population": 1}, {"elite": 1.5}, {"mutation": -0.1}, {"rivals": 0}):
        with pytest.raises(InputError, match="genetic"):
            Genetic(**wrong)


def test_the_genetic_algorithm_finds_most_small_optima() -> None:
    small = [case for case in FINITE if not case.problem.closed and case.problem.clusters <= 5]
    reached = [solve(c.problem, "ga-feasible", StopRule(iterations=200)).cost <= c.optimum + 1e-7 for c in small]
    assert np.mean(reached) > 0.9


# 0 holds 1 and 2, 2 holds 3; 4 lies beside them
NESTED = [(1, 0), (2, 0), (3, 2), (3, 0)]
PLACES = np.array([[0.0, 0], [2, 0], [3, 0], [3.5, 0], [-1, 0]])


def test_kernels_come_first() -> None:
    problem = replace(points(PLACES, NESTED), start_costs=np.array([0.0, 9, 9, 9, 9]))
    # into 0 before 0 itself; of its children 1 and 2 the nearer to the start is not known: the first
    assert solve(problem, "tree").nodes.tolist() == [1, 3, 2, 0, 4]
    from_the_side = replace(problem, start_costs=np.array([9.0, 9, 9, 9, 0]))
    assert solve(from_the_side, "tree").nodes.tolist() == [4, 1, 3, 2, 0]


def test_a_walk_without_precedence_is_the_nearest_neighbours() -> None:
    problem = strokes(15)
    assert solve(problem, "tree").nodes.tolist() == solve(problem, "nn").nodes.tolist()


def test_deep_nesting() -> None:
    count = 1500
    problem = points(np.zeros((count, 2)), [(k + 1, k) for k in range(count - 1)])
    assert solve(problem, "tree").nodes.tolist() == list(range(count))[::-1]


def test_overlapping_enclosures_are_no_forest() -> None:
    with pytest.raises(SolverError, match="no forest: cluster 2 comes before clusters 0 and 1"):
        solve(points(PLACES, [(2, 0), (2, 1)]), "tree")


def test_figures_of_the_washing_cases() -> None:
    """Ties downwards, then to the left; or from the left with ties to the right."""
    for name, leftmost in (("case1", 1.011), ("case2", 1.069)):
        case = washing(name)
        assert solve(case.problem, "nn-feasible").cost / case.optimum == pytest.approx(leftmost, abs=6e-4)
    case = washing("case2")
    order = np.lexsort((-case.points[:, 0], case.points[:, 1]))
    places, number = case.points[order], np.argsort(order)
    begin = np.where(order == np.lexsort((case.points[:, 0], case.points[:, 1]))[0], 0.0, math.inf)
    turned = OrderingProblem(np.arange(len(places)), EuclidCosts(places, places), begin, precedence=number[case.before])
    assert solve(turned, "nn-feasible").cost / case.optimum == pytest.approx(1.038, abs=6e-4)
