"""The model of generalised tours, and the fast form held against it."""

from __future__ import annotations

import itertools
import math
import time

import numpy as np
import pytest

from optplan.domain.arrays import FloatArray, IntArray
from optplan.ordering.cutting import undirected_root
from optplan.ordering.cutting.lp import Solution
from optplan.ordering.cutting.undirected import Undirected, undirected_form
from optplan.ordering.cutting.undirected_lp import Cut, CutProgramme
from optplan.ordering.cutting.undirected_root import Root, first_edges
from optplan_models import highs
from optplan_models.ordering import generalised
from tests.undirected_cases import random_undirected, tour_optimum

NO_TOUR = np.zeros((0, 2), dtype=np.int64)


def form_of(kind: str, count: int, seed: int, *, closed: bool) -> tuple[Undirected, float]:
    problem = random_undirected(kind, count, seed, closed=closed)
    form = undirected_form(problem)
    assert form is not None
    return form, tour_optimum(problem)


def all_edges(form: Undirected) -> tuple[IntArray, FloatArray]:
    """Edges and their plain costs, without node costs."""
    edges = first_edges(form, NO_TOUR)
    costs = form.edge_costs(edges[:, 0], edges[:, 1]) - 0.5 * form.node_costs[edges].sum(axis=1)
    return edges[np.isfinite(costs)], costs[np.isfinite(costs)]


def every_set(form: Undirected) -> list[IntArray]:
    """Every set of points that holds a whole cluster and leaves a whole one outside, once with its complement."""
    points, sets = np.arange(form.points), []
    for rest in itertools.product((False, True), repeat=form.points - 1):
        inside = np.array([*rest, False])
        held = [inside[form.cluster == c] for c in range(form.clusters)]
        if any(h.all() for h in held) and any(not h.any() for h in held):
            sets.append(points[inside])
    return sets


def relaxation(form: Undirected, edges: IntArray, costs: FloatArray, sets: list[IntArray]) -> float:
    model = generalised.build(form.cluster, form.mate, edges, costs, form.node_costs, sets)
    result = highs.run(highs.compile_model(model).relaxed())
    return result.objective


CASES = [
    (kind, count, seed, closed)
    for seed, (kind, count, closed) in enumerate(itertools.product(("lines", "matrix"), (3, 4), (False, True)))
]


@pytest.mark.parametrize(("kind", "count", "seed", "closed"), CASES)
def test_all_cuts_make_tours(kind: str, count: int, seed: int, closed: bool) -> None:
    form, best = form_of(kind, count, seed, closed=closed)
    edges, costs = all_edges(form)
    model = generalised.build(form.cluster, form.mate, edges, costs, form.node_costs, every_set(form))
    result = highs.run(highs.compile_model(model))
    assert result.objective == pytest.approx(best)


@pytest.mark.parametrize(("kind", "count", "seed", "closed"), CASES)
def test_the_cut_loop_reaches_the_relaxation_with_all_cuts(
    kind: str, count: int, seed: int, closed: bool, monkeypatch: pytest.MonkeyPatch
) -> None:
    """A violated cut is found as long as there is one: bound and model agree."""
    monkeypatch.setattr(undirected_root, "STALL", -1.0)
    form, best = form_of(kind, count, seed, closed=closed)
    edges, costs = all_edges(form)
    expected = relaxation(form, edges, costs, every_set(form))
    root = Root(CutProgramme(form, edges), NO_TOUR, math.inf, time.monotonic() + 60, lambda _: None)
    assert isinstance(root.tighten(), Solution)
    assert root.bound <= best + 1e-9
    assert root.bound == pytest.approx(expected, abs=1e-6 * max(1.0, abs(expected)))


def relaxation_of(form: Undirected, edges: IntArray, costs: FloatArray, cuts: list[Cut]) -> float:
    """Of the model with the cuts of the fast form, blossoms among them."""
    model = generalised.build(form.cluster, form.mate, edges, costs, form.node_costs)
    for cut in cuts:
        if is_blossom(form, cut):
            pairs = np.column_stack(np.divmod(cut.teeth, form.clusters))
            generalised.add_blossom(model, form.cluster, cut.members, pairs)
        else:
            generalised.add_cut(model, form.mate, cut.members)
    return highs.run(highs.compile_model(model).relaxed()).objective


def is_blossom(form: Undirected, cut: Cut) -> bool:
    """Whether the row asks for 1 - t links across instead of 2."""
    held = np.bincount(form.cluster[cut.members], minlength=form.clusters) == np.bincount(form.cluster)
    whole = 0 if len(cut.halves) == len(cut.members) else int(held.sum())
    return whole - cut.right != pytest.approx(1.0)


def test_the_fast_form_has_the_bound_of_the_model_with_the_same_cuts() -> None:
    """Columns for y, degrees and cuts written out on one side, none of them on the other."""
    problem = random_undirected("lines", 12, 5, closed=False)
    form = undirected_form(problem)
    assert form is not None
    edges, costs = all_edges(form)
    programme = CutProgramme(form, edges)
    root = Root(programme, NO_TOUR, math.inf, time.monotonic() + 60, lambda _: None)
    solution = root.tighten()
    assert isinstance(solution, Solution)
    blossoms = [cut for cut in programme.cuts if is_blossom(form, cut)]
    assert len(programme.cuts) > len(blossoms) + 5
    assert blossoms
    assert relaxation_of(form, edges, costs, programme.cuts) == pytest.approx(solution.objective, rel=1e-7)
    sets = [cut.members for cut in programme.cuts if not is_blossom(form, cut)]
    fewer = CutProgramme(form, edges)
    fewer.add_cuts(sets[:3])
    again = fewer.programme.solve()
    assert isinstance(again, Solution)
    assert relaxation(form, edges, costs, sets[:3]) == pytest.approx(again.objective, rel=1e-7)
    assert again.objective < solution.objective


@pytest.mark.parametrize(("kind", "count", "seed", "closed"), CASES)
def test_blossoms_leave_every_tour(kind: str, count: int, seed: int, closed: bool) -> None:
    """With every blossom of one to three teeth the best tour is still there."""
    form, best = form_of(kind, count, seed, closed=closed)
    edges, costs = all_edges(form)
    model = generalised.build(form.cluster, form.mate, edges, costs, form.node_costs, every_set(form))
    only = (np.bincount(form.cluster) == 2)[form.cluster] & (form.mate != np.arange(form.points))
    pairs = list(itertools.combinations(range(form.clusters), 2))
    random = np.random.default_rng(seed)
    for _ in range(300):
        inside = random.random(form.points) < 0.5
        inside = np.where(only, inside, inside & inside[form.mate])
        split = int((inside != inside[form.mate]).sum()) // 2
        count_of = 1 + int(random.integers(3))
        if (count_of + split) % 2 == 0 or count_of > len(pairs):
            continue
        teeth = np.array([pairs[k] for k in random.choice(len(pairs), count_of, replace=False)])
        generalised.add_blossom(model, form.cluster, np.flatnonzero(inside), teeth)
    assert highs.run(highs.compile_model(model)).objective == pytest.approx(best)
