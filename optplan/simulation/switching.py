"""A tool that is on and off a little later than it is told."""

from __future__ import annotations

import numpy as np

from optplan.domain.arrays import FloatArray, IntArray
from optplan.domain.path import RAISED, Trajectory
from optplan.domain.robot import Tool
from optplan.timing.actuation import Commands, tool_commands


def switched(time: FloatArray, lag: FloatArray, trajectory: Trajectory, tool: Tool) -> tuple[IntArray, float]:
    """The tool settings (n,) at moments of a drive, and by how much marks begin or end elsewhere than planned, m.

    Commands are given where the plan's timetable has them, by the robot's place along the path; what it does
    meanwhile decides where it is when they take effect. A gap or a mark that is too short for the tool to follow is
    missed by as much as is marked, or left out, of it.

    Parameters
    ----------
    time : (n,) s, increasing
    lag : (n,) m along the path behind the schedule
    """
    commands = tool_commands(trajectory, tool)
    planned = np.interp(time, trajectory.t, trajectory.s)
    progress = np.maximum.accumulate(np.clip(planned - lag, 0.0, trajectory.s[-1]))
    row = np.searchsorted(progress, commands.s)
    reached = row < len(time)  # a drive may end before
    given = np.where(commands.time < 0, commands.time, time[np.minimum(row, len(time) - 1)])
    # standing, the clock decides: a command within a stop is given so long before its end
    standing = np.interp(commands.time, trajectory.t, trajectory.v) == 0
    given = np.where(standing & (commands.time >= 0), np.maximum(given, commands.time), given)
    delay = np.where(commands.setting == RAISED, tool.off_delay, tool.on_delay)
    effect = (given + delay)[reached]
    setting, at = commands.setting[reached], commands.at[reached]
    if len(effect) == 0:
        return np.full(len(time), RAISED), 0.0
    before = np.searchsorted(effect, time + 1e-9, side="right") - 1
    tools = np.where(before >= 0, setting[np.maximum(before, 0)], RAISED)
    missed = np.abs(np.interp(effect, time, progress) - at)
    return tools.astype(np.int64), max(float(missed.max()), _never_told(trajectory, commands, float(progress[-1])))


def _never_told(trajectory: Trajectory, commands: Commands, driven: float) -> float:
    """The longest stretch (m) of what was driven in which the tool is not as wanted as a change was never told."""
    path = trajectory.path
    changes = np.flatnonzero(np.diff(path.tool)) + 1
    wanted = path.offsets[changes]
    told = np.isin(wanted, commands.at)
    # an untold change is made up for by the next one that is told
    ends = np.append(commands.at, path.offsets[-1])
    until = ends[np.searchsorted(ends[:-1], wanted, side="right")]
    lost = np.where(told, 0.0, np.minimum(until, driven) - wanted)
    return float(lost.max(initial=0.0))
