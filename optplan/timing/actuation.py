"""When the tool has to be told what to do: it is on and off a little later than it is told."""

from __future__ import annotations

from typing import NamedTuple

import numpy as np

from optplan.domain.arrays import FloatArray, IntArray
from optplan.domain.path import RAISED, Trajectory
from optplan.domain.robot import Tool
from optplan.timing.sampling import begins


class Commands(NamedTuple):
    """Tool commands in the order in which they are given."""

    time: FloatArray
    """(k,) s, when the command is given; negative: before the robot sets off"""
    s: FloatArray
    """(k,) m along the path, where the robot is then; 0 before it sets off"""
    setting: IntArray
    """(k,) the setting that is asked for"""
    at: FloatArray
    """(k,) m along the path, where it has to be reached"""


def tool_commands(trajectory: Trajectory, tool: Tool) -> Commands:
    """What to tell the tool, and when, so that it changes where the path says.

    Each change is told ahead by the tool's delay: `off_delay` for raising it, `on_delay` for everything else. A command
    that would come before the one ahead of it, as between two marks that nearly touch, is given together with that one,
    and only the later one is kept.
    """
    path = trajectory.path
    if len(path) == 0:
        return Commands(np.zeros(0), np.zeros(0), np.zeros(0, dtype=np.int64), np.zeros(0))
    before = np.concatenate([[RAISED], path.tool[:-1]])
    rows = np.flatnonzero(path.tool != before)
    if path.tool[-1] != RAISED:
        rows = np.append(rows, len(path))
    setting, at = np.append(path.tool, RAISED)[rows], path.offsets[rows]
    # a tool goes down after a turn on the spot and up before one; at a stop it works while the robot stands
    wanted = begins(trajectory)[rows]
    told = wanted - np.where(setting == RAISED, tool.off_delay, tool.on_delay)
    # none may be overtaken by the next one
    told = np.minimum.accumulate(told[::-1])[::-1]
    kept = np.append(told[1:] > told[:-1], True) if len(told) else np.zeros(0, dtype=np.bool_)
    told, setting, at = told[kept], setting[kept], at[kept]
    place = np.interp(told, trajectory.t, np.arange(len(trajectory.t)))
    low = np.clip(place.astype(np.int64), 0, max(len(trajectory.t) - 2, 0))
    into = np.clip(told - trajectory.t[low], 0.0, None)
    step = np.diff(trajectory.t, append=trajectory.t[-1])[low]
    rate = np.divide(np.diff(trajectory.v, append=0.0)[low], step, out=np.zeros(len(low)), where=step > 0)
    s = np.minimum(trajectory.s[low] + into * (trajectory.v[low] + rate * into / 2), trajectory.s[-1])
    return Commands(told, np.where(told < 0, 0.0, s), setting, at)
