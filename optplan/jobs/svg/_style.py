"""The cascade: attributes, style sheets, inline style and inheritance become one computed style."""

from __future__ import annotations

import re
from collections.abc import Callable
from functools import lru_cache
from typing import NamedTuple

from lxml import etree

from optplan.domain.errors import LimitError
from optplan.domain.job import FillRule
from optplan.jobs.svg._color import BLACK, NO_PAINT, Paint, parse_paint
from optplan.jobs.svg._number import FONT_UNITS, NUMBERS, parse_length
from optplan.jobs.svg._report import Report
from optplan.jobs.svg._sheet import Declaration, StyleSheets, inline_declarations, is_plain
from optplan.jobs.svg.limits import MAX_INLINE_CHARS, MAX_STYLE_CHARS

_CASCADE_WORDS = frozenset({"inherit", "initial", "unset", "revert", "revert-layer"})
CACHED_CHARS = 2000
"""longer texts are not remembered"""
GEOMETRY = frozenset({"x", "y", "width", "height", "cx", "cy", "r", "rx", "ry"})
"""properties that are attributes too; a style sheet wins over the attribute"""


class Style(NamedTuple):
    """What counts of an element's style. The first group is inherited.

    Parameters
    ----------
    stroke_width : user units of the element
    opacity : product of the element's and of all that hold it
    effects : names of properties that a plan cannot follow: clip-path, mask, filter
    transform : value of the property, None to leave it to the attribute
    geometry : values of properties in `GEOMETRY`
    """

    color: Paint = BLACK
    fill: Paint = BLACK
    stroke: Paint = NO_PAINT
    fill_opacity: float = 1.0
    stroke_opacity: float = 1.0
    stroke_width: float = 1.0
    fill_rule: FillRule = FillRule.NONZERO
    visible: bool = True
    dashed: bool = False
    markers: tuple[bool, bool, bool] = (False, False, False)
    opacity: float = 1.0
    displayed: bool = True
    effects: tuple[str, ...] = ()
    fixed_width: bool = False
    origin: bool = False
    transform: str | None = None
    geometry: tuple[tuple[str, str], ...] = ()


INITIAL = Style()
_INHERITED = {
    "color": "color",
    "fill": "fill",
    "stroke": "stroke",
    "fill-opacity": "fill_opacity",
    "stroke-opacity": "stroke_opacity",
    "stroke-width": "stroke_width",
    "fill-rule": "fill_rule",
    "visibility": "visible",
    "stroke-dasharray": "dashed",
}
_MARKERS = ("marker-start", "marker-mid", "marker-end")
_EFFECTS = ("clip-path", "mask", "filter")
_OTHERS = (*_MARKERS, *_EFFECTS, "opacity", "display", "vector-effect", "transform", "transform-origin")
PROPERTIES = frozenset({*_INHERITED, *_OTHERS})
_SHEET_PROPERTIES = PROPERTIES | GEOMETRY
_NOT_FOLLOWED = frozenset({"d", "mix-blend-mode", "translate", "rotate", "scale", "offset-path", "zoom"})


