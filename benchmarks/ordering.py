"""Figures of ordering: heuristics by gap to the best known, exact methods by time and certified gap.

The libraries are looked for in `../shared/data` beside the project; without them those rows are left out.
"""

from __future__ import annotations

import csv
import math
import statistics
import subprocess
import sys
from collections.abc import Callable, Iterator, Sequence
from pathlib import Path
from typing import NamedTuple

from benchmarks.drawings import drawing
from benchmarks.peers import PEERS, available, peer_cost
from benchmarks.table import Row
from optplan.compare import Case, load_case
from optplan.compare.runs import verified
from optplan.domain.ordering import OrderingProblem
from optplan.domain.stop import StopRule
from optplan.ordering import solve
from optplan.ordering.cutting.undirected import undirected_form

DATA = Path(__file__).parents[2] / "shared" / "data"


class Class(NamedTuple):
    """A class of instances and its targets: mean gap in % after 1 s and after 10 s."""

    name: str
    folder: str
    takes: Callable[[str, int], bool]
    after_1: float
    after_10: float


SPARSE = (".1", ".15")
CLASSES = (
    Class("ATSP: ftv, ft, kro124p, p43, br17", "atsp", lambda name, _: name != "rbg358", 0.0, 0.0),
    Class("ATSP: rbg358", "atsp", lambda name, _: name == "rbg358", 0.3, 0.0),
    Class("GTSP: up to 60 sets", "gtsp", lambda _, sets: sets <= 60, 0.0, 0.0),
    Class("GTSP: 61 to 220 sets", "gtsp", lambda _, sets: sets > 60, 0.5, 0.05),
    Class("SOP: TSPLIB", "sop", lambda name, _: not name.startswith("R."), 0.5, 1.0),
    Class(
        "SOP: SOPLIB at 1 and 15 %", "sop", lambda name, _: name.startswith("R.") and name.endswith((".1", ".15")), 3, 1
    ),
)


def library(folder: str) -> Iterator[Case]:
    """The instances of a folder whose best value is known."""
    table = DATA / "ordering" / "best_known.csv"
    if not table.is_file():
        return
    with table.open() as stream:
        names = [row["instance"] for row in csv.DictReader(stream) if row["class"] == folder]
    for name in names:
        yield load_case(next((DATA / "ordering" / folder).glob(f"{name}.*")))


def warm_up() -> None:
    """Compile what is measured later."""
    for name in ("search", "beam", "dp", "cuts"):
        solve(drawing(8, 0), name, StopRule(seconds=20, iterations=50))
    case = next(library("sop"), None)
    if case is not None:
        for name in ("search", "beam", "dp", "cuts"):
            solve(case.problem, name, StopRule(seconds=20, iterations=50))


def heuristics(seeds: Sequence[int], budgets: Sequence[float]) -> Iterator[Row]:
    """Gap of `search` to the best known, mean over instances and seeds; the worst instance is named."""
    for group in CLASSES:
        cases = [case for case in library(group.folder) if group.takes(case.name, case.problem.clusters)]
        for budget in budgets if cases else ():
            gaps = {case.name: statistics.mean(excess(case, budget, seed) for seed in seeds) for case in cases}
            worst = max(gaps, key=lambda name: gaps[name])
            target = group.after_1 if budget <= 1 else group.after_10
            remark = f"worst {worst} {gaps[worst]:.2f} %"
            yield Row(f"{group.name}, {budget:g} s", statistics.mean(gaps.values()), target, "%", remark)
    cases = list(library("pcgtsp"))
    for budget, share in zip(budgets, (0.75, 1.0), strict=False) if cases else ():
        gaps = {case.name: statistics.mean(excess(case, budget, seed) for seed in seeds) for case in cases}
        reached = sum(gap <= 1e-9 for gap in gaps.values()) / len(gaps)
        worst = max(gaps, key=lambda name: gaps[name])
        yield Row(
            f"PCGTSP: above the listed value, {budget:g} s",
            100 * (1 - reached),
            100 * (1 - share),
            "%",
            f"of all instances; worst {worst} {gaps[worst]:.2f} %",
        )


def excess(case: Case, budget: float, seed: int) -> float:
    """Gap of one run to the best known, %."""
    # what is as good as the best known cannot be much better: the rest of the time is saved
    answer = solve(case.problem, "search", StopRule(seconds=budget, target=case.best_known), seed)
    if not verified(case.problem, answer) or math.isinf(answer.cost):
        return math.inf
    return 100 * (answer.cost / case.best_known - 1)


