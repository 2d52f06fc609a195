"""Figures of simulated drives: processor time of a long plan, and wheel accelerations of one corner.

The corner is a right one, driven at a constant 1.5 m/s, once as an arc between two lines (a Dubins corner), once with
clothoids around the arc (continuous curvature). `corners` measures the accelerations of both wheels from 1 m before the
corner to 1 m behind it: the greatest, the root of the mean square, and the mean of the size.

A published experiment with such a robot reports 0.480 and 0.198 rad/s^2, 59 % less. These are not the same figures: at
1.5 m/s a wheel gains or loses v kappa track / (2 radius) = 4.3 rad/s on the way into this corner and again on the way
out, which over 4 m and more is a mean above 3 rad/s^2, whatever steers. Published ones must be means over longer
drives, or of smoothed speeds. What can be compared is how much less it becomes.
"""

from __future__ import annotations

import math
import sys
from collections.abc import Iterator
from typing import NamedTuple

import numpy as np

import optplan as op
from benchmarks.table import Row, print_rows, used
from optplan.domain.arrays import FloatArray
from optplan.domain.path import Path, Trajectory
from optplan.domain.result import Plan
from optplan.geometry.curves import Curve

SWATH, RADIUS = 22.0, 1.0
"""Lines of the long plan and radius of the half circles between them, m."""
KAPPA, SIGMA, SPEED = 1.125, 3.0, 1.5
"""The corner: 1/m, 1/m^2, m/s."""
RUN_UP = 4.0
"""Straight before and behind the corner, m: enough to reach the speed."""


def chain(curvature: list[float], sharpness: list[float], length: list[float]) -> Path:
    """A path of clothoids from the origin, tool down."""
    curve = Curve(np.zeros(3), np.array(curvature), np.array(sharpness), np.array(length))
    count = len(length)
    zero = np.zeros(count)
    return Path(
        np.column_stack([curve.states[:-1, :2], zero]),
        curve.states[:-1, 2],
        zero,
        curve.curvature,
        curve.sharpness,
        curve.length,
        zero,
        zero,
        np.ones(count, dtype=np.int64),
        np.zeros(count, dtype=np.int64),
    )


def long_plan(metres: float = 1000.0) -> Plan:
    """Parallel lines with half circles between them for the line marker, at 1 m/s."""
    turns = round(metres / (SWATH + math.pi * RADIUS))
    curvature, length = [0.0], [SWATH]
    for k in range(turns):
        curvature += [(-1) ** k / RADIUS, 0.0]
        length += [math.pi * RADIUS, SWATH]
    path = chain(curvature, [0.0] * len(length), length)
    robot = op.load_robot("line-marker")
    options = op.Options(time=op.TimeOptions(work_speed=1.0, transit_speed=1.0))
    return Plan(op.read(op.instance("wave")), robot, options, path=path, trajectory=op.profile(path, robot, options))


def speeds() -> Iterator[Row]:
    """Processor seconds to simulate a plan of 1000 m."""
    plan = long_plan()
    op.simulate(plan)  # so that compiling is not counted
    for tracker in ("path-frame", "pure-pursuit"):
        options = op.DriveOptions(tracker=tracker, slip=0.02, noise=0.01)
        seconds, drive = used(lambda: op.simulate(plan, options), 3), op.simulate(plan, options)  # noqa: B023
        remark = f"{len(drive)} steps, {drive.reason}"
        yield Row(f"simulate 1000 m at 1 m/s, {tracker}", seconds, 5.0, "s", remark)


class Corner(NamedTuple):
    """Wheel accelerations of one corner, rad/s^2, and how far off the robot got, m."""

    kind: str
    tracker: str
    greatest: float
    rms: float
    mean: float
    cross_track: float


def corner_path(kind: str) -> Path:
    """A right corner of 90 degrees with straight run-ups: "dubins" or "cc"."""
    if kind == "dubins":
        return chain([0.0, -KAPPA, 0.0], [0.0] * 3, [RUN_UP, math.pi / 2 / KAPPA, RUN_UP])
    ramp = KAPPA / SIGMA
    arc = (math.pi / 2 - KAPPA * ramp) / KAPPA
    return chain([0.0, 0.0, -KAPPA, -KAPPA, 0.0], [0, -SIGMA, 0, SIGMA, 0], [RUN_UP, ramp, arc, ramp, RUN_UP])


def at_constant_speed(path: Path) -> Trajectory:
    """Up to speed within the first metre, down within the last."""
    offsets = path.offsets
    s = np.sort(np.concatenate([offsets, [1.0, offsets[-1] - 1.0]]))
    v = np.full(len(s), SPEED)
    v[[0, -1]] = 0.0
    t = np.concatenate([[0.0], np.cumsum(2 * np.diff(s) / (v[1:] + v[:-1]))])
    return Trajectory(path, s, t, v)


def corners(lag: float = 0.05) -> list[Corner]:
    """Both kinds of corner by both trackers."""
    made = []
    for tracker in ("path-frame", "pure-pursuit"):
        for kind in ("dubins", "cc"):
            path = corner_path(kind)
            plan = Plan(
                op.read(op.instance("wave")),
                op.load_robot("line-marker"),
                op.Options(),
                path=path,
                trajectory=at_constant_speed(path),
            )
            drive = op.simulate(plan, op.DriveOptions(tracker=tracker, lag=lag))
            driven: FloatArray = np.concatenate([[0.0], np.cumsum(np.hypot(np.diff(drive.x), np.diff(drive.y)))])
            inside = (driven > RUN_UP - 1) & (driven < path.offsets[-1] - RUN_UP + 1)
            wheels = np.abs(drive.wheel_acceleration[inside])
            rms = float(np.sqrt((wheels**2).mean()))
            off = float(np.abs(drive.cross_track[inside]).max())
            made.append(Corner(kind, tracker, float(wheels.max()), rms, float(wheels.mean()), off))
    return made


def print_corners() -> None:
    """The table of corners, and what clothoids save."""
    print("\nwheel acceleration of a right corner at 1.5 m/s, rad/s^2 (published: dubins 0.480, cc 0.198, -59 %)")
    print(f"{'tracker':<14}{'corner':<8}{'greatest':>10}{'rms':>8}{'mean':>8}{'off, mm':>9}")
    table = corners()
    for row in table:
        print(
            f"{row.tracker:<14}{row.kind:<8}{row.greatest:>10.2f}{row.rms:>8.2f}{row.mean:>8.2f}"
            f"{1000 * row.cross_track:>9.1f}"
        )
    for dubins, smooth in zip(table[::2], table[1::2], strict=True):
        less = [
            100 * (getattr(smooth, name) / getattr(dubins, name) - 1)
            for name in ("greatest", "rms", "mean", "cross_track")
        ]
        print(f"{dubins.tracker:<14}{'change':<8}{less[0]:>8.0f} %{less[1]:>6.0f} %{less[2]:>6.0f} %{less[3]:>7.0f} %")


def main() -> int:
    """Print the figures; 0 when every target is met."""
    good = print_rows(speeds())
    print_corners()
    return 0 if good else 1


if __name__ == "__main__":
    sys.exit(main())
