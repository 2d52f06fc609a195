"""The settings of a plan, a group for each stage. None leaves a choice to the robot or the program."""

from __future__ import annotations

import math
from dataclasses import dataclass, field

from optplan.domain.arrays import MAX_NUMBER
from optplan.domain.errors import InputError
from optplan.domain.job import FillSettings
from optplan.domain.robot import Mobility
from optplan.domain.washing import WashOptions

METRICS = ("auto", "euclid", "dubins", "cc", "time")
KEEP = ("nothing", "order", "all")

Link = tuple[str, int, str, int]
"""An enforced connection: stroke and its drawn vertex, counted from 0 (-1: the last), twice."""


@dataclass(frozen=True)
class PageOptions:
    """How a drawing is put on its canvas.

    Parameters
    ----------
    width, height, margin : of the canvas, m; None takes the robot's canvas; with neither the drawing keeps its size
    tolerance : greatest distance between a drawn curve and its polyline, m; None: a twentieth of the narrowest mark
    """

    width: float | None = None
    height: float | None = None
    margin: float | None = None
    tolerance: float | None = None

    def __post_init__(self) -> None:
        _above_zero("page", width=self.width, height=self.height, tolerance=self.tolerance)
        if self.margin is not None and not (math.isfinite(self.margin) and self.margin >= 0):
            raise InputError(f"page margin is {self.margin} m; expected 0 or more")


@dataclass(frozen=True)
class CoverOptions:
    """How areas are filled and lines are prepared.

    Parameters
    ----------
    direction : of the fill lines, rad from the x axis
    spacing : between fill lines, m; None: the width of the tool
    inset : of the lines from the outline, m; None: what fits the boundary, or half the width of the tool without one
    boundary : whether the outline, half a tool width inside, is driven too: it gives areas a crisp edge
    elements : settings of single elements, by id; they win over the ones above
    inner_first : whether whatever a closed line encloses is driven before it
    links : connections that have to be driven, one stroke directly after the other
    cut : whether lines of a field may be left and entered where others meet them
    headings : directions in which a spot of a field may be driven
    """

    direction: float = 0.0
    spacing: float | None = None
    inset: float | None = None
    boundary: bool = True
    elements: tuple[tuple[str, FillSettings], ...] = ()
    inner_first: bool = False
    links: tuple[Link, ...] = ()
    cut: bool = True
    headings: int = 8

    def __post_init__(self) -> None:
        _whole("cover", headings=self.headings)
        if not 1 <= self.headings <= 360:
            raise InputError(f"cover headings is {self.headings}; expected 1..360")
        FillSettings(self.direction, self.spacing, self.inset)


@dataclass(frozen=True)
class OrderOptions:
    """How the strokes are ordered.

    Parameters
    ----------
    solver : a name from `optplan.ordering.SOLVERS`, or "auto"
    metric : "euclid", "dubins", "cc" (continuous curvature), "time" (s, on facades), or "auto": what the robot's
        mobility asks for
    seconds, iterations : stop rule; None sets no limit beyond the solver's own
    seed : of everything random
    start : (x, y) m where the robot stands, or None for the drawing's own start point, or a free choice
    entries : greatest number of vertices at which a closed stroke may be entered; None: every vertex, or 16 where
        headings count
    avoid : m between strokes that are worth a metre not driven over finished work; 0: finished work is no matter
    heading : rad, where the robot faces at the start; None: it is set down as it suits
    drying : s after which finished work may be driven over; None: never
    keep : "order": strokes are driven in the order of the job; "all": and each from its first point to its last;
        "nothing"
    refill : m of marks that a tank lasts, after which it is filled again at the start point; None: no stops for that
    refill_time : s that filling takes
    """

    solver: str = "auto"
    metric: str = "auto"
    seconds: float | None = None
    iterations: int | None = None
    seed: int = 0
    start: tuple[float, float] | None = None
    entries: int | None = None
    avoid: float = 0.0
    heading: float | None = None
    drying: float | None = None
    keep: str = "nothing"
    refill: float | None = None
    refill_time: float = 120.0

    def __post_init__(self) -> None:
        if isinstance(self.avoid, bool) or not 0 <= self.avoid <= MAX_NUMBER:
            raise InputError(f"order avoid is {self.avoid}; expected a number from 0 to {MAX_NUMBER:g}")
        if self.metric not in METRICS:
            raise InputError(f"there is no metric {self.metric!r}; expected one of {', '.join(METRICS)}")
        if self.keep not in KEEP:
            raise InputError(f"order keep is {self.keep!r}; expected one of {', '.join(KEEP)}")
        _above_zero("order", seconds=self.seconds, drying=self.drying, refill=self.refill)
        if isinstance(self.refill_time, bool) or not 0 <= self.refill_time <= MAX_NUMBER:
            raise InputError(f"order refill_time is {self.refill_time} s; expected 0 to {MAX_NUMBER:g}")
        _whole("order", iterations=self.iterations, seed=self.seed, entries=self.entries)
        if self.iterations is not None and not 0 <= self.iterations < 2**62:
            raise InputError(f"order iterations is {self.iterations}; expected 0..2^62 - 1")
        if not 0 <= self.seed < 2**31:
            raise InputError(f"order seed is {self.seed}; expected 0..2^31 - 1")
        if self.start is not None and (
            len(tuple(self.start)) != 2 or not all(abs(x) <= MAX_NUMBER for x in self.start)
        ):
            raise InputError(f"order start is {self.start}; expected two numbers of metres, at most {MAX_NUMBER:g}")
        if self.heading is not None:
            if self.start is None:
                raise InputError("order heading says where the robot faces, but there is no start; expected both")
            if isinstance(self.heading, bool) or not abs(self.heading) <= MAX_NUMBER:
                raise InputError(f"order heading is {self.heading}; expected a finite number of radians")
        if self.entries is not None and self.entries < 1:
            raise InputError(f"order entries is {self.entries}; expected 1 or more")


