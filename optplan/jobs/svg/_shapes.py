"""The basic shapes, as subpaths in their own coordinates."""

from __future__ import annotations

import math
from collections.abc import Callable
from typing import NamedTuple, Protocol

from optplan.jobs.svg._number import Axis, number_run, numbers, refuse_not_finite
from optplan.jobs.svg._path import Subpath, arc_pieces, parse_path, polyline

SHAPES = frozenset({"path", "rect", "circle", "ellipse", "line", "polyline", "polygon"})


class Geometry(Protocol):
    """Where a shape's numbers come from."""

    def length(self, name: str, axis: Axis) -> float | None:
        """A length in user units, or None when it is absent or "auto"."""

    def text(self, name: str) -> str:
        """An attribute, "" when it is absent."""


class Outline(NamedTuple):
    """A shape's subpaths and what is wrong with it, or None."""

    subpaths: list[Subpath]
    problem: str | None = None


def outline(kind: str, geometry: Geometry, limit: int) -> Outline:
    """The outline of one of `SHAPES`.

    Parameters
    ----------
    kind : its tag
    geometry : its attributes
    limit : segments that it may have

    Raises
    ------
    InputError : NaN or infinity among the numbers
    LimitError : more segments than `limit`
    """
    if kind == "path":
        subpaths, problem = parse_path(geometry.text("d"), limit)
        return Outline(subpaths, None if problem is None else f"path data broken, drawn up to the break: {problem}")
    if kind in ("polyline", "polygon"):
        return _poly(geometry.text("points"), limit, closed=kind == "polygon")
    return _BUILDERS[kind](geometry)


def _poly(text: str, limit: int, *, closed: bool) -> Outline:
    run, end = number_run(text)
    values = numbers(run, 2 * limit + 2)
    problem = None
    if text[end:].strip():
        refuse_not_finite(text, end)
        problem = "list of points broken, drawn up to the break"
    elif len(values) % 2:
        problem = "odd number of coordinates, the last one left out"
    points = [complex(values[k], values[k + 1]) for k in range(0, len(values) - 1, 2)]
    return Outline([polyline(points, closed=closed)] if points else [], problem)


def _line(geometry: Geometry) -> Outline:
    x1, x2 = (geometry.length(name, "x") or 0.0 for name in ("x1", "x2"))
    y1, y2 = (geometry.length(name, "y") or 0.0 for name in ("y1", "y2"))
    return Outline([polyline([complex(x1, y1), complex(x2, y2)], closed=False)])


def _rect(geometry: Geometry) -> Outline:
    x, y = geometry.length("x", "x") or 0.0, geometry.length("y", "y") or 0.0
    width, height = geometry.length("width", "x") or 0.0, geometry.length("height", "y") or 0.0
    problem = _refuse_sizes(width=width, height=height)
    if problem:
        return Outline([], problem)
    given_x, given_y = geometry.length("rx", "x"), geometry.length("ry", "y")
    if (given_x or 0) < 0 or (given_y or 0) < 0:
        problem = "negative corner radius taken as 0"
    rx = given_x if given_x is not None else given_y
    ry = given_y if given_y is not None else given_x
    rx, ry = min(max(rx or 0.0, 0.0), width / 2), min(max(ry or 0.0, 0.0), height / 2)
    if rx == 0 or ry == 0:
        corners = [complex(x, y), complex(x + width, y), complex(x + width, y + height), complex(x, y + height)]
        return Outline([polyline(corners, closed=True)], problem)
    path = Subpath([complex(x + rx, y)], closed=True)
    quarter = math.pi / 2
    sides = (
        (complex(x + width - rx, y), complex(x + width - rx, y + ry), -quarter),
        (complex(x + width, y + height - ry), complex(x + width - rx, y + height - ry), 0.0),
        (complex(x + rx, y + height), complex(x + rx, y + height - ry), quarter),
        (complex(x, y + ry), complex(x + rx, y + ry), 2 * quarter),
    )
    for end, center, start in sides:
        path.line(end)
        for first, second, stop in arc_pieces(center, rx, ry, 0.0, start, quarter):
            path.cubic(first, second, stop)
    return Outline([path], problem)


def _circle(geometry: Geometry) -> Outline:
    radius = geometry.length("r", "r") or 0.0
    return _oval(geometry, radius, radius, _refuse_sizes(radius=radius))


def _ellipse(geometry: Geometry) -> Outline:
    given_x, given_y = geometry.length("rx", "x"), geometry.length("ry", "y")
    rx = (given_x if given_x is not None else given_y) or 0.0
    ry = (given_y if given_y is not None else given_x) or 0.0
    return _oval(geometry, rx, ry, _refuse_sizes(radius=min(rx, ry)))


def _oval(geometry: Geometry, rx: float, ry: float, problem: str | None) -> Outline:
    if problem:
        return Outline([], problem)
    center = complex(geometry.length("cx", "x") or 0.0, geometry.length("cy", "y") or 0.0)
    path = Subpath([center + rx], closed=True)
    for first, second, end in arc_pieces(center, rx, ry, 0.0, 0.0, 2 * math.pi):
        path.cubic(first, second, end)
    return Outline([path])


def _refuse_sizes(**sizes: float) -> str | None:
    for name, size in sizes.items():
        if size <= 0:
            return f"{'negative' if size < 0 else 'no'} {name}: not drawn"
    return None


_BUILDERS: dict[str, Callable[[Geometry], Outline]] = {
    "line": _line,
    "rect": _rect,
    "circle": _circle,
    "ellipse": _ellipse,
}