class Cascade:
    """Computes styles.

    Parameters
    ----------
    root : of the drawing
    report : is told what cannot be used
    """

    def __init__(self, root: etree._Element, report: Report) -> None:
        self._sheets = StyleSheets(root, report)
        self._report = report
        self._unusual = 0
        """characters of long style attributes that needed the tokenizer"""

    def style(
        self, element: etree._Element, parent: Style, viewport: tuple[float, float] | None, place: Callable[[], str]
    ) -> Style:
        """The style of `element` inside `parent`.

        Parameters
        ----------
        viewport : width and height that percentages refer to, user units, None when they are not known
        place : names the element for the report
        """
        values = self._declared(element, place)
        inherited = parent._replace(
            displayed=True, effects=(), fixed_width=False, origin=False, transform=None, geometry=()
        )
        if not values:
            return inherited
        changes: dict[str, object] = {}
        for name, field in _INHERITED.items():
            text = values.get(name)
            if text is None or text in ("inherit", "unset", "revert", "revert-layer"):
                continue
            if text == "initial":
                changes[field] = getattr(INITIAL, field)
            elif name == "stroke-width":
                changes[field] = self._width(text, viewport, parent.stroke_width, place)
            else:
                changes[field] = _computed(name, text)
        if changes.get("color") is not None and changes["color"].kind != "color":  # type: ignore[attr-defined]
            changes["color"] = parent.color
        if any(name in values for name in _MARKERS):
            changes["markers"] = tuple(
                values[name] != "none" if values.get(name, "inherit") not in _CASCADE_WORDS else old
                for name, old in zip(_MARKERS, parent.markers, strict=True)
            )
        if "opacity" in values and values["opacity"] not in _CASCADE_WORDS:
            changes["opacity"] = parent.opacity * _alpha(values["opacity"])
        changes["displayed"] = values.get("display") != "none"
        effects = tuple(name for name in _EFFECTS if values.get(name, "none") not in {"none", *_CASCADE_WORDS})
        transform = values.get("transform")
        return inherited._replace(
            **changes,  # type: ignore[arg-type]
            effects=effects,
            fixed_width=values.get("vector-effect") == "non-scaling-stroke",
            origin=_moves(values.get("transform-origin", "")),
            transform=None if transform in _CASCADE_WORDS else transform,
            geometry=tuple((name, values[name]) for name in GEOMETRY if name in values),
        )

    def _width(self, text: str, viewport: tuple[float, float] | None, parent: float, place: Callable[[], str]) -> float:
        length = parse_length(text)
        width = None if length is None else length.pixels(viewport)
        if length is None or width is None:
            self._report.add(
                "changed", f"stroke width in {'%' if text.endswith('%') else 'a unit'} not known: inherited", place()
            )
            return parent
        if length.unit in FONT_UNITS:
            self._report.add("changed", "lengths in units of a font: taken for a font of 16 px", place())
        return max(width, 0.0)

    def _declared(self, element: etree._Element, place: Callable[[], str]) -> dict[str, str]:
        values: dict[str, str] = {}
        inline: list[Declaration] = []
        for name, value in element.attrib.items():
            if name in PROPERTIES:
                if name != "transform":
                    self._take(values, Declaration(str(name), str(value).strip()), place)
            elif name == "style":
                text = str(value)
                inline = _inline(text) if len(text) <= CACHED_CHARS else self._long_inline(text)
        matching = self._sheets.matching(element)
        if not (inline or matching):
            return values
        # important declarations of sheets beat those of the attribute that are not, and the other way round
        for important in (False, True):
            for declaration in (*matching, *inline):
                if declaration.important is important:
                    self._take(values, declaration, place)
        return values

    def _long_inline(self, text: str) -> list[Declaration]:
        if len(text) > MAX_INLINE_CHARS:
            raise LimitError(f"the style attribute has {len(text)} characters; the limit is {MAX_INLINE_CHARS}")
        self._unusual += 0 if is_plain(text) else len(text)
        if self._unusual > MAX_STYLE_CHARS:
            raise LimitError(f"long style attributes hold more than {MAX_STYLE_CHARS} characters, the limit")
        return inline_declarations(text)

    def _take(self, values: dict[str, str], declaration: Declaration, place: Callable[[], str]) -> None:
        name, text, _ = declaration
        if name == "marker":
            for each in _MARKERS:
                self._take(values, Declaration(each, text), place)
        elif name in _SHEET_PROPERTIES:
            known = _valid(name, text) if len(text) <= CACHED_CHARS else _valid.__wrapped__(name, text)
            if known is None:
                self._report.add("ignored", f"value of {name} that cannot be understood", place())
            else:
                values[name] = known
        elif name in _NOT_FOLLOWED and text not in ("none", "normal"):
            self._report.add("ignored", f"style property {name}", place())


@lru_cache(maxsize=4096)
def _inline(text: str) -> list[Declaration]:
    return inline_declarations(text)


def _alpha(text: str) -> float:
    length = parse_length(text)
    assert length is not None, "was checked when it was declared"
    return min(1.0, max(0.0, length.value / 100 if length.unit == "%" else length.value))


def _moves(origin: str) -> bool:
    return re.search(r"[1-9]|center|right|bottom", origin) is not None


@lru_cache(maxsize=8192)
def _valid(name: str, text: str) -> str | None:
    """The value as it is kept, or None when the property does not accept it."""
    lower = text.strip().lower()
    if lower in _CASCADE_WORDS:
        return lower
    if name in ("fill", "stroke", "color"):
        return None if parse_paint(text) is None else text
    if name in ("opacity", "fill-opacity", "stroke-opacity"):
        length = parse_length(lower)
        return None if length is None or length.unit not in ("", "%") else lower
    if name == "stroke-width":
        length = parse_length(lower)
        return None if length is None or length.value < 0 or length.pixels((1, 1)) is None else lower
    if name == "fill-rule":
        return lower if lower in ("nonzero", "evenodd") else None
    if name == "visibility":
        return lower if lower in ("visible", "hidden", "collapse") else None
    return text if name in (*_MARKERS, *_EFFECTS) and lower != "none" else lower


def _computed(name: str, text: str) -> object:
    match name:
        case "fill" | "stroke" | "color":
            return parse_paint(text)
        case "fill-opacity" | "stroke-opacity":
            return _alpha(text)
        case "fill-rule":
            return FillRule(text)
        case "visibility":
            return text == "visible"
    return any(float(number) > 0 for number in NUMBERS.findall(text))
