"""Figures, how they are timed, and how they are printed."""

from __future__ import annotations

import statistics
import time
from collections.abc import Callable, Iterable
from typing import NamedTuple


class Row(NamedTuple):
    """A figure: what, measured, target, unit, and a remark."""

    what: str
    measured: float
    target: float
    unit: str
    remark: str = ""


def used(work: Callable[[], object], times: int = 5) -> float:
    """Processor seconds, the median of several runs."""
    seconds = []
    for _ in range(times):
        start = time.process_time()
        work()
        seconds.append(time.process_time() - start)
    return statistics.median(seconds)


def print_rows(rows: Iterable[Row]) -> bool:
    """Print each figure as it is measured; whether every target is met."""
    met = True
    for row in rows:
        good = row.measured <= row.target
        met = met and good
        verdict = "met" if good else "NOT MET"
        print(
            f"{row.what:<52}{row.measured:>11.4g} {row.unit:<3}{row.target:>9.3g}  {verdict}  {row.remark}", flush=True
        )
    return met
