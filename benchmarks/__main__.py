"""`python -m benchmarks`: measure, compare with the targets, print a table."""

from __future__ import annotations

import os
import statistics
import subprocess
import sys
import tempfile
from collections.abc import Sequence
from pathlib import Path
from typing import NamedTuple

from benchmarks.drawings import random_drawing
from optplan.instances import instance

_OPTPLAN = [sys.executable, "-m", "optplan"]


class Run(NamedTuple):
    """What a command used: processor time and peak memory."""

    seconds: float
    megabytes: float


def run(command: Sequence[str], **environment: str) -> Run:
    """Run a command to its end; CalledProcessError when it fails."""
    # a child of a child: its peak memory is then that of the command alone
    code = (
        "import resource, subprocess, sys;"
        "subprocess.run(sys.argv[1:], check=True, stdout=subprocess.DEVNULL);"
        "use = resource.getrusage(resource.RUSAGE_CHILDREN);"
        "print(use.ru_utime + use.ru_stime, use.ru_maxrss / 1024)"
    )
    done = subprocess.run(
        [sys.executable, "-c", code, *command],
        check=True,
        capture_output=True,
        text=True,
        env={**os.environ, **environment},
    )
    seconds, megabytes = done.stdout.split()
    return Run(float(seconds), float(megabytes))


def plan(file: Path, *extra: str, **environment: str) -> Run:
    """`optplan plan` with default settings into a folder that is thrown away."""
    with tempfile.TemporaryDirectory() as folder:
        return run([*_OPTPLAN, "plan", str(file), "-o", f"{folder}/plan", "-q", *extra], **environment)


def main() -> int:
    """Print the table; 0 when every target is met."""
    rows: list[tuple[str, float, float, str]] = []

    def record(what: str, value: float, target: float, unit: str) -> None:
        rows.append((what, value, target, unit))
        verdict = "met" if value <= target else "NOT MET"
        print(f"{what:<52}{value:>9.2f} {unit:<3}{target:>9.2f} {unit:<3}  {verdict}", flush=True)

    print(f"{'figure':<52}{'measured':>9}    {'target':>9}      (CPU seconds; peak memory)")
    helps = [run([*_OPTPLAN, "--help"]).seconds for _ in range(5)]
    record("optplan --help", statistics.median(helps), 0.5, "s")
    lion = instance("drawings/lion")
    with tempfile.TemporaryDirectory() as folder:
        large = Path(folder) / "large.svg"
        large.write_text(random_drawing(1000))
        cache = f"{folder}/cache"
        record("plan a dozen strokes, first run on a new machine", plan(lion, NUMBA_CACHE_DIR=cache).seconds, 30, "s")
        again = [plan(lion, NUMBA_CACHE_DIR=cache).seconds for _ in range(3)]
        record("plan a dozen strokes, second run", statistics.median(again), 5, "s")
        # 30 s for the plan, and the 30 s that compiling may take once
        record("plan 1000 strokes, compiling included", plan(large, NUMBA_CACHE_DIR=cache).seconds, 60, "s")
        used = plan(large, NUMBA_CACHE_DIR=cache)
    record("plan 1000 strokes", used.seconds, 30, "s")
    record("plan 1000 strokes, peak memory", used.megabytes, 1000, "MB")
    return 0 if all(value <= target for _, value, target, _ in rows) else 1


if __name__ == "__main__":
    sys.exit(main())
