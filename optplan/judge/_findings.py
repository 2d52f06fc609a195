"""Words and tolerances that all checks share."""

from __future__ import annotations

import math
from collections.abc import Sequence

from optplan.domain.arrays import FloatArray
from optplan.domain.options import Options
from optplan.domain.report import Check, Verdict
from optplan.domain.robot import Robot

GAP = 1e-6
"""m between the end of a piece and the start of the next: far below what any robot notices, far above rounding."""
ANGLE = 1e-6
"""rad by which headings may differ at a joint."""
RELATIVE = 1e-6
"""Limits of speed, acceleration, curvature and time are held to one part in a million."""
SAME_PLACE = 1e-9
"""m along the path below which two places are one: what is left of adding lengths in another order."""

Place = tuple[float, float]


def place_of(point: FloatArray) -> Place:
    """(x, y) of a point (2 or more coordinates), m."""
    return float(point[0]), float(point[1])


def held(
    name: str,
    value: float,
    limit: float,
    unit: str,
    place: Place | None = None,
    detail: str = "",
    *,
    slack: float = 0.0,
) -> Check:
    """A check that fails when `value` is above `limit` by more than `slack` (NaN fails too)."""
    good = value <= limit + slack
    return Check(name, Verdict.PASSED if good else Verdict.FAILED, float(value), float(limit), unit, place, detail)


def noted(name: str, value: float, unit: str, detail: str, place: Place | None = None) -> Check:
    """Something measured that has no limit."""
    return Check(name, Verdict.NOTED, float(value), None, unit, place, detail)


def unchecked(names: Sequence[str], why: str) -> list[Check]:
    """Stand-ins for checks that could not be made, so that every report lists the same names."""
    return [Check(name, Verdict.NOTED, 0.0, detail=f"Not checked: {why}.") for name in names]


def page_tolerance(robot: Robot, options: Options) -> float:
    """Greatest distance between a drawn curve and its polyline, m: the chosen one, or a twentieth of the narrowest
    mark."""
    chosen = options.page.tolerance
    narrowest = min(setting.width for setting in robot.tool.settings[1:])
    return max(narrowest / 20 if chosen is None else chosen, 1e-6)


def deviation_limit(robot: Robot, options: Options) -> float:
    """How far a driven stroke may be from its polyline, m: once the tolerance for flattening the curve and once for
    rounding the polyline."""
    return 2 * page_tolerance(robot, options)


def work_and_transit_speed(robot: Robot, options: Options) -> tuple[float, float]:
    """Speed limits with the tool down and up, m/s: the chosen ones, or the robot's."""
    work, transit, constant = options.time.work_speed, options.time.transit_speed, options.time.constant_speed
    if constant is not None:
        return constant, constant
    mobility = robot.mobility
    return (mobility.work_speed if work is None else work), (mobility.transit_speed if transit is None else transit)


def count_of(number: int, what: str) -> str:
    """ "1 stroke", "2 strokes"."""
    return f"{number} {what}" if number == 1 else f"{number} {what}s"


def finite(value: float, cap: float = 1e300) -> float:
    """The value, or a very large number in place of infinity: reports are written as JSON, which has none."""
    return math.copysign(cap, value) if math.isinf(value) else value
