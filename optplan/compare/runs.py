"""The runs of a comparison, each checked independently."""

from __future__ import annotations

import math
import time
from collections.abc import Callable, Iterator, Sequence
from dataclasses import dataclass, replace
from itertools import pairwise

import numpy as np

from optplan.compare.cases import Case
from optplan.domain.errors import InputError
from optplan.domain.ordering import EuclidCosts, Ordering, OrderingProblem
from optplan.domain.progress import Progress, ProgressCallback, silent
from optplan.domain.stop import StopReason, StopRule
from optplan.ordering import SOLVERS


@dataclass(frozen=True)
class Result:
    """One run.

    Parameters
    ----------
    instance, clusters, nodes : what was solved
    solver, seed, budget : by whom, and the seconds it had (infinite: as long as it liked)
    cost, bound : found and proved; infinite and minus infinity when nothing was
    status, stopped, message : what is known, why it stopped, what people should know
    seconds, cpu : wall time and processor time (child processes included), s
    verified : the path is a solution and its cost is what the solver says, both checked here
    best : least cost known of the instance, this comparison included
    """

    instance: str
    clusters: int
    nodes: int
    solver: str
    seed: int
    budget: float
    cost: float
    bound: float
    status: str
    stopped: str
    message: str
    seconds: float
    cpu: float
    verified: bool
    best: float = math.inf

    @property
    def gap(self) -> float:
        """(cost - bound) / cost; infinite when one of them is missing."""
        if not (math.isfinite(self.cost) and math.isfinite(self.bound)):
            return math.inf
        return max(0.0, self.cost - self.bound) / max(abs(self.cost), 1e-9)

    @property
    def excess(self) -> float:
        """Cost over the best known, relative; infinite when nothing was found."""
        return (self.cost - self.best) / max(abs(self.best), 1e-9) if math.isfinite(self.cost) else math.inf


def compare_solvers(
    cases: Sequence[Case],
    solvers: Sequence[str],
    seeds: Sequence[int] = (0,),
    budgets: Sequence[float] = (10.0,),
    progress: ProgressCallback | None = None,
    cancelled: Callable[[], bool] | None = None,
) -> Iterator[Result]:
    """Run every solver on every instance, with every seed and budget; results come one by one.

    Solvers without a random choice run once an instance and budget: with the first seed. Before anything is timed each
    solver solves a tiny problem, so that neither imports nor compiling count.

    Parameters
    ----------
    cases : what to solve
    solvers : names in `optplan.ordering.SOLVERS`
    seeds : >= 0
    budgets : seconds, > 0
    progress, cancelled : as everywhere; a cancel ends the comparison behind the run at work

    Raises
    ------
    InputError : an unknown solver, a bad seed or budget; before anything runs
    """
    for name in solvers:
        if name not in SOLVERS:
            raise InputError(f"there is no solver {name!r}; expected one of {', '.join(SOLVERS)}")
    for seed in seeds:
        if not 0 <= seed < 2**31:
            raise InputError(f"the seed is {seed}; expected 0..2^31 - 1")
    rules = [(budget, StopRule(seconds=budget, cancelled=cancelled)) for budget in budgets]
    return _run_all(cases, solvers, seeds, rules, progress or silent, cancelled or (lambda: False))


def _run_all(
    cases: Sequence[Case],
    solvers: Sequence[str],
    seeds: Sequence[int],
    rules: Sequence[tuple[float, StopRule]],
    progress: ProgressCallback,
    cancelled: Callable[[], bool],
) -> Iterator[Result]:
    total = len(cases) * len(solvers) * len(seeds) * len(rules)
    warm: set[str] = set()
    done = 0
    for case in cases:
        for name in solvers:
            for budget, rule in rules:
                for seed in seeds:
                    if cancelled():
                        return
                    progress(Progress("compare", done / total, message=f"{case.name} {name}"))
                    if name not in warm:
                        warm.add(name)
                        _warm_up(name)
                    yield _run(case, name, seed, budget, rule)
                    done += 1
    progress(Progress("compare", 1.0))


def _run(case: Case, name: str, seed: int, budget: float, rule: StopRule) -> Result:
    solver, problem = SOLVERS[name], case.problem
    reason = solver.refusal(problem)
    if reason:
        return _result(case, name, seed, budget, None, reason, 0.0, True)
    before = _processor_time()
    answer = solver.solve(problem, rule, seed)
    used = _processor_time() - before
    return _result(case, name, seed, budget, answer, answer.message, used, verified(problem, answer))


def _result(
    case: Case, name: str, seed: int, budget: float, answer: Ordering | None, message: str, cpu: float, good: bool
) -> Result:
    return Result(
        case.name,
        case.problem.clusters,
        case.problem.nodes,
        name,
        seed,
        budget,
        math.inf if answer is None else answer.cost,
        -math.inf if answer is None else answer.bound,
        "refused" if answer is None else answer.status.value,
        "" if answer is None else answer.stopped.value,
        message,
        0.0 if answer is None else answer.seconds,
        cpu,
        good,
        case.best_known,
    )


def verified(problem: OrderingProblem, answer: Ordering) -> bool:
    """Whether an answer is what it says: every cluster once, every rule kept, the cost added up arc by arc."""
    order = answer.nodes.tolist()
    if not order:
        return problem.clusters == 0 or math.isinf(answer.cost)
    clusters = [int(problem.cluster[node]) for node in order]
    place = {cluster: k for k, cluster in enumerate(clusters)}
    if sorted(clusters) != list(range(problem.clusters)):
        return False
    if any(place[a] >= place[b] for a, b in problem.precedence.tolist()):
        return False
    steps = list(pairwise(order))
    tied: dict[int, bool] = {}
    for link, tail, head in problem.enforced.tolist():
        tied[link] = tied.get(link, False) or (tail, head) in steps
    if not all(tied.values()):
        return False
    if problem.closed and len(order) > 1:
        steps.append((order[-1], order[0]))
    cost = float(problem.start_costs[order[0]] + problem.end_costs[order[-1]])
    cost += math.fsum(problem.node_costs[order].tolist())
    for tail, head in steps:
        cost += float(problem.costs.pairs(np.array([tail]), np.array([head]))[0])
    good = abs(cost - answer.cost) <= 1e-9 * max(1.0, abs(cost)) and answer.bound <= answer.cost
    return good and answer.stopped is not StopReason.FAILED


def _warm_up(name: str) -> None:
    """Import and compile what a solver needs: for problems without a direction, with rules, and closed ones."""
    points = np.random.default_rng(0).uniform(size=(16, 2))
    free = OrderingProblem(np.arange(16), EuclidCosts(points, points))
    for part in ("search", "dp", "cuts", name) if name == "auto" else (name,):
        for tiny in (free, replace(free, precedence=np.array([[0, 1], [2, 3]])), replace(free, closed=True)):
            if SOLVERS[part].refusal(tiny) is None:
                SOLVERS[part].solve(tiny, StopRule(seconds=1.0, iterations=50), 0)


def _processor_time() -> float:
    """Processor seconds of this process and of its children that have ended."""
    try:
        import resource
    except ImportError:  # not on every system
        return time.process_time()
    own, children = (resource.getrusage(who) for who in (resource.RUSAGE_SELF, resource.RUSAGE_CHILDREN))
    return own.ru_utime + own.ru_stime + children.ru_utime + children.ru_stime
