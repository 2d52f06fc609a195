"""`dp`: the dynamic programme over order ideals, guided by the duals of a linear programme and pruned by its bound."""

from __future__ import annotations

from optplan.domain.ordering import OrderingProblem
from optplan.domain.stop import StopReason, StopRule
from optplan.ordering.beam import Hunt, widen
from optplan.ordering.cutoff import cutoff
from optplan.ordering.cutting.directed import root
from optplan.ordering.ideals_bound import Relaxation, refuse_large_tables
from optplan.ordering.ideals_layers import most_states
from optplan.ordering.ideals_network import Reduced, closure
from optplan.ordering.method import Run

LOOSE_CLUSTERS = 60
"""Up to this many clusters the programme is tried without precedence: bounds leave few of the 2^m sets."""
LEAST_DENSITY = 0.02
"""Share of the pairs of clusters that precedence orders; with less, more clusters are hopeless."""
SCOUT_WIDTH = 2048
"""Widest sweep before the linear programme: it finds a path, and many problems need no more."""
ROOT_SHARE, ROOT_SECONDS = 0.5, 60.0
"""Share of the time left for the linear programme, and its time when there is no limit."""


def refuse_loose_precedence(problem: OrderingProblem) -> str | None:
    """Why the order ideals are too many."""
    count = problem.clusters
    if count > LOOSE_CLUSTERS:
        density = 2.0 * float(closure(count, problem.precedence).sum()) / (count * (count - 1))
        if density < LEAST_DENSITY:
            return (
                f"{count} clusters of which precedence orders {100 * density:.2g} % of the pairs; at most "
                f"{LOOSE_CLUSTERS} clusters, or at least {100 * LEAST_DENSITY:g} % of the pairs ordered"
            )
    return refuse_large_tables(problem)


def prove_by_ideals(run: Run, reduced: Reduced | None = None) -> StopReason:
    """Prove the optimum, or that there is none, as far as time and memory allow. One iteration is one width.

    Narrow sweeps look for a path. Unless they prove it, a linear programme with cuts gives reduced costs. Then sweeps
    guided by these, or by the costs themselves if that proves more, widen until all states are kept whose bound is
    below the path's cost. Where they do not fit into memory the worst are dropped, and the least of their bounds is
    what is proved.

    Parameters
    ----------
    run : perhaps with a known path
    reduced : reduced costs that bound all paths better than the one known, instead of those of the linear programme
    """
    goal, widest = cutoff(run.problem), most_states(run.problem)
    if reduced is None:
        scout = Hunt(run, Relaxation(run.problem), goal)
        stop = widen(scout, SCOUT_WIDTH)
        if stop is not StopReason.FINISHED or goal.closed(run):
            return stop
        reduced = _duals(run)
        goal.conclude(run, reduced.bound, scout.relaxation.rounding)
        if goal.closed(run):
            return StopReason.FINISHED
        hunt = Hunt(run, Relaxation(run.problem, reduced), goal, scout.direction)
        found = hunt.sweep(hunt.direction, SCOUT_WIDTH)
        if found.stopped:
            return found.stopped
        # the duals bound the whole better, walks in places often what is left of it
        return widen(hunt if found.floor > scout.floor else scout, widest, 2 * SCOUT_WIDTH)
    return widen(Hunt(run, Relaxation(run.problem, reduced), goal), widest)


def _duals(run: Run) -> Reduced:
    """Reduced costs for paths that are better than the known one."""
    seconds = max(1e-3, min(ROOT_SHARE * run.clock.remaining, ROOT_SECONDS))
    clock = StopRule(seconds, cancelled=lambda: run.stop() is not None).start()
    found = root(run.problem, run.cost, clock, run.nodes if len(run.nodes) else None)
    return Reduced(found.bound, found.arcs, found.start, found.end)
