"""The walk over what is drawn: groups, copies, viewports, styles; every shape becomes an `Element`."""

from __future__ import annotations

import math
from collections.abc import Iterator
from dataclasses import dataclass
from typing import NamedTuple

from lxml import etree

from optplan.domain.errors import InputError, LimitError, located
from optplan.domain.job import Element
from optplan.jobs.svg._census import INKSCAPE, XLINK, Census, is_svg, unique
from optplan.jobs.svg._curves import Made, is_area, make_curves
from optplan.jobs.svg._number import FONT_UNITS, Axis, parse_length
from optplan.jobs.svg._paint import Painter
from optplan.jobs.svg._report import Report, local_name, place_of
from optplan.jobs.svg._shapes import SHAPES, outline
from optplan.jobs.svg._style import GEOMETRY, INITIAL, Cascade, Style
from optplan.jobs.svg._transform import IDENTITY, Matrix, multiply, parse_transform, scale_of, translation
from optplan.jobs.svg._view import Page, viewport_transform
from optplan.jobs.svg.limits import MAX_DEPTH, MAX_ELEMENTS, MAX_SEGMENTS, MAX_TEXT

_GROUPS = frozenset({"g", "a", "switch"})
_NOT_DRAWN = frozenset(
    {"defs", "symbol", "clipPath", "mask", "marker", "pattern", "linearGradient", "radialGradient", "meshgradient"}
    | {"hatch", "solidcolor", "filter", "style", "title", "desc", "metadata", "script", "view", "cursor", "font"}
    | {"font-face", "color-profile", "animate", "animateColor", "animateMotion", "animateTransform", "set", "discard"}
)
_TEXT = frozenset({"text", "tspan", "textPath", "tref", "flowRoot", "altGlyph"})


class _Context(NamedTuple):
    """What an element inherits from its place in the tree of copies."""

    matrix: Matrix
    """to user units of the root"""
    style: Style
    viewport: tuple[float, float] | None
    layer: str = ""
    copies: tuple[str, ...] = ()
    """ids of the `use` elements around it, the innermost first"""
    targets: tuple[str, ...] = ()
    """ids of what they copy"""
    depth: int = 0
    size: tuple[float | None, float | None] = (None, None)
    """width and height that a `use` gives to the svg or symbol it copies"""
    copied: bool = False
    """whether the element is what a `use` copies"""


@dataclass
class _Spent:
    elements: int = 0
    segments: int = 0
    text: int = 0


class _Attributes:
    """Numbers of one element: style sheets first, then attributes; in user units."""

    def __init__(self, element: etree._Element, context: _Context, style: Style, report: Report, place: str) -> None:
        self._element, self._viewport, self._report, self._place = element, context.viewport, report, place
        self._styled = dict(style.geometry)

    def text(self, name: str) -> str:
        """An attribute, "" when it is absent."""
        return str(self._element.get(name, ""))

    def length(self, name: str, axis: Axis) -> float | None:
        """A length in user units, None when it is absent, "auto" or cannot be understood (which is reported)."""
        styled = self._styled.get(name) if name in GEOMETRY else None
        text = self._element.get(name) if styled is None else styled
        if text is None or text.strip() == "auto":
            return None
        length = parse_length(str(text))
        value = None if length is None else length.pixels(self._viewport, axis)
        if length is None or value is None:
            self._report.add("ignored", f"{name} that is no length or has a unit not known here", self._place)
        elif length.unit in FONT_UNITS:
            self._report.add("changed", "lengths in units of a font: taken for a font of 16 px", self._place)
        return value


