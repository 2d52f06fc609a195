"""Rings to areas: which points a set of rings encloses under SVG's fill rules."""

from __future__ import annotations

from collections.abc import Sequence
from typing import TYPE_CHECKING

import numpy as np

from optplan.domain.arrays import BoolArray, FloatArray, IntArray
from optplan.domain.errors import LimitError
from optplan.domain.job import FillRule

if TYPE_CHECKING:
    from shapely import Polygon

MAX_FACES = 20_000
"""Most faces that crossing rings may cut the plane into."""
MAX_CROSSINGS = 10 * MAX_FACES
"""Most pairs of edges that may cross: more make too many faces, unless many meet in one point. Found out before the
rings are cut into pieces, whose time and memory grow with it."""


def region(rings: Sequence[FloatArray], rule: FillRule) -> tuple[list[Polygon], bool]:
    """The area that rings enclose.

    Parameters
    ----------
    rings : (n, 2) m each, implicitly closed; those of fewer than three points enclose nothing
    rule : which faces belong to it

    Returns
    -------
    disjoint polygons with holes, largest first; and whether a ring crossed itself or another one

    Raises
    ------
    LimitError : the rings cross so often that there are more than MAX_FACES faces, or MAX_CROSSINGS crossings
    """
    import shapely

    rings = [ring for ring in rings if len(ring) >= 3]
    if not rings:
        return [], False
    if len(rings) == 1:
        polygon = shapely.Polygon(rings[0])
        if polygon.is_valid:
            return ([polygon] if polygon.area > 0 else []), False
    _few_crossings(rings)
    lines = shapely.union_all([shapely.LinearRing(ring) for ring in rings])
    faces = shapely.get_parts(shapely.polygonize([lines]))
    if len(faces) > MAX_FACES:
        raise LimitError(f"a fill crosses itself into {len(faces)} faces; at most {MAX_FACES} are untangled")
    if len(faces) == 0:
        return [], False
    inside = shapely.point_on_surface(faces)
    winding = np.zeros(len(faces), dtype=np.int64)
    for ring in rings:
        winding += _winding(ring, shapely.get_coordinates(inside))
    chosen: BoolArray = winding % 2 == 1 if rule is FillRule.EVENODD else winding != 0
    area = shapely.union_all(faces[chosen])
    parts = [part for part in shapely.get_parts(area) if part.geom_type == "Polygon" and part.area > 0]
    crossed = any(not shapely.LinearRing(ring).is_simple for ring in rings) or _rings_cross(rings)
    return sorted(parts, key=lambda part: -part.area), crossed


def _few_crossings(rings: Sequence[FloatArray]) -> None:
    """Raises LimitError when more than MAX_CROSSINGS pairs of edges cross."""
    import shapely

    ends = np.concatenate([np.stack([ring, np.roll(ring, -1, axis=0)], axis=1) for ring in rings])
    if len(ends) ** 2 <= 2 * MAX_CROSSINGS:
        return
    edges = shapely.linestrings(ends)
    tree = shapely.STRtree(edges)
    pairs = 0  # each is met twice
    for begin in range(0, len(edges), 256):
        pairs += tree.query(edges[begin : begin + 256], predicate="crosses").shape[1]
        if pairs > 2 * MAX_CROSSINGS:
            raise LimitError(f"the edges of a fill cross more than {MAX_CROSSINGS} times, which is the limit")


def _rings_cross(rings: Sequence[FloatArray]) -> bool:
    import shapely

    shapes = [shapely.LinearRing(ring) for ring in rings]
    tree = shapely.STRtree(shapes)
    first, second = tree.query(shapes, predicate="crosses")
    return bool((first < second).any())


def _winding(ring: FloatArray, points: FloatArray) -> IntArray:
    """Winding number (k,) of a ring (n, 2) about points (k, 2): signed crossings of the ray to the right."""
    number = np.zeros(len(points), dtype=np.int64)
    a, b = ring, np.roll(ring, -1, axis=0)
    # in slices, so that many points against a long ring do not fill the memory
    for begin in range(0, len(points), 1024):
        x, y = points[begin : begin + 1024, 0:1], points[begin : begin + 1024, 1:2]
        side = (b[:, 0] - a[:, 0]) * (y - a[:, 1]) - (x - a[:, 0]) * (b[:, 1] - a[:, 1])
        up = (a[:, 1] <= y) & (b[:, 1] > y) & (side > 0)
        down = (a[:, 1] > y) & (b[:, 1] <= y) & (side < 0)
        number[begin : begin + 1024] = up.sum(axis=1) - down.sum(axis=1)
    return number


def containment(rings: Sequence[FloatArray], closed: Sequence[bool]) -> list[int]:
    """The containment tree of lines and rings.

    Parameters
    ----------
    rings : (n, 2) m each
    closed : whether each is a ring; only rings contain others

    Returns
    -------
    for each the index of the smallest ring that wholly contains it, or -1. Tested exactly, on the whole line.
    """
    import shapely

    shapes = [
        shapely.LinearRing(ring) if is_ring else shapely.LineString(ring) if len(ring) > 1 else shapely.Point(ring[0])
        for ring, is_ring in zip(rings, closed, strict=True)
    ]
    holders = [k for k, is_ring in enumerate(closed) if is_ring]
    areas = [shapely.make_valid(shapely.Polygon(rings[k])) for k in holders]
    if not areas:
        return [-1] * len(shapes)
    tree = shapely.STRtree(areas)
    parent, size = [-1] * len(shapes), [np.inf] * len(shapes)
    inner, outer = tree.query(shapes, predicate="within")
    for child, k in zip(inner.tolist(), outer.tolist(), strict=True):
        holder = holders[k]
        if holder != child and areas[k].area < size[child] and not shapes[child].equals(shapes[holder]):
            parent[child], size[child] = holder, areas[k].area
    return parent
