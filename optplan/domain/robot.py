"""A robot: a tool and a mobility."""

from __future__ import annotations

import math
from dataclasses import dataclass
from typing import NamedTuple

from optplan.domain.arrays import MAX_NUMBER
from optplan.domain.errors import InputError


class CurvatureLimits(NamedTuple):
    """What a robot can steer at a given speed."""

    curvature: float
    """kappa_max, 1/m; infinite where only a stop can turn faster"""
    sharpness: float
    """sigma_max = max |dkappa/ds|, 1/m^2"""


class ToolPlace(NamedTuple):
    """Where a tool sits, from the robot's reference point and in the direction in which its body points."""

    right: float
    """m"""
    ahead: float
    """m; negative: behind"""

    @property
    def aside(self) -> bool:
        """Whether the tool is anywhere but in the middle."""
        return self != (0.0, 0.0)


MIDDLE = ToolPlace(0.0, 0.0)
"""Of a tool at the robot's reference point."""


@dataclass(frozen=True)
class ToolSetting:
    """One way of holding the tool.

    Parameters
    ----------
    name : what people call it, e.g. "3 pins"
    width : width of the mark, m; 0 for the raised tool
    code : the number a controller knows it by, 0..127 (a mask of pins)
    """

    name: str
    width: float
    code: int = 0

    def __post_init__(self) -> None:
        if not (math.isfinite(self.width) and self.width >= 0):
            raise InputError(f"tool setting {self.name!r}: width is {self.width} m; expected 0 or more")
        if not 0 <= self.code <= 127:
            raise InputError(f"tool setting {self.name!r}: code is {self.code}; expected 0..127")


@dataclass(frozen=True)
class Tool:
    """What touches the surface.

    Parameters
    ----------
    settings : the first is the raised tool (width 0), the others mark
    right, ahead : where the tool sits, m from the robot's reference point
    stroke_widths : drawing syntax; setting k + 1 draws strokes up to stroke_widths[k] drawing units wide, the last
        one everything wider. Empty: stroke widths mean nothing and setting 1 draws everything.
    red_is_travel, green_is_start : drawing syntax of colours; where False, colours are layers
    fill : index of the setting that fills areas
    on_delay, off_delay : from the command until the tool marks, and until it no longer does, s
    """

    settings: tuple[ToolSetting, ...]
    right: float = 0.0
    ahead: float = 0.0
    stroke_widths: tuple[float, ...] = ()
    red_is_travel: bool = False
    green_is_start: bool = False
    fill: int = 1
    on_delay: float = 0.0
    off_delay: float = 0.0

    def __post_init__(self) -> None:
        if len(self.settings) < 2 or self.settings[0].width != 0:
            raise InputError("a tool needs the raised setting (width 0) first and at least one more")
        if any(setting.width <= 0 for setting in self.settings[1:]):
            raise InputError("every tool setting but the first needs a width above 0")
        if len({setting.name for setting in self.settings}) != len(self.settings):
            raise InputError("two tool settings share a name")
        if self.stroke_widths and len(self.stroke_widths) != len(self.settings) - 2:
            raise InputError(
                f"{len(self.stroke_widths)} stroke widths for {len(self.settings) - 1} marking settings; "
                "expected one less than there are settings"
            )
        if any(b <= a for a, b in zip((0.0, *self.stroke_widths), self.stroke_widths, strict=False)):
            raise InputError("stroke widths must be above 0 and increase")
        if not 1 <= self.fill < len(self.settings):
            raise InputError(f"fill names tool setting {self.fill}; expected 1..{len(self.settings) - 1}")
        for name in ("on_delay", "off_delay"):
            if not 0 <= getattr(self, name) <= MAX_NUMBER:
                raise InputError(f"{name} is {getattr(self, name)} s; expected 0 or more")
        if not (math.isfinite(self.right) and math.isfinite(self.ahead)):
            raise InputError("the tool's place is not finite")

    def setting_for(self, stroke_width: float) -> int:
        """Index of the setting that draws a stroke of this width (drawing units)."""
        return 1 + sum(stroke_width > limit + 1e-9 for limit in self.stroke_widths)


