"""Exact ordering of problems without a direction."""

from __future__ import annotations

import itertools
import math
import time
from dataclasses import replace
from pathlib import Path

import numpy as np
import psutil
import pytest

from benchmarks.drawings import drawing
from optplan.domain.arrays import IntArray
from optplan.domain.ordering import EuclidCosts, MatrixCosts, OrderingProblem, Status
from optplan.domain.stop import StopReason, StopRule
from optplan.ordering import solve
from optplan.ordering._kernels.mincut import cheap_edges, cut_tree_sets, subtour_sets
from optplan.ordering.cutting.lp import Solution
from optplan.ordering.cutting.undirected import Undirected, undirected_form
from optplan.ordering.cutting.undirected_branch import branch_and_cut, useful_edges
from optplan.ordering.cutting.undirected_cuts import violated_blossoms, violated_sets
from optplan.ordering.cutting.undirected_lp import CutProgramme, pair_numbers
from optplan.ordering.cutting.undirected_root import Root, first_edges
from optplan.ordering.cutting.undirected_solve import undirected_bound
from optplan.ordering.tsplib import read_tsplib
from tests.ordering_cases import cases, random_problem
from tests.undirected_cases import KINDS, random_undirected, tour_optimum

DATA = Path(__file__).resolve().parents[2].parent / "shared" / "data"
SMALL = [
    (kind, 3 + seed % 4, seed, closed) for seed, (kind, closed) in enumerate(itertools.product(KINDS, (False, True)))
]
VARIED = [(kind, 3 + seed % 4, seed, closed) for kind in KINDS for closed in (False, True) for seed in range(10, 16)]


def form_of(problem: OrderingProblem) -> Undirected:
    form = undirected_form(problem)
    assert form is not None
    return form


def proved(problem: OrderingProblem, start: bool = True) -> tuple[float, float]:
    """Cost and bound by cut loop and tree in this process; from the search's tour, or from none."""
    form = form_of(problem)
    nodes = solve(problem, "search", StopRule(iterations=50)).nodes if start else np.zeros(0, dtype=np.int64)
    tour = form.edges_of(nodes) if len(nodes) else np.zeros((0, 2), dtype=np.int64)
    cost = problem.cost_of(nodes) if len(nodes) else math.inf
    programme = CutProgramme(form, first_edges(form, tour))
    root = Root(programme, tour, cost, time.monotonic() + 60, lambda _: None)
    solution = root.tighten()
    if solution is not None:
        assert branch_and_cut(root, solution, lambda _: None)
    if math.isfinite(root.cost):
        order = form.nodes_of(root.tour)
        assert order is not None
        assert problem.faults(order) == []
        assert problem.cost_of(order) == pytest.approx(root.cost)
    return root.cost, root.bound


@pytest.mark.parametrize(("kind", "count", "seed", "closed"), VARIED)
@pytest.mark.parametrize("start", [True, False])
def test_the_optimum_is_proved(kind: str, count: int, seed: int, closed: bool, start: bool) -> None:
    problem = random_undirected(kind, count, seed, closed=closed)
    best = tour_optimum(problem)
    cost, bound = proved(problem, start)
    if math.isinf(best):
        assert cost == bound == math.inf
        return
    assert cost == pytest.approx(best)
    assert best - 1e-5 <= bound <= best + 1e-12


@pytest.mark.parametrize(("kind", "count", "seed", "closed"), SMALL[:6])
def test_the_solver_streams_its_proof(kind: str, count: int, seed: int, closed: bool) -> None:
    problem = random_undirected(kind, count, seed, closed=closed)
    best = tour_optimum(problem)
    answer = solve(problem, "cuts")
    assert answer.stopped is StopReason.FINISHED
    assert answer.status is (Status.OPTIMAL if math.isfinite(best) else Status.INFEASIBLE)
    assert answer.cost == pytest.approx(best)
    assert answer.bound <= best + 1e-12


