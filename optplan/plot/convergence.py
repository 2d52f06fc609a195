"""Incumbent and bound over the time of a run."""

from __future__ import annotations

import math
from collections.abc import Sequence
from typing import TYPE_CHECKING

from optplan.domain.errors import InputError
from optplan.domain.ordering import Ordering

if TYPE_CHECKING:
    from matplotlib.axes import Axes
    from matplotlib.figure import Figure

_COLOURS = ("#1f6f8b", "#d1495b", "#8a6a3f", "#4c956c", "#6a4c93", "#3b2f1e")
FIRST = 1e-3
"""s; the time axis is logarithmic and begins here at the earliest."""


def convergence_figure(runs: Sequence[Ordering], title: str = "") -> Figure:
    """A figure of one or several answers to the same problem: what was found and what was proved, when.

    Solid lines are incumbents, dashed ones lower bounds; the area between them is what is not known.

    Parameters
    ----------
    runs : answers with a trace
    title : of the figure

    Raises
    ------
    InputError : no answer has a trace with a solution or a bound
    """
    from matplotlib.figure import Figure

    shown = [run for run in runs if any(math.isfinite(p.cost) or math.isfinite(p.bound) for p in run.trace)]
    if not shown:
        raise InputError("there is nothing to draw: no answer has a trace with a solution or a bound")
    made = Figure(figsize=(7.5, 4.4), facecolor="white", layout="constrained")
    axes = made.add_subplot()
    for run, colour in zip(shown, _repeated(_COLOURS, len(shown)), strict=True):
        _curves(axes, run, colour)
    axes.set_xscale("log")
    axes.set(xlabel="s", ylabel="cost", title=title)
    axes.grid(visible=True, which="both", alpha=0.2)
    axes.legend(frameon=False, fontsize=8)
    low, high = _window(shown)
    axes.set_ylim(low, high)
    return made


def _curves(axes: Axes, run: Ordering, colour: str) -> None:
    end = max(run.seconds, FIRST)
    times = [max(p.seconds, FIRST) for p in run.trace] + [end]
    costs = [p.cost for p in run.trace] + [run.cost]
    bounds = [p.bound for p in run.trace] + [run.bound]
    known = [(t, c) for t, c in zip(times, costs, strict=True) if math.isfinite(c)]
    proved = [(t, b) for t, b in zip(times, bounds, strict=True) if math.isfinite(b)]
    gap = "" if math.isinf(run.gap) else f", gap {100 * run.gap:.2f} %"
    if known:
        axes.step(*zip(*known, strict=True), where="post", color=colour, label=f"{run.solver}: {run.cost:.4g}{gap}")
    if proved:
        label = "" if known else f"{run.solver}: bound {run.bound:.4g}"
        axes.step(*zip(*proved, strict=True), where="post", color=colour, linestyle="--", label=label or None)
    both = [k for k in range(len(times)) if math.isfinite(costs[k]) and math.isfinite(bounds[k])]
    if both:
        between = [[values[k] for k in both] for values in (times, costs, bounds)]
        axes.fill_between(between[0], between[1], between[2], step="post", color=colour, alpha=0.08)


def _window(runs: Sequence[Ordering]) -> tuple[float, float]:
    """Costs worth seeing: from a little below the best bound to the first costs that are not absurd."""
    ends = [value for run in runs for value in (run.cost, run.bound) if math.isfinite(value)]
    seen = [p.cost for run in runs for p in run.trace if math.isfinite(p.cost)] or ends
    best = max(ends)
    low, high = min(ends), max(min(max(seen), best + 0.6 * abs(best)), best)
    room = 0.06 * max(high - low, 1e-9 * max(abs(high), 1.0), 0.02 * abs(high))
    return low - room, high + room


def _repeated(colours: Sequence[str], count: int) -> list[str]:
    return [colours[k % len(colours)] for k in range(count)]
