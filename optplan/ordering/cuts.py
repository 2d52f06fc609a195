"""`cuts`: cutting planes and branch and cut, in the undirected form where there is one, else in the directed one."""

from __future__ import annotations

import math

from optplan.domain.ordering import OrderingProblem
from optplan.domain.stop import RunningStop, StopReason, StopRule
from optplan.ordering.arrays import DENSE_NODES
from optplan.ordering.bounds import tree_bound
from optplan.ordering.cutting.directed import directed_bound, solve_directed
from optplan.ordering.cutting.undirected import undirected_form
from optplan.ordering.cutting.undirected_solve import solve_undirected, undirected_bound
from optplan.ordering.method import Run
from optplan.ordering.reduce import reduced


def refuse_no_form(problem: OrderingProblem) -> str | None:
    """Why neither form takes it."""
    if problem.nodes <= DENSE_NODES or undirected_form(problem) is not None:
        return None
    return f"it has {problem.nodes} nodes and costs or rules with a direction; at most {DENSE_NODES}"


def solve_by_cuts(run: Run) -> StopReason:
    """Prove the optimum, or give incumbent and bound."""
    form = undirected_form(run.problem)
    return solve_directed(run) if form is None else solve_undirected(run, form)


def prove_by_cuts(run: Run) -> StopReason:
    """The same after a search: where a path is known, all the time goes to the proof."""
    form = undirected_form(run.problem)
    return solve_directed(run) if form is None else solve_undirected(run, form, search_first=False)


def lower_bound(problem: OrderingProblem, stop: StopRule | RunningStop | None = None) -> float:
    """The best lower bound that 1-trees and cutting planes give in the time there is; valid for the whole problem.

    Infinite when there is provably no solution, minus infinity when nothing is known.

    Parameters
    ----------
    problem : of any size
    stop : time limit and cancel; without a time limit, 1-trees alone. Iterations are steps of their ascent
    """
    clock = stop if isinstance(stop, RunningStop) else (stop or StopRule()).start()
    small = reduced(problem).problem
    bound = tree_bound(small, clock)
    if math.isinf(clock.rule.seconds) or clock.reason() or small.clusters < 2 or refuse_no_form(small):
        return bound
    cut = directed_bound if undirected_form(small) is None else undirected_bound
    return max(bound, cut(small, clock))
