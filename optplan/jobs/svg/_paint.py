"""From computed paint to a plain colour: what one tool can draw."""

from __future__ import annotations

from lxml import etree

from optplan.jobs.svg._census import XLINK, is_element
from optplan.jobs.svg._color import MAX_PAINT_CHARS, Paint, parse_paint
from optplan.jobs.svg._report import Report, local_name
from optplan.jobs.svg._sheet import inline_declarations
from optplan.jobs.svg._style import Style

STAND_IN = "#808080"
"""colour of gradients and patterns"""
_MAX_CHAIN = 20
_MAX_STOPS = 1000


class Painter:
    """Resolves paint.

    Parameters
    ----------
    targets : elements by id
    report : is told what is drawn in another colour
    """

    def __init__(self, targets: dict[str, etree._Element], report: Report) -> None:
        self._targets, self._report = targets, report
        self._swatches: dict[str, str | None] = {}

    def stroke(self, style: Style, place: str) -> str | None:
        """Colour of the stroke as "#rrggbb", None for none."""
        return self._color(style.stroke, style.stroke_opacity, style.color, place)

    def fill(self, style: Style, place: str) -> str | None:
        """Colour of the area as "#rrggbb", None for none."""
        return self._color(style.fill, style.fill_opacity, style.color, place)

    def _color(self, paint: Paint, opacity: float, current: Paint, place: str) -> str | None:
        if paint.kind == "none":
            return None
        if paint.kind == "reference":
            paint = self._referenced(paint, place)
            if paint.kind == "none":
                return None
        if paint.kind == "current":
            paint = current
        if paint.kind == "context":
            self._report.add("changed", f"paint taken from a marker or copy: drawn in {STAND_IN}", place)
            return STAND_IN
        alpha = paint.alpha * opacity
        if alpha == 0:
            self._report.add("ignored", "stroke or fill that is fully transparent", place)
            return None
        if alpha < 1:
            self._report.add("changed", "half-transparent: drawn opaque", place)
        return paint.color

    def _referenced(self, paint: Paint, place: str) -> Paint:
        target = self._targets.get(paint.reference)
        if target is None:
            if paint.fallback is not None:
                self._report.add("changed", "paint that is not in the file: its fallback is used", place)
                return paint.fallback
            self._report.add("ignored", "paint that is not in the file", place)
            return Paint("none")
        if paint.reference not in self._swatches:
            self._swatches[paint.reference] = self._swatch(target)
        color = self._swatches[paint.reference]
        if color is None:
            color = STAND_IN
            self._report.add("changed", f"gradient or pattern drawn in {STAND_IN}", place)
        return Paint("color", color)

    def _swatch(self, target: etree._Element) -> str | None:
        """The colour of a gradient whose stops are all one colour, as drawing programs keep named colours."""
        for _ in range(_MAX_CHAIN):
            if local_name(target) not in ("linearGradient", "radialGradient"):
                return None
            stops = [child for child in target if is_element(child) and local_name(child) == "stop"]
            if stops:
                colors = {_stop_color(stop) for stop in stops[:_MAX_STOPS]}
                return colors.pop() if len(colors) == 1 and len(stops) <= _MAX_STOPS else None
            link = str(target.get("href") or target.get(f"{{{XLINK}}}href") or "")
            further = self._targets.get(link[1:]) if link.startswith("#") else None
            if further is None:
                return None
            target = further
        return None


def _stop_color(stop: etree._Element) -> str | None:
    text = str(stop.get("stop-color", "#000000"))
    for declaration in inline_declarations(str(stop.get("style", ""))[:MAX_PAINT_CHARS]):
        if declaration.name == "stop-color":
            text = declaration.value
    paint = parse_paint(text)
    return paint.color if paint is not None and paint.kind == "color" else None
