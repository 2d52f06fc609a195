"""Robots whose drives are not simulated: they move exactly along the trajectory."""

from __future__ import annotations

import math

import numpy as np

from optplan.domain.drive import Drive
from optplan.domain.path import Trajectory
from optplan.domain.robot import Robot
from optplan.simulation.figures import figures_of
from optplan.timing.motion import motion

STEP = 0.01
"""Time between two moments, s."""


def follow(robot: Robot, trajectory: Trajectory) -> Drive:
    """The planned motion as a drive without wheels and without errors. Heights are left out."""
    duration = trajectory.duration
    time = np.linspace(0.0, duration, max(2, math.ceil(duration / STEP) + 1))
    moved = motion(trajectory, robot, time)
    none = np.zeros(len(time))
    wheels = np.zeros((len(time), 2))
    return Drive(
        **{name: getattr(moved, name) for name in moved.__dataclass_fields__},
        wheel_speed=wheels,
        wheel_acceleration=wheels,
        cross_track=none,
        lag=none,
        finished=True,
        reason="moved exactly along the trajectory: only robots with two driven wheels are simulated",
        method="kinematic",
        figures=figures_of(time, moved.tool, wheels, wheels, none, none, duration, None),
    )
