"""Figures of speed profiles and of the judge: processor time, and whether independent programmes agree."""

from __future__ import annotations

import itertools
import sys
from collections.abc import Iterator
from dataclasses import replace

import numpy as np

from benchmarks.driving import chain
from benchmarks.table import Row, print_rows, used
from optplan.domain.options import Options, OrderOptions, PageOptions
from optplan.domain.path import Path
from optplan.instances import instance
from optplan.jobs.reading import read
from optplan.judge import verify
from optplan.pipeline import plan
from optplan.robots import load_robot
from optplan.timing.fastest import greatest, profile
from optplan.timing.grid import grid_of


def clothoids(count: int, seed: int) -> Path:
    """A path of random clothoids of 0.5 to 2 m, up to 1.5 1/m, straight at both ends, with the tool down."""
    random = np.random.default_rng(seed)
    lengths = random.uniform(0.5, 2.0, count)
    curvatures = np.concatenate([[0.0], random.uniform(-1.5, 1.5, count - 1), [0.0]])
    rate = np.diff(curvatures) / lengths
    return chain(curvatures[:-1].tolist(), rate.tolist(), lengths.tolist())


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
    return 0 if print_rows(itertools.chain(profiles(), judging(), trailing())) else 1


if __name__ == "__main__":
    sys.exit(main())