class Walk:
    """Reads the elements of a drawing in document order.

    Parameters
    ----------
    census, cascade, page, report : of the same file
    close_gap : ends at most this far apart are joined, drawing units; None takes half of each stroke's width
    """

    def __init__(self, census: Census, cascade: Cascade, page: Page, report: Report, close_gap: float | None) -> None:
        self._census, self._cascade, self._page, self._report = census, cascade, page, report
        self._close_gap = close_gap
        self._painter = Painter(census.targets, report)
        self._spent = _Spent()
        self._taken = set(census.ids.values())
        self._own = set(census.ids.values())

    def elements(self, root: etree._Element) -> Iterator[Element]:
        """Every element that draws something.

        Raises
        ------
        InputError : NaN, infinity, a copy that holds itself
        LimitError : more than the limits
        """
        stack = [(root, _Context(IDENTITY, INITIAL, self._page.viewport))]
        while stack:
            element, context = stack.pop()
            place = self._place(element)
            with located(place):
                drawn, children = self._visit(element, context, place)
            if drawn is not None:
                yield drawn
            stack.extend(reversed(children))

    def _place(self, element: etree._Element) -> str:
        return place_of(element, element.get("id"))

    def _visit(
        self, element: etree._Element, context: _Context, place: str
    ) -> tuple[Element | None, list[tuple[etree._Element, _Context]]]:
        self._count(element, context)
        tag = local_name(element)
        if tag in _NOT_DRAWN and not (tag == "symbol" and context.copied):
            return None, []
        if tag not in SHAPES and tag not in _GROUPS and tag not in ("svg", "use", "symbol"):
            self._not_drawn(tag, element, place)
            return None, []
        if (element.get("requiredExtensions") or "").strip():
            self._report.add("ignored", "element that asks for an extension", place)
            return None, []
        style = self._cascade.style(element, context.style, context.viewport, lambda: place)
        if not style.displayed:
            self._report.add("ignored", "hidden (display: none), with all it holds", place)
            return None, []
        for effect in style.effects:
            self._report.add("changed", f"{effect} not applied: drawn as it is without", place)
        context = context._replace(style=style, matrix=self._moved(element, context, style, place, tag))
        if tag in SHAPES:
            return self._shape(tag, element, context, place), []
        if tag == "use":
            return None, self._copy(element, context, place)
        if tag in ("svg", "symbol"):
            context = self._enter(element, tag, context, place)
        context = context._replace(depth=context.depth + 1, size=(None, None), copied=False)
        if element.get(f"{{{INKSCAPE}}}groupmode") == "layer":
            label = element.get(f"{{{INKSCAPE}}}label") or element.get("id") or self._census.ids[element]
            context = context._replace(layer=str(label))
        children = [child for child in element if is_svg(child)]
        if tag == "switch":
            children = self._choice(children)
        return None, [(child, context) for child in children]

    def _count(self, element: etree._Element, context: _Context) -> None:
        self._spent.elements += 1
        self._spent.text += sum(map(len, element.attrib.values()))
        if self._spent.elements > MAX_ELEMENTS:
            raise LimitError(f"with all copies made by `use` there are more than {MAX_ELEMENTS} elements, the limit")
        if self._spent.text > MAX_TEXT:
            raise LimitError(f"with all copies made by `use` there are more than {MAX_TEXT} characters, the limit")
        if context.depth > MAX_DEPTH:
            raise LimitError(f"with all copies made by `use` elements are nested more than {MAX_DEPTH} deep, the limit")

    def _moved(self, element: etree._Element, context: _Context, style: Style, place: str, tag: str) -> Matrix:
        """The element's matrix with its own transform."""
        text = style.transform if style.transform is not None else element.get("transform")
        if not text:
            return context.matrix
        if tag == "svg" and context.depth == 0:
            self._report.add("ignored", "transform of the root element", place)
            return context.matrix
        own = parse_transform(str(text))
        if own is None:
            self._report.add("ignored", "transform that cannot be understood", place)
            return context.matrix
        if style.origin or (element.get("transform-origin") or "0").strip("0 px"):
            self._report.add("ignored", "transform-origin: transforms are about the origin", place)
        return multiply(context.matrix, own)

    def _not_drawn(self, tag: str, element: etree._Element, place: str) -> None:
        if tag == "image":
            link = str(element.get("href") or element.get(f"{{{XLINK}}}href") or "")
            where = f"inside the file, {len(link)} characters" if link.startswith("data:") else "in another file"
            self._report.add("ignored", f"image ({where})", place)
        elif tag in _TEXT:
            self._report.add("ignored", "text: only paths are drawn", place)
        else:
            self._report.add("ignored", f"element <{tag[:40]}>", place)

    def _choice(self, children: list[etree._Element]) -> list[etree._Element]:
        """The child of a switch that is drawn: the first whose conditions hold for a reader of English."""
        for position, child in enumerate(children):
            languages = child.get("systemLanguage")
            speaks = languages is None or any(
                word.strip().lower().split("-")[0] == "en" for word in languages.split(",")
            )
            if speaks and not (child.get("requiredExtensions") or "").strip():
                others = children[:position] + children[position + 1 :]
                chosen = [child]
                break
        else:
            others, chosen = children, []
        for other in others:
            self._report.add("ignored", "alternative in a switch", self._place(other))
        return chosen

    def _enter(self, element: etree._Element, tag: str, context: _Context, place: str) -> _Context:
        """Inside a nested svg or a symbol."""
        if tag == "svg" and context.depth == 0:
            return context
        attributes = _Attributes(element, context, context.style, self._report, place)
        matrix = context.matrix
        if tag == "svg":
            shift = translation(attributes.length("x", "x") or 0.0, attributes.length("y", "y") or 0.0)
            matrix = multiply(matrix, shift)
        whole = context.viewport or (None, None)
        given = context.size if context.copied else (None, None)
        sizes = []
        for size, name, axis, default in zip(given, ("width", "height"), ("x", "y"), whole, strict=True):
            own = attributes.length(name, axis) if size is None else size  # type: ignore[arg-type]
            sizes.append(default if own is None else own)
        if any(size is not None and size <= 0 for size in sizes):
            raise InputError("the inner viewport has no size; expected a width and a height above 0")
        inner, viewport = viewport_transform(element, sizes[0], sizes[1], self._report)
        if element.get("viewBox") is not None and "slice" in (element.get("preserveAspectRatio") or ""):
            self._report.add("changed", "inner viewport (slice): drawn uncut", place)
        return context._replace(matrix=multiply(matrix, inner), viewport=viewport)

    def _copy(self, element: etree._Element, context: _Context, place: str) -> list[tuple[etree._Element, _Context]]:
        link = str(element.get("href") or element.get(f"{{{XLINK}}}href") or "").strip()
        target = self._census.targets.get(link[1:]) if link.startswith("#") else None
        if target is None or not is_svg(target):
            what = "that is not in the file" if link.startswith("#") else "outside the file (never fetched)"
            self._report.add("ignored", f"copy of something {what}", place)
            return []
        own, name = self._census.ids[element], link[1:]
        if name in context.targets or any(parent is target for parent in element.iterancestors()):
            chain = " -> ".join([*context.targets, name][:10])
            raise InputError(f"`use` copies something that holds itself ({chain}); expected no circle")
        attributes = _Attributes(element, context, context.style, self._report, place)
        shift = translation(attributes.length("x", "x") or 0.0, attributes.length("y", "y") or 0.0)
        return [
            (
                target,
                context._replace(
                    matrix=multiply(context.matrix, shift),
                    copies=(own, *context.copies),
                    targets=(*context.targets, name),
                    depth=context.depth + 1,
                    size=(attributes.length("width", "x"), attributes.length("height", "y")),
                    copied=True,
                ),
            )
        ]

    def _shape(self, tag: str, element: etree._Element, context: _Context, place: str) -> Element | None:
        style = context.style
        if not style.visible or style.opacity == 0:
            self._report.add("ignored", "hidden (visibility or opacity)", place)
            return None
        width = style.stroke_width * (1.0 if style.fixed_width else scale_of(context.matrix))
        stroke = self._painter.stroke(style, place) if style.stroke_width > 0 else None
        fill = self._painter.fill(style, place)
        if style.stroke_width == 0 and style.stroke.kind != "none":
            self._report.add("ignored", "stroke of width 0", place)
        if not math.isfinite(width):
            raise InputError("the transforms make its stroke width infinite; expected a finite one")
        if stroke is None and fill is None:
            self._report.add("ignored", "neither stroke nor fill", place)
            return None
        made = self._outline(tag, element, context, place, width if stroke else 0.0)
        if fill is not None and not is_area(made.curves):
            fill = None
            if made.curves and stroke is None:
                self._report.add("ignored", "filled line: it has no area", place)
        if not made.curves or (stroke is None and fill is None):
            return None
        self._remark(made, style, stroke, fill, place)
        return Element(
            id=self._name(element, context),
            curves=made.curves,
            stroke=stroke,
            fill=fill,
            stroke_width=width,
            fill_rule=style.fill_rule,
            layer=context.layer,
        )

    def _outline(self, tag: str, element: etree._Element, context: _Context, place: str, width: float) -> Made:
        attributes = _Attributes(element, context, context.style, self._report, place)
        shape = outline(tag, attributes, MAX_SEGMENTS - self._spent.segments)
        if shape.problem:
            self._report.add("ignored" if not shape.subpaths else "changed", shape.problem, place)
        self._spent.segments += sum(len(subpath.handles) for subpath in shape.subpaths)
        if self._spent.segments > MAX_SEGMENTS:
            raise LimitError(f"the drawing has more than {MAX_SEGMENTS} segments, which is the limit")
        gap = self._page.unit * (width / 2 if self._close_gap is None else self._close_gap)
        made = make_curves(shape.subpaths, multiply(self._page.to_metres, context.matrix), gap)
        if not shape.subpaths and not shape.problem:
            self._report.add("ignored", "shape without an outline", place)
        if made.dropped:
            self._report.add("ignored", "stroke of zero length", place, made.dropped)
        return made

    def _remark(self, made: Made, style: Style, stroke: str | None, fill: str | None, place: str) -> None:
        if made.joined:
            self._report.add("notice", "ends that nearly meet were joined", place, made.joined)
        if fill is not None and any(not curve.closed and is_area((curve,)) for curve in made.curves):
            self._report.add("notice", "open path with a fill: the fill closes it with a straight line", place)
        if stroke is not None and style.dashed:
            self._report.add("changed", "dashed stroke drawn solid", place)
        if stroke is not None and style.fixed_width:
            self._report.add("changed", "stroke that keeps its width on screen: the width is taken for the page", place)
        if any(style.markers):
            self._report.add("ignored", "markers such as arrow heads", place)
        if style.opacity < 1:
            self._report.add("changed", "half-transparent: drawn opaque", place)

    def _name(self, element: etree._Element, context: _Context) -> str:
        own = self._census.ids[element]
        if not context.copies and own in self._own:
            self._own.discard(own)
            return own
        name = unique("@".join([own, *context.copies]), self._taken)
        self._taken.add(name)
        return name
