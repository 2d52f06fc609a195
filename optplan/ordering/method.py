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
from optplan.ordering.opened import Opened, opened, rotated
from optplan.ordering.reduce import reduced

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
        better = self._takes(nodes)
        if better:
            self._note()
        return better

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
        self.remember(part)
        better, higher = self._takes(part.nodes), part.bound > self.bound
        self.bound = max(self.bound, part.bound)
        # noted once: with one of them still old, the trace would go back behind the part's history
        if better or higher:
            self._note()

    def remember(self, part: Run, extra: float = 0.0, *, bounds: bool = True) -> None:
        """Keep the history of a part, whose costs are `extra` less than those of this run."""
        later = part.clock.started - self.clock.started
        cost, bound = self.cost, self.bound
        for point in part.trace:
            cost = min(cost, point.cost + extra)
            bound = max(bound, point.bound + extra) if bounds else bound
            self.trace.append(TracePoint(later + point.seconds, cost, min(bound, cost)))

    def _takes(self, nodes: IntArray) -> bool:
        cost = self.problem.cost_of(nodes) if len(nodes) else math.inf
        if not cost < self.cost or self.problem.faults(nodes):
            return False
        self.nodes, self.cost = np.array(nodes, dtype=np.int64), cost
        return True

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
    search : works on a `Run` over a problem of two clusters or more without duplicate nodes and without enforced
        connections; says why it stopped
    refuse : why a problem is out of reach, or None
    closed : whether it takes closed paths; if not, it is given open ones instead, see `opened`
    proves, precedence, improves : see `Solver`
    """

    name: str
    summary: str
    search: Callable[[Run], StopReason]
    refuse: Callable[[OrderingProblem], str | None] = _welcome
    closed: bool = False
    proves: bool = False
    precedence: bool = True
    improves: bool = False

    def refusal(self, problem: OrderingProblem) -> str | None:
        """Why this problem is out of reach, or None when it is welcome."""
        return self._refusal(reduced(problem).problem)

    def _refusal(self, problem: OrderingProblem) -> str | None:
        paths = [problem] if self.closed or not problem.closed else [way.problem for way in opened(problem)]
        return next((why for path in paths if path.clusters > 1 and (why := self.refuse(path))), None)

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
        smaller = reduced(problem)
        run = Run(smaller.problem, clock, seed, progress=progress or silent)
        if start is not None and problem.clusters:
            run.start = smaller.shrink(np.asarray(start, dtype=np.int64))
            run.offer(run.start)
        if reason := self._refusal(run.problem):
            raise SolverError(f"{self.name} cannot take this problem: {reason}")
        stopped = self.work(run)
        nodes = smaller.expand(run.nodes) if len(run.nodes) else run.nodes
        return _answer(problem, run, nodes, stopped, self.name)

    def work(self, run: Run) -> StopReason:
        """Search, whatever the size, and closed paths as open ones where the search takes no others."""
        if run.problem.clusters <= 1:
            return _trivial(run)
        return self._search_opened(run) if run.problem.closed and not self.closed else self.search(run)

    def _search_opened(self, run: Run) -> StopReason:
        """Search the open paths one after the other; the tour's bound is the least of theirs."""
        ways = opened(run.problem)
        known = rotated(run.problem, run.nodes, ways)
        least, stopped = math.inf, StopReason.FINISHED
        for number, way in enumerate(ways):
            share = 1.0 / (len(ways) - number)
            part = _part(run, way, share)
            if len(known) and known[0] == way.root:
                part.start = way.shrink(known)
                part.offer(part.start)
            stop = _trivial(part) if way.problem.clusters <= 1 else self.search(part)
            run.iterations += part.iterations
            run.message = part.message or run.message
            # the bound of one path says nothing about the tour unless it is the only one
            run.remember(part, way.extra, bounds=len(ways) == 1)
            if len(part.nodes):
                run.offer(way.expand(part.nodes))
            least = min(least, part.bound + way.extra)
            if stop in (StopReason.CANCELLED, StopReason.TARGET, StopReason.FAILED):
                return stop
            stopped = stop if stop is not StopReason.FINISHED else stopped
        run.prove(least)
        return stopped


def _part(run: Run, way: Opened, share: float) -> Run:
    """A run of one of several open paths, with its share of what is left of the limits."""
    rule = run.rule
    left = None if rule.iterations is None else math.ceil(share * max(0, rule.iterations - run.iterations))
    seconds = max(1e-3, share * run.clock.remaining)
    limits = replace(rule, seconds=seconds, iterations=left, target=rule.target - way.extra)

    def tell(seen: Progress) -> None:
        run.progress(replace(seen, cost=min(run.cost, seen.cost + way.extra), bound=-math.inf))

    return Run(way.problem, limits.start(), run.seed, progress=tell)


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
    message = run.message
    if not message and math.isinf(cost) and bound < math.inf:
        message = "nothing was found before it stopped"
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
        message,
        tuple(run.trace),
    )
    if math.isinf(cost):
        status = Status.INFEASIBLE if bound == math.inf else Status.UNKNOWN
    else:
        status = Status.OPTIMAL if answer.gap <= OPTIMAL_GAP else Status.FEASIBLE
    return replace(answer, status=status)
