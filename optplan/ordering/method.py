"""What all solvers share: the run, its incumbent and bound, and the honest answer made of them."""

from __future__ import annotations

import math
from collections.abc import Callable
from dataclasses import dataclass, field, replace

import numpy as np

from optplan.domain.arrays import FloatArray, IntArray
from optplan.domain.errors import InputError, SolverError
from optplan.domain.ordering import Ordering, OrderingProblem, Status, TracePoint
from optplan.domain.progress import Progress, ProgressCallback, silent
from optplan.domain.stop import RunningStop, StopReason, StopRule
from optplan.ordering.reduce import distinct_nodes

OPTIMAL_GAP = 1e-6
"""A smaller relative gap than this is rounding."""
REPORT_EVERY = 0.1
"""Seconds between two progress reports that bring nothing new."""


@dataclass
class Run:
    """A solver at work: its clock, and the best that it knows.

    Solvers hand in what they find through `offer` and what they prove through `prove`; both report progress.
    """

    problem: OrderingProblem
    clock: RunningStop
    seed: int = 0
    start: IntArray | None = None
    progress: ProgressCallback = silent
    nodes: IntArray = field(default_factory=lambda: np.zeros(0, dtype=np.int64))
    cost: float = math.inf
    bound: float = -math.inf
    iterations: int = 0
    message: str = ""
    trace: list[TracePoint] = field(default_factory=list)
    reported: float = -math.inf

    @property
    def rule(self) -> StopRule:
        """The limits."""
        return self.clock.rule

    def offer(self, nodes: IntArray) -> bool:
        """Take over a path if it is a solution better than the best so far; whether it was."""
        cost = self.problem.cost_of(nodes)
        if not cost < self.cost or self.problem.faults(nodes):
            return False
        self.nodes, self.cost = np.array(nodes, dtype=np.int64), cost
        self._note()
        return True

    def prove(self, bound: float) -> None:
        """No solution costs less than this (infinite: there is none)."""
        if bound > self.bound:
            self.bound = bound
            self._note()

    def stop(self) -> StopReason | None:
        """Why to stop now, or None to go on; also keeps the progress alive."""
        if self.clock.elapsed - self.reported > REPORT_EVERY:
            self._report()
        return self.clock.reason(self.iterations, self.cost)

    def within(self, seconds: float, iterations: int | None = None) -> Run:
        """The same run, best and all, for a part of the time."""
        seconds = max(1e-3, min(seconds, self.clock.remaining))
        part = Run(
            self.problem,
            replace(self.rule, seconds=seconds, iterations=iterations).start(),
            seed=self.seed,
            start=self.nodes if len(self.nodes) else self.start,
            progress=lambda p: self.progress(replace(p, bound=max(p.bound, min(self.bound, p.cost)))),
        )
        part.prove(self.bound)
        return part

    def adopt(self, part: Run) -> None:
        """Take over what a part of this run has found."""
        self.iterations += part.iterations
        if len(part.nodes):
            self.offer(part.nodes)
        self.prove(part.bound)

    def _note(self) -> None:
        self.trace.append(TracePoint(self.clock.elapsed, self.cost, min(self.bound, self.cost)))
        self._report()

    def _report(self) -> None:
        self.reported = self.clock.elapsed
        parts = [self.clock.elapsed / self.rule.seconds]
        if self.rule.iterations:
            parts.append(self.iterations / self.rule.iterations)
        fraction = min(1.0, max(parts)) if max(parts) > 0 else None
        self.progress(Progress("order", fraction, self.cost, min(self.bound, self.cost), self.message))


def _welcome(_: OrderingProblem) -> str | None:
    return None


@dataclass(frozen=True)
class Method:
    """A solver: a search and its refusals, wrapped into the `Solver` protocol.

    Parameters
    ----------
    name, summary : for people
    search : works on a `Run` over a problem of two clusters or more without duplicate nodes; says why it stopped
    refuse : why a problem is out of reach, or None
    """

    name: str
    summary: str
    search: Callable[[Run], StopReason]
    refuse: Callable[[OrderingProblem], str | None] = _welcome

    def refusal(self, problem: OrderingProblem) -> str | None:
        """Why this problem is out of reach, or None when it is welcome."""
        return None if problem.clusters <= 1 else self.refuse(distinct_nodes(problem)[0])

    def solve(
        self,
        problem: OrderingProblem,
        stop: StopRule,
        seed: int,
        start: IntArray | None = None,
        progress: ProgressCallback | None = None,
    ) -> Ordering:
        """Solve it, perhaps from a known solution `start` (m,) of nodes.

        Raises
        ------
        InputError : `start` is no solution
        SolverError : the problem is refused
        """
        if start is not None and (faults := problem.faults(start)):
            raise InputError(f"the start is no solution: {faults[0]}")
        clock = stop.start()
        small, original, same = distinct_nodes(problem)
        run = Run(small, clock, seed, progress=progress or silent)
        if start is not None and problem.clusters:
            run.start = same[np.asarray(start, dtype=np.int64)]
            run.offer(run.start)
        if small.clusters <= 1:
            stopped = _trivial(run)
        elif reason := self.refuse(small):
            raise SolverError(f"{self.name} cannot take this problem: {reason}")
        else:
            stopped = self.search(run)
        return _answer(problem, run, original[run.nodes], stopped, self.name)


def _trivial(run: Run) -> StopReason:
    """No cluster, or one."""
    problem = run.problem
    if problem.clusters == 0:
        run.cost = run.bound = 0.0
        return StopReason.FINISHED
    costs: FloatArray = problem.start_costs + problem.end_costs + problem.node_costs
    run.offer(np.array([costs.argmin()]))
    run.prove(float(costs.min()))
    return StopReason.FINISHED


def _answer(problem: OrderingProblem, run: Run, nodes: IntArray, stopped: StopReason, solver: str) -> Ordering:
    cost = problem.cost_of(nodes) if len(nodes) or problem.clusters == 0 else math.inf
    bound = min(run.bound, cost)
    answer = Ordering(
        nodes,
        cost,
        bound,
        Status.FEASIBLE,
        stopped,
        solver,
        run.seed,
        run.clock.elapsed,
        run.iterations,
        run.message,
        tuple(run.trace),
    )
    if math.isinf(cost):
        status = Status.INFEASIBLE if bound == math.inf else Status.UNKNOWN
    else:
        status = Status.OPTIMAL if answer.gap <= OPTIMAL_GAP else Status.FEASIBLE
    return replace(answer, status=status)
