"""The model by degree rows and cuts, and its fast form."""

from __future__ import annotations

from dataclasses import replace
from typing import Any

import numpy as np
import pytest

from optplan.domain.arrays import FloatArray
from optplan.domain.ordering import MatrixCosts, OrderingProblem
from optplan.ordering.cutting.directed_graph import RootedTour, rooted_tour, takes_closed
from optplan.ordering.cutting.directed_root import CutLoop
from optplan.ordering.cutting.directed_separation import Separator
from optplan_models.ordering import cuts
from optplan_models.ordering.rooted import Ints, Rooted
from tests.models.rooted_cases import as_model, every_arc, least, rooted, small, tours, used
from tests.ordering_cases import optimum, random_problem


def random_cuts(problem: Rooted, rng: np.random.Generator) -> list[cuts.Cut]:
    """One cut of each family around a random set."""
    order, others = problem.order(), np.delete(np.arange(problem.clusters), problem.root)
    root = problem.cluster == problem.root
    inside = (rng.random(len(root)) < rng.uniform(0.2, 0.8)) & ~root
    found = [cuts.subtour(problem, inside, int(rng.choice(others)))]
    whole = [c for c in others if inside[problem.cluster == c].all()]
    beyond = [c for c in others if not inside[problem.cluster == c].any()]
    if whole:
        found.append(cuts.predecessor(problem, inside))
    if beyond:
        found.append(cuts.successor(problem, inside | root))
    # partly inside or not, they only have to precede each other
    pairs = np.argwhere(order)
    first, last = pairs[rng.integers(len(pairs))]
    more = [c for c in range(problem.clusters) if order[c, last] and rng.random() < 0.5]
    found.append(cuts.combined(problem, inside | root, {int(first), *more}, [int(last)]))
    return found


def as_cuts(tour: RootedTour, marks: Any) -> list[cuts.Cut]:
    """Marks of the fast form as cuts of the model."""
    heads = np.arange(tour.nodes)
    ends = marks[:, tour.ends(heads)]
    inner = marks[:, : tour.nodes]
    return [cuts.Cut(m & 1 > 0, e & 2 > 0, m & 4 > 0, e & 8 > 0) for m, e in zip(inner, ends, strict=True)]


@pytest.mark.parametrize("seed", range(18))
def test_no_solution_is_cut_off(seed: int) -> None:
    problem = small(seed)
    model = rooted(problem)
    count = len(model.cluster)
    solutions, arcs = used(tours(problem), count), every_arc(count)
    rng = np.random.default_rng(seed)
    for _ in range(60):
        for cut in random_cuts(model, rng):
            assert (solutions @ cut.arcs(arcs) > 0).all()


def fractional(tour: RootedTour, rng: np.random.Generator) -> tuple[Ints, Ints, FloatArray]:
    """A mean of two points that satisfy the degree rows."""
    total: Any = 0.0
    for _ in range(2):
        costs = np.where(np.isfinite(tour.costs), rng.random(tour.costs.shape), np.inf)
        loop = CutLoop(replace(tour, costs=costs), lambda: False)
        loop.start()
        assert loop.programme.solve(lambda: False) == "Optimal"
        total = total + 0.5 * loop.programme.primal
    return loop.programme.tails, loop.programme.heads, np.asarray(total)


@pytest.mark.parametrize("seed", range(18))
def test_separated_cuts_are_violated_and_cut_off_no_solution(seed: int) -> None:
    problem = small(seed)
    tour = rooted_tour(problem)
    solutions, arcs = used(tours(problem), tour.nodes), every_arc(tour.nodes)
    if not len(solutions):
        return
    separator, rng = Separator(tour), np.random.default_rng(seed)
    for _ in range(12):
        tails, heads, values = fractional(tour, rng)
        marks = separator.violated(tails, heads, values, 50, deep=True)
        for cut in as_cuts(tour, marks):
            assert values[cut.arcs(np.stack([tails, heads], axis=1))].sum() < 1.0
            assert (solutions @ cut.arcs(arcs) > 0).all()


@pytest.mark.parametrize("seed", range(12))
def test_bound_is_that_of_the_model_with_the_same_cuts(seed: int) -> None:
    problem = random_problem(
        "matrix" if seed % 2 else "euclid",
        9,
        seed,
        precedence=seed % 3 > 0,
        start=False,
        end=False,
        closed=seed % 4 == 0,
    )
    if problem.closed and not takes_closed(problem):
        return
    loop = CutLoop(rooted_tour(problem), lambda: False)
    loop.start()
    assert loop.run() in ("done", "proved")
    model = as_model(loop.tour)
    relaxed = least(cuts.build(model, as_cuts(loop.tour, loop.programme.marks)), relaxed=True)
    assert relaxed == pytest.approx(loop.base, rel=1e-6, abs=1e-6)


def every_cut(problem: Rooted) -> list[cuts.Cut]:
    """All combined cuts between two clusters."""
    order, count = problem.order(), len(problem.cluster)
    root = problem.cluster == problem.root
    found = []
    for bits in range(2**count):
        inside = (bits >> np.arange(count) & 1).astype(np.bool_)
        if inside[root].all():
            found += [cuts.combined(problem, inside, [a], [b]) for a, b in np.argwhere(order).tolist()]
    return found


def singletons(seed: int) -> OrderingProblem:
    """Five clusters of one node."""
    costs = MatrixCosts(np.random.default_rng(seed).uniform(0, 10, (5, 5)))
    pairs = random_problem("matrix", 5, seed, precedence=True, start=False, end=False).precedence
    return OrderingProblem(np.arange(5), costs, precedence=pairs)


@pytest.mark.parametrize("seed", range(6))
def test_separation_is_exact(seed: int) -> None:
    """The cut loop ends where all combined cuts between two clusters, written out, lead as well, or higher."""
    problem = singletons(seed)
    model = rooted(problem)
    full = least(cuts.build(model, every_cut(model)), relaxed=True)
    loop = CutLoop(rooted_tour(problem), lambda: False)
    loop.start()
    loop.run()
    best = optimum(problem)
    assert full <= best + 1e-6
    assert full - 0.02 * abs(full) <= loop.base <= best + 1e-9


def test_complete_with_enough_cuts() -> None:
    problem = singletons(1)
    model = cuts.build(rooted(problem), every_cut(rooted(problem)))
    assert least(model) == pytest.approx(optimum(problem), abs=1e-6)


def test_combined_needs_precedence() -> None:
    problem = rooted(singletons(0))
    inside = np.ones(len(problem.cluster), dtype=np.bool_)
    with pytest.raises(ValueError, match="precede"):
        cuts.combined(problem, inside, [0], [0])
