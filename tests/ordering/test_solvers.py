"""Every solver through the same tests."""

from __future__ import annotations

import math
import time

import numpy as np
import pytest

from optplan.domain.errors import InputError, SolverError
from optplan.domain.ordering import EuclidCosts, MatrixCosts, Ordering, OrderingProblem, Status
from optplan.domain.progress import Progress
from optplan.domain.stop import StopReason, StopRule
from optplan.ordering import SOLVERS, lower_bound, solve
from optplan.ordering.method import Run
from tests.ordering_cases import Case, cases, optimum, optimum_by_product, random_problem, renamed, strokes

CASES = list(cases())
MODELS = {"mtz-lifted", "mtz", "flow", "noon-bean"}
"""Solvers that hand a mixed-integer model to a child process, so that every problem takes a while."""
PROVES = {"brute", "auto", "cuts", "bnb", "beam", "dp"} | MODELS
SEARCHES = {"search", "nn", "nn-feasible", "2opt", "tree", "ga", "ga-feasible"}
ANYTIME = {"search", "ga", "ga-feasible"}
"""Searches that go on for as long as they may."""
NEEDS_FOREST = {"tree"}
"""Solvers that refuse precedence which is no containment."""
REFUSES_PRECEDENCE = {"noon-bean"}
NEEDS_POINTS = {"rows", "rows-split"}
"""Solvers of circles in a plane; they have tests of their own."""
NEEDS_PROGRAM = {"lkh"}
"""Solvers that run a program which is not installed here; they have tests of their own."""
GENERAL = [name for name in SOLVERS if name not in NEEDS_POINTS | NEEDS_PROGRAM]
EVERY = pytest.mark.parametrize("solver", GENERAL)
TOLERANCE = 1e-7


def judge(problem: OrderingProblem, answer: Ordering, best: float) -> None:
    """What must be true of every answer, whoever gave it."""
    slack = TOLERANCE * max(1.0, abs(best)) if math.isfinite(best) else 0.0
    assert answer.bound <= best + slack
    if len(answer.nodes) or problem.clusters == 0:
        assert problem.faults(answer.nodes) == []
        assert answer.cost == pytest.approx(problem.cost_of(answer.nodes), abs=1e-12)
        assert answer.cost >= best - slack
        assert answer.status in (Status.OPTIMAL, Status.FEASIBLE)
    else:
        assert answer.cost == math.inf
        assert answer.status in (Status.INFEASIBLE, Status.UNKNOWN)
    assert answer.bound <= answer.cost
    if answer.status is Status.OPTIMAL:
        assert answer.cost == pytest.approx(best, abs=1e-6 * max(1.0, abs(best)))
    if answer.status is Status.INFEASIBLE:
        assert best == math.inf


def welcome(solver: str, problem: OrderingProblem) -> None:
    """Skip what a solver may refuse; anything else is refused by none."""
    if solver in NEEDS_FOREST and SOLVERS[solver].refusal(problem):
        pytest.skip("precedence is no forest")
    if solver in REFUSES_PRECEDENCE and len(problem.precedence):
        assert SOLVERS[solver].refusal(problem)
        pytest.skip("it knows no precedence")


def test_each_solver_is_put_into_a_group() -> None:
    assert set(SOLVERS) == PROVES | SEARCHES | NEEDS_POINTS | NEEDS_PROGRAM
    assert all(SOLVERS[name].name == name and SOLVERS[name].summary for name in SOLVERS)


def test_the_oracles_agree() -> None:
    for case in CASES:
        if case.problem.clusters <= 3 or case.name.startswith("dubins-4"):
            assert optimum_by_product(case.problem) == pytest.approx(case.optimum)


@pytest.mark.parametrize("solver", [name for name in GENERAL if name not in MODELS])
@pytest.mark.parametrize("case", CASES, ids=lambda c: c.name)
def test_answers_bracket_the_optimum(solver: str, case: Case) -> None:
    welcome(solver, case.problem)
    answer = solve(case.problem, solver, StopRule(iterations=200) if solver in SEARCHES else None)
    judge(case.problem, answer, case.optimum)
    assert answer.solver == solver
    if solver in PROVES:
        assert answer.status is (Status.OPTIMAL if math.isfinite(case.optimum) else Status.INFEASIBLE)
        assert answer.stopped is StopReason.FINISHED


