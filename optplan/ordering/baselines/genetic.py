"""`ga` and `ga-feasible`: a genetic algorithm over orders, without and with an eye on precedence."""

from __future__ import annotations

from dataclasses import dataclass, replace
from typing import TYPE_CHECKING

import numpy as np

from optplan.domain.arrays import IntArray
from optplan.domain.errors import InputError
from optplan.domain.ordering import OrderingProblem
from optplan.domain.stop import StopReason
from optplan.ordering.arrays import kernel_costs, kernel_structure
from optplan.ordering.baselines.honest import offer_as_published
from optplan.ordering.method import Run

if TYPE_CHECKING:
    from optplan.ordering._kernels.genetic import Population

SLICE = 500_000
"""Arc costs, or steps of a repair, between two looks at the stop rule."""


@dataclass(frozen=True)
class Genetic:
    """The parameters of the genetic algorithm.

    Parameters
    ----------
    population : individuals, >= 2
    generations : when no limit says otherwise
    elite : share of the best that live on unchanged, 0..1
    mutation : probability of a swap, and of another node, 0..1
    rivals : individuals in a tournament, >= 1
    """

    population: int = 100
    generations: int = 500
    elite: float = 0.1
    mutation: float = 0.3
    rivals: int = 3

    def __post_init__(self) -> None:
        if self.population < 2 or self.generations < 0 or self.rivals < 1:
            raise InputError("a genetic algorithm needs 2 individuals, 0 generations and 1 rival or more")
        if not (0 <= self.elite <= 1 and 0 <= self.mutation <= 1):
            raise InputError("the elite share and the mutation probability of a genetic algorithm lie within 0..1")


def genetic(run: Run, settings: Genetic | None = None) -> StopReason:
    """Order crossover, swap mutation, tournaments, elitism. It knows nothing of precedence.

    Order crossover after Davis, "Applying adaptive algorithms to epistatic domains" (1985). An individual also carries
    a node for each cluster, which a child takes from the parent that gave it the cluster's place. One iteration is one
    generation; the same seed and number of generations give the same path.
    """
    return _evolve(run, settings or Genetic(), run.problem.precedence[:0])


def genetic_feasible(run: Run, settings: Genetic | None = None) -> StopReason:
    """The same, but every child is repaired to the order nearest to its own that precedence allows.

    Nearest in this sense: of all clusters whose predecessors are done, always the one that the child has foremost.
    """
    return _evolve(run, settings or Genetic(), run.problem.precedence)


def _evolve(run: Run, settings: Genetic, precedence: IntArray) -> StopReason:
    from optplan.ordering._kernels.genetic import breed

    problem = run.problem
    obeyed = replace(problem, precedence=np.concatenate([precedence, _fixed_ends(problem, precedence)]))
    costs, structure = kernel_costs(problem), kernel_structure(obeyed)
    parents, children = _first_generation(run, settings.population), _empty(settings.population, problem.clusters)
    random = np.array([run.seed % 2**64], dtype=np.uint64)
    buffer = np.zeros((3, problem.clusters), dtype=np.int64)
    work = problem.clusters * (problem.clusters if len(obeyed.precedence) else 10) * (30 if costs.kind == 2 else 1)
    chunk = max(1, SLICE // work)

    def fill(target: Population, source: Population, low: int, rivals: int) -> StopReason | None:
        for start in range(low, settings.population, chunk):
            if (stop := run.stop()) and stop is not StopReason.ITERATIONS:
                return stop
            end = min(start + chunk, settings.population)
            args = (rivals, settings.mutation, random, buffer, start, end)
            breed(costs, structure, problem.closed, source, target, *args)
        return None

    if stop := fill(parents, children, 0, 0):
        return stop
    best = _report(run, parents, np.inf)
    endless = run.rule.iterations is not None or np.isfinite(run.rule.seconds)
    elite = max(1, round(settings.elite * settings.population))
    while endless or run.iterations < settings.generations:
        if stop := run.stop():
            return stop
        kept = np.argsort(parents.value, kind="stable")[:elite]
        for old, new in zip(parents, children, strict=True):
            new[:elite] = old[kept]
        if stop := fill(children, parents, elite, settings.rivals):
            return stop
        parents, children = children, parents
        run.iterations += 1
        best = _report(run, parents, best)
    return run.stop() or StopReason.FINISHED


def _report(run: Run, population: Population, best: float) -> float:
    """Offer the best individual if it is better than `best`; the better of the two costs."""
    k = int(population.value.argmin())
    if not population.value[k] < best:
        return best
    offer_as_published(run, population.choice[k][population.order[k]])
    return float(population.value[k])


def _empty(size: int, clusters: int) -> Population:
    from optplan.ordering._kernels.genetic import Population

    shape = (size, clusters)
    return Population(np.zeros(shape, dtype=np.int64), np.zeros(shape, dtype=np.int64), np.zeros(size))


def _first_generation(run: Run, size: int) -> Population:
    """Random orders and nodes, and the given solution if there is one."""
    problem = run.problem
    rng = np.random.default_rng(run.seed)
    population = _empty(size, problem.clusters)
    first = problem.first_node
    for k in range(size):
        population.order[k] = rng.permutation(problem.clusters)
        population.choice[k] = rng.integers(first[:-1], first[1:])
    if run.start is not None:
        population.order[0] = problem.cluster[run.start]
        population.choice[0, population.order[0]] = run.start
    return population


def _fixed_ends(problem: OrderingProblem, precedence: IntArray) -> IntArray:
    """(k, 2) a single cluster that may be first before all others, a single one that may be last behind them.

    A depot of the published algorithm is not permuted either. None where the precedence obeyed forbids it.
    """
    everyone = np.arange(problem.clusters)
    pairs = [np.zeros((0, 2), dtype=np.int64)]
    for side, costs in enumerate((problem.start_costs, problem.end_costs)):
        possible = np.unique(problem.cluster[np.isfinite(costs)])
        if len(possible) == 1 and not (precedence[:, 1 - side] == possible[0]).any():
            others = everyone[everyone != possible[0]]
            fixed = np.full(len(others), possible[0])
            pairs.append(np.column_stack([others, fixed] if side else [fixed, others]))
    if len(pairs) == 3 and pairs[1][0, 0] == pairs[2][0, 1]:
        pairs.pop()  # the same cluster cannot be both
    return np.concatenate(pairs)
