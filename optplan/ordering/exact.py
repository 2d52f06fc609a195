"""`mtz`, `mtz-lifted` and `flow`: complete Pyomo models, solved by HiGHS in a child process."""

from __future__ import annotations

import math
from collections.abc import Callable
from typing import Any, NamedTuple

import numpy as np

from optplan.domain.arrays import FloatArray, IntArray
from optplan.domain.ordering import OrderingProblem
from optplan.domain.stop import StopReason, StopRule
from optplan.ordering.arrays import dense_costs
from optplan.ordering.bounds import tree_bound
from optplan.ordering.method import Run
from optplan.ordering.search import search

MAX_ARCS = 30_000
"""Most arcs between nodes of different clusters: beyond, not even the root is solved in a minute."""
WARM_SHARE = 0.1
"""Share of the time for finding a start."""
WARM_ITERATIONS = 2000


def arc_count(problem: OrderingProblem) -> int:
    """Arcs between nodes of different clusters."""
    sizes = problem.first_node[1:] - problem.first_node[:-1]
    return int(problem.nodes**2 - (sizes**2).sum())


def refuse_many_arcs(problem: OrderingProblem) -> str | None:
    """Why the model is too large."""
    arcs = arc_count(problem)
    return (
        None if arcs <= MAX_ARCS else f"it has {arcs} arcs between nodes; at most {MAX_ARCS} (fewer entries give fewer)"
    )


def mtz_by_highs(run: Run) -> StopReason:
    """Prove the optimum, or give incumbent and bound. Iterations are those of the search for a start."""
    warm = run.within(WARM_SHARE * run.clock.remaining, _fewer(run.rule.iterations, WARM_ITERATIONS))
    stopped = search(warm)
    run.adopt(warm)
    if stopped in (StopReason.CANCELLED, StopReason.TARGET):
        return stopped
    # cheap, and there is something to show when the model does not get far
    run.prove(tree_bound(run.problem, StopRule(max(0.2 * run.clock.remaining, 0.1), cancelled=run.rule.cancelled)))
    return prove_by_highs(run)


def plain_mtz_by_highs(run: Run) -> StopReason:
    """The model as published, without a start or a bound from elsewhere. There are no iterations."""
    return prove_by_highs(run, lifted=False)


def flow_by_highs(run: Run) -> StopReason:
    """The flow model, without a start or a bound from elsewhere. There are no iterations."""
    return _solve(run, _stated_flow(run))


def prove_by_highs(run: Run, *, lifted: bool = True) -> StopReason:
    """Let HiGHS improve and prove what the run has found so far, by the lifted model or the published one."""
    return _solve(run, _stated_mtz(run, lifted))


class Stated(NamedTuple):
    """A Pyomo model, whose variables hold the best path known, and how to read a path (m,) from them."""

    model: Any
    path: Callable[[], IntArray]


def _stated_mtz(run: Run, lifted: bool) -> Stated:
    from optplan_models.ordering import mtz

    problem = run.problem
    model = mtz.build(
        dense_costs(problem),
        problem.cluster,
        problem.start_costs,
        problem.end_costs,
        problem.node_costs,
        problem.precedence,
        lifted=lifted,
    )
    if len(run.nodes):
        mtz.set_path(model, problem.cluster, run.nodes)
    return Stated(model, lambda: mtz.path_of(model))


def _stated_flow(run: Run) -> Stated:
    from optplan_models.ordering import flow, rooted

    problem = run.problem
    tour = rooted.with_depot(
        dense_costs(problem),
        problem.cluster,
        problem.start_costs,
        problem.end_costs,
        problem.node_costs,
        problem.precedence,
    )
    model = flow.build(tour)
    if len(run.nodes):
        known = np.append(problem.nodes, run.nodes)  # the depot is the node behind all others
        rooted.set_tour(model, known)
        flow.set_flow(model, known)
    return Stated(model, lambda: rooted.tour_of(model, tour)[1:])


def _solve(run: Run, stated: Stated) -> StopReason:
    from optplan_models import highs

    try:
        compiled = highs.compile_model(stated.model)
    except highs.InfeasibleError:
        run.prove(math.inf)
        return StopReason.FINISHED
    start = highs.start_values(compiled) if len(run.nodes) else None
    stopped: list[StopReason] = []

    def take(values: FloatArray) -> None:
        highs.load_values(compiled, values)
        run.offer(stated.path())

    def ended() -> bool:
        # HiGHS keeps the time itself and says its last word; iterations are not counted
        stop = run.stop()
        if stop in (StopReason.CANCELLED, StopReason.TARGET):
            stopped.append(stop)
        return bool(stopped)

    if (stop := run.stop()) and stop is not StopReason.ITERATIONS:
        return stop
    try:
        result = highs.run(
            compiled,
            seconds=run.clock.remaining if math.isfinite(run.rule.seconds) else math.inf,
            start=start,
            seed=run.seed,
            cancelled=ended,
            incumbent=take,
            bound=run.prove,
        )
    except highs.HighsError as error:
        run.message = f"HiGHS failed: {error}"
        return StopReason.FAILED
    if result.values is not None:
        take(result.values)
    if result.status == "Infeasible" and len(run.nodes):
        # a known solution contradicts the proof
        run.message = "HiGHS calls a problem infeasible that has a solution; its bound is not used"
        return StopReason.FAILED
    run.prove(result.bound)
    if stopped:
        return stopped[0]
    if result.status in ("Optimal", "Infeasible"):
        return StopReason.FINISHED
    if result.status in ("TimeLimit", "Killed"):
        return StopReason.TIME
    run.message = f"HiGHS ended with status {result.status}"
    return StopReason.FAILED


def _fewer(given: int | None, most: int) -> int:
    return most if given is None else min(given, most)
