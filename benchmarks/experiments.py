"""The experiments of a published line-marking planner, again: `python -m benchmarks.experiments` prints their tables.

Random pairs of poses in a box of 10 m, kappa <= 1.125 1/m, sharpness 0.5 to 3 1/m^2: whether paths are continuous,
whether there is always one, how long they are against Dubins paths, and how long they take: at one constant speed, and
as fast as the wheels of the line marker allow.
"""

from __future__ import annotations

import math
from typing import NamedTuple

import numpy as np

import optplan as op
from benchmarks.connectors import KAPPA, queries
from optplan.domain.arrays import FloatArray
from optplan.domain.options import Options, TimeOptions
from optplan.domain.path import Path
from optplan.geometry.cc import cc_lengths, cc_path
from optplan.geometry.curves import Curve
from optplan.geometry.dubins import dubins_lengths, dubins_path

SHARPNESSES = (0.5, 1.0, 2.0, 3.0)
SPEED = 1.5
"""m/s, where speed is constant"""


def path_of(start: FloatArray, curvatures: FloatArray, sharpnesses: FloatArray, lengths: FloatArray) -> Path:
    """A path of clothoids with the tool up."""
    curve = Curve(start[:3], curvatures, sharpnesses, lengths)
    count = len(lengths)
    zero, none = np.zeros(count), np.zeros(count, dtype=np.int64)
    places = np.column_stack([curve.states[:-1, :2], zero])
    return Path(places, curve.states[:-1, 2], zero, curvatures, sharpnesses, lengths, zero, zero, none, none - 1)


class Row(NamedTuple):
    """One sharpness limit."""

    sharpness: float
    worst_joint: float
    """m, between the ends of pieces that follow each other, and from the last to the goal, of 100 pairs"""
    steps: int
    """joints of them at which heading or curvature jumps"""
    failures: int
    """of 10 000 pairs"""
    longer: float
    """mean length over that of Dubins paths, less 1, of 10 000 pairs"""
    constant: float
    """mean time at constant speed over that of Dubins paths, less 1, of 100 pairs"""
    fastest: float
    """mean least time over that of Dubins paths that slow down where their curvature jumps, less 1, of 100 pairs"""


def experiment(sharpness: float, few: int = 100, many: int = 10_000) -> Row:
    """All of them for one limit of sharpness."""
    starts, ends = queries(many, 0), queries(many, 1)
    lengths = cc_lengths(starts, ends, KAPPA, sharpness)
    plain = dubins_lengths(starts[:, :3], ends[:, :3], 1 / KAPPA)
    robot = op.load_robot("line-marker")
    constant = Options(time=TimeOptions(constant_speed=SPEED))
    worst, steps, ratios = 0.0, 0, []
    for start, end in zip(starts[:few], ends[:few], strict=True):
        found = cc_path(start, end, KAPPA, sharpness)
        made = path_of(start, found.curvatures, found.sharpnesses, found.lengths)
        last = Curve(start[:3], found.curvatures, found.sharpnesses, found.lengths).states
        worst = max(worst, float(np.hypot(*(last[-1, :2] - end[:2]))))
        worst = max(worst, float(np.abs(made.start[1:, :2] - last[1:-1, :2]).max(initial=0.0)))
        bend = found.curvatures + found.sharpnesses * found.lengths
        steps += int((np.abs(found.curvatures[1:] - bend[:-1]) > 1e-9).sum())
        steps += abs(math.remainder(last[-1, 2] - end[2], 2 * math.pi)) > 1e-9
        dubins = dubins_path(start[:3], end[:3], 1 / KAPPA)
        arcs = np.array(dubins.lengths)
        old = path_of(start, np.array(dubins.curvatures), np.zeros(len(arcs)), arcs)
        ratios.append(
            [op.profile(made, robot, o).duration / op.profile(old, robot, o).duration for o in (constant, Options())]
        )
    mean = np.array(ratios).mean(axis=0) - 1
    failures = int((~np.isfinite(lengths)).sum())
    return Row(sharpness, worst, steps, failures, float((lengths / plain).mean() - 1), float(mean[0]), float(mean[1]))


def main() -> None:
    """Print the table."""
    print("sharpness  worst joint, m  jumps of 100  failures of 10000  length  constant speed  as fast as possible")
    for sharpness in SHARPNESSES:
        row = experiment(sharpness)
        print(
            f"{row.sharpness:>9.1f}{row.worst_joint:>16.1e}{row.steps:>14}{row.failures:>19}{100 * row.longer:>+7.1f}%"
            f"{100 * row.constant:>+15.1f}%{100 * row.fastest:>+20.1f}%"
        )


if __name__ == "__main__":
    main()
