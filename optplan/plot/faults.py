"""Where a plan breaks its limits, on its picture."""

from __future__ import annotations

from typing import TYPE_CHECKING

from optplan.domain.report import Check, Verdict
from optplan.domain.result import Plan

if TYPE_CHECKING:
    from matplotlib.axes import Axes

BROKEN, WORTH_SEEING = "#d00000", "#e07b00"
_NOTED = ("over finished work", "wheels over finished work")
"""What has no limit and is marked all the same, at its worst place, when there is any."""


def draw_faults(axes: Axes, plan: Plan) -> None:
    """Rings around the worst spot of every broken check, and of driving over finished work; their names below."""
    if plan.report is None:
        return
    broken = [check for check in plan.report.checks if check.verdict is Verdict.FAILED]
    noted = [check for check in plan.report.checks if check.name in _NOTED and check.value > 0]
    marked = [(check, BROKEN) for check in broken] + [(check, WORTH_SEEING) for check in noted]
    for number, (check, colour) in enumerate(marked, start=1):
        if check.place is None:
            continue
        axes.plot(*check.place, "o", ms=15, mfc="none", mec=colour, mew=1.8, zorder=9)
        axes.annotate(
            str(number),
            check.place,
            xytext=(8, -12),
            textcoords="offset points",
            fontsize=8,
            weight="bold",
            color=colour,
            zorder=9,
        )
    if broken:
        lines = [f"{number} {_told(check)}" for number, (check, _) in enumerate(marked, start=1)]
    else:
        lines = [f"{number} {check.name}" for number, check in enumerate(noted, start=1)]
    if lines:
        colour = BROKEN if broken else WORTH_SEEING
        axes.annotate(
            "   ".join(lines),
            (0, 0),
            xycoords="axes fraction",
            xytext=(0, -30),
            textcoords="offset points",
            fontsize=7,
            color=colour,
            va="top",
        )


def _told(check: Check) -> str:
    where = "" if check.place is not None else " (no place)"
    limit = "" if check.limit is None else f" of {check.limit:.3g}"
    return f"{check.name} {check.value:.3g}{limit} {check.unit}".rstrip() + where
