"""Figures of speed profiles and of the judge: processor time, and whether independent programmes agree."""

from __future__ import annotations

import statistics
import sys
import time
from collections.abc import Callable, Iterator
from dataclasses import replace

import numpy as np

from benchmarks.ordering import Row
from optplan.domain.options import Options, OrderOptions, PageOptions
from optplan.domain.path import Path
from optplan.geometry.clothoids import clothoid_displacement
from optplan.instances import instance
from optplan.jobs.reading import read
from optplan.judge import verify
from optplan.pipeline import plan
from optplan.robots import load_robot
from optplan.timing.fastest import greatest, profile
from optplan.timing.grid import grid_of


def used(work: Callable[[], object], times: int = 5) -> float:
    """Processor seconds, the median of several runs."""
    seconds = []
    for _ in range(times):
        start = time.process_time()
        work()
        seconds.append(time.process_time() - start)
    return statistics.median(seconds)


def clothoids(count: int, seed: int) -> Path:
    """A path of random clothoids of 0.5 to 2 m, up to 1.5 1/m, straight at both ends, with the tool down."""
    random = np.random.default_rng(seed)
    lengths = random.uniform(0.5, 2.0, count)
    curvatures = np.concatenate([[0.0], random.uniform(-1.5, 1.5, count - 1), [0.0]])
    rate = np.diff(curvatures) / lengths
    heading = np.concatenate([[0.0], np.cumsum(lengths * (curvatures[:-1] + curvatures[1:]) / 2)])[:-1]
    steps = clothoid_displacement(heading, curvatures[:-1], rate, lengths)
    start = np.zeros((count, 3))
    start[1:, :2] = np.cumsum(np.column_stack(steps), axis=0)[:-1]
    zero, tool = np.zeros(count), np.ones(count, dtype=np.int64)
    return Path(start, heading, zero, curvatures[:-1], rate, lengths, zero, zero, tool, np.arange(count))


def profiles() -> Iterator[Row]:
    """Speed profiles on random paths."""
    from optplan_models.speed import SpeedPath, duration, fastest_speeds

    robot, path = load_robot("beach-rake"), clothoids(800, 0)
    profile(path, robot)
    points = len(grid_of(path, robot, Options()).s)
    seconds = used(lambda: profile(path, robot), 9)
    yield Row("speed profile, 1000 points", 1e6 * seconds / points, 0.2, "ms", f"{points} points, a path of 1000 m")
    apart: dict[str, float] = {"cone programme": 0.0, "linear programme": 0.0}
    for name in ("beach-rake", "line-marker", "pen-plotter"):
        for seed in range(5):
            grid = grid_of(clothoids(10, seed), load_robot(name), Options(), even=True)
            time = duration(grid.length, greatest(grid))
            limits = SpeedPath(
                grid.length, grid.curvature, grid.sharpness, grid.acceleration, grid.cap, grid.half_track
            )
            for what, found in (
                ("cone programme", fastest_speeds(limits)),
                ("linear programme", fastest_speeds(limits, "squares")),
            ):
                apart[what] = max(apart[what], abs(found.time / time - 1))
    for what, most in apart.items():
        yield Row(f"sweep and {what} apart, relative", most, 1e-6, "")


def judging() -> Iterator[Row]:
    """The judge on the football field: 717.6 m of lines, about 1000 m in all."""
    options = Options(page=PageOptions(125.0, 88.0, 10.0), order=OrderOptions(metric="cc", seconds=5.0))
    made = plan(read(instance("football")), load_robot("line-marker"), options)
    assert made.path is not None
    metres = float(made.path.length.sum())
    verify(made)
    yield Row("a plan judged", used(lambda: verify(made), 3), 2.0, "s", f"{metres:.0f} m")


def trailing() -> Iterator[Row]:
    """A rake 0.3 m behind the robot on a drawing of a dozen strokes: how far it is from its lines, by the judge."""
    robot = load_robot("beach-rake")
    towing = replace(robot, tool=replace(robot.tool, ahead=-0.3))
    made = plan(read(instance("lion")), towing, Options(order=OrderOptions(seconds=3.0)))
    assert made.report is not None
    off = next(check.value for check in made.report.checks if check.name == "deviation")
    verified = "verified" if made.report.ok else "NOT VERIFIED"
    yield Row("rake 0.3 m behind, greatest deviation", 1000 * off, 5.0, "mm", f"on all of the length; {verified}")


def main() -> int:
    """Print the table; 0 when every target is met."""
    met = True
    for part in (profiles(), judging(), trailing()):
        for row in part:
            good = row.measured <= row.target
            met = met and good
            verdict = "met" if good else "NOT MET"
            print(
                f"{row.what:<52}{row.measured:>11.4g} {row.unit:<3}{row.target:>9.3g}  {verdict}  {row.remark}",
                flush=True,
            )
    return 0 if met else 1


if __name__ == "__main__":
    sys.exit(main())