@dataclass(frozen=True)
class DiffDrive:
    """Two driven wheels.

    Parameters
    ----------
    track : distance between the wheels, m
    wheel_radius : m
    wheel_speed, wheel_acceleration : limits of each wheel, rad/s and rad/s^2
    work_speed, transit_speed : driving speeds with the tool down and up, m/s
    turns_on_spot : whether it may stop and turn
    turn_rate : angular speed of such a turn, rad/s
    radius, sharpness : chosen limits, m and 1/m^2; 0 and infinity leave what the wheels allow
    lateral_acceleration : limit of v^2 |kappa|, m/s^2: it tips over or slides beyond
    reverses : whether it may drive backwards
    """

    track: float
    wheel_radius: float
    wheel_speed: float
    wheel_acceleration: float
    work_speed: float
    transit_speed: float
    turns_on_spot: bool = False
    turn_rate: float = 1.0
    radius: float = 0.0
    sharpness: float = math.inf
    lateral_acceleration: float = math.inf
    reverses: bool = False

    def __post_init__(self) -> None:
        _positive(self, "track", "wheel_radius", "wheel_speed", "wheel_acceleration", "work_speed", "transit_speed")
        _positive(self, "turn_rate")
        if not (math.isfinite(self.radius) and self.radius >= 0):
            raise InputError(f"radius is {self.radius} m; expected 0 or more")
        if not self.sharpness > 0:
            raise InputError(f"sharpness is {self.sharpness} 1/m^2; expected more than 0")
        if not self.lateral_acceleration > 0:
            raise InputError(f"lateral_acceleration is {self.lateral_acceleration} m/s^2; expected more than 0")
        rim = self.wheel_speed * self.wheel_radius
        for name in ("work_speed", "transit_speed"):
            if getattr(self, name) > rim:
                raise InputError(f"{name} is {getattr(self, name)} m/s; the wheels reach only {rim:g} m/s")
        if self.turn_rate * self.track / 2 > rim:
            raise InputError(
                f"turn_rate is {self.turn_rate} rad/s; the wheels reach only {2 * rim / self.track:g} rad/s"
            )

    @property
    def acceleration(self) -> float:
        """Limit of the speed's change on a straight line, m/s^2."""
        return self.wheel_acceleration * self.wheel_radius

    @property
    def turn_acceleration(self) -> float:
        """Limit of the angular acceleration when turning on the spot, rad/s^2."""
        return self.acceleration / (self.track / 2)

    def curvature_limits(self, speed: float) -> CurvatureLimits:
        """Limits at a constant speed (m/s).

        The outer wheel runs at v (1 + |kappa| track / 2) and may not pass its limit; at constant speed its acceleration
        is v^2 |dkappa/ds| track / 2. A chosen radius or sharpness tightens what the wheels allow.
        """
        half = self.track / 2
        curvature = (self.wheel_speed * self.wheel_radius / speed - 1) / half
        sharpness = self.acceleration / (half * speed**2)
        if self.radius > 0:
            curvature = min(curvature, 1 / self.radius)
        curvature = min(curvature, self.lateral_acceleration / speed**2)
        return CurvatureLimits(max(curvature, 0.0), min(sharpness, self.sharpness))


class _AnyCurve:
    """What mobilities share that need no heading: they turn without moving, at no cost of time."""

    turns_on_spot = True
    reverses = False
    turn_rate = math.inf
    turn_acceleration = math.inf

    def curvature_limits(self, speed: float) -> CurvatureLimits:
        """None: it follows any curve (`speed` is not used)."""
        return CurvatureLimits(math.inf, math.inf)


@dataclass(frozen=True)
class Gantry(_AnyCurve):
    """Moves along two axes at once and needs no heading: a pen plotter.

    Parameters
    ----------
    work_speed, transit_speed : along the path, m/s
    acceleration : along the path, m/s^2
    """

    work_speed: float
    transit_speed: float
    acceleration: float

    def __post_init__(self) -> None:
        _positive(self, "work_speed", "transit_speed", "acceleration")


@dataclass(frozen=True)
class Boom(_AnyCurve):
    """A boom lift: it stops, works, and moves on.

    Parameters
    ----------
    speeds : limits of the axes (across the wall, up the wall, away from it), m/s
    acceleration : of each axis, m/s^2
    reach : of the arm, m: what it works from one stop is within a sphere of this radius
    dwell : working time of a stop, s
    standoff : of the arm's foot from the wall, m, less than the reach
    """

    speeds: tuple[float, float, float]
    acceleration: float
    reach: float
    dwell: float
    standoff: float = 0.0

    def __post_init__(self) -> None:
        _positive(self, "acceleration", "reach")
        if not all(math.isfinite(v) and v > 0 for v in self.speeds):
            raise InputError(f"speeds are {self.speeds} m/s; expected three numbers above 0")
        if not (math.isfinite(self.dwell) and self.dwell >= 0):
            raise InputError(f"dwell is {self.dwell} s; expected 0 or more")
        if not 0 <= self.standoff < self.reach:
            raise InputError(f"standoff is {self.standoff} m; expected 0 or more, less than the reach {self.reach} m")

    @property
    def radius(self) -> float:
        """Of the circle that its sphere cuts out of a flat wall, m."""
        return math.sqrt(self.reach**2 - self.standoff**2)

    @property
    def work_speed(self) -> float:
        """The slowest axis of the wall's plane, m/s."""
        return min(self.speeds[:2])

    @property
    def transit_speed(self) -> float:
        """The slowest axis of the wall's plane, m/s: reached in every direction."""
        return min(self.speeds[:2])


