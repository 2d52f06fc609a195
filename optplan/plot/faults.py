"""Where a plan breaks its limits, on its picture."""

from __future__ import annotations

import textwrap
from typing import TYPE_CHECKING, NamedTuple

import numpy as np

from optplan.domain.report import Check, Verdict
from optplan.domain.result import Plan

if TYPE_CHECKING:
    from matplotlib.axes import Axes

BROKEN, WORTH_SEEING = "#d00000", "#e07b00"
_NOTED = ("over finished work", "wheels over finished work")
"""What has no limit and is marked all the same, at its worst place, when there is any."""
_RING = 15.0
"""Diameter of a ring, points; places nearer than half of that share one."""
_LINE = 10.0
"""Height of a line of the legend, points."""
_LETTER = 3.9
"""Width of a letter in it, points."""


class Fault(NamedTuple):
    """A check that is marked, with its number on the picture."""

    number: int
    check: Check
    colour: str


def faults_of(plan: Plan) -> list[Fault]:
    """The broken checks of a plan, then driving over finished work; none of a plan that was not judged."""
    if plan.report is None:
        return []
    broken = [(check, BROKEN) for check in plan.report.checks if check.verdict is Verdict.FAILED]
    noted = [(check, WORTH_SEEING) for check in plan.report.checks if check.name in _NOTED and check.value > 0]
    return [Fault(number, *marked) for number, marked in enumerate(broken + noted, start=1)]


def legend_of(faults: list[Fault], width: float) -> list[str]:
    """What the numbers mean, in lines of at most so many points."""
    if not faults:
        return []
    # what belongs together stays on one line
    whole = [f"{fault.number} {_told(fault.check)}".replace(" ", "\xa0") for fault in faults]
    lines = textwrap.wrap("   ".join(whole), max(int(width / _LETTER), 20), break_long_words=False)
    return [line.replace("\xa0", " ") for line in lines]


def height_of(lines: list[str]) -> float:
    """Inches that a legend takes."""
    return len(lines) * _LINE / 72


def draw_faults(axes: Axes, faults: list[Fault], lines: list[str]) -> None:
    """Rings around the worst spots, with numbers, and what these mean below."""
    from matplotlib.patheffects import withStroke

    halo = [withStroke(linewidth=2.5, foreground="white")]
    for place, numbers, colour in _rings(axes, faults):
        axes.plot(*place, "o", ms=_RING, mfc="none", mec=colour, mew=1.8, zorder=9, clip_on=False, path_effects=halo)
        axes.annotate(
            ", ".join(map(str, numbers)),
            place,
            xytext=(8, -12),
            textcoords="offset points",
            fontsize=8,
            weight="bold",
            color=colour,
            zorder=10,
            path_effects=halo,
            annotation_clip=False,
        )
    if lines:
        axes.annotate(
            "\n".join(lines),
            (0, 0),
            xycoords="axes fraction",
            xytext=(0, -30),
            textcoords="offset points",
            fontsize=7,
            color=faults[0].colour,
            va="top",
        )


def _rings(axes: Axes, faults: list[Fault]) -> list[tuple[tuple[float, float], list[int], str]]:
    """Places with the numbers and the colour of what is there; rings that would hide each other become one."""
    rings: list[tuple[tuple[float, float], list[int], str]] = []
    size = _RING / 2 * axes.figure.dpi / 72  # pixels
    for number, check, colour in faults:
        if check.place is None:
            continue
        spot = axes.transData.transform(check.place)
        for place, numbers, _ in rings:
            if np.linalg.norm(axes.transData.transform(place) - spot) < size:
                numbers.append(number)
                break
        else:
            rings.append((check.place, [number], colour))
    return rings


def _told(check: Check) -> str:
    if check.verdict is not Verdict.FAILED:
        return f"{check.name} {check.value:.3g} {check.unit}"
    where = "" if check.place is not None else " (no place)"
    limit = "" if check.limit is None else f" of {check.limit:.3g}"
    return f"{check.name} {check.value:.3g}{limit} {check.unit}".rstrip() + where
