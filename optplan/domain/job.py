"""The four jobs: a drawing, a sports field, a facade, a surface."""

from __future__ import annotations

import math
from dataclasses import dataclass, replace
from enum import StrEnum
from typing import NamedTuple

import numpy as np

from optplan.domain.arrays import FloatArray, frozen_floats
from optplan.domain.errors import InputError, LimitError
from optplan.domain.facade import Facade as Facade


class Note(NamedTuple):
    """A line of the load report: something that was changed, ignored or is worth knowing."""

    kind: str
    """ "ignored", "changed" or "notice" """
    place: str
    text: str
    times: int = 1


class FillRule(StrEnum):
    """How overlapping rings make an area (SVG's fill-rule)."""

    NONZERO = "nonzero"
    EVENODD = "evenodd"


@dataclass(frozen=True)
class FillSettings:
    """How one area is filled; None leaves it to the options of the plan.

    Parameters
    ----------
    direction : of the lines, rad from the x axis
    spacing : between the lines, m
    inset : of the lines from the outline, m
    """

    direction: float | None = None
    spacing: float | None = None
    inset: float | None = None

    def __post_init__(self) -> None:
        if self.direction is not None and not math.isfinite(self.direction):
            raise InputError(f"the fill direction is {self.direction}; expected a finite angle")
        if self.spacing is not None and not (math.isfinite(self.spacing) and self.spacing > 0):
            raise InputError(f"the fill spacing is {self.spacing} m; expected more than 0")
        if self.inset is not None and not (math.isfinite(self.inset) and self.inset >= 0):
            raise InputError(f"the fill inset is {self.inset} m; expected 0 or more")


@dataclass(frozen=True, eq=False)
class Curve:
    """A chain of straight lines or cubic Beziers.

    Parameters
    ----------
    points : (n, 2) m, the vertices; a closed curve does not repeat its first
    handles : (k, 2, 2) m, the two inner control points of each of the k segments (n - 1 open, n closed), or None for
        straight lines
    closed : whether the last vertex joins the first
    """

    points: FloatArray
    handles: FloatArray | None = None
    closed: bool = False

    def __post_init__(self) -> None:
        object.__setattr__(self, "points", frozen_floats(self.points, "curve points", (None, 2)))
        if len(self.points) < 2:
            raise InputError(f"a curve has {len(self.points)} points; expected at least 2")
        if self.handles is not None:
            count = len(self.points) if self.closed else len(self.points) - 1
            object.__setattr__(self, "handles", frozen_floats(self.handles, "curve handles", (count, 2, 2)))


@dataclass(frozen=True, eq=False)
class Element:
    """One element of a drawing, as it was drawn; what its style means is decided when it is covered.

    Parameters
    ----------
    id : unique in the drawing, the same each time the file is read
    curves : its subpaths
    stroke, fill : colours as "#rrggbb", or None for none
    stroke_width : drawing units, transforms counted
    fill_rule : which rings make the area
    fill_settings : how to fill it
    entry : drawn vertex, counted from 0, where it must be entered, or None
    layer : name of the layer it is on, "" for none
    """

    id: str
    curves: tuple[Curve, ...]
    stroke: str | None
    fill: str | None
    stroke_width: float = 1.0
    fill_rule: FillRule = FillRule.NONZERO
    fill_settings: FillSettings = FillSettings()
    entry: int | None = None
    layer: str = ""

    def __post_init__(self) -> None:
        if not (math.isfinite(self.stroke_width) and self.stroke_width >= 0):
            raise InputError(f"element {self.id!r} has a stroke width of {self.stroke_width}; expected 0 or more")


@dataclass(frozen=True, eq=False)
class Drawing:
    """A drawing, in metres as printed on paper, x to the right and y up.

    Parameters
    ----------
    name : for people
    elements : in document order
    unit : metres of one drawing unit (SVG user unit)
    page : width and height of the page, m, or None
    notes : the load report
    """

    name: str
    elements: tuple[Element, ...]
    unit: float = 0.0254 / 96
    page: tuple[float, float] | None = None
    notes: tuple[Note, ...] = ()

    def __post_init__(self) -> None:
        if not (math.isfinite(self.unit) and self.unit > 0):
            raise InputError(f"a drawing unit is {self.unit} m; expected a finite number above 0")
        seen: set[str] = set()
        for element in self.elements:
            if element.id in seen:
                raise InputError(f"two elements are called {element.id!r}; expected ids that differ")
            seen.add(element.id)

    def with_element(self, id: str, *, fill_settings: FillSettings | None = None, entry: int | None = None) -> Drawing:
        """The same drawing with other settings of one element. Raises InputError when there is no such element."""
        if all(element.id != id for element in self.elements):
            raise InputError(
                f"there is no element {id!r}; expected one of {', '.join(e.id for e in self.elements[:20])}"
            )

        def changed(element: Element) -> Element:
            if element.id != id:
                return element
            settings = element.fill_settings if fill_settings is None else fill_settings
            return replace(element, fill_settings=settings, entry=element.entry if entry is None else entry)

        return replace(self, elements=tuple(map(changed, self.elements)))