Polygon = tuple[tuple[float, float], ...]


@dataclass(frozen=True)
class ConnectOptions:
    """How strokes are driven and joined.

    Parameters
    ----------
    corner : deflection above which a vertex of a stroke is a corner, rad: the robot stops there and turns, or, when it
        cannot, the stroke is split. Gentler vertices are rounded within the page tolerance.
    keep_out : polygons of (x, y) m that connectors do not enter
    keep_in : a polygon of (x, y) m that connectors do not leave
    on_canvas : whether connectors stay on the canvas
    clearance : between connectors and the borders of all of these, m
    reversing : whether connectors may be driven backwards, by a robot that can; strokes are driven forwards
    pad_before, pad_after : m driven with the tool up in the direction of a stroke, before and after it, as older
        planners have it: to compare with
    curved_padding : whether padding goes on with the curvature of the stroke's end; else it is straight
    """

    corner: float = math.radians(30)
    keep_out: tuple[Polygon, ...] = ()
    keep_in: Polygon | None = None
    on_canvas: bool = False
    clearance: float = 0.0
    reversing: bool = False
    pad_before: float = 0.0
    pad_after: float = 0.0
    curved_padding: bool = False

    def __post_init__(self) -> None:
        for side in ("pad_before", "pad_after"):
            if isinstance(getattr(self, side), bool) or not 0 <= getattr(self, side) <= MAX_NUMBER:
                raise InputError(f"connect {side} is {getattr(self, side)} m; expected 0 to {MAX_NUMBER:g}")
        if not isinstance(self.curved_padding, bool):
            raise InputError(f"curved_padding is {self.curved_padding!r}; expected true or false")
        if not 0 < self.corner <= math.pi:
            raise InputError(f"corner is {self.corner} rad; expected more than 0 and at most pi")
        if isinstance(self.clearance, bool) or not 0 <= self.clearance <= MAX_NUMBER:
            raise InputError(f"the clearance is {self.clearance} m; expected 0 to {MAX_NUMBER:g}")
        if not isinstance(self.reversing, bool):
            raise InputError(f"reversing is {self.reversing!r}; expected true or false")
        named = [(f"keep-out polygon {k}", ring) for k, ring in enumerate(self.keep_out)]
        for name, ring in [*named, *([("the keep-in polygon", self.keep_in)] if self.keep_in is not None else [])]:
            if len(ring) < 3:
                raise InputError(f"{name} has {len(ring)} vertices; expected 3 or more")
            if not all(abs(x) <= MAX_NUMBER for place in ring for x in place):
                raise InputError(f"{name} has a vertex that is no place; expected x, y in m, at most {MAX_NUMBER:g}")

    @property
    def padding(self) -> float:
        """Of one stroke, m."""
        return self.pad_before + self.pad_after


@dataclass(frozen=True)
class TimeOptions:
    """How fast the path is driven.

    Parameters
    ----------
    work_speed, transit_speed : m/s with the tool down and up; None takes the robot's
    jerk : limit of the change of the acceleration along the path, m/s^3
    power : limit of acceleration times speed, W/kg
    constant_speed : m/s everywhere, from the first metre to the last, as older planners have it: to compare with, as
        no robot drives so
    """

    work_speed: float | None = None
    transit_speed: float | None = None
    jerk: float | None = None
    power: float | None = None
    constant_speed: float | None = None

    def __post_init__(self) -> None:
        _above_zero("time", work_speed=self.work_speed, transit_speed=self.transit_speed)
        _above_zero("time", jerk=self.jerk, power=self.power, constant_speed=self.constant_speed)
        others = (self.work_speed, self.transit_speed, self.jerk, self.power)
        if self.constant_speed is not None and any(limit is not None for limit in others):
            raise InputError("time constant_speed excludes the other limits of speed; expected it alone")

    def speeds(self, mobility: Mobility) -> tuple[float, float]:
        """Limits of speed with the tool down and up, m/s."""
        if self.constant_speed is not None:
            return self.constant_speed, self.constant_speed
        return self.work_speed or mobility.work_speed, self.transit_speed or mobility.transit_speed


@dataclass(frozen=True)
class Options:
    """All settings of a plan."""

    page: PageOptions = field(default_factory=PageOptions)
    cover: CoverOptions = field(default_factory=CoverOptions)
    order: OrderOptions = field(default_factory=OrderOptions)
    connect: ConnectOptions = field(default_factory=ConnectOptions)
    time: TimeOptions = field(default_factory=TimeOptions)
    wash: WashOptions = field(default_factory=WashOptions)


def _whole(group: str, **values: int | None) -> None:
    for name, value in values.items():
        if value is not None and (isinstance(value, bool) or not isinstance(value, int)):
            raise InputError(f"{group} {name} is {value!r}; expected a whole number")


def _above_zero(group: str, **values: float | None) -> None:
    for name, value in values.items():
        if value is None:
            continue
        if isinstance(value, bool) or not isinstance(value, int | float):
            raise InputError(f"{group} {name} is {value!r}; expected a number of SI units")
        if not (math.isfinite(value) and value > 0):
            raise InputError(f"{group} {name} is {value}; expected a finite number above 0")
        if value < 1 / MAX_NUMBER:  # its square would be lost
            raise InputError(f"{group} {name} is {value}; expected at least {1 / MAX_NUMBER:g}")
