"""How a robot moved: as planned, or as a simulated robot really drove."""

from __future__ import annotations

from dataclasses import dataclass

from optplan.domain.arrays import FloatArray, IntArray, frozen_floats, frozen_ints
from optplan.domain.errors import InputError


@dataclass(frozen=True, eq=False)
class Motion:
    """Where a robot was, moment by moment.

    Parameters
    ----------
    time : (n,) s, never decreasing
    x, y : (n,) m, the robot's reference point: the middle between the wheels of a robot that has some
    heading : (n,) rad, where its front points, left positive, not wrapped
    speed : (n,) m/s forwards; negative backwards
    turn_rate : (n,) rad/s, left positive
    tool : (n,) index of the tool setting; 0 is raised
    tool_x, tool_y : (n,) m, where the tool is
    """

    time: FloatArray
    x: FloatArray
    y: FloatArray
    heading: FloatArray
    speed: FloatArray
    turn_rate: FloatArray
    tool: IntArray
    tool_x: FloatArray
    tool_y: FloatArray

    def __post_init__(self) -> None:
        count = (len(self.time),)
        for name in ("time", "x", "y", "heading", "speed", "turn_rate", "tool_x", "tool_y"):
            object.__setattr__(self, name, frozen_floats(getattr(self, name), f"motion {name}", count))
        object.__setattr__(self, "tool", frozen_ints(self.tool, "motion tool", count))
        if (self.time[1:] < self.time[:-1]).any():
            raise InputError("a motion runs backwards in time")

    def __len__(self) -> int:
        return len(self.time)


@dataclass(frozen=True, eq=False)
class Drive(Motion):
    """What a simulated robot did with a plan.

    Parameters
    ----------
    wheel_speed : (n, 2) rad/s, left and right
    wheel_acceleration : (n, 2) rad/s^2, constant since the moment before
    cross_track : (n,) m from the planned line of the tool to the tool, left of its direction positive
    lag : (n,) m along the path by which the robot is behind its schedule
    finished : whether it came to rest at the end of the plan
    reason : why it ended, a few words
    method : the tracker, or "kinematic": no wheels were simulated, it moved exactly along the trajectory
    figures : (name, value, unit)
    """

    wheel_speed: FloatArray
    wheel_acceleration: FloatArray
    cross_track: FloatArray
    lag: FloatArray
    finished: bool
    reason: str
    method: str
    figures: tuple[tuple[str, float, str], ...] = ()

    def __post_init__(self) -> None:
        super().__post_init__()
        count = len(self.time)
        for name, shape in (
            ("wheel_speed", (count, 2)),
            ("wheel_acceleration", (count, 2)),
            ("cross_track", (count,)),
            ("lag", (count,)),
        ):
            object.__setattr__(self, name, frozen_floats(getattr(self, name), f"drive {name}", shape))

    def figure(self, name: str) -> float:
        """Value of a figure; KeyError when it was not measured."""
        return {key: value for key, value, _ in self.figures}[name]