@pytest.mark.parametrize(("kind", "count", "seed", "closed"), VARIED)
def test_tours_and_paths_are_the_same(kind: str, count: int, seed: int, closed: bool) -> None:
    problem = random_undirected(kind, count, seed, closed=closed)
    form = form_of(problem)
    rng = np.random.default_rng(seed)
    for _ in range(5):
        order = rng.permutation(problem.clusters)
        nodes = np.array([rng.integers(problem.first_node[c], problem.first_node[c + 1]) for c in order])
        edges = form.edges_of(nodes)
        total = form.edge_costs(edges[:, 0], edges[:, 1]).sum()
        assert total == pytest.approx(problem.cost_of(nodes))
        back = form.nodes_of(rng.permutation(edges))
        assert back is not None
        assert problem.cost_of(back) == pytest.approx(problem.cost_of(nodes))
        assert form.nodes_of(edges[1:]) is None


def test_what_has_a_direction_is_no_undirected_problem() -> None:
    for case in cases():
        problem = case.problem
        form = undirected_form(problem)
        if form is not None:
            assert not len(problem.precedence)
            everything = np.arange(problem.nodes)
            for i in everything.tolist():
                there = problem.costs.pairs(np.full(problem.nodes, i), everything)
                back = problem.costs.pairs(form.mate[everything], np.full(problem.nodes, form.mate[i]))
                outside = problem.cluster != problem.cluster[i]
                assert np.array_equal(there[outside], back[outside])
    for kind in ("matrix", "euclid", "dubins"):
        assert undirected_form(random_problem(kind, 5, 1, precedence=False, start=False, end=False)) is None
    lines = random_undirected("lines", 5, 3, closed=False)
    assert undirected_form(replace(lines, precedence=np.array([[0, 1]]))) is None
    with_ways = np.flatnonzero(form_of(lines).mate[: lines.nodes] != np.arange(lines.nodes))
    own = lines.node_costs.copy()
    own[with_ways[0]] = 1.0
    assert undirected_form(replace(lines, node_costs=own)) is None
    assert undirected_form(replace(random_undirected("lines", 2, 0, closed=False), closed=True)) is None


def root_of(problem: OrderingProblem) -> tuple[Root, Solution]:
    form = form_of(problem)
    answer = solve(problem, "search", StopRule(iterations=1000))
    tour = form.edges_of(answer.nodes)
    # against the best tour the bound might be proof enough
    cost, deadline = 1.02 * answer.cost, time.monotonic() + 60
    root = Root(CutProgramme(form, first_edges(form, tour)), tour, cost, deadline, lambda _: None)
    solution = root.tighten()
    assert solution is not None
    return root, solution


def test_reduced_costs_of_the_complete_graph_prove_the_bound() -> None:
    """Priced by the kernel, and written out here from cuts and duals."""
    problem = drawing(20, 0)
    root, solution = root_of(problem)
    programme, form = root.programme, root.programme.form
    edges = np.argwhere(form.cluster[:, None] < form.cluster)
    dual = programme.dual(solution)
    assert any(len(cut.teeth) for cut, value in zip(programme.cuts, dual.cuts.tolist(), strict=True) if value)
    expected = form.edge_costs(edges[:, 0], edges[:, 1]) - dual.prices[edges].sum(axis=1)
    for value, cut in zip(dual.cuts.tolist(), programme.cuts, strict=True):
        inside = np.isin(edges, cut.members)
        teeth = np.isin(pair_numbers(form, edges[:, 0], edges[:, 1]), cut.teeth)
        expected += value * (inside.all(axis=1) | (teeth & (inside[:, 0] != inside[:, 1])))
    assert programme.reduced_costs(dual, edges) == pytest.approx(expected, abs=1e-9)
    assert expected.min() > -1e-6
    priced = programme.price(solution, math.inf, len(edges) + 1)
    assert np.array_equal(np.sort(priced.edges, axis=1), edges)
    assert priced.reduced == pytest.approx(expected, abs=1e-9)
    # any tour costs the duals' value and its reduced costs, and what the cuts it has in abundance are worth
    tour = programme.reduced_costs(dual, np.sort(root.tour, axis=1)).sum()
    assert root.cost >= dual.value + tour - 1e-9
    assert priced.bound == pytest.approx(dual.value, rel=1e-6)
    assert root.bound <= root.cost


def test_an_early_bound_is_one() -> None:
    """The first programme knows few edges: its value bounds nothing, the safe bound does."""
    problem = drawing(20, 3)
    form = form_of(problem)
    best = solve(problem, "cuts").cost
    answer = solve(problem, "nn-feasible")
    programme = CutProgramme(form, form.edges_of(answer.nodes))
    solution = programme.programme.solve()
    assert isinstance(solution, Solution)
    assert solution.objective == pytest.approx(answer.cost)
    assert programme.price(solution, 0.0, 10).bound <= best < solution.objective


