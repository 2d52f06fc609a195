"""Solvers of ordering problems, and lower bounds."""

from __future__ import annotations

from optplan.domain.arrays import IntArray
from optplan.domain.errors import InputError
from optplan.domain.ordering import Ordering, OrderingProblem, Solver
from optplan.domain.progress import ProgressCallback
from optplan.domain.stop import StopRule
from optplan.ordering.arrays import refuse_unknown_costs
from optplan.ordering.auto import choose_and_solve
from optplan.ordering.bounds import lower_bound
from optplan.ordering.exact import mtz_by_highs, refuse_many_arcs
from optplan.ordering.local import nearest_neighbour
from optplan.ordering.method import Method
from optplan.ordering.search import search
from optplan.ordering.subsets import refuse_many_subsets, subset_programme

__all__ = ["SOLVERS", "lower_bound", "solve"]

_METHODS = (
    Method("auto", "proof where proof is cheap, else search and a bound", choose_and_solve, refuse_unknown_costs),
    Method("nn", "nearest feasible neighbour, from several first strokes", nearest_neighbour, refuse_unknown_costs),
    Method("search", "exchanges, ruin and recreate, annealed: any-time", search, refuse_unknown_costs, closed=True),
    Method("brute", "dynamic programming over subsets: proves small problems", subset_programme, refuse_many_subsets),
    Method("exact", "mixed-integer model (MTZ) by HiGHS: proves, or gives a bound", mtz_by_highs, refuse_many_arcs),
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
