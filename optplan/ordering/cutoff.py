"""What a path must cost less than to be worth looking for, and what follows when there is none."""

from __future__ import annotations

import math
from dataclasses import dataclass

import numpy as np

from optplan.domain.ordering import OrderingProblem
from optplan.ordering.arrays import dense_costs
from optplan.ordering.method import Run

TOLERANCE = 1e-7
"""A path must be better by this, relatively, to be looked for: many paths cost the same but for rounding."""
LARGEST_STEPS = 1e9
"""Costs beyond are not looked at for a step: their sums would not be exact."""


@dataclass(frozen=True)
class Cutoff:
    """When a bound is as good as a proof.

    step : all costs are multiples of this, so that a better path is better by a step; 0 when none is known
    """

    step: float

    def of(self, run: Run) -> float:
        """Paths that cost this or more are not looked for; infinite when no path is known."""
        if math.isinf(run.cost):
            return math.inf
        return run.cost - (self.step * (1.0 - 1e-6) if self.step else TOLERANCE * abs(run.cost))

    def conclude(self, run: Run, floor: float, rounding: float) -> None:
        """Prove what follows when no path below the cutoff costs less than the floor, up to rounding."""
        bound = min(floor, self.of(run))
        if math.isfinite(bound):
            bound -= rounding
            bound = self.step * math.ceil(bound / self.step - 1e-9) if self.step else bound
        run.prove(bound)

    def closed(self, run: Run) -> bool:
        """Whether nothing is left to find."""
        slack = 0.0 if self.step or math.isinf(run.cost) else 2.0 * TOLERANCE * abs(run.cost)
        return run.bound >= run.cost - slack


def cutoff(problem: OrderingProblem) -> Cutoff:
    """The cutoff of a problem: whole numbers have a step, their greatest common divisor."""
    numbers = [dense_costs(problem).ravel(), problem.start_costs, problem.end_costs, problem.node_costs]
    # arcs inside a cluster may be anything, which can only make the step smaller
    values = np.unique(np.abs(np.concatenate(numbers)))
    values = values[np.isfinite(values)]
    if len(values) == 0 or values[-1] > LARGEST_STEPS or not np.array_equal(values, np.rint(values)):
        return Cutoff(0.0)
    return Cutoff(float(np.gcd.reduce(values.astype(np.int64))))