def test_better_tours_survive_the_fixing() -> None:
    """Against an incumbent that is not the best, the best tour's edges stay."""
    problem = drawing(20, 4)
    form = form_of(problem)
    best = solve(problem, "cuts")
    assert best.status is Status.OPTIMAL
    root, solution = root_of(problem)
    root.cost = best.cost * 1.02
    kept = useful_edges(root, solution)
    assert kept is not None
    mine = {tuple(edge) for edge in np.sort(form.edges_of(best.nodes), axis=1).tolist()}
    assert mine <= {tuple(edge) for edge in kept.tolist()}
    assert len(kept) < 0.5 * form.points**2 / 2


@pytest.mark.parametrize("kind", ["drawing", *KINDS])
def test_blossoms_hold_for_tours(kind: str) -> None:
    """Handles split closed strokes and open ones; mixed clusters, and two depots, are there too."""
    rng = np.random.default_rng(0)
    problem = drawing(12, 1) if kind == "drawing" else random_undirected(kind, 10, 1, closed=False)
    form = form_of(problem)
    edges = np.argwhere(form.cluster[:, None] < form.cluster)
    edges = edges[np.isfinite(form.edge_costs(edges[:, 0], edges[:, 1]))]
    tours: list[IntArray] = []
    while len(tours) < 40:
        order = rng.permutation(problem.clusters)
        nodes = np.array([rng.integers(problem.first_node[c], problem.first_node[c + 1]) for c in order])
        tour = np.sort(form.edges_of(nodes), axis=1)
        tours.append(tour)
    programme = CutProgramme(form, edges)
    for seed in range(40):
        weights = np.random.default_rng(seed).choice([0.0, 0.5, 1.0], len(edges), p=[0.92, 0.06, 0.02])
        handles, teeth = violated_blossoms(form, edges, weights)
        programme.add_cuts(handles, teeth)
    assert len(programme.cuts) > 20
    split = 0
    for cut in programme.cuts:
        held = np.bincount(form.cluster[cut.members], minlength=form.clusters)
        split += bool(((held > 0) & (held < np.bincount(form.cluster))).any())
        for tour in tours:
            inside = np.isin(tour, cut.members)
            crosses = inside[:, 0] != inside[:, 1]
            used = (np.isin(pair_numbers(form, tour[:, 0], tour[:, 1]), cut.teeth) & crosses).sum()
            assert crosses.sum() >= 1 - len(cut.teeth) + 2 * used
            half = np.isin(tour, cut.halves).sum()
            assert inside.all(axis=1).sum() - 0.5 * half + used <= cut.right + 1e-9
    assert split > 10


@pytest.mark.parametrize("most", [1, 3])
def test_a_limit_leaves_some_of_the_violated_sets(most: int) -> None:
    form = form_of(drawing(30, 0))
    rng = np.random.default_rng(0)
    for _ in range(10):
        # rings of a few clusters each: every one lacks links to the others
        rings = np.array_split(rng.permutation(form.clusters), 5)
        points = np.searchsorted(form.cluster, np.arange(form.clusters))
        leaves = form.mate[points]
        edges = np.concatenate([np.column_stack([leaves[ring], points[np.roll(ring, -1)]]) for ring in rings])
        weights = np.ones(len(edges))
        found = violated_sets(form, edges, weights, most)
        assert found
        everything = {members.tobytes() for members in violated_sets(form, edges, weights)}
        assert {members.tobytes() for members in found} <= everything
        shared = np.bincount(np.concatenate([np.unique(form.cluster[members]) for members in found]))
        assert shared.max() <= most


