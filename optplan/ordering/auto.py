"""`auto`: proof where proof is cheap, else the best search plus a bound."""

from __future__ import annotations

import math

from optplan.domain.stop import StopReason, StopRule
from optplan.ordering.bounds import lower_bound
from optplan.ordering.exact import MAX_ARCS, arc_count, prove_by_highs
from optplan.ordering.method import OPTIMAL_GAP, Run
from optplan.ordering.search import search
from optplan.ordering.subsets import MAX_WORK, subset_programme, transitions

BRUTE_SPEED = 3e8
"""Transitions of the subset programme in a second, cautiously."""
EXACT_CLUSTERS = 30
"""Beyond, the model with positions closes no gap in a time that anyone waits."""
EXACT_SECONDS = 10.0
"""Given to the model when there is no time limit."""
SEARCH_SHARE = 0.7
BOUND_SHARE = 0.1


def choose_and_solve(run: Run) -> StopReason:
    """Subsets when they are few; else local search, a bound, and the model when it is small."""
    problem = run.problem
    if transitions(problem) <= min(MAX_WORK, 0.5 * BRUTE_SPEED * run.rule.seconds) and run.rule.iterations is None:
        run.message = f"brute: {problem.clusters} clusters are few enough to prove the optimum"
        stop = subset_programme(run)
        if run.bound > -math.inf or stop is not StopReason.TIME:
            return stop
    provable = problem.clusters <= EXACT_CLUSTERS and arc_count(problem) <= MAX_ARCS and run.rule.iterations is None
    run.message = f"search with a bound: {problem.clusters} clusters are too many to prove the optimum"
    share = 0.2 if provable else SEARCH_SHARE
    part = run.within(share * run.clock.remaining, run.rule.iterations)
    stop = search(part)
    run.adopt(part)
    if stop is StopReason.CANCELLED:
        return stop
    ended = run.stop()
    run.prove(lower_bound(problem, StopRule(BOUND_SHARE * run.rule.seconds, cancelled=run.rule.cancelled)))
    if ended in (StopReason.TARGET, StopReason.ITERATIONS, StopReason.CANCELLED):
        return ended
    if _closed(run) or not provable:
        if math.isfinite(run.rule.seconds) and not _closed(run):
            return _use_the_rest(run)
        return run.stop() or StopReason.FINISHED
    run.message = f"search, then mtz-lifted: {problem.clusters} clusters may be few enough to prove the optimum"
    limited = math.isinf(run.rule.seconds)
    part = run.within(EXACT_SECONDS if limited else run.clock.remaining)
    part.nodes, part.cost = run.nodes, run.cost
    stop = prove_by_highs(part)
    run.adopt(part)
    if stop is StopReason.FAILED:
        run.message = part.message
        return run.stop() or StopReason.FINISHED
    if stop is StopReason.TIME and limited:
        run.message += f"; not proved in {EXACT_SECONDS:g} s"
        return StopReason.FINISHED
    return stop


def _closed(run: Run) -> bool:
    return run.cost - run.bound <= OPTIMAL_GAP * max(abs(run.cost), 1e-9)


def _use_the_rest(run: Run) -> StopReason:
    """Search on until the time is over."""
    if stop := run.stop():
        return stop
    part = run.within(run.clock.remaining)
    part.seed += 1
    stop = search(part)
    run.adopt(part)
    return run.stop() or stop
