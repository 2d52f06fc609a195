"""When a long computation ends: time, iterations, target, cancel."""

from __future__ import annotations

import math
import time
from collections.abc import Callable
from dataclasses import dataclass, field
from enum import StrEnum

from optplan.domain.errors import InputError


class StopReason(StrEnum):
    """Why a solver stopped; what is known about its solution is kept apart (`Status`)."""

    FINISHED = "finished"
    """It had nothing left to do: proved, or its search was exhausted."""
    TIME = "time limit"
    ITERATIONS = "iteration limit"
    TARGET = "target reached"
    CANCELLED = "cancelled"
    FAILED = "failed"


@dataclass(frozen=True)
class StopRule:
    """When to stop. Every field may be left out; with none of them a solver runs until it is finished.

    Parameters
    ----------
    seconds : wall time, s, > 0
    iterations : the solver's own unit of work, >= 0; with a seed it makes a run repeatable
    target : stop as soon as the cost is at or below this
    cancelled : asked often (at most 0.1 s of work apart); True ends the run with the best found so far

    Raises
    ------
    InputError : a limit that is negative or not a number
    """

    seconds: float = math.inf
    iterations: int | None = None
    target: float = -math.inf
    cancelled: Callable[[], bool] | None = None

    def __post_init__(self) -> None:
        if not self.seconds > 0:
            raise InputError(f"the time limit is {self.seconds} s; expected more than 0")
        if self.iterations is not None and not 0 <= self.iterations < 2**62:
            raise InputError(f"the iteration limit is {self.iterations}; expected 0..2^62 - 1")
        if math.isnan(self.target):
            raise InputError("the target cost is NaN; expected a number")

    def start(self) -> RunningStop:
        """Start the clock."""
        return RunningStop(self)


@dataclass
class RunningStop:
    """A stop rule with its clock running."""

    rule: StopRule
    started: float = field(default_factory=time.perf_counter)

    @property
    def elapsed(self) -> float:
        """Seconds since the start."""
        return time.perf_counter() - self.started

    @property
    def remaining(self) -> float:
        """Seconds left, possibly infinite, never negative."""
        return max(0.0, self.rule.seconds - self.elapsed)

    def reason(self, iterations: int = 0, cost: float = math.inf) -> StopReason | None:
        """Why to stop now, or None to go on."""
        rule = self.rule
        if rule.cancelled is not None and rule.cancelled():
            return StopReason.CANCELLED
        if cost <= rule.target:
            return StopReason.TARGET
        if rule.iterations is not None and iterations >= rule.iterations:
            return StopReason.ITERATIONS
        if self.elapsed >= rule.seconds:
            return StopReason.TIME
        return None
