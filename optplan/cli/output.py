"""What commands print: tables for people, JSON for machines, progress on stderr."""

from __future__ import annotations

import json
import math
import signal
import sys
from collections.abc import Iterator, Sequence
from contextlib import contextmanager
from typing import TYPE_CHECKING, Any

from optplan.domain.progress import Progress, ProgressCallback, silent
from optplan.domain.units import shown

if TYPE_CHECKING:
    from rich.console import Console

    from optplan.domain.job import Note
    from optplan.domain.ordering import Ordering
    from optplan.domain.report import Report
    from optplan.domain.result import Plan

_TITLES = {
    "cover": "covering",
    "order": "ordering",
    "connect": "connecting",
    "time": "timing",
    "verify": "verifying",
    "drive": "driving",
    "animate": "drawing",
}


def console(*, err: bool = False) -> Console:
    """A console on stdout or stderr that leaves the text alone: no markup, no emoji, no highlighting."""
    from rich.console import Console

    return Console(stderr=err, markup=False, emoji=False, highlight=False, soft_wrap=False)


def print_json(value: Any) -> None:
    """One JSON object on stdout."""
    print(json.dumps(value, indent=2, ensure_ascii=False, allow_nan=False, default=str))


def finite(value: float | None) -> float | None:
    """The value, or None where JSON has no number for it."""
    return value if value is not None and math.isfinite(value) else None


@contextmanager
def progress_bar(quiet: bool, unit: str = " m") -> Iterator[ProgressCallback]:
    """A callback that draws a bar on a terminal, and does nothing elsewhere; costs are in `unit`."""
    if quiet or not sys.stderr.isatty():
        yield silent
        return
    from rich.progress import BarColumn, SpinnerColumn, TextColumn, TimeElapsedColumn
    from rich.progress import Progress as Bars

    columns = (
        SpinnerColumn(),
        TextColumn("{task.description:<10}", markup=False),
        BarColumn(bar_width=28),
        TimeElapsedColumn(),
        TextColumn("{task.fields[news]}", markup=False),
    )
    with Bars(*columns, console=console(err=True), transient=True) as bars:
        tasks: dict[str, Any] = {}

        def tell(event: Progress) -> None:
            if event.stage not in tasks:
                title = _TITLES.get(event.stage, event.stage)
                tasks[event.stage] = bars.add_task(title, total=None, news="")
            changed: dict[str, Any] = {}
            if event.fraction is not None:
                changed.update(total=1.0, completed=event.fraction)
            news = _news(event, unit)
            if news:
                changed["news"] = news
            bars.update(tasks[event.stage], **changed)

        yield tell


def _news(event: Progress, unit: str) -> str:
    parts = []
    if math.isfinite(event.cost):
        parts.append(f"best {event.cost:.2f}{unit}")
    if math.isfinite(event.bound):
        parts.append(f"bound {event.bound:.2f}{unit}")
    if event.message:
        parts.append(event.message[:40])
    return "  ".join(parts)


@contextmanager
def cancellable() -> Iterator[list[bool]]:
    """Turns the first Ctrl-C into a wish to stop with the best found so far; the second one ends the program."""
    wished: list[bool] = []

    def wish(*_: object) -> None:
        wished.append(True)
        print("stopping with the best found so far; Ctrl-C again ends at once", file=sys.stderr)
        signal.signal(signal.SIGINT, signal.default_int_handler)

    try:
        before = signal.signal(signal.SIGINT, wish)
    except ValueError:  # not the main thread
        yield wished
        return
    try:
        yield wished
    finally:
        signal.signal(signal.SIGINT, before)


def print_table(
    columns: Sequence[str], rows: Sequence[Sequence[str]], right: Sequence[int] = (), *, wrap: bool = True
) -> None:
    """A plain table; columns whose index is in `right` are right-aligned. Without `wrap` it may exceed the terminal."""
    from rich import box
    from rich.table import Table
    from rich.text import Text

    table = Table(box=box.SIMPLE_HEAD if any(columns) else None, pad_edge=False, show_header=any(columns))
    for k, name in enumerate(columns):
        table.add_column(name, justify="right" if k in right else "left", overflow="fold", no_wrap=not wrap)
    for row in rows:
        table.add_row(*(Text(cell) for cell in row))
    target = console()
    if not wrap:
        target.width = max(target.width, 200)
    target.print(table)


def print_notes(plan: Plan) -> None:
    """The load report."""
    print_job_notes(plan.job.name, [*plan.job.notes, *(plan.cover.notes if plan.cover is not None else ())])


def print_job_notes(name: str, notes: Sequence[Note]) -> None:
    """What a job's reader, or more, has to say."""
    if notes:
        print(f"{name}: what was ignored, changed or is worth knowing")
        print_table(("", "", ""), _note_rows(notes))


def print_order(ordering: Ordering) -> None:
    """The solver's answer in one or two lines."""
    gap = "no bound" if math.isinf(ordering.gap) else f"gap {100 * ordering.gap:.2f} %"
    bound = f", bound {ordering.bound:.3f} {ordering.unit}" if math.isfinite(ordering.bound) else ""
    cost = f"{ordering.cost:.3f} {ordering.unit} between strokes" if math.isfinite(ordering.cost) else "nothing found"
    print(f"order: {ordering.status.value} by {ordering.solver}: {cost}{bound}, {gap}; {ordering.stopped.value}")
    if ordering.message:
        print(f"       {ordering.message}")