def test_minimum_cuts_against_all_sets() -> None:
    for seed in range(20):
        rng = np.random.default_rng(seed)
        count = int(rng.integers(4, 8))
        pairs = np.array(list(itertools.combinations(range(count), 2)))
        weights = np.where(rng.random(len(pairs)) < 0.7, rng.uniform(0, 1, len(pairs)), 0.0)
        sides = np.array(list(itertools.product((0, 1), repeat=count)))[1:-1]
        cut = ((sides[:, pairs[:, 0]] != sides[:, pairs[:, 1]]) * weights).sum(axis=1)
        trees = cut_tree_sets(count, pairs[:, 0].copy(), pairs[:, 1].copy(), weights)
        least = ((trees[:, pairs[:, 0]] != trees[:, pairs[:, 1]]) * weights).sum(axis=1).min()
        assert least == pytest.approx(cut.min(), abs=1e-6)
        cluster = np.arange(count) // 2
        others = np.arange(1, cluster.max() + 1)
        found = subtour_sets(count, pairs[:, 0].copy(), pairs[:, 1].copy(), weights, cluster, others, 0, count)
        for c in others.tolist():
            fits = (sides[:, cluster == c] == 1).all(axis=1) & (sides[:, cluster == 0] == 0).all(axis=1)
            mine = found[found[:, -1] == c]
            assert (len(mine) > 0) == (cut[fits].min() < 2 - 1e-4)
            for row in mine:
                value = ((row[pairs[:, 0]] != row[pairs[:, 1]]) * weights).sum()
                assert value == pytest.approx(cut[fits].min(), abs=1e-6)


def test_no_more_edges_are_told_than_wanted() -> None:
    places = np.random.default_rng(0).uniform(size=(20, 2))
    none = np.zeros(0, dtype=np.int64)
    edges, reduced = cheap_edges(
        np.zeros((0, 0)),
        places,
        np.zeros((0, 20)),
        np.arange(20),
        np.ones(20),
        np.zeros(21, dtype=np.int64),
        none,
        np.zeros(0),
        np.zeros(1, dtype=np.int64),
        none,
        1.0,
        0,
        20,
        np.full(20, math.inf),
        7,
    )
    assert len(edges) == len(reduced) == 7


@pytest.mark.parametrize("factor", [1e-6, 1e6])
def test_scale_does_not_matter(factor: float) -> None:
    problem = drawing(12, 2)
    costs = problem.costs
    assert isinstance(costs, EuclidCosts)
    scaled = OrderingProblem(problem.cluster, EuclidCosts(costs.exits * factor, costs.entries * factor))
    first, second = solve(problem, "cuts"), solve(scaled, "cuts")
    assert second.status is Status.OPTIMAL
    assert second.cost == pytest.approx(factor * first.cost)


def test_points_in_one_place_and_costs_that_cancel() -> None:
    ones = np.ones((10, 2))
    answer = solve(OrderingProblem(np.arange(10), EuclidCosts(ones, ones)), "cuts")
    assert (answer.cost, answer.status) == (0.0, Status.OPTIMAL)
    matrix = np.random.default_rng(1).uniform(-5, 5, (7, 7))
    problem = OrderingProblem(np.arange(7), MatrixCosts(matrix + matrix.T))
    assert solve(problem, "cuts").bound == pytest.approx(tour_optimum(problem), abs=1e-5)


def test_bounds_of_larger_drawings() -> None:
    problem = drawing(60, 1)
    known = solve(problem, "search", StopRule(iterations=5000)).cost
    bound = undirected_bound(problem)
    assert 0.95 * known < bound <= known
    early = undirected_bound(problem, StopRule(seconds=4.0))
    assert early <= bound + 1e-9


def test_cancel_is_heard_while_the_child_works() -> None:
    problem = drawing(150, 0)
    start = solve(problem, "nn-feasible").nodes
    heard: list[float] = []

    def cancelled() -> bool:
        # once the search is over and a child is at work
        busy = bool(psutil.Process().children())
        if busy and not heard:
            heard.append(time.perf_counter())
        return busy and time.perf_counter() - heard[0] > 0.5

    answer = solve(problem, "cuts", StopRule(cancelled=cancelled), start=start)
    late = time.perf_counter() - heard[0] - 0.5
    assert answer.stopped is StopReason.CANCELLED
    assert problem.faults(answer.nodes) == []
    assert late < 2.0
    assert not psutil.Process().children()


@pytest.mark.parametrize("name", ["11berlin52", "16pr76", "20rat99"])
def test_known_optima_of_a_library(name: str) -> None:
    file = DATA / "ordering" / "gtsp" / f"{name}.gtsp"
    if not file.exists():
        pytest.skip("the library is not here")
    answer = solve(read_tsplib(file).problem, "cuts")
    rows = (DATA / "ordering" / "best_known.csv").read_text().splitlines()
    known = next(float(row.split(",")[2]) for row in rows if row.startswith(f"gtsp,{name},"))
    assert answer.status is Status.OPTIMAL
    assert answer.cost == known
