"""Figures of a football pitch of 105 x 68 m, as a published line-marking planner measured its own.

Caps of these comparisons, which no preset has: curvature 1.125 1/m, its change 3 1/m^2, one constant speed of 1.5 m/s.
The baseline is what such planners do: segments in the order and direction of the template, 0.5 m of padding before and
0.1 m behind each, Dubins paths between.
"""

from __future__ import annotations

import math
import subprocess
import sys
import tempfile
import time
from collections.abc import Iterator
from dataclasses import replace
from typing import NamedTuple

import numpy as np

import optplan as op
from benchmarks.table import Row, print_rows
from optplan.domain.options import ConnectOptions, CoverOptions, Options, OrderOptions, TimeOptions
from optplan.domain.ordering import Ordering
from optplan.domain.result import Plan
from optplan.domain.robot import DiffDrive, Robot
from optplan.domain.stop import StopRule

KAPPA, SIGMA, SPEED = 1.125, 3.0, 1.5
WORK, TRANSIT = 1.5, 2.0
"""m/s, where speed is free"""
CONSTANT = TimeOptions(constant_speed=SPEED)
BASELINE = Options(
    cover=CoverOptions(cut=False, headings=1),
    order=OrderOptions(metric="dubins", keep="all"),
    connect=ConnectOptions(pad_before=0.5, pad_after=0.1),
    time=CONSTANT,
)


def capped() -> Robot:
    """The line marker within the caps of the comparison, and fast enough for it."""
    robot = op.load_robot("line-marker")
    assert isinstance(robot.mobility, DiffDrive)
    limits = replace(robot.mobility, radius=1 / KAPPA, sharpness=SIGMA, work_speed=WORK, transit_speed=WORK)
    return replace(robot, mobility=limits)


def fast() -> Robot:
    """The line marker as it is, with the speeds of the time-optimal plan: its wheels alone limit how it steers."""
    robot = op.load_robot("line-marker")
    assert isinstance(robot.mobility, DiffDrive)
    return replace(robot, mobility=replace(robot.mobility, work_speed=WORK, transit_speed=TRANSIT))


class Made(NamedTuple):
    """A plan and what it took."""

    plan: Plan
    metres: float
    seconds: float
    """of driving"""
    took: float
    """s of planning the order"""


def made(robot: Robot, options: Options, limit: float) -> Made:
    """The football pitch planned within a time limit for the order."""
    job = op.template("football")
    before = time.perf_counter()
    plan = op.plan(job, robot, options, stop=StopRule(limit))
    took = time.perf_counter() - before
    assert plan.path is not None
    assert plan.trajectory is not None
    assert plan.report is not None
    assert plan.report.ok
    return Made(plan, float(plan.path.length.sum()), plan.trajectory.duration, took)


def whole(metric: str = "cc", **order: float) -> Options:
    """Lines in one go, at one speed."""
    return Options(cover=CoverOptions(cut=False), order=OrderOptions(metric=metric, **order), time=CONSTANT)  # type: ignore[arg-type]


def pieces(metric: str = "cc") -> Options:
    """Lines that may be left where others meet them, at one speed."""
    return Options(order=OrderOptions(metric=metric), time=CONSTANT)


def crossings(plan: Plan) -> int:
    """Ways on which the robot's middle passes over marks that are finished by then."""
    assert plan.report is not None
    detail = next(check.detail for check in plan.report.checks if check.name == "over finished work")
    return int("".join(filter(str.isdigit, detail)) or 0)


def steepest(plan: Plan) -> float:
    """Greatest wheel acceleration of a simulated drive, rad/s^2, without its first and last two seconds."""
    drive = op.simulate(plan, op.DriveOptions(ideal=True))
    inner = (drive.time > 2) & (drive.time < drive.time[-1] - 2)
    return float(np.abs(drive.wheel_acceleration[inner]).max())


def bound_after(ordering: Ordering, seconds: float) -> float:
    """What was proved by then."""
    return max((point.bound for point in ordering.trace if point.seconds <= seconds), default=-math.inf)


def rows() -> Iterator[Row]:
    """All figures, as they are measured."""
    robot = capped()
    base = made(robot, BASELINE, 10)
    yield Row("baseline: hand order, padded Dubins", base.seconds, 1064, "s", f"{base.metres:.1f} m")
    hand = made(robot, replace(whole(), order=OrderOptions(metric="cc", keep="order")), 10)
    yield Row("hand order, best directions, G2", hand.seconds, 1011, "s", f"{hand.metres:.1f} m")

    one = made(robot, whole(), 300)
    assert one.plan.ordering is not None
    gap = 1 - bound_after(one.plan.ordering, 60) / one.plan.ordering.cost
    yield Row("uncut, unpadded, G2", one.seconds, 661, "s", f"{one.metres:.2f} m")
    yield Row("  gap of the order after 60 s", 100 * gap, 2, "%", one.plan.ordering.status.value)
    yield Row("  proved after", one.took if one.plan.ordering.gap < 1e-6 else math.inf, 300, "s")

    short = made(robot, pieces(), 10)
    yield Row("cut at junctions, after 10 s", short.seconds, 625, "s", f"{short.metres:.2f} m")
    best = made(robot, pieces(), 150)
    assert best.plan.ordering is not None
    yield Row(
        "  proved after", best.took if best.plan.ordering.gap < 1e-6 else math.inf, 60, "s", f"{best.metres:.2f} m"
    )

    free = replace(pieces("time"), time=TimeOptions(work_speed=WORK, transit_speed=TRANSIT))
    quick = made(fast(), free, 20)
    tame = made(robot, free, 20)
    remark = f"{quick.metres:.1f} m; with the caps of curvature as well {tame.seconds:.0f} s"
    yield Row("time-optimal, within the wheels' limits", quick.seconds, 585, "s", remark)

    dry = made(robot, whole(avoid=20.0), 40)
    yield Row("wet crossings", crossings(dry.plan), 3, "", f"{crossings(one.plan)} in the shortest plan")
    yield Row("  longer than the shortest plan", 100 * (dry.metres / one.metres - 1), 12, "%")

    ratio = steepest(best.plan) / steepest(base.plan)
    yield Row("peak wheel acceleration over padded Dubins", ratio, 0.5, "")
    with tempfile.TemporaryDirectory() as folder:
        before = time.perf_counter()
        command = [sys.executable, "-m", "optplan", "plan", "football-pitch", "-o", f"{folder}/x", "-q"]
        subprocess.run([*command, "--time-limit", "6s", "-e", "messages"], check=True, stdout=subprocess.DEVNULL)
        yield Row("whole command, read to export", time.perf_counter() - before, 15, "s", "wall")


if __name__ == "__main__":
    sys.exit(0 if print_rows(rows()) else 1)
