"""Reads drawings in SVG."""

from __future__ import annotations

import math
import os

from optplan.domain.errors import InputError, located
from optplan.domain.job import Drawing
from optplan.jobs.svg._census import take_census
from optplan.jobs.svg._report import Report
from optplan.jobs.svg._style import Cascade
from optplan.jobs.svg._tree import SVG, open_source, parse_tree
from optplan.jobs.svg._view import page_of
from optplan.jobs.svg._walk import Walk


def read_svg(
    source: str | bytes | os.PathLike[str], *, name: str | None = None, close_gap: float | None = None
) -> Drawing:
    """A drawing from SVG or compressed SVG.

    Coordinates become metres as printed, x to the right and y up from the page's lower edge (from its upper edge when
    the file does not say how high the page is). Lines stay straight and curves stay curves. What a plan cannot show,
    and what was changed, is listed in the drawing's notes.

    Parameters
    ----------
    source : path of a file, its contents as bytes, or as text that starts with "<"
    name : of the drawing; by default that of the file
    close_gap : the ends of a subpath that are at most this far apart are joined, drawing units; by default half of the
        stroke's width. A gap of 5 % of the subpath's length or more always stays open.

    Raises
    ------
    InputError : not a file, not SVG, entities other than short plain text, NaN or infinity, a page without a size,
        copies in a circle, nothing to draw
    LimitError : beyond one of `optplan.jobs.svg.limits`
    """
    if close_gap is not None and not (math.isfinite(close_gap) and close_gap >= 0):
        raise InputError(f"close_gap is {close_gap}; expected 0 or more drawing units")
    opened = open_source(source)
    with located(opened.name):
        root = parse_tree(opened)
        report = Report()
        if not str(root.tag).startswith("{"):
            report.add("notice", f"the file does not declare the namespace {SVG}; read as SVG all the same")
        page = page_of(root, report)
        if not (math.isfinite(page.unit) and page.unit > 0):
            raise InputError("the viewBox and the page differ too much in size to compute")
        census = take_census(root, report)
        walk = Walk(census, Cascade(root, report), page, report, close_gap)
        elements = tuple(walk.elements(root))
        notes = report.notes()
        if not elements:
            left_out = "; ".join(f"{note.text} ({note.times})" for note in notes if note.kind == "ignored")
            raise InputError(
                f"there is nothing to draw; left out: {left_out}" if left_out else "there is nothing to draw"
            )
        return Drawing(
            name=name or opened.stem or "drawing", elements=elements, unit=page.unit, page=page.size, notes=notes
        )