MOST_PASSES = 20
"""Of one segment."""


MOST_NORTH = 85.0
"""Degrees from the equator: nearer to a pole, east and north mean little."""


class Anchor(NamedTuple):
    """Where on earth the origin of a field lies (WGS 84)."""

    latitude: float
    """degrees"""
    longitude: float
    """degrees"""
    bearing: float
    """degrees clockwise from north in which the field's y axis points"""


def check_anchor(anchor: Anchor) -> None:
    """InputError for what is no place on earth, or no bearing."""
    good = abs(anchor.latitude) <= MOST_NORTH and abs(anchor.longitude) <= 180 and abs(anchor.bearing) <= 360
    if not good:
        raise InputError(
            f"({anchor.latitude}, {anchor.longitude}), bearing {anchor.bearing} is no place; "
            f"expected -{MOST_NORTH:g}..{MOST_NORTH:g} degrees north, -180..180 east, and a bearing of -360..360"
        )


ACTUATIONS = {"NONE": 0, "PUMP": 1, "VALVE": 2, "SPRAY": 3, "DISC": 4, "ALL": 7}
"""What a marking robot can switch on, with the numbers of its messages."""
MOST_METRES = 1e6
"""Farthest that anything of a field lies from its origin along an axis, and its widest mark, m."""
MOST_SEGMENTS = 20_000
"""Of a field."""
SAME_PLACE = 1e-6
"""m within which two given places are one."""


@dataclass(frozen=True, eq=False)
class FieldSegment:
    """A line, an arc or a spot to mark.

    Parameters
    ----------
    id, label : of the segment; ids are unique in the field
    start, end : (2,) m; a spot has both in its middle
    center : (2,) m of an arc, None for anything else
    sweep : signed angle of the arc, rad, left positive, at most a full turn; 0 for anything else
    spot : diameter of a spot, m; 0 for anything else
    actuation : one of `ACTUATIONS`; "NONE" is not marked
    width : of the mark, m; None: as wide as the tool
    passes : how often it is marked
    directed : only from start to end

    Raises
    ------
    InputError : anything of that violated, naming the segment
    """

    id: str
    start: FloatArray
    end: FloatArray
    center: FloatArray | None = None
    sweep: float = 0.0
    spot: float = 0.0
    actuation: str = "ALL"
    width: float | None = None
    passes: int = 1
    directed: bool = False
    label: str = ""

    def __post_init__(self) -> None:
        what = f"segment {self.id!r}"
        for name in ("start", "end", "center"):
            value = getattr(self, name)
            if value is not None:
                object.__setattr__(self, name, frozen_floats(value, f"{what}: {name}", (2,)))
                _near(getattr(self, name), f"{what}: {name}")
        if not math.isfinite(self.sweep):
            raise InputError(f"{what}: the sweep is {self.sweep} rad; expected a finite angle")
        if self.actuation not in ACTUATIONS:
            raise InputError(f"{what}: the actuation is {self.actuation!r}; expected one of {', '.join(ACTUATIONS)}")
        if not 0 <= self.spot <= MOST_METRES:
            raise InputError(f"{what}: the spot's diameter is {self.spot} m; expected 0..{MOST_METRES:g} m")
        if self.width is not None and not 0 < self.width <= MOST_METRES:
            raise InputError(f"{what}: the width is {self.width} m; expected more than 0, at most {MOST_METRES:g} m")
        if isinstance(self.passes, bool) or not 1 <= self.passes <= MOST_PASSES:
            raise InputError(f"{what}: {self.passes} passes; expected 1..{MOST_PASSES}")
        if (self.center is None) != (self.sweep == 0):
            raise InputError(f"{what}: an arc has a centre and a sweep, a line and a spot have neither")
        apart = float(np.linalg.norm(self.end - self.start))
        if self.center is not None:
            self._check_arc(what, self.center)
        elif self.spot > 0:
            if apart > SAME_PLACE:
                raise InputError(f"{what}: a spot starts and ends {apart:g} m apart; expected one place")
        elif apart <= SAME_PLACE:
            raise InputError(f"{what}: start and end coincide; expected a line, or the diameter of a spot")

    def _check_arc(self, what: str, center: FloatArray) -> None:
        radii = [float(np.linalg.norm(point - center)) for point in (self.start, self.end)]
        if self.spot > 0:
            raise InputError(f"{what}: is both an arc and a spot; expected one of them")
        if radii[0] <= SAME_PLACE:
            raise InputError(f"{what}: the radius is {radii[0]:g} m; expected more than 0")
        if abs(radii[0] - radii[1]) > 1e-6 * max(radii) + SAME_PLACE:
            raise InputError(
                f"{what}: start and end are {radii[0]:g} and {radii[1]:g} m from the centre; expected one radius"
            )
        if abs(self.sweep) > 2 * math.pi * (1 + 1e-9):
            raise InputError(f"{what}: sweeps {math.degrees(self.sweep):g} degrees; expected a turn, 360, at most")
        missed = float(np.linalg.norm(turned(self.start, center, self.sweep) - self.end))
        if missed > 1e-6 * radii[0] + SAME_PLACE:
            raise InputError(
                f"{what}: the sweep ends {missed:g} m away from the end; expected start, sweep and end to fit"
            )

    @property
    def radius(self) -> float:
        """Of an arc, m; infinite for a line, 0 for a spot."""
        if self.center is None:
            return 0.0 if self.spot > 0 else math.inf
        return float(np.linalg.norm(self.start - self.center))

    @property
    def length(self) -> float:
        """m; of a spot, its diameter"""
        if self.center is not None:
            return abs(self.sweep) * self.radius
        return self.spot or float(np.linalg.norm(self.end - self.start))

    @property
    def closed(self) -> bool:
        """Whether it is a full circle."""
        return abs(self.sweep) >= 2 * math.pi * (1 - 1e-9)