def print_stage(plan: Plan, stage: str) -> None:
    """What a stage has made, and the report when it got that far."""
    from optplan.domain.path import RAISED

    if stage == "cover" and plan.cover is not None:
        print_notes(plan)
        areas = f", {len(plan.cover.areas)} areas" if plan.cover.areas else ""
        print(f"cover: {len(plan.cover.strokes)} strokes{areas}")
    if plan.ordering is not None and stage in ("cover", "order"):
        print_order(plan.ordering)
    if plan.path is not None and plan.report is None:
        down = float(plan.path.length[plan.path.tool != RAISED].sum())
        up = float(plan.path.length[(plan.path.tool == RAISED) & (plan.path.stroke < 0)].sum())
        print(f"path: {len(plan.path)} pieces, {down:.3f} m tool down, {up:.3f} m tool up between strokes")
    if plan.trajectory is not None and plan.report is None:
        print(f"time: {plan.trajectory.duration:.1f} s")
    if plan.report is not None:
        print_report(plan.report)


NAMESPACE = "elements and attributes of the namespace "


def _note_rows(notes: Sequence[Note]) -> list[tuple[str, str, str]]:
    """Notes that say the same become one row, and so do foreign namespaces."""
    grouped: dict[tuple[str, str], list[Note]] = {}
    foreign = []
    for note in notes:
        if note.text.startswith(NAMESPACE):
            foreign.append(f"{note.text.removeprefix(NAMESPACE).rstrip('#/').rpartition('/')[2]} (x {note.times})")
        else:
            grouped.setdefault((note.kind, note.text), []).append(note)
    rows = []
    for (kind, text), same in grouped.items():
        times = sum(note.times for note in same)
        places = [note.place for note in same if note.place]
        where = ", ".join(places[:3]) + (f" and {len(places) - 3} more" if len(places) > 3 else "")
        rows.append((kind, f"{text} (x {times})" if times > 1 else text, where))
    if foreign:
        rows.append(("ignored", f"foreign namespaces: {', '.join(foreign)}", ""))
    return rows


_MARKS = {"passed": "ok", "failed": "FAILED", "noted": "-"}


def print_report(report: Report, lengths: str = "m") -> None:
    """The judge's findings: checks with value and limit, reasons where something failed, and figures; with lengths in
    m, ft or yd (what reasons say stays in metres)."""
    rows = []
    for check in report.checks:
        value, unit = shown(check.value, check.unit, lengths)
        limit = "" if check.limit is None else f"{shown(check.limit, check.unit, lengths)[0]:.4g}"
        failed = check.verdict.value == "failed"
        place = f" at ({check.place[0]:.2f}, {check.place[1]:.2f})" if failed and check.place is not None else ""
        detail = "" if check.verdict.value == "passed" else check.detail + place
        rows.append((_MARKS[check.verdict.value], check.name, f"{value:.4g}", limit, unit, detail))
    print_table(("", "check", "value", "limit", "unit", ""), rows, right=(2, 3))
    told = [(name, *shown(value, unit, lengths)) for name, value, unit in report.figures]
    figures = [(name, f"{value:.3f}".rstrip("0").rstrip("."), unit) for name, value, unit in told]
    half = (len(figures) + 1) // 2
    left, right = figures[:half], [*figures[half:], ("", "", "")][:half]
    print_table(
        ("figure", "value", "unit", "  ", "figure", "value", "unit"),
        [(*a, "", *b) for a, b in zip(left, right, strict=True)],
        right=(1, 5),
    )


def plan_facts(plan: Plan) -> dict[str, Any]:
    """A plan's findings for machines."""
    notes = [*plan.job.notes, *(plan.cover.notes if plan.cover is not None else ())]
    facts: dict[str, Any] = {
        "job": plan.job.name,
        "robot": plan.robot.name,
        "notes": [{"kind": n.kind, "place": n.place, "text": n.text, "times": n.times} for n in notes],
    }
    if plan.cover is not None:
        facts["strokes"] = len(plan.cover.strokes)
    ordering = plan.ordering
    if ordering is not None:
        facts["ordering"] = {
            "solver": ordering.solver,
            "status": ordering.status.value,
            "stopped": ordering.stopped.value,
            "cost": finite(ordering.cost),
            "bound": finite(ordering.bound),
            "gap": finite(ordering.gap),
            "seconds": ordering.seconds,
            "message": ordering.message,
        }
    if plan.report is not None:
        facts |= report_facts(plan.report)
    return facts


def report_facts(report: Report) -> dict[str, Any]:
    """The judge's findings for machines."""
    return {
        "ok": report.ok,
        "checks": [
            {
                "name": check.name,
                "verdict": check.verdict.value,
                "value": finite(check.value),
                "limit": finite(check.limit),
                "unit": check.unit,
                "place": check.place,
                "detail": check.detail,
            }
            for check in report.checks
        ],
        "figures": {name: {"value": finite(value), "unit": unit} for name, value, unit in report.figures},
    }
