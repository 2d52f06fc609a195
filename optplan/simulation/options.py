"""What a simulated robot is like, beyond what its preset says."""

from __future__ import annotations

import math
from dataclasses import dataclass

from optplan.domain.arrays import MAX_NUMBER
from optplan.domain.errors import InputError

TRACKERS = ("path-frame", "pure-pursuit")
"""Names of the control laws."""
LAG = 0.05
"""Time constant of a wheel unless something else is said, s: a choice, that of a small speed-controlled motor."""


@dataclass(frozen=True)
class DriveOptions:
    """How a plan is driven.

    Parameters
    ----------
    tracker : "path-frame": feed-forward of the trajectory, feedback in the path's frame; "pure-pursuit": steers at a
        point ahead on the path
    lag : time constant with which a wheel reaches the speed asked for, s; None: from mass and motor, else `LAG`
    mass : of the robot, kg; with it the energy is estimated
    motor : torque of each wheel's drive per speed that it lacks, N m s/rad; lag = mass radius^2 / (2 motor)
    rolling : resistance of the ground as a share of the weight, for the energy
    slip : standard deviation of each wheel's slip, a share of its speed
    noise, heading_noise : standard deviations of the measured place (m, in x and y) and heading (rad)
    seed : of everything random
    lookahead : of pure pursuit, m; None: the wheels' distance or 0.5 s ahead, whichever is more
    lost : the robot gives up this far from its path, m; None: four times the wheels' distance
    start : x, y (m) and heading (rad) where it stands at first; None: at the beginning of the path
    ideal : no lag, no slip, no noise, and it begins on the path

    Raises
    ------
    InputError : an unknown tracker, a value out of its range, or values that contradict one another
    """

    tracker: str = "path-frame"
    lag: float | None = None
    mass: float | None = None
    motor: float | None = None
    rolling: float = 0.05
    slip: float = 0.0
    noise: float = 0.0
    heading_noise: float = 0.0
    seed: int = 0
    lookahead: float | None = None
    lost: float | None = None
    start: tuple[float, float, float] | None = None
    ideal: bool = False

    def __post_init__(self) -> None:
        if self.tracker not in TRACKERS:
            raise InputError(f"there is no tracker {self.tracker!r}; expected one of {', '.join(TRACKERS)}")
        for name in ("lag", "mass", "motor", "lookahead", "lost"):
            value = getattr(self, name)
            if value is not None and not (_number(value) and 1 / MAX_NUMBER <= value <= MAX_NUMBER):
                raise InputError(f"the robot's {name} is {value}; expected a finite number above 0")
        for name, most in (("rolling", 10.0), ("slip", 0.5), ("noise", 100.0), ("heading_noise", math.pi)):
            value = getattr(self, name)
            if not (_number(value) and 0 <= value <= most):
                raise InputError(f"{name.replace('_', ' ')} is {value}; expected a number from 0 to {most:g}")
        seed: object = self.seed
        if isinstance(seed, bool) or not (isinstance(seed, int) and 0 <= seed < 2**31):
            raise InputError(f"the seed is {seed!r}; expected a whole number, 0..2^31 - 1")
        start: tuple[float, ...] | None = self.start
        if start is not None and not (len(start) == 3 and all(_number(x) and abs(x) <= MAX_NUMBER for x in start)):
            raise InputError(f"the robot's start is {start}; expected x, y in m and a heading in rad")
        if self.motor is not None and (self.mass is None or self.lag is not None):
            raise InputError("a motor gives the lag together with a mass; expected both, and no lag beside them")
        if self.ideal and (self.lag or self.motor or self.slip or self.noise or self.heading_noise or self.start):
            raise InputError("an ideal drive has no lag, slip, noise or start of its own; expected none of them")

    def time_constant(self, wheel_radius: float) -> float:
        """Lag of a wheel of that radius (m), s; 0 for an ideal drive."""
        if self.ideal:
            return 0.0
        if self.motor is not None and self.mass is not None:
            return self.mass * wheel_radius**2 / (2 * self.motor)
        return LAG if self.lag is None else self.lag


def _number(value: object) -> bool:
    return isinstance(value, int | float) and not isinstance(value, bool) and math.isfinite(value)
