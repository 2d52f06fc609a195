"""`beam`: the dynamic programme over order ideals with a limited width, which grows until it proves."""

from __future__ import annotations

import math
from dataclasses import dataclass, field

import numpy as np

from optplan.domain.arrays import IntArray
from optplan.domain.ordering import OrderingProblem
from optplan.domain.stop import StopReason
from optplan.ordering.cutoff import Cutoff, cutoff
from optplan.ordering.ideals_bound import Relaxation, refuse_large_tables
from optplan.ordering.ideals_layers import Sweep, most_states, sweep
from optplan.ordering.ideals_network import closure
from optplan.ordering.local import nearest_neighbour
from optplan.ordering.method import Run
from optplan.ordering.search import search

DENSE = 0.1
"""Share of the pairs of clusters that precedence has to order for narrow sweeps to end in good paths."""
FIRST_WIDTH = 32
SCOUT_WIDTH = 128
"""Widest sweep that looks for nothing but a path to begin with."""
GROWTH = 4
BOTH_WIDTH = 256
"""From this width on only the direction with the better bound is followed."""
MOST_STATES = 30_000_000
"""States after which the search ends when nothing else ends it: some 30 to 60 s."""
ROUNDS = (20, 100)
"""Fewest and most steps of the ascent between two widths."""
STATE_WORK = 100
"""A state takes as long as this many arcs in the ascent."""
POLISH_EACH = 8
"""Iterations a cluster of the search from each better path."""


@dataclass
class Hunt:
    """A run, the relaxation that guides it, and what it is after."""

    run: Run
    relaxation: Relaxation
    goal: Cutoff
    direction: int = 0
    floor: float = -math.inf
    reached: IntArray = field(default_factory=lambda: np.zeros(0, dtype=np.int64))
    polished: float = math.inf

    def sweep(self, direction: int, width: int) -> Sweep:
        """Go through all layers once; `stopped` also when that leaves nothing to find."""
        run, relaxation = self.run, self.relaxation
        nothing = Sweep(np.zeros(0, dtype=np.int64), -math.inf, 0)
        guide = None if run.stop() else relaxation.guide(direction, run)
        if guide is None:
            return nothing._replace(stopped=run.stop() or StopReason.TIME)
        found = sweep(run, relaxation.sides[direction], guide, width, self.goal.of(run))
        if len(found.nodes):
            nodes = found.nodes[::-1] if direction else found.nodes
            run.offer(nodes)
            if not len(self.reached) or run.problem.cost_of(nodes) < run.problem.cost_of(self.reached):
                self.reached = nodes
        self.goal.conclude(run, found.floor, relaxation.rounding)
        return found._replace(stopped=StopReason.FINISHED) if self.goal.closed(run) else found

    def sharpen(self, states: int) -> None:
        """Improve the bound for about as long as that many states took."""
        run, relaxation = self.run, self.relaxation
        relaxation.ascend(run, int(np.clip(STATE_WORK * states / max(relaxation.work, 1), *ROUNDS)))
        self.goal.conclude(run, relaxation.bound, relaxation.rounding)
        relaxation.eliminate(run, self.goal.of(run))

    def polish(self) -> None:
        """Take the best path that sweeps reached to a local optimum: another one than where a given path leads."""
        run = self.run
        if len(self.reached) and (cost := run.problem.cost_of(self.reached)) < self.polished:
            part = run.within(math.inf, POLISH_EACH * run.problem.clusters)
            part.start = self.reached
            search(part)
            part.iterations = 0
            run.adopt(part)
            self.polished = cost


def beam_search(run: Run) -> StopReason:
    """Sweeps of growing width until the optimum is proved. One iteration is one width."""
    return widen(Hunt(run, Relaxation(run.problem), cutoff(run.problem)), most_states(run.problem))


def dense(problem: OrderingProblem) -> bool:
    """Whether precedence leaves so few orders that narrow sweeps are the way to a good path."""
    if problem.closed or not len(problem.precedence) or refuse_large_tables(problem):
        return False
    count = problem.clusters
    return 2.0 * float(closure(count, problem.precedence).sum()) >= DENSE * count * (count - 1)


def scout(run: Run, share: float) -> None:
    """A path from narrow sweeps, in at most a share of the time left: a better beginning than nearest neighbours."""
    part = run.within(share * run.clock.remaining if math.isfinite(run.rule.seconds) else math.inf)
    widen(Hunt(part, Relaxation(run.problem), cutoff(run.problem)), SCOUT_WIDTH)
    part.iterations = 0
    run.adopt(part)


def widen(hunt: Hunt, widest: int, width: int = FIRST_WIDTH) -> StopReason:
    """Sweeps of growing width up to the widest, the bound that guides them improved in between, until one proves.

    Without a time limit it also ends after `MOST_STATES`. Leaves the better direction in the hunt, and the floor there.
    """
    run, total = hunt.run, 0
    if len(run.nodes) == 0 and not run.stop():
        near = run.within(math.inf, 1)
        nearest_neighbour(near)
        near.iterations = 0
        run.adopt(near)
    directions = [0, 1] if width < BOTH_WIDTH else [hunt.direction]
    while width <= widest and (total <= MOST_STATES or math.isfinite(run.rule.seconds)):
        began = run.clock.elapsed
        found = []
        for direction in directions:
            found.append(hunt.sweep(direction, width))
            if stop := found[-1].stopped:
                return stop
        run.iterations += 1
        better = int(np.argmax([sweep.floor for sweep in found]))
        hunt.direction, hunt.floor = directions[better], found[better].floor
        if width >= BOTH_WIDTH:
            directions = [hunt.direction]
        states = sum(sweep.states for sweep in found)
        total += states
        hunt.polish()
        hunt.sharpen(states)
        if hunt.goal.closed(run):
            return StopReason.FINISHED
        width = _next_width(run, width, run.clock.elapsed - began)
    return run.stop() or StopReason.FINISHED


def _next_width(run: Run, width: int, seconds: float) -> int:
    """Four times as wide, or as wide as the time left allows: a sweep that does not end finds no path."""
    affordable = 0.8 * run.clock.remaining / max(seconds, 1e-3) * width
    return int(max(FIRST_WIDTH, min(GROWTH * width, affordable)))
