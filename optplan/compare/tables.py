"""Results as CSV and as a table for people."""

from __future__ import annotations

import csv
import io
import math
import statistics
from collections.abc import Sequence
from dataclasses import fields, replace

from optplan.compare.runs import Result

COLUMNS = ("instance", "solver", "budget", "best cost", "over best", "bound", "gap", "CPU s", "status")
"""Of the summary."""


def with_best(results: Sequence[Result]) -> list[Result]:
    """The results, each knowing the least cost of its instance that was known before or found by any of them."""
    best: dict[str, float] = {}
    for result in results:
        best[result.instance] = min(best.get(result.instance, math.inf), result.best, result.cost)
    return [replace(result, best=best[result.instance]) for result in results]


def csv_text(results: Sequence[Result]) -> str:
    """All runs, one a row, with gap and excess over the best known; infinite numbers are left empty."""
    names = [*(field.name for field in fields(Result)), "gap", "excess"]
    stream = io.StringIO()
    writer = csv.writer(stream, lineterminator="\n")
    writer.writerow(names)
    for result in with_best(results):
        writer.writerow([_cell(getattr(result, name)) for name in names])
    return stream.getvalue()


def summary_rows(results: Sequence[Result]) -> list[tuple[str, ...]]:
    """One row an instance, solver and budget, over all seeds: best cost, mean excess, best bound, mean CPU time."""
    groups: dict[tuple[str, str, float], list[Result]] = {}
    for result in with_best(results):
        groups.setdefault((result.instance, result.solver, result.budget), []).append(result)
    return [_row(group) for group in groups.values()]


def _row(group: Sequence[Result]) -> tuple[str, ...]:
    first = group[0]
    cost, bound = min(r.cost for r in group), max(r.bound for r in group)
    found = [r.excess for r in group if math.isfinite(r.cost)]
    excess = f"{100 * statistics.mean(found):.2f} %" if found else ""
    gap = "" if not (math.isfinite(cost) and math.isfinite(bound)) else _percent(cost, bound)
    states = {r.status for r in group}
    status = states.pop() if len(states) == 1 else f"{sum(r.status == 'optimal' for r in group)}/{len(group)} optimal"
    if not all(r.verified for r in group):
        status = "NOT VERIFIED"
    return (
        first.instance,
        first.solver,
        f"{first.budget:g} s" if math.isfinite(first.budget) else "",
        f"{cost:.6g}" if math.isfinite(cost) else "",
        excess,
        f"{bound:.6g}" if math.isfinite(bound) else "",
        gap,
        f"{statistics.mean(r.cpu for r in group):.2f}",
        status,
    )


def _percent(cost: float, bound: float) -> str:
    return f"{100 * max(0.0, cost - bound) / max(abs(cost), 1e-9):.2f} %"


def _cell(value: object) -> object:
    if isinstance(value, float):
        return f"{value:.12g}" if math.isfinite(value) else ""
    return value
