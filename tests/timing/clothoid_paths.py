"""Random paths of clothoids, and robots to drive them."""

from __future__ import annotations

from dataclasses import replace

import numpy as np

from optplan.domain.arrays import FloatArray
from optplan.domain.path import Path
from optplan.domain.robot import Robot
from optplan.geometry.clothoids import clothoid_displacement
from tests.strategies import PLOTTER, TOOL, WHEELS

WEAK = Robot("weak", "", TOOL, replace(WHEELS, wheel_speed=8.0, wheel_acceleration=5.0, work_speed=0.7))
"""Wheels that limit speed and acceleration in bends."""
SLIPPERY = Robot("slippery", "", TOOL, replace(WHEELS, wheel_acceleration=8.0, lateral_acceleration=0.2))
ROBOTS = (WEAK, SLIPPERY, PLOTTER)


def clothoids(lengths: FloatArray, curvatures: FloatArray) -> Path:
    """One path of pieces (n,) m long, with curvatures (n + 1,) 1/m at their ends, with the tool down."""
    count = len(lengths)
    rate = np.diff(curvatures) / lengths
    heading = np.concatenate([[0.0], np.cumsum(lengths * (curvatures[:-1] + curvatures[1:]) / 2)])[:-1]
    dx, dy = clothoid_displacement(heading, curvatures[:-1], rate, lengths)
    start = np.zeros((count, 3))
    start[1:, 0], start[1:, 1] = np.cumsum(dx)[:-1], np.cumsum(dy)[:-1]
    zero, tool = np.zeros(count), np.ones(count, dtype=np.int64)
    return Path(start, heading, zero, curvatures[:-1], rate, lengths, zero, zero, tool, np.arange(count))


def random_path(count: int, seed: int, tight: float = 1.5) -> Path:
    """Clothoids of 0.2 to 3 m, straight at both ends, up to `tight` 1/m between."""
    random = np.random.default_rng(seed)
    curvatures = np.concatenate([[0.0], random.uniform(-tight, tight, count - 1), [0.0]])
    return clothoids(random.uniform(0.2, 3.0, count), curvatures)
