"""Proofs for problems without a direction: search, cut loop, branch and cut."""

from __future__ import annotations

import math
import time
from collections.abc import Callable
from dataclasses import replace

import numpy as np

from optplan.domain.arrays import IntArray
from optplan.domain.ordering import OrderingProblem
from optplan.domain.stop import RunningStop, StopReason, StopRule
from optplan.ordering.cutting.child import prove_in_child
from optplan.ordering.cutting.undirected import Undirected, undirected_form
from optplan.ordering.cutting.undirected_branch import branch_and_cut
from optplan.ordering.cutting.undirected_lp import CutProgramme
from optplan.ordering.cutting.undirected_root import ALL_POINTS, Root, first_edges
from optplan.ordering.method import Method, Run
from optplan.ordering.search import search

SEARCH = Method("search", "for a tour to begin with", search, closed=True)
SEARCH_SHARE = 0.2
"""Of the time, for a tour to begin with."""
SEARCH_EACH = 50
"""Iterations of the search for each cluster."""
NO_TOUR = np.zeros((0, 2), dtype=np.int64)


def solve_undirected(run: Run, form: Undirected, *, branch: bool = True, search_first: bool = True) -> StopReason:
    """Prove the optimum, or give incumbent and bound; the bound is one of the complete problem at any time.

    After Fischetti, Salazar Gonzalez and Toth ("A branch-and-cut algorithm for the symmetric generalized traveling
    salesman problem", 1997). Iterations are those of the search.

    Parameters
    ----------
    run : of a problem without enforced connections
    form : of the same problem (`undirected_form`)
    branch : False for the bound of the cut loop alone
    search_first : False when the path that is known comes from a search
    """
    if search_first or not len(run.nodes):
        _search(run)
    if (stop := run.stop()) and stop is not StopReason.ITERATIONS:
        return stop
    tour = form.edges_of(run.nodes) if len(run.nodes) else NO_TOUR
    if not len(tour) and form.points > ALL_POINTS:
        run.message = "no path is known: the cut loop has nothing to begin with"
        return run.stop() or StopReason.FINISHED
    until = time.time() + run.clock.remaining
    return prove_in_child(run, f"{__name__}:prove", form, tour, until, run.seed, branch)


def _search(run: Run) -> None:
    """Find a tour to begin with, or a better one."""
    problem, rule = run.problem, run.rule
    most = SEARCH_EACH * problem.clusters
    limits = replace(
        rule,
        seconds=max(1e-3, SEARCH_SHARE * run.clock.remaining),
        iterations=most if rule.iterations is None else min(most, rule.iterations),
    )
    answer = SEARCH.solve(problem, limits, run.seed, run.nodes if len(run.nodes) else None)
    run.iterations += answer.iterations
    if len(answer.nodes):
        run.offer(answer.nodes)


def undirected_bound(problem: OrderingProblem, stop: StopRule | RunningStop | None = None) -> float:
    """No solution costs less, by cuts alone; minus infinity when nothing is known or the problem has no such form.

    problem : of any size, without enforced connections; stop : time limit and cancel
    """
    clock = stop if isinstance(stop, RunningStop) else (stop or StopRule()).start()
    form = undirected_form(problem)
    if form is None:
        return -math.inf
    run = Run(problem, clock)
    solve_undirected(run, form, branch=False)
    return run.bound


def prove(send: Callable[..., None], form: Undirected, tour: IntArray, until: float, seed: int, branch: bool) -> None:
    """The child's part: send bounds and paths until it is proved or the time is over.

    form, tour (m, 2) edges, none when no tour is known; until : time limit, of time.time; branch : below the root too
    """
    deadline = time.monotonic() + (until - time.time())
    scale = _scale(form, tour)
    form = form.scaled(scale)
    costs = form.edge_costs(tour[:, 0], tour[:, 1])
    root = Root(
        CutProgramme(form, first_edges(form, tour), seed),
        tour,
        float(costs.sum()) if len(tour) else math.inf,
        deadline,
        lambda bound: send("bound", bound / scale),
    )
    solution = root.tighten()
    finished = root.closed()
    if solution is not None and not finished:
        finished = not branch or branch_and_cut(root, solution, lambda edges: send("incumbent", form.nodes_of(edges)))
    send("done", finished)


def _scale(form: Undirected, tour: IntArray) -> float:
    """The power of two that makes an average edge cost 1 to 2: HiGHS's tolerances are absolute."""
    for edges in (tour, first_edges(form, tour)):
        costs = form.edge_costs(edges[:, 0], edges[:, 1])
        costs = np.abs(costs[np.isfinite(costs)])
        if costs.any():
            return float(2.0 ** -math.floor(math.log2(costs.mean())))
    return 1.0
