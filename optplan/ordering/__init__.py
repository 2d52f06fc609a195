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
from optplan.ordering.bounds import lower_bound
from optplan.ordering.branch import branch_and_bound, refuse_many_nodes
from optplan.ordering.exact import mtz_by_highs, plain_mtz_by_highs, refuse_many_arcs
from optplan.ordering.ideals import prove_by_ideals, refuse_loose_precedence
from optplan.ordering.ideals_bound import refuse_large_tables
from optplan.ordering.lkh import lkh, refuse_without_lkh
from optplan.ordering.local import local_search
from optplan.ordering.method import Method
from optplan.ordering.subsets import refuse_many_subsets, subset_programme

__all__ = ["SOLVERS", "lower_bound", "solve"]

_METHODS = (
    Method("auto", "proof where proof is cheap, else search and a bound", choose_and_solve, refuse_unknown_costs),
    Method("local", "2-opt, or-opt and node choice, then perturbations: any-time", local_search, refuse_unknown_costs),
    Method("brute", "dynamic programming over subsets: proves small problems", subset_programme, refuse_many_subsets),
    Method("bnb", "depth-first branch and bound: proves a dozen strokes", branch_and_bound, refuse_many_nodes),
    Method(
        "beam", "beam search over order ideals: any-time, proves dense precedence", beam_search, refuse_large_tables
    ),
    Method(
        "dp", "dynamic programme over order ideals: proves dense precedence", prove_by_ideals, refuse_loose_precedence
    ),
    Method(
        "mtz-lifted", "mixed-integer model (MTZ, lifted) by HiGHS: proves, or bounds", mtz_by_highs, refuse_many_arcs
    ),
    Method("mtz", "mixed-integer model (MTZ) as published, by HiGHS", plain_mtz_by_highs, refuse_many_arcs),
    Method("noon-bean", "as a travelling-salesman problem, solved by MTZ", noon_bean, refuse_precedence_or_many_cities),
    Method("rows", "circles of a facade strictly row by row, by MTZ", rows, refuse_rows),
    Method("rows-split", "the same, rows cut where precedence changes", rows_split, refuse_rows_split),
    Method("nn", "nearest neighbour as published: no precedence", nearest_neighbour_as_published, closed=True),
    Method("nn-feasible", "nearest feasible neighbour, ties downwards", nearest_feasible_neighbour, closed=True),
    Method("2opt", "nearest neighbour and 2-opt as published: no precedence", two_opt, closed=True),
    Method("tree", "what lies inside a stroke first, then the nearest", kernel_first, refuse_no_forest, closed=True),
    Method("ga", "genetic algorithm as published: no precedence", genetic, refuse_unknown_costs, closed=True),
    Method("ga-feasible", "genetic algorithm, repaired", genetic_feasible, refuse_unknown_costs, closed=True),
    Method("lkh", "the program LKH, where it is installed", lkh, refuse_without_lkh),
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