@dataclass(frozen=True)
class Arm(_AnyCurve):
    """An industrial arm.

    Parameters
    ----------
    work_speed, transit_speed : Cartesian speeds of the tool, m/s
    acceleration : m/s^2
    orientation_rate : limit of the tool's turning, rad/s
    """

    work_speed: float
    transit_speed: float
    acceleration: float
    orientation_rate: float

    def __post_init__(self) -> None:
        _positive(self, "work_speed", "transit_speed", "acceleration", "orientation_rate")


Mobility = DiffDrive | Gantry | Boom | Arm


@dataclass(frozen=True)
class Canvas:
    """Where a drawing goes, lower left corner at the origin.

    Parameters
    ----------
    width, height : m
    margin : nothing is placed closer to the border, m
    """

    width: float
    height: float
    margin: float = 0.0

    def __post_init__(self) -> None:
        _positive(self, "width", "height")
        if not (math.isfinite(self.margin) and self.margin >= 0):
            raise InputError(f"the canvas margin is {self.margin} m; expected 0 or more")
        if 2 * self.margin >= min(self.width, self.height):
            raise InputError(
                f"a canvas of {self.width:g} x {self.height:g} m is smaller than its margin of {self.margin:g} m "
                "on every side; expected room in the middle"
            )


@dataclass(frozen=True)
class Supplies:
    """What a robot uses up: an estimate needs no more.

    Parameters
    ----------
    name : of what the tool gives: "paint", "water"; "" when it gives nothing
    per_area : m^3 of it a m^2 of marks
    flow : m^3/s of it while the tool works
    tank : m^3 of it that the robot carries; infinite when it need not
    power : W from the battery, on average
    battery : J of a full charge; infinite when it need not be charged
    """

    name: str = ""
    per_area: float = 0.0
    flow: float = 0.0
    tank: float = math.inf
    power: float = 0.0
    battery: float = math.inf

    def __post_init__(self) -> None:
        for name in ("per_area", "flow", "power"):
            if not 0 <= getattr(self, name) <= MAX_NUMBER:
                raise InputError(f"{name} is {getattr(self, name)}; expected a finite number, 0 or more")
        for name in ("tank", "battery"):
            if not getattr(self, name) > 0:
                raise InputError(f"{name} is {getattr(self, name)}; expected more than 0")
        if (self.per_area > 0 or self.flow > 0) and not self.name:
            raise InputError("what the tool gives has no name; expected one, such as 'paint'")


@dataclass(frozen=True)
class Robot:
    """A tool on a mobility, with the canvas it is usually given.

    Parameters
    ----------
    name, summary : for people
    tool, mobility : see there
    canvas : where drawings go unless the user says otherwise; None keeps a drawing's own size
    sources : where each number comes from: {"mobility.track": "measured"}; numbers that somebody just chose say so
    supplies : what it uses up, or None when nobody knows
    """

    name: str
    summary: str
    tool: Tool
    mobility: Mobility
    canvas: Canvas | None = None
    sources: tuple[tuple[str, str], ...] = ()
    supplies: Supplies | None = None

    @property
    def offset(self) -> ToolPlace:
        """Where the tool sits in the robot's frame; in the middle for robots that need no heading."""
        if isinstance(self.mobility, DiffDrive):
            return ToolPlace(self.tool.right, self.tool.ahead)
        return MIDDLE

    @property
    def heading_counts(self) -> bool:
        """Whether a move's length depends on headings: a robot that cannot turn on the spot."""
        return not self.mobility.turns_on_spot


def _positive(owner: object, *names: str) -> None:
    for name in names:
        value = getattr(owner, name)
        if not (math.isfinite(value) and value > 0):
            raise InputError(f"{name} is {value}; expected a finite number above 0")
        if value < 1 / MAX_NUMBER:  # its square would be lost
            raise InputError(f"{name} is {value}; expected at least {1 / MAX_NUMBER:g}")