MODEL_CASES = [("mtz-lifted", case) for case in CASES[1::8]] + [("mtz", case) for case in CASES[2::20]]
MODEL_CASES += [("flow", case) for case in CASES[3::12]]
MODEL_CASES += [("noon-bean", case) for case in CASES[::15] if not len(case.problem.precedence)]


@pytest.mark.parametrize(("solver", "case"), MODEL_CASES, ids=[f"{case.name}-{name}" for name, case in MODEL_CASES])
def test_the_model_brackets_the_optimum(solver: str, case: Case) -> None:
    answer = solve(case.problem, solver)
    judge(case.problem, answer, case.optimum)
    assert answer.status is (Status.OPTIMAL if math.isfinite(case.optimum) else Status.INFEASIBLE)


def test_local_search_finds_most_optima() -> None:
    reached = [
        solve(case.problem, "search", StopRule(iterations=300)).cost <= case.optimum + TOLERANCE
        for case in CASES
        if math.isfinite(case.optimum)
    ]
    assert np.mean(reached) > 0.9


@EVERY
def test_no_cluster(solver: str) -> None:
    empty = OrderingProblem(np.zeros(0, dtype=np.int64), MatrixCosts(np.zeros((0, 0))))
    answer = solve(empty, solver)
    assert (answer.cost, answer.bound, answer.status) == (0.0, 0.0, Status.OPTIMAL)


@EVERY
def test_one_cluster(solver: str) -> None:
    problem = OrderingProblem(
        np.zeros(3, dtype=np.int64),
        MatrixCosts(np.full((3, 3), math.inf)),
        np.array([1.0, 2.0, math.inf]),
        np.array([3.0, 1.0, 0.0]),
        np.array([0.0, 0.5, 0.0]),
    )
    answer = solve(problem, solver)
    assert answer.nodes.tolist() == [1]
    assert answer.cost == answer.bound == 3.5
    impossible = OrderingProblem(problem.cluster, problem.costs, np.full(3, math.inf))
    assert solve(impossible, solver).status is Status.INFEASIBLE


@EVERY
def test_no_arcs_is_a_result(solver: str) -> None:
    problem = OrderingProblem(np.arange(4), MatrixCosts(np.full((4, 4), math.inf)))
    answer = solve(problem, solver, StopRule(iterations=50) if solver in SEARCHES else None)
    assert len(answer.nodes) == 0
    assert answer.status is (Status.INFEASIBLE if solver in PROVES else Status.UNKNOWN)


@EVERY
def test_all_points_in_one_place(solver: str) -> None:
    problem = OrderingProblem(np.repeat(np.arange(5), 2), EuclidCosts(np.ones((10, 2)), np.ones((10, 2))))
    answer = solve(problem, solver, StopRule(iterations=20) if solver in SEARCHES else None)
    assert answer.cost == 0.0
    assert problem.faults(answer.nodes) == []


@EVERY
@pytest.mark.parametrize("kind", ["matrix", "euclid"])
def test_same_seed_same_answer(solver: str, kind: str) -> None:
    problem = random_problem(kind, 7, 3, precedence=True, start=False, end=True)
    welcome(solver, problem)
    answers = [solve(problem, solver, StopRule(iterations=50), seed=5) for _ in range(2)]
    assert answers[0].nodes.tolist() == answers[1].nodes.tolist()
    assert answers[0].cost == answers[1].cost


@EVERY
def test_cancel_ends_with_what_is_known(solver: str) -> None:
    problem = some_strokes(solver)
    calls = []

    def cancelled() -> bool:
        calls.append(1)
        return len(calls) > 3

    given = solve(problem, "nn").nodes
    answer = solve(
        problem, solver, StopRule(cancelled=cancelled, iterations=10**9 if solver in ANYTIME else None), 0, given
    )
    judge(problem, answer, solve(problem, "brute").cost)
    assert answer.stopped is StopReason.CANCELLED or answer.status is Status.OPTIMAL
    assert len(answer.nodes) == problem.clusters
    at_once = solve(problem, solver, StopRule(cancelled=lambda: True), 0, given)
    assert at_once.stopped is StopReason.CANCELLED
    assert at_once.seconds < 5


