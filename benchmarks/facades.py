"""Figures of facades: proofs of the order of stops, quick orders, and few circles."""

from __future__ import annotations

import sys
from collections.abc import Iterator

from benchmarks.ordering import proved, warm_up
from benchmarks.table import Row, print_rows
from optplan.compare import load_case
from optplan.coverage.circles import fewest_circles
from optplan.domain.stop import StopRule
from optplan.domain.washing import WashOptions
from optplan.ordering import solve


def proofs() -> Iterator[Row]:
    """Processor seconds until the shortest order is proved, from nothing."""
    for name, solver, target in (
        ("case1", "beam", 1.0),
        ("case2", "beam", 1.0),
        ("case1", "cuts", 2.0),
        ("case2", "cuts", 5.0),
        ("large273", "beam", 3.0),
    ):
        case = load_case(f"washing/{name}")
        yield proved(f"{name}, {case.problem.clusters} circles, proved by {solver}", [case.problem], solver, target)
    case = load_case("washing/large539")
    answer = solve(case.problem, "cuts", StopRule(seconds=60))
    yield Row("large539, 539 circles, gap of cuts after 60 s", 100 * answer.gap, 0.3, "%", f"{answer.cost:.3f} m")


def quick() -> Iterator[Row]:
    """How far from the best order a method is after 20 ms: the better method, the worst of nine seeds."""
    for name in ("case1", "case2"):
        case = load_case(f"washing/{name}")
        gaps = {}
        for solver in ("beam", "search"):
            solve(case.problem, solver, StopRule(seconds=0.5))
            runs = [solve(case.problem, solver, StopRule(seconds=0.02), seed).cost for seed in range(9)]
            gaps[solver] = 100 * (max(runs) / case.best_known - 1)
        best = min(gaps, key=lambda solver: gaps[solver])
        yield Row(f"{name}, order of {best} after 20 ms, above the best", gaps[best], 0.5, "%")


def circles() -> Iterator[Row]:
    """How many circles more than are proved to be needed, of the candidate positions."""
    import shapely

    wall = shapely.box(0, 0, 22, 18)
    windows = shapely.union_all([shapely.box(x, y, x + 2.2, y + 2.4) for x in (2, 8, 14, 18.5) for y in (2, 7.5, 13)])
    found = fewest_circles(wall.difference(windows), 1.0, WashOptions(turned=True, effort=30.0))
    count = len(found.centres)
    remark = f"{count} circles of {found.candidates} positions, {found.bound} or more needed"
    yield Row("a wall with twelve windows, circles above the bound", count - found.bound, 1.0, "", remark)


def figures() -> Iterator[Row]:
    """All of them."""
    warm_up()
    yield from quick()
    yield from proofs()
    yield from circles()


if __name__ == "__main__":
    sys.exit(0 if print_rows(figures()) else 1)
