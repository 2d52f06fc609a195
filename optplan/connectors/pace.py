"""Connectors that take the least time: each within the limits of the speed that suits it best."""

from __future__ import annotations

import math
from collections.abc import Callable
from typing import NamedTuple

import numpy as np

from optplan.domain.arrays import FloatArray
from optplan.domain.errors import InputError
from optplan.domain.options import Options
from optplan.domain.robot import CurvatureLimits, DiffDrive, Robot, ToolPlace
from optplan.geometry.cc import shared_tables
from optplan.geometry.curves import Curve
from optplan.geometry.threads import by_rows

SHARES = (1.0, 0.95, 0.9, 0.85, 0.8, 0.75, 0.7, 0.6, 0.5)
"""Of the transit speed: the slower a robot drives, the tighter it turns."""
LEAST_CURVATURE = 0.02
"""1/m: wider turns are no use on a field."""
SLICE = 4000
"""connectors between two looks at whether a cancel has come"""


class Pace(NamedTuple):
    """How fast a robot drives, and what it can steer at which speed."""

    rungs: tuple[CurvatureLimits, ...]
    """limits of connectors, for falling speed; no two alike"""
    numbers: tuple[float, float, float, float, float]
    """half the track, acceleration, transit speed, speed of the wheels' rims, lateral acceleration; SI"""
    work: float
    """m/s, of the tool"""
    place: ToolPlace

    @property
    def tightest(self) -> CurvatureLimits:
        """The limits of the slowest connectors."""
        return self.rungs[-1]

    def stroke_speeds(self, curvature: FloatArray) -> FloatArray:
        """Speeds (k,) m/s at which strokes are driven where the robot's curvature is this, 1/m."""
        half, _, _, rim, lateral = self.numbers
        bend = np.abs(curvature)
        tool = np.hypot(1 + curvature * self.place.right, curvature * self.place.ahead)
        with np.errstate(divide="ignore", invalid="ignore"):
            sideways = np.where(bend > 0, np.sqrt(lateral / bend), np.inf)
            speeds: FloatArray = np.minimum.reduce([self.work / tool, rim / (1 + bend * half), sideways])
        return speeds

    def times(self, exits: FloatArray, entries: FloatArray) -> FloatArray:
        """Seconds (k,) of connectors between states (k, 4) x, y, heading, curvature."""
        least: FloatArray = self.by_rung(exits, entries).min(axis=0, initial=np.inf)
        return least

    def by_rung(self, exits: FloatArray, entries: FloatArray) -> FloatArray:
        """Seconds (rungs, k), infinite where a state is bent more than a rung allows."""
        made = np.full((len(self.rungs), len(exits)), np.inf)
        for k, limits in enumerate(self.rungs):
            self._fill(limits, exits, entries, made[k][:, None], True, None, 1)
        return made

    def time_along(self, curves: tuple[Curve, ...]) -> float:
        """Seconds along curves, one after the other, between strokes."""
        from optplan.connectors._kernels.times import time_of

        rows = [np.column_stack([curve.curvature, curve.sharpness, curve.length]) for curve in curves]
        if not rows:
            return 0.0
        pieces = np.ascontiguousarray(np.concatenate(rows))
        ends = np.array([pieces[0, 0], curves[-1].end_curvature[-1]])
        before, after = self.stroke_speeds(ends)
        return float(time_of(pieces, len(pieces), before, after, np.array(self.numbers)))

    def matrix(self, exits: FloatArray, entries: FloatArray, told: Callable[[float], None] | None = None) -> FloatArray:
        """Seconds (n, m) from every exit (n, 4) to every entry (m, 4). `told` is called with the share that is done."""
        out = np.full((len(exits), len(entries)), np.inf)
        for number, limits in enumerate(self.rungs[::-1]):

            def share(part: float, number: int = number) -> None:
                if told is not None:
                    told((number + part) / len(self.rungs))

            self._fill(limits, exits, entries, out, False, share, None)
        return out

    def _fill(
        self,
        limits: CurvatureLimits,
        exits: FloatArray,
        entries: FloatArray,
        out: FloatArray,
        paired: bool,
        told: Callable[[float], None] | None,
        threads: int | None,
    ) -> None:
        from optplan.connectors._kernels.times import times

        kappa, s = limits.curvature, limits.sharpness / limits.curvature**2
        shared, pace = shared_tables(s), np.array(self.numbers)
        first, last = (np.ascontiguousarray(states, dtype=np.float64) for states in (exits, entries))
        before, after = self.stroke_speeds(first[:, 3]), self.stroke_speeds(last[:, 3])

        def fill(part: slice) -> None:
            there = part if paired else slice(None)
            times(first[part], last[there], before[part], after[there], paired, kappa, s, *shared, pace, out[part])

        by_rows(fill, len(first), max(1, SLICE // max(1 if paired else len(last), 1)), threads, told)


def pace_of(robot: Robot, options: Options) -> Pace:
    """The pace of a robot on wheels. Raises InputError when it cannot turn, or nothing limits how it steers."""
    mobility = robot.mobility
    if not isinstance(mobility, DiffDrive):
        raise InputError(f"the metric 'time' needs wheels, which {robot.name} has not; expected 'euclid'")
    work, transit = options.time.speeds(mobility)
    if options.time.constant_speed is not None:
        raise InputError("at one speed everywhere the metric 'time' is 'cc'; expected that, or limits of speed")
    rungs: list[CurvatureLimits] = []
    for share in SHARES:
        limits = mobility.curvature_limits(share * transit)
        if limits.curvature >= LEAST_CURVATURE and limits not in rungs:
            rungs.append(limits)
    if not rungs:
        raise InputError(f"{robot.name} cannot turn at {transit:g} m/s; expected a lower transit speed")
    if math.isinf(rungs[-1].sharpness) or math.isinf(rungs[-1].curvature):
        raise InputError(f"the metric 'time' needs limits of steering, which {robot.name} has not")
    rim = mobility.wheel_speed * mobility.wheel_radius
    numbers = (mobility.track / 2, mobility.acceleration, transit, rim, mobility.lateral_acceleration)
    return Pace(tuple(rungs), numbers, work, robot.offset)