def some_strokes(solver: str) -> OrderingProblem:
    """Few enough to be proved in a second."""
    return strokes(6 if solver in MODELS else 9)


@EVERY
def test_target_ends_the_search(solver: str) -> None:
    problem = some_strokes(solver)
    answer = solve(problem, solver, StopRule(target=1e6, iterations=10**9 if solver in ANYTIME else None))
    assert len(answer.nodes) == problem.clusters
    assert answer.stopped is StopReason.TARGET or answer.status is Status.OPTIMAL


@EVERY
def test_never_worse_than_the_start(solver: str) -> None:
    problem = some_strokes(solver)
    best = solve(problem, "brute")
    answer = solve(problem, solver, StopRule(iterations=3) if solver in SEARCHES else None, start=best.nodes)
    assert answer.cost <= best.cost + 1e-12
    with pytest.raises(InputError, match="visited"):
        solve(problem, solver, start=np.array([0]))


@EVERY
def test_progress_improves(solver: str) -> None:
    seen: list[Progress] = []
    answer = solve(
        some_strokes(solver), solver, StopRule(iterations=20) if solver in SEARCHES else None, progress=seen.append
    )
    assert seen
    assert all(p.stage == "order" and p.bound <= p.cost for p in seen)
    costs = [point.cost for point in answer.trace]
    assert costs == sorted(costs, reverse=True)
    bounds = [point.bound for point in answer.trace]
    assert bounds == sorted(bounds)


def test_what_a_part_of_a_run_found_does_not_turn_its_trace_back() -> None:
    problem = strokes(12)
    poor, good = (solve(problem, name, StopRule(iterations=500)).nodes for name in ("nn", "search"))
    run = Run(problem, StopRule().start())
    run.offer(poor)
    part = run.within(math.inf)
    assert part.offer(good)
    part.prove(0.9 * part.cost)
    run.adopt(part)
    assert (run.cost, run.bound) == (part.cost, part.bound)
    costs, bounds = ([getattr(point, name) for point in run.trace] for name in ("cost", "bound"))
    assert costs == sorted(costs, reverse=True)
    assert bounds == sorted(bounds)


def test_iterations_are_counted() -> None:
    for limit in (0, 1, 17):
        assert solve(strokes(30), "search", StopRule(iterations=limit)).iterations == limit
    assert solve(strokes(30), "search", StopRule(iterations=0)).cost <= solve(strokes(30), "nn").cost


def test_time_limit() -> None:
    answer = solve(strokes(60), "search", StopRule(seconds=0.3))
    assert answer.stopped is StopReason.TIME
    assert answer.seconds < 20
    # on a fast machine sixty strokes are proved in a second
    automatic = solve(strokes(150), "auto", StopRule(seconds=1.0))
    assert automatic.status is Status.FEASIBLE
    assert 0 < automatic.bound < automatic.cost
    assert "search" in automatic.message


def test_refusals_say_why() -> None:
    large = strokes(200)
    for name in ("brute", "mtz-lifted"):
        reason = SOLVERS[name].refusal(large)
        assert reason
        with pytest.raises(SolverError, match="at most"):
            solve(large, name)
    assert all(SOLVERS[name].refusal(large) is None for name in SEARCHES | {"auto"})


def test_unknown_name_lists_the_known() -> None:
    with pytest.raises(InputError, match="search") as caught:
        solve(strokes(3), "best")
    assert all(name in str(caught.value) for name in SOLVERS)


def test_precedence_survives_a_long_search() -> None:
    rng = np.random.default_rng(0)
    pairs = [(int(a), int(b)) for a in range(60) for b in range(a + 1, 60) if rng.random() < 0.05]
    problem = strokes(60)
    problem = OrderingProblem(problem.cluster, problem.costs, precedence=np.array(pairs))
    answer = solve(problem, "search", StopRule(iterations=2000))
    assert problem.faults(answer.nodes) == []
    assert answer.cost < 0.9 * solve(problem, "nn-feasible").cost


