"""`mtz-lifted` and `mtz`: the Pyomo model with positions (MTZ), solved by HiGHS in a child process."""

from __future__ import annotations

import math

from optplan.domain.arrays import FloatArray
from optplan.domain.ordering import OrderingProblem
from optplan.domain.stop import StopReason, StopRule
from optplan.ordering.arrays import dense_costs
from optplan.ordering.bounds import lower_bound
from optplan.ordering.local import local_search
from optplan.ordering.method import Run

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
    stopped = local_search(warm)
    run.adopt(warm)
    if stopped in (StopReason.CANCELLED, StopReason.TARGET):
        return stopped
    # cheap, and there is something to show when the model does not get far
    run.prove(lower_bound(run.problem, StopRule(max(0.2 * run.clock.remaining, 0.1), cancelled=run.rule.cancelled)))
    return prove_by_highs(run)


def plain_mtz_by_highs(run: Run) -> StopReason:
    """The model as published, without a start or a bound from elsewhere. There are no iterations."""
    return prove_by_highs(run, lifted=False)


def prove_by_highs(run: Run, *, lifted: bool = True) -> StopReason:
    """Let HiGHS improve and prove what the run has found so far, by the lifted model or the published one."""
    from optplan_models import highs
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
    start = None
    if len(run.nodes):
        mtz.set_path(model, problem.cluster, run.nodes)
    compiled = highs.compile_model(model)
    if len(run.nodes):
        start = highs.start_values(compiled)
    stopped: list[StopReason] = []

    def take(values: FloatArray) -> None:
        highs.load_values(compiled, values)
        run.offer(mtz.path_of(model))

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
