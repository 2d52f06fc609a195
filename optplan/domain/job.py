"""The four jobs: a drawing, a sports field, a facade, a surface."""

from __future__ import annotations

import math
from dataclasses import dataclass, replace
from enum import StrEnum
from typing import NamedTuple

import numpy as np

from optplan.domain.arrays import FloatArray, frozen_floats
from optplan.domain.errors import InputError
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


@dataclass(frozen=True, eq=False)
class FieldSegment:
    """A line or an arc to mark.

    Parameters
    ----------
    id, label : of the segment
    start, end : (2,) m
    center : (2,) m of an arc, None for a line
    sweep : signed angle of the arc, rad, left positive; 0 for a line
    tool : index of the tool setting; 0 drives without marking
    """

    id: str
    start: FloatArray
    end: FloatArray
    center: FloatArray | None = None
    sweep: float = 0.0
    tool: int = 1
    label: str = ""

    def __post_init__(self) -> None:
        for name in ("start", "end", "center"):
            value = getattr(self, name)
            if value is not None:
                object.__setattr__(self, name, frozen_floats(value, f"segment {self.id!r} {name}", (2,)))
        if not math.isfinite(self.sweep):
            raise InputError(f"segment {self.id!r}: the sweep is {self.sweep} rad; expected a finite angle")
        if (self.center is None) != (self.sweep == 0):
            raise InputError(f"segment {self.id!r}: an arc has a centre and a sweep, a line neither")
        if self.center is not None:
            radii = [float(np.linalg.norm(point - self.center)) for point in (self.start, self.end)]
            if abs(radii[0] - radii[1]) > 1e-6 * max(radii) + 1e-9:
                raise InputError(
                    f"segment {self.id!r}: start and end are {radii} m from the centre; expected one radius"
                )


@dataclass(frozen=True, eq=False)
class Field:
    """A sports field to mark.

    Parameters
    ----------
    name : for people
    segments : what to mark
    keep_in : (n, 2) m polygon that the robot stays in, or None
    keep_out : polygons (n, 2) m that it stays out of
    """

    name: str
    segments: tuple[FieldSegment, ...]
    keep_in: FloatArray | None = None
    keep_out: tuple[FloatArray, ...] = ()
    notes: tuple[Note, ...] = ()

    def __post_init__(self) -> None:
        if self.keep_in is not None:
            object.__setattr__(self, "keep_in", frozen_floats(self.keep_in, "keep_in", (None, 2)))
        object.__setattr__(self, "keep_out", tuple(frozen_floats(p, "keep_out", (None, 2)) for p in self.keep_out))


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
