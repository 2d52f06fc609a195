"""The drawing syntax: what a robot's tool makes of the colours and widths of a drawing."""

from __future__ import annotations

from dataclasses import dataclass

from optplan.domain.arrays import FloatArray
from optplan.domain.job import Drawing, Element, Note
from optplan.domain.robot import Tool


@dataclass(frozen=True, eq=False)
class Mark:
    """What the robot does with one element.

    Parameters
    ----------
    element : of the drawing
    outline : tool setting that draws its outline; 0 travels along it with the tool raised, None leaves it out
    fill : whether its area is to be filled
    start : whether it only says where the robot starts
    layer : the drawing's layer; where colours mean nothing else, the colour it has when it is on none
    """

    element: Element
    outline: int | None
    fill: bool
    start: bool
    layer: str

    @property
    def drawn(self) -> bool:
        """Whether the robot does anything at all with it."""
        return self.outline is not None or self.fill


@dataclass(frozen=True, eq=False)
class Marked:
    """A drawing as a tool understands it.

    Parameters
    ----------
    marks : one for each element, in the same order
    start : (2,) m, where the robot starts, or None when the drawing leaves that open
    notes : what is worth knowing about it
    """

    marks: tuple[Mark, ...]
    start: FloatArray | None
    notes: tuple[Note, ...]


def is_white(color: str) -> bool:
    """Whether a colour is white or next to it."""
    return all(level >= 250 for level in _levels(color))


def is_red(color: str) -> bool:
    """Whether a colour is pure red, give or take what a colour chooser does."""
    red, green, blue = _levels(color)
    return red >= 200 and green <= 60 and blue <= 60


def is_green(color: str) -> bool:
    """Whether a colour is pure green, light ("lime") or dark ("green")."""
    red, green, blue = _levels(color)
    return green >= 120 and red <= 60 and blue <= 60


def interpret(drawing: Drawing, tool: Tool) -> Marked:
    """What the robot does with each element.

    A stroke's width picks the tool setting. Where the tool declares it, red strokes are travel drawn by hand and the
    last point of a green one is the start; a start line is never filled. White or no stroke is not drawn. A fill other
    than white or none asks for the area to be filled. Where neither red nor green means anything, colours are layers.
    """
    notes: list[Note] = []
    marks = tuple(_mark(element, tool, notes) for element in drawing.elements)
    lines = [mark.element for mark in marks if mark.start]
    if len(lines) > 1:
        others = ", ".join(line.id for line in lines[:-1][:5])
        notes.append(
            Note("notice", lines[-1].id, f"several start lines: the last one counts, not {others}", len(lines))
        )
    return Marked(marks, _last_point(lines[-1]) if lines else None, tuple(notes))


def _mark(element: Element, tool: Tool, notes: list[Note]) -> Mark:
    stroke, fill = element.stroke, element.fill
    layer = element.layer
    if not (layer or tool.red_is_travel or tool.green_is_start):
        layer = stroke or fill or ""
    if stroke is not None and tool.green_is_start and is_green(stroke):
        if fill is not None and not (is_green(fill) or is_white(fill)):
            notes.append(Note("ignored", element.id, f"fill {fill} of a start line"))
        return Mark(element, None, False, True, layer)
    filled = fill is not None and not is_white(fill)
    outline = None
    if stroke is not None and is_white(stroke):
        if not filled:
            notes.append(Note("notice", element.id, "white stroke: not drawn"))
    elif stroke is not None:
        travel = tool.red_is_travel and is_red(stroke)
        outline = 0 if travel else tool.setting_for(element.stroke_width)
    if fill is not None and is_white(fill):
        notes.append(Note("notice", element.id, "white area: not drawn, and not cut out of what lies below it"))
    return Mark(element, outline, filled, False, layer)


def _last_point(element: Element) -> FloatArray:
    curve = element.curves[-1]
    place: FloatArray = curve.points[0 if curve.closed else -1]
    return place


def _levels(color: str) -> tuple[int, int, int]:
    return int(color[1:3], 16), int(color[3:5], 16), int(color[5:7], 16)
