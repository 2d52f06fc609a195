"""Where a robot's tool is."""

from __future__ import annotations

import math

import numpy as np

from optplan.domain.arrays import FloatArray, IntArray
from optplan.domain.robot import ToolPlace


def tool_positions(position: FloatArray, heading: FloatArray, gear: IntArray, place: ToolPlace) -> FloatArray:
    """Places (k, 3) of the tool, m.

    Parameters
    ----------
    position : (k, 3) m, of the robot's reference point
    heading : (k,) rad, of travel
    gear : (k,) 1 forwards; -1 backwards: the body points against the direction of travel
    place : of the tool in the body's frame
    """
    if not place.aside:
        return position
    body = heading + np.where(gear < 0, math.pi, 0.0)
    moved = position.copy()
    moved[:, 0] += place.ahead * np.cos(body) + place.right * np.sin(body)
    moved[:, 1] += place.ahead * np.sin(body) - place.right * np.cos(body)
    return moved
