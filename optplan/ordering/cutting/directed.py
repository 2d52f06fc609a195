"""Exact ordering of directed and precedence-constrained problems: a cut loop, then branch and cut.

After Balas, Fischetti and Pulleyblank ("The precedence-constrained asymmetric traveling salesman polytope", 1995) and
Ascheuer, Juenger and Reinelt ("A branch & cut algorithm for the asymmetric traveling salesman problem with precedence
constraints", 2000).
"""

from __future__ import annotations

import math
from dataclasses import dataclass, replace

import numpy as np

from optplan.domain.arrays import FloatArray, IntArray
from optplan.domain.ordering import OrderingProblem
from optplan.domain.stop import RunningStop, StopReason, StopRule
from optplan.ordering.arrays import DENSE_NODES
from optplan.ordering.beam import dense, scout
from optplan.ordering.cutting.directed_graph import rooted_tour, takes_closed
from optplan.ordering.cutting.directed_guess import guess
from optplan.ordering.cutting.directed_root import CutLoop
from optplan.ordering.cutting.directed_tree import Tree
from optplan.ordering.local import nearest_neighbour
from optplan.ordering.method import Method, Run
from optplan.ordering.search import search as anneal

FIRST_EACH = 200
"""Iterations a cluster of the search for a path to begin with."""
POLISH_EACH = 20
"""Iterations a cluster of the search from a path that the programme suggests."""
SCOUT_SHARE = 0.15
"""Of the time, for a first path where precedence is dense."""
SEARCH = Method("search", "for incumbents", anneal, closed=True)


@dataclass(frozen=True, eq=False)
class Root:
    """Duals of the root programme, as a bound and reduced costs >= 0 that hold for the complete problem.

    Of every solution that costs less than the incumbent given (of every solution when none was):
        cost >= bound + start[first node] + sum of arcs[i, j] over its arcs + end[last node],
    and it uses no arc, first or last node whose entry is infinite. Of a closed problem, the arc from the last node to
    the first counts among the arcs, and start and end are 0. "Less" means by more than 1e-7 of the incumbent, or, of
    whole costs, by at least the greatest number that divides them all.

    Parameters
    ----------
    bound : minus infinity when nothing is known, infinite when no such solution exists
    arcs : (n, n); start, end : (n,)
    """

    bound: float
    arcs: FloatArray
    start: FloatArray
    end: FloatArray


def refuse_many_nodes(problem: OrderingProblem) -> str | None:
    """Why the costs do not fit into a matrix."""
    if problem.nodes <= DENSE_NODES:
        return None
    return f"it has {problem.nodes} nodes; at most {DENSE_NODES}"


def root(
    problem: OrderingProblem,
    incumbent_cost: float = math.inf,
    stop: StopRule | RunningStop | None = None,
    start: IntArray | None = None,
) -> Root:
    """Bound and reduced costs by cuts alone.

    Parameters
    ----------
    problem : of two clusters or more, no duplicate nodes, no enforced connections; open, or closed and `takes_closed`
    incumbent_cost : of a known solution: only better ones matter
    stop : when to stop; what is proved by then is returned
    start : (m,) a solution, which makes the first programme small; found by nearest neighbours when not given
    """
    clock = stop.start() if isinstance(stop, StopRule) else stop or StopRule().start()
    tour = rooted_tour(problem)
    loop = CutLoop(tour, lambda: clock.reason() is not None)
    if start is None:
        left = replace(clock.rule, seconds=max(1e-3, clock.remaining), iterations=1, target=-math.inf)
        start = Method("nn", "", nearest_neighbour).solve(problem, left, 0).nodes
    if len(start):
        loop.learn(tour.tour_of(start))
    loop.upper = incumbent_cost
    loop.start()
    loop.run()
    reduced = loop.reduced.copy()
    if math.isfinite(loop.base):  # else the time was over before anything was proved
        reduced[loop.base + reduced >= loop.cutoff] = math.inf
    inner = slice(None) if problem.closed else slice(-1)
    none = np.zeros(problem.nodes)
    return Root(
        loop.base,
        reduced[inner, inner],
        none if problem.closed else reduced[-1, :-1],
        none if problem.closed else reduced[:-1, -1],
    )


def directed_bound(problem: OrderingProblem, stop: StopRule | RunningStop | None = None) -> float:
    """No solution of the problem costs less; infinite: there is none. By cuts alone, so also for large problems.

    Parameters and limits as in `root`.
    """
    clock = stop.start() if isinstance(stop, StopRule) else stop or StopRule().start()
    bounds = [-math.inf]
    loop = CutLoop(rooted_tour(problem), lambda: clock.reason() is not None, proved=bounds.append)
    left = replace(clock.rule, seconds=max(1e-3, clock.remaining), iterations=1, target=-math.inf)
    known = Method("nn", "", nearest_neighbour).solve(problem, left, 0).nodes
    if len(known):
        loop.learn(loop.tour.tour_of(known))
    loop.start()
    loop.run()
    return max(bounds)


def solve_directed(run: Run) -> StopReason:
    """Prove the optimum, or give incumbent and bound. One iteration is one node of the tree of branch and cut."""
    problem = run.problem
    if problem.closed and not takes_closed(problem):
        # several clusters can be first, and it matters which: one open problem for each first node
        whole = Method("cuts", "", solve_directed)
        known = run.nodes if len(run.nodes) else None
        limits = replace(run.rule, seconds=max(1e-3, run.clock.remaining))
        answer = whole.solve(problem, limits, run.seed, known, run.progress)
        if len(answer.nodes):
            run.offer(answer.nodes)
        run.prove(answer.bound)
        return answer.stopped
    tour = rooted_tour(problem)

    def ended() -> bool:
        run.iterations = loop.nodes
        return run.stop() is not None

    loop = CutLoop(tour, ended, run.prove, lambda nodes: run.offer(tour.path_of(nodes)), run.seed)

    def search(start: IntArray | None, iterations: int) -> None:
        limits = replace(run.rule, seconds=max(1e-3, run.clock.remaining), iterations=iterations)
        found = SEARCH.solve(problem, limits, run.seed, start).nodes
        if len(found):
            loop.learn(tour.tour_of(found))

    def improve() -> None:
        lp = loop.programme
        nodes = guess(tour, loop.reduced, lp.tails[: len(lp.primal)], lp.heads[: len(lp.primal)], lp.primal)
        if nodes is not None and not problem.faults(tour.path_of(nodes)):
            search(tour.path_of(nodes), POLISH_EACH * problem.clusters)

    if dense(problem) and run.rule.iterations is None:
        scout(run, SCOUT_SHARE)
    if len(run.nodes):
        loop.learn(tour.tour_of(run.nodes))
    search(run.nodes if len(run.nodes) else None, FIRST_EACH * problem.clusters)
    loop.start()
    state = loop.run()
    finished = state == "proved"
    if state == "done":
        improve()
        loop.shrink()
        finished = Tree(loop, improve).run()
    if stop := run.stop():
        return stop
    if not finished:
        run.message = "HiGHS could not solve a linear programme of the cut loop"
        return StopReason.FAILED
    return StopReason.FINISHED
