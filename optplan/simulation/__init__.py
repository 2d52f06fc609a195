"""A robot that drives a plan."""

from __future__ import annotations

import math
from typing import TYPE_CHECKING

from optplan.domain.errors import InputError, LimitError
from optplan.domain.robot import DiffDrive
from optplan.simulation.options import TRACKERS, DriveOptions

if TYPE_CHECKING:
    from optplan.domain.drive import Drive
    from optplan.domain.progress import ProgressCallback
    from optplan.domain.result import Plan
    from optplan.domain.stop import StopRule

__all__ = ["TRACKERS", "DriveOptions", "simulate"]

LONGEST = 20_000.0
"""Longest plan that is simulated, s."""


def simulate(
    plan: Plan,
    options: DriveOptions | None = None,
    progress: ProgressCallback | None = None,
    stop: StopRule | None = None,
) -> Drive:
    """Drive a plan with a simulated robot.

    A robot with two driven wheels is controlled a hundred times a second: its wheels answer with a lag and within their
    limits, it may slip and measure wrongly. Any other robot moves exactly along the trajectory; its drive says so.

    Parameters
    ----------
    plan : with a trajectory
    options : the robot's circumstances; default: tracker "path-frame", a lag of 0.05 s, no noise
    progress : called with what share of the plan's duration has been driven
    stop : asked between slices of a few milliseconds: a cancel or time limit ends the drive where it is

    Returns
    -------
    the drive; whether it reached the end, and why not, is in it

    Raises
    ------
    InputError : the plan has no speeds, the options are wrong, or the path leaves the plane
    LimitError : the plan is longer than `LONGEST`
    """
    from optplan.domain.progress import silent

    asked = options or DriveOptions()
    trajectory = plan.trajectory
    if trajectory is None or len(trajectory.path) == 0:
        raise InputError("the plan has no speeds to drive; run the stage time first")
    if not (math.isfinite(trajectory.duration) and trajectory.duration <= LONGEST):
        raise LimitError(f"the plan takes {trajectory.duration:g} s; at most {LONGEST:g} s are simulated")
    if not isinstance(plan.robot.mobility, DiffDrive):
        from optplan.simulation.follower import follow

        return follow(plan.robot, trajectory)
    from optplan.simulation.driving import drive_wheels

    return drive_wheels(plan.robot, plan.robot.mobility, trajectory, asked, progress or silent, stop)
