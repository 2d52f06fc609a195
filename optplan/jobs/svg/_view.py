"""Viewports: how a viewBox fits into a size, and how large the page is."""

from __future__ import annotations

from typing import NamedTuple

from lxml import etree

from optplan.domain.errors import InputError
from optplan.jobs.svg._number import FONT_UNITS, PX, Length, number_run, numbers, parse_length, refuse_not_finite
from optplan.jobs.svg._report import Report, place_of
from optplan.jobs.svg._transform import IDENTITY, Matrix, multiply, scale_of

Box = tuple[float, float, float, float]
_ALIGN = {"xmin": 0.0, "xmid": 0.5, "xmax": 1.0, "ymin": 0.0, "ymid": 0.5, "ymax": 1.0}


class Page(NamedTuple):
    """The drawing's page.

    Parameters
    ----------
    to_metres : from the user units of the root to metres, y up
    unit : metres of a user unit
    size : width and height, m, or None
    viewport : width and height in user units, or None
    """

    to_metres: Matrix
    unit: float
    size: tuple[float, float] | None
    viewport: tuple[float, float] | None


def view_box(element: etree._Element, report: Report) -> Box | None:
    """The viewBox (x, y, width, height), None when it is absent or malformed.

    Raises
    ------
    InputError : no or negative size, NaN, infinity
    """
    text = element.get("viewBox")
    if text is None:
        return None
    place = place_of(element)
    run, end = number_run(text)
    if text[end:].strip():
        refuse_not_finite(text, end)
    values = numbers(run, 1000)
    if len(values) != 4 or text[end:].strip():
        report.add("ignored", "viewBox that is not four numbers", place)
        return None
    if values[2] <= 0 or values[3] <= 0:
        raise InputError(
            f"the viewBox is {values[2]:g} x {values[3]:g} units large; expected a width and a height above 0", place
        )
    return (values[0], values[1], values[2], values[3])


def fit(box: Box, width: float, height: float, aspect: str | None) -> Matrix:
    """The transform from a viewBox into a viewport of `width` x `height` at the origin (preserveAspectRatio)."""
    words = (aspect or "").lower().split()
    if words[:1] == ["defer"]:
        words = words[1:]
    align = words[0] if words else "xmidymid"
    sx, sy = width / box[2], height / box[3]
    if align == "none":
        return (sx, 0.0, 0.0, sy, -box[0] * sx, -box[1] * sy)
    ax, ay = _ALIGN.get(align[:4], 0.5), _ALIGN.get(align[4:], 0.5)
    scale = max(sx, sy) if words[1:2] == ["slice"] else min(sx, sy)
    return (
        scale,
        0.0,
        0.0,
        scale,
        ax * (width - box[2] * scale) - box[0] * scale,
        ay * (height - box[3] * scale) - box[1] * scale,
    )


def page_of(root: etree._Element, report: Report) -> Page:
    """Page and units of the root element.

    Raises
    ------
    InputError : no or negative size, NaN, infinity
    """
    box = view_box(root, report)
    width, height = _size(root, "width", report), _size(root, "height", report)
    if box is None:
        known = width is not None and height is not None
        size = (width * PX, height * PX) if width is not None and height is not None else None
        flip = (PX, 0.0, 0.0, -PX, 0.0, size[1] if size else 0.0 if height is None else height * PX)
        return Page(flip, PX, size, (width or 0.0, height or 0.0) if known else None)
    if width is None and height is None:
        width, height = box[2], box[3]
    elif width is None:
        assert height is not None, "both missing was the case before"
        width = height * box[2] / box[3]
    elif height is None:
        height = width * box[3] / box[2]
    inner = fit(box, width, height, root.get("preserveAspectRatio"))
    to_metres = multiply((PX, 0.0, 0.0, -PX, 0.0, height * PX), inner)
    return Page(to_metres, scale_of(inner) * PX, (width * PX, height * PX), (box[2], box[3]))


def viewport_transform(
    element: etree._Element, width: float | None, height: float | None, report: Report
) -> tuple[Matrix, tuple[float, float] | None]:
    """The transform of a nested svg or a symbol, and the viewport inside it."""
    box = view_box(element, report)
    if width is None or height is None:
        return IDENTITY, None if box is None else (box[2], box[3])
    if box is None:
        return IDENTITY, (width, height)
    return fit(box, width, height, element.get("preserveAspectRatio")), (box[2], box[3])


def _size(root: etree._Element, name: str, report: Report) -> float | None:
    """Width or height of the page in pixels, None when it is absent or not to be known."""
    text = root.get(name)
    if text is None or text.strip() == "auto":
        return None
    place = place_of(root)
    length: Length | None = parse_length(text)
    if length is not None and length.value <= 0:
        raise InputError(f"the {name} of the page is {text.strip()}; expected more than 0", place)
    if length is not None and length.unit == "%":
        if length.value != 100:
            report.add("ignored", f"{name} of the page in % of a window", place)
        return None
    pixels = None if length is None else length.pixels()
    if length is None or pixels is None:
        report.add("ignored", f"{name} of the page that cannot be understood", place)
    elif length.unit in FONT_UNITS:
        report.add("changed", "lengths in units of a font: taken for a font of 16 px", place)
    return pixels
