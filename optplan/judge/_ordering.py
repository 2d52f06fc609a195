"""What the solver claimed, against what was really connected."""

from __future__ import annotations

import math

import numpy as np

from optplan.domain.options import Options
from optplan.domain.ordering import Ordering, Status
from optplan.domain.path import Path, Trajectory
from optplan.domain.report import Check, Verdict
from optplan.domain.robot import Robot
from optplan.judge._findings import RELATIVE, finite, held, noted


def bound(ordering: Ordering) -> Check:
    """The bound may not pass the cost, and an optimum needs a bound that meets it."""
    cost, lower = ordering.cost, ordering.bound
    slack = RELATIVE * max(abs(cost), 1e-3) if math.isfinite(cost) else 0.0
    optimal = ordering.status is Status.OPTIMAL
    unit = ordering.unit
    if math.isinf(lower) and lower < 0 and not optimal:
        return noted("bound", 0.0, unit, "Nothing is proved: there is no lower bound.")
    detail = f"The order costs at most {max(ordering.gap, 0):.2%} more than the best one."
    check = held("bound", finite(lower), finite(cost), unit, detail=detail, slack=slack)
    if check.verdict is Verdict.FAILED:
        return held(
            "bound", finite(lower), finite(cost), unit, detail="The lower bound is above the cost.", slack=slack
        )
    if optimal and not cost - lower <= slack:
        detail = f"The order is called optimal with a gap of {ordering.gap:.3g}."
        return Check("bound", Verdict.FAILED, finite(lower), finite(cost), unit, None, detail)
    return check


def cost(ordering: Ordering, path: Path, trajectory: Trajectory | None, robot: Robot, options: Options) -> Check:
    """Metres, or seconds, between strokes, against the cost that the solver reported for them."""
    if ordering.unit == "s":
        return _seconds(ordering, path, trajectory)
    driven = float(path.length[path.stroke < 0].sum())
    claimed = ordering.cost
    slack = RELATIVE * max(driven, 1e-3)
    metric = options.order.metric
    asked = "dubins" if robot.heading_counts else "euclid"
    if metric not in ("auto", asked, "cc"):
        return noted("cost", driven, "m", f"The order was chosen by the metric {metric}, not by what is driven.")
    more = claimed - driven
    good = abs(more) <= slack
    detail = (
        "The path between strokes is as long as the solver said."
        if good
        else (f"The path between strokes is {driven:.9g} m long, the solver said {finite(claimed):.9g} m.")
    )
    verdict = Verdict.PASSED if good else Verdict.FAILED
    return Check("cost", verdict, driven, finite(claimed), "m", None, detail)


def _seconds(ordering: Ordering, path: Path, trajectory: Trajectory | None) -> Check:
    """The time between strokes; where these are too short to reach their speed, the solver knows less."""
    if trajectory is None:
        return noted("cost", finite(ordering.cost), "s", "The plan has no speeds to compare the solver's seconds with.")
    ends = np.interp(np.concatenate([[0.0], np.cumsum(path.length)]), trajectory.s, trajectory.t)
    taken = float(np.diff(ends)[path.stroke < 0].sum())
    detail = f"The path between strokes takes {taken:.4g} s, the solver reckoned with {finite(ordering.cost):.4g} s."
    return noted("cost", taken, "s", detail)
