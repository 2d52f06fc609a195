"""`dp`: the dynamic programme over order ideals, guided by a dual solution and pruned by its bound."""

from __future__ import annotations

from optplan.domain.ordering import OrderingProblem
from optplan.domain.stop import StopReason
from optplan.ordering.beam import Hunt, widen
from optplan.ordering.cutoff import cutoff
from optplan.ordering.ideals_bound import Relaxation, refuse_large_tables
from optplan.ordering.ideals_layers import most_states
from optplan.ordering.ideals_network import Reduced, closure
from optplan.ordering.method import Run

LOOSE_CLUSTERS = 60
"""Up to this many clusters the programme is tried without precedence: bounds leave few of the 2^m sets."""
LEAST_DENSITY = 0.02
"""Share of the pairs of clusters that precedence orders; with less, more clusters are hopeless."""
GUIDE_WIDTH = 2048
"""Widest beam that looks for a path before all states are kept."""


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
    """Prove the optimum, or that there is none, as far as time and memory allow. One iteration is one sweep.

    A narrow beam looks for a path and improves the bound; then all states are kept whose bound is below it. Where they
    do not fit into memory the worst are dropped, and the least of their bounds is what is proved.

    Parameters
    ----------
    run : perhaps with a known path
    reduced : reduced costs that bound all paths, or at least those better than the known one; without them the costs
        themselves
    """
    hunt = Hunt(run, Relaxation(run.problem, reduced), cutoff(run.problem))
    stop = widen(hunt, GUIDE_WIDTH)
    if stop is not StopReason.FINISHED or hunt.goal.closed(run):
        return stop
    found = hunt.sweep(hunt.direction, most_states(run.problem))
    run.iterations += 1
    if not found.stopped:
        run.message = f"the states did not fit into memory ({found.states} were kept)"
    return found.stopped or StopReason.FINISHED