@pytest.mark.parametrize("case", CASES, ids=lambda c: c.name)
def test_lower_bound_is_one(case: Case) -> None:
    assert lower_bound(case.problem) <= case.optimum + TOLERANCE * max(1.0, abs(case.optimum))


@pytest.mark.parametrize("count", [1200, 1300])
def test_lower_bound_of_large_problems(count: int) -> None:
    """Both sides of the switch to the sparse bound."""
    problem = strokes(count)
    known = solve(problem, "nn").cost
    bound = lower_bound(problem, StopRule(iterations=30))
    assert 0.3 * known < bound < known


def test_lower_bound_is_sharp_on_a_line() -> None:
    places = np.column_stack([np.arange(20.0), np.zeros(20)])
    problem = OrderingProblem(np.arange(20), EuclidCosts(places, places))
    assert lower_bound(problem) == pytest.approx(19.0)


def test_optimum_of_a_scaled_problem_scales() -> None:
    problem = strokes(7, 4)
    costs = problem.costs
    assert isinstance(costs, EuclidCosts)
    for factor in (1e-6, 1e6):
        scaled = OrderingProblem(problem.cluster, EuclidCosts(costs.exits * factor, costs.entries * factor))
        for name in ("mtz-lifted", "brute"):
            answer = solve(scaled, name)
            assert answer.status is Status.OPTIMAL
            assert answer.cost == pytest.approx(factor * optimum(problem), rel=1e-6)


@pytest.mark.parametrize("solver", [name for name in GENERAL if name not in MODELS])
@pytest.mark.parametrize("factor", [1e-3, 1.0, 1e4])
def test_names_and_units_do_not_matter(solver: str, factor: float) -> None:
    for case in CASES[3::9]:
        problem = renamed(case.problem, 1, factor)
        if SOLVERS[solver].refusal(problem):
            continue
        answer = solve(problem, solver, StopRule(iterations=200) if solver in SEARCHES else None)
        judge(problem, answer, factor * case.optimum)
        if solver in PROVES:
            assert answer.status is (Status.OPTIMAL if math.isfinite(case.optimum) else Status.INFEASIBLE)


@pytest.mark.parametrize("seed", range(4))
def test_no_search_is_below_a_proved_bound(seed: int) -> None:
    """On problems too large for enumeration: what is found is never cheaper than what is proved, by whomever."""
    rng = np.random.default_rng(seed)
    pairs = np.array([(a, b) for a in range(24) for b in range(a + 1, 24) if rng.random() < 0.1 * (seed % 2)])
    base = strokes(24, seed)
    problem = OrderingProblem(base.cluster, base.costs, precedence=pairs.reshape(-1, 2).astype(np.int64))
    problem = renamed(problem, seed, 7.0) if seed >= 2 else problem
    proved = [solve(problem, name, StopRule(seconds=1)).bound for name in ("cuts", "beam")]
    found = [
        solve(problem, name, StopRule(iterations=500)).cost for name in SEARCHES if not SOLVERS[name].refusal(problem)
    ]
    assert max(*proved, lower_bound(problem, StopRule(seconds=1))) <= min(found) * (1 + 1e-9)


@EVERY
def test_a_cancel_is_heard_within_half_a_second(solver: str) -> None:
    """In the middle of work on a real size; once in three tries, for the machine may be busy."""
    problem = strokes(24 if solver in MODELS else 40, 1)
    if reason := SOLVERS[solver].refusal(problem):
        problem = strokes(12, 1)
        assert SOLVERS[solver].refusal(problem) is None, reason
    solve(problem, solver, StopRule(seconds=0.01))  # compiled before it is timed
    delays = []
    for _ in range(3):
        due = time.perf_counter() + 0.3

        def cancelled(due: float = due) -> bool:
            return time.perf_counter() >= due

        solve(problem, solver, StopRule(cancelled=cancelled, iterations=10**9 if solver in ANYTIME else None))
        delays.append(time.perf_counter() - due)
        if delays[-1] < 0.5:
            return
    pytest.fail(f"heard after {min(delays):.2f} s")
