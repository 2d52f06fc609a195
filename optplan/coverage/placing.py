"""Putting a drawing on a canvas."""

from __future__ import annotations

from dataclasses import dataclass
from typing import NamedTuple

import numpy as np

from optplan.domain.arrays import FloatArray
from optplan.domain.errors import InputError
from optplan.domain.job import Curve, Element
from optplan.domain.options import PageOptions
from optplan.domain.robot import Canvas, Robot
from optplan.geometry.flatten import flatten

CLOSE = 1e-2
"""Neighbouring points nearer than this share of the tolerance are one."""


@dataclass(frozen=True)
class Placement:
    """A drawing's similarity onto the canvas: canvas = scale * drawing + shift."""

    scale: float
    shift: tuple[float, float]

    def apply(self, points: FloatArray) -> FloatArray:
        """Points (n, 2) of the drawing on the canvas, m."""
        moved: FloatArray = points * self.scale + np.array(self.shift)
        return moved


class Line(NamedTuple):
    """A subpath on the canvas."""

    points: FloatArray
    """(n, 2) m; a closed one does not repeat its first point, and runs counter-clockwise"""
    closed: bool
    drawn: FloatArray
    """(k, 2) m, the vertices it was drawn with"""


def canvas_of(page: PageOptions, robot: Robot) -> Canvas | None:
    """The canvas that options and robot ask for; None keeps the drawing's own size and place.

    Raises InputError when it has no room within its margin, or only one of width and height is given.
    """
    usual = robot.canvas
    if usual is None:
        if page.width is None and page.height is None:
            if page.margin is not None:
                raise InputError("a margin needs a canvas: give page width and height too")
            return None
        if page.width is None or page.height is None:
            raise InputError("a canvas needs both a width and a height")
        return Canvas(page.width, page.height, page.margin or 0.0)
    margin = usual.margin if page.margin is None else page.margin
    return Canvas(page.width or usual.width, page.height or usual.height, margin)


def placement(elements: list[Element], canvas: Canvas | None) -> Placement:
    """Scale and centre what is drawn, keeping its proportions, on the canvas within its margin.

    Raises InputError when there is nothing with an extent.
    """
    if canvas is None:
        return Placement(1.0, (0.0, 0.0))
    # the true extent of the curves: control points may lie far outside
    rough = [_extent(curve) for element in elements for curve in element.curves]
    low = np.min([box[0] for box in rough], axis=0)
    high = np.max([box[1] for box in rough], axis=0)
    size = high - low
    room = np.array([canvas.width, canvas.height]) - 2 * canvas.margin
    if not (size > 0).any():
        raise InputError("the drawing has no extent; expected more than one point")
    with np.errstate(divide="ignore", over="ignore"):
        scale = float(np.min(np.where(size > 0, room / size, np.inf)))
    if not np.isfinite(scale) or scale <= 0:
        raise InputError(f"the drawing measures {size[0]:g} x {size[1]:g} m on paper, which no canvas can scale")
    shift = np.array([canvas.width, canvas.height]) / 2 - scale * (low + high) / 2
    return Placement(scale, (float(shift[0]), float(shift[1])))


def placed(element: Element, where: Placement, tolerance: float) -> list[Line]:
    """The subpaths of an element on the canvas, flattened within `tolerance` (m there)."""
    lines = []
    for curve in element.curves:
        points = where.apply(flatten(curve, tolerance / where.scale))
        # points that all but coincide have no direction between them worth turning to
        ring = np.concatenate([points, points[:1]]) if curve.closed else points
        apart = np.abs(np.diff(ring, axis=0)).max(axis=1) > CLOSE * tolerance
        points = points[apart] if curve.closed else points[np.concatenate([[True], apart])]
        if len(points) > 1:
            closed = curve.closed and len(points) > 2
            points = counter_clockwise(points) if closed else points
            lines.append(Line(points, closed, where.apply(curve.points)))
    return lines


def signed_area(ring: FloatArray) -> float:
    """Area inside a ring (n, 2), m^2; negative when it runs clockwise."""
    x, y = (ring - ring[0]).T
    return float((x * np.roll(y, -1) - y * np.roll(x, -1)).sum() / 2)


def counter_clockwise(ring: FloatArray) -> FloatArray:
    """The ring (n, 2) counter-clockwise, beginning with the same vertex."""
    return ring if signed_area(ring) >= 0 else np.concatenate([ring[:1], ring[:0:-1]])


def _extent(curve: Curve) -> tuple[FloatArray, FloatArray]:
    """Least and greatest coordinates, of the vertices and of what bulges between them."""
    points = curve.points
    if curve.handles is not None:
        p0 = points if curve.closed else points[:-1]
        p3 = np.roll(points, -1, axis=0) if curve.closed else points[1:]
        p1, p2 = curve.handles[:, 0], curve.handles[:, 1]
        # a cubic turns back where its derivative, a quadratic in t, is zero: a t^2 - 2 b t + c = 0, both roots stably
        a, b, c = p3 - 3 * p2 + 3 * p1 - p0, 2 * p1 - p0 - p2, p1 - p0
        root = b + np.where(b < 0, -1, 1) * np.sqrt(np.maximum(b * b - a * c, 0))
        with np.errstate(divide="ignore", invalid="ignore"):
            t = np.stack([root / a, c / root])
        t = np.where((t > 0) & (t < 1), t, 0.0)  # NaN and what lies outside: the vertex again
        u = 1 - t
        bulges = u**3 * p0 + 3 * u**2 * t * p1 + 3 * u * t**2 * p2 + t**3 * p3
        points = np.concatenate([points, bulges.reshape(-1, 2)])
    return points.min(axis=0), points.max(axis=0)
