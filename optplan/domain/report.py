"""What the independent judge measured."""

from __future__ import annotations

from dataclasses import dataclass
from enum import StrEnum


class Verdict(StrEnum):
    """Outcome of one check."""

    PASSED = "passed"
    FAILED = "failed"
    NOTED = "noted"
    """Measured, with no limit to hold it against."""


@dataclass(frozen=True)
class Check:
    """One thing that was measured and, where there is a limit, held against it.

    Parameters
    ----------
    name : short and stable, e.g. "curvature"
    verdict : see `Verdict`
    value, limit : in `unit`; limit is None when there is none
    unit : "m", "1/m", "" for a count ...
    place : (x, y) of the worst spot, m, or None
    detail : a sentence for people
    """

    name: str
    verdict: Verdict
    value: float
    limit: float | None = None
    unit: str = ""
    place: tuple[float, float] | None = None
    detail: str = ""


@dataclass(frozen=True)
class Report:
    """The judge's findings about a plan.

    Parameters
    ----------
    checks : in a fixed order
    figures : (name, value, unit): lengths, times, areas, bound and gap
    """

    checks: tuple[Check, ...]
    figures: tuple[tuple[str, float, str], ...] = ()

    @property
    def ok(self) -> bool:
        """Whether no check failed."""
        return all(check.verdict is not Verdict.FAILED for check in self.checks)

    def figure(self, name: str) -> float:
        """Value of a figure; KeyError when it was not measured."""
        return {key: value for key, value, _ in self.figures}[name]
