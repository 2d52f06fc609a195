"""Solvers of ordering problems, and lower bounds."""

from __future__ import annotations

from optplan.domain.arrays import IntArray
from optplan.domain.errors import InputError
from optplan.domain.ordering import Ordering, OrderingProblem, Solver
from optplan.domain.progress import ProgressCallback
from optplan.domain.stop import StopRule
from optplan.ordering.arrays import refuse_unknown_costs
from optplan.ordering.auto import choose_and_solve
from optplan.ordering.baselines.genetic import genetic, genetic_feasible
from optplan.ordering.baselines.nearest import nearest_feasible_neighbour, nearest_neighbour_as_published
from optplan.ordering.baselines.rows import refuse_rows, refuse_rows_split, rows, rows_split
from optplan.ordering.baselines.shifted import noon_bean, refuse_precedence_or_many_cities
from optplan.ordering.baselines.tree import kernel_first, refuse_no_forest
from optplan.ordering.baselines.two_opt import two_opt
from optplan.ordering.beam import beam_search
from optplan.ordering.branch import branch_and_bound
from optplan.ordering.branch import refuse_many_nodes as refuse_large_trees
from optplan.ordering.cuts import lower_bound, refuse_no_form, solve_by_cuts
from optplan.ordering.exact import flow_by_highs, mtz_by_highs, plain_mtz_by_highs, refuse_many_arcs
from optplan.ordering.ideals import prove_by_ideals, refuse_loose_precedence
from optplan.ordering.ideals_bound import refuse_large_tables
from optplan.ordering.lkh import lkh, refuse_without_lkh
from optplan.ordering.method import Method
from optplan.ordering.search import search
from optplan.ordering.subsets import refuse_many_subsets, subset_programme

__all__ = ["SOLVERS", "lower_bound", "solve"]

_METHODS = (
    Method(
        "auto",
        "proof where proof is cheap, else search and a bound",
        choose_and_solve,
        refuse_unknown_costs,
        closed=True,
        proves=True,
        improves=True,
    ),
    Method(
        "search",
        "exchanges, ruin and recreate, annealed",
        search,
        refuse_unknown_costs,
        closed=True,
        improves=True,
    ),
    Method("cuts", "cutting planes, then branch and cut", solve_by_cuts, refuse_no_form, closed=True, proves=True),
    Method("dp", "dynamic programme over order ideals", prove_by_ideals, refuse_loose_precedence, proves=True),
    Method("beam", "beam search over order ideals", beam_search, refuse_large_tables, proves=True, improves=True),
    Method("bnb", "depth-first branch and bound, as published", branch_and_bound, refuse_large_trees, proves=True),
    Method("brute", "dynamic programming over all subsets", subset_programme, refuse_many_subsets, proves=True),
    Method("mtz-lifted", "mixed-integer model: positions, lifted", mtz_by_highs, refuse_many_arcs, proves=True),
    Method("mtz", "the same as published", plain_mtz_by_highs, refuse_many_arcs, proves=True),
    Method("flow", "mixed-integer model: flow of one commodity", flow_by_highs, refuse_many_arcs, proves=True),
    Method(
        "noon-bean",
        "as a travelling-salesman problem, weights shifted",
        noon_bean,
        refuse_precedence_or_many_cities,
        proves=True,
        precedence=False,
    ),
    Method("rows", "circles of a facade strictly row by row, as published", rows, refuse_rows),
    Method("rows-split", "the same, rows cut where precedence changes", rows_split, refuse_rows_split),
    Method("nn", "nearest neighbour, as published", nearest_neighbour_as_published, closed=True, precedence=False),
    Method("nn-feasible", "nearest feasible neighbour, ties downwards", nearest_feasible_neighbour, closed=True),
    Method("2opt", "nearest neighbour and 2-opt, as published", two_opt, closed=True, precedence=False),
    Method("tree", "what lies inside a stroke first, then the nearest", kernel_first, refuse_no_forest, closed=True),
    Method(
        "ga",
        "genetic algorithm, as published",
        genetic,
        refuse_unknown_costs,
        closed=True,
        precedence=False,
        improves=True,
    ),
    Method(
        "ga-feasible",
        "the same, children repaired to keep precedence",
        genetic_feasible,
        refuse_unknown_costs,
        closed=True,
        improves=True,
    ),
    Method("lkh", "the program LKH, where it is installed", lkh, refuse_without_lkh, improves=True),
)

SOLVERS: dict[str, Solver] = {method.name: method for method in _METHODS}
"""Every solver by the name that users type."""


def solve(
    problem: OrderingProblem,
    solver: str = "auto",
    stop: StopRule | None = None,
    seed: int = 0,
    start: IntArray | None = None,
    progress: ProgressCallback | None = None,
) -> Ordering:
    """Order the strokes.

    Parameters
    ----------
    problem : what to order
    solver : a name in `SOLVERS`
    stop : when to stop; without limits a solver runs until it is finished
    seed : of everything random
    start : (m,) nodes of a known solution to begin with
    progress : told about every improvement

    Raises
    ------
    InputError : no solver of that name, or a start that is no solution
    SolverError : the solver refuses the problem; says why
    """
    if solver not in SOLVERS:
        raise InputError(f"there is no solver {solver!r}; expected one of {', '.join(SOLVERS)}")
    return SOLVERS[solver].solve(problem, stop or StopRule(), seed, start, progress)