def _near(points: FloatArray, what: str) -> None:
    """InputError for places (..., 2) that are farther away than any field reaches."""
    if points.size and np.abs(points).max() > MOST_METRES:
        raise InputError(f"{what} is {np.abs(points).max():g} m away; expected at most {MOST_METRES:g} m")


def turned(point: FloatArray, center: FloatArray, angle: float) -> FloatArray:
    """A point (2,) turned about a centre by an angle, rad."""
    cosine, sine = math.cos(angle), math.sin(angle)
    made: FloatArray = center + np.array([[cosine, -sine], [sine, cosine]]) @ (point - center)
    return made


@dataclass(frozen=True, eq=False)
class Field:
    """A sports field to mark.

    Parameters
    ----------
    name : for people
    segments : what to mark, in the order in which people would
    keep_in : (n, 2) m polygon that the robot stays in, or None
    keep_out : polygons (n, 2) m that it stays out of
    start : (x, y) m where the robot stands, or None
    line_width : of all segments that do not state their own, m; None: as wide as the tool
    anchor : where on earth it lies, or None

    Raises
    ------
    InputError : two segments of one id, no segments or more than `MOST_SEGMENTS`, places out of reach, an anchor
        that is no place on earth
    """

    name: str
    segments: tuple[FieldSegment, ...]
    keep_in: FloatArray | None = None
    keep_out: tuple[FloatArray, ...] = ()
    notes: tuple[Note, ...] = ()
    start: tuple[float, float] | None = None
    line_width: float | None = None
    anchor: Anchor | None = None

    def __post_init__(self) -> None:
        given: object = self.segments
        segments = tuple(given) if isinstance(given, tuple | list) else ()
        if not segments or not all(isinstance(segment, FieldSegment) for segment in segments):
            raise InputError(f"the segments are {self.segments!r:.60}; expected one FieldSegment or more")
        if len(segments) > MOST_SEGMENTS:
            raise LimitError(f"there are {len(segments)} segments; expected at most {MOST_SEGMENTS}")
        object.__setattr__(self, "segments", segments)
        seen: set[str] = set()
        for segment in self.segments:
            if segment.id in seen:
                raise InputError(f"two segments are called {segment.id!r}; expected ids that differ")
            seen.add(segment.id)
        if self.keep_in is not None:
            object.__setattr__(self, "keep_in", frozen_floats(self.keep_in, "keep_in", (None, 2)))
        object.__setattr__(self, "keep_out", tuple(frozen_floats(p, "keep_out", (None, 2)) for p in self.keep_out))
        polygons = [("keep_in", self.keep_in), *((f"keep_out[{k}]", ring) for k, ring in enumerate(self.keep_out))]
        for name, points in polygons:
            if points is not None:
                if len(points) < 3:
                    raise InputError(f"{name} has {len(points)} corners; expected 3 or more")
                _near(points, name)
        if self.line_width is not None and not 0 < self.line_width <= MOST_METRES:
            raise InputError(f"the line width is {self.line_width} m; expected more than 0, at most {MOST_METRES:g} m")
        if self.start is not None:
            _near(frozen_floats(self.start, "the start", (2,)), "the start")
        if self.anchor is not None:
            check_anchor(self.anchor)


@dataclass(frozen=True, eq=False)
class Surface:
    """A recorded surface to grind.

    Parameters
    ----------
    name : for people
    points : (n, 3) m, recorded with the tool
    tool_axes : (n, 3) unit vectors along the tool at each point, out of the surface, or None
    disc_radius : m
    """

    name: str
    points: FloatArray
    tool_axes: FloatArray | None = None
    disc_radius: float = 0.02
    notes: tuple[Note, ...] = ()

    def __post_init__(self) -> None:
        object.__setattr__(self, "points", frozen_floats(self.points, "points", (None, 3)))
        if self.tool_axes is not None:
            axes = frozen_floats(self.tool_axes, "tool_axes", (len(self.points), 3))
            if not np.allclose(np.linalg.norm(axes, axis=1), 1, atol=1e-6):
                raise InputError("tool_axes are not all of unit length")
            object.__setattr__(self, "tool_axes", axes)
        if not (math.isfinite(self.disc_radius) and self.disc_radius > 0):
            raise InputError(f"the disc radius is {self.disc_radius} m; expected a finite number above 0")


Job = Drawing | Field | Facade | Surface