def proofs() -> Iterator[Row]:
    """Processor seconds until the optimum is proved, or the certified gap at the end of the time."""
    for what, source, solver, target in (
        ("ftv70", "ordering/atsp/ftv70.atsp", "cuts", 2.0),
        ("kro124p", "ordering/atsp/kro124p.atsp", "cuts", 4.0),
        ("R.500.100.30", "ordering/sop/R.500.100.30.sop", "beam", 1.0),
        ("R.400.100.60", "ordering/sop/R.400.100.60.sop", "beam", 1.0),
        ("R.200.1000.30", "ordering/sop/R.200.1000.30.sop", "beam", 1.0),
    ):
        if (DATA / source).is_file():
            yield proved(f"{what} proved by {solver}", [load_case(DATA / source).problem], solver, target)
    for strokes, target in ((20, 1.0), (40, 20.0)):
        drawings = [drawing(strokes, seed) for seed in range(5)]
        yield proved(f"drawings of {strokes} strokes proved by cuts, the worst", drawings, "cuts", target)
    for strokes, seconds, gap, seeds in ((100, 60.0, 2.0, 5), (500, 120.0, 8.0, 5)):
        gaps = [solve(drawing(strokes, seed), "auto", StopRule(seconds=seconds)).gap for seed in range(seeds)]
        yield Row(f"drawings of {strokes} strokes, gap after {seconds:g} s, the worst", 100 * max(gaps), gap, "%")


def proved(what: str, problems: Sequence[OrderingProblem], solver: str, target: float) -> Row:
    """The longest proof; infinite when one was not finished within ten times the target."""
    start = 0.0
    if undirected_form(problems[0]) is not None:  # the one form that is proved in a process of its own
        start = statistics.median(_used(drawing(4, seed), solver, 60.0)[0] for seed in range(3))
    runs = [_used(problem, solver, 10 * target) for problem in problems]
    worst = max(seconds if good else math.inf for seconds, good in runs)
    return Row(what, max(worst - start, 0.0), target, "s", f"{start:.2f} s for processes to start taken off")


def _used(problem: OrderingProblem, solver: str, seconds: float) -> tuple[float, bool]:
    """Processor time of a run, and whether it was a proof."""
    began = processor_time()
    answer = solve(problem, solver, StopRule(seconds=seconds))
    return processor_time() - began, answer.status == "optimal"


def processor_time() -> float:
    """Of this process and its children that have ended, s."""
    import resource

    own, children = (resource.getrusage(who) for who in (resource.RUSAGE_SELF, resource.RUSAGE_CHILDREN))
    return own.ru_utime + own.ru_stime + children.ru_utime + children.ru_stime


def scale() -> Iterator[Row]:
    """5000 strokes: 30 s against a run of ten times the time, each in a process of its own for its memory."""
    (short, memory), (long, _) = (_large(seconds) for seconds in (30, 300))
    yield Row("5000 strokes, 30 s: above a run of 300 s", 100 * (short / long - 1), 3.0, "%")
    yield Row("5000 strokes, peak memory", memory, 1500, "MB")


def _large(seconds: int) -> tuple[float, float]:
    """Cost of 5000 strokes after so long, and the peak memory, MB."""
    code = (
        "import resource\n"
        "from benchmarks.drawings import drawing\n"
        "from optplan.domain.stop import StopRule\n"
        "from optplan.ordering import solve\n"
        f"answer = solve(drawing(5000, 0), 'search', StopRule(seconds={seconds}))\n"
        "print(answer.cost, resource.getrusage(resource.RUSAGE_SELF).ru_maxrss / 1024)"
    )
    done = subprocess.run([sys.executable, "-c", code], check=True, capture_output=True, text=True)
    cost, memory = done.stdout.split()
    return float(cost), float(memory)


def peers(seconds: float) -> Iterator[Row]:
    """`search` against other programs on the same problems in the same time: both above the better of them."""
    problems = [
        (source, load_case(DATA / "ordering" / source).problem)
        for source in ("atsp/kro124p.atsp", "atsp/rbg358.atsp", "gtsp/39rat195.gtsp", "sop/ft70.3.sop")
        if (DATA / "ordering" / source).is_file()
    ]
    problems.append(("drawing of 50 strokes", drawing(50, 0)))
    for name, problem in problems:
        ours = solve(problem, "search", StopRule(seconds=seconds)).cost
        for peer in PEERS:
            if len(problem.precedence) and peer == "pyvrp":
                continue  # it knows none
            theirs = peer_cost(problem, peer, seconds)
            best = min(ours, theirs)
            above, target = (100 * (cost / best - 1) for cost in (ours, theirs))
            yield Row(f"{Path(name).stem}, {seconds:g} s: search, against {peer}", above, target, "%")


def figures(*, quick: bool = False) -> Iterator[Row]:
    """All of them; `quick` with one seed and without the runs that take minutes."""
    warm_up()
    yield from heuristics(range(1 if quick else 5), (1.0,) if quick else (1.0, 10.0))
    yield from proofs()
    if available():
        yield from peers(1.0 if quick else 10.0)
    if not quick:
        yield from scale()


def main(arguments: Sequence[str]) -> int:
    """Print the table; 0 when every target is met."""
    met = True
    print(f"{'figure':<62}{'measured':>10}   {'target':>9}")
    for row in figures(quick="--quick" in arguments):
        good = row.measured <= row.target + 1e-9
        met = met and good
        verdict = "reached" if good else "NOT REACHED"
        value, target = f"{row.measured:.2f} {row.unit}", f"{row.target:g} {row.unit}"
        print(f"{row.what:<62}{value:>10}{target:>12}  {verdict:<12}{row.remark}", flush=True)
    return 0 if met else 1


if __name__ == "__main__":
    sys.exit(main(sys.argv[1:]))
