"""Circles of one size over an area: which of its parts lies in which of them, exactly.

The borders of the circles and of the area cut it into faces; each of them lies wholly inside or wholly outside of every
circle. Each face has a corner, where two borders meet, or is bounded by one circle alone. So the faces are found by
looking around every corner: between any two borders that leave it lies one face.
"""

from __future__ import annotations

from typing import Any, NamedTuple

import numpy as np
from scipy.sparse import csr_array
from scipy.spatial import cKDTree

from optplan.domain.arrays import FloatArray, IntArray
from optplan.domain.errors import LimitError

STEP = 1e-5
"""Distance from a corner at which a face is looked at, in radii. Faces smaller than that may be missed: see MARGIN."""
MARGIN = 1e-4
"""Share by which circles are made smaller when a cover is planned: at their own size they wash every face that is too
small to be seen."""
MOST_WITNESSES = 2_000_000
"""Most places that are looked at."""


class Faces(NamedTuple):
    """Which circles wash which face; one row a different set of circles."""

    points: FloatArray
    """(m, 2) m, a place inside a face of each kind"""
    member: csr_array
    """(m, n) 0 or 1: whether circle j holds the place"""


def faces_of(area: Any, centres: FloatArray, radius: float) -> Faces:
    """The faces of a polygonal area (shapely) cut by circles with these centres (n, 2) and this radius, m.

    Raises LimitError when there are too many.
    """
    import shapely

    witnesses = np.concatenate([_around_corners(area, centres, radius), _in_rings(centres, radius)])
    if len(witnesses) > MOST_WITNESSES:
        raise LimitError(f"{len(centres)} circles cut the wall into too many pieces; expected fewer or larger circles")
    shapely.prepare(area)
    inside = shapely.contains_xy(area, witnesses[:, 0], witnesses[:, 1])
    points = witnesses[inside]
    member = holders(points, centres, radius)
    return _distinct(points, member)


def holders(points: FloatArray, centres: FloatArray, radius: float) -> Any:
    """(m, n) 0 or 1: which circles hold which points (m, 2)."""
    if len(points) == 0 or len(centres) == 0:
        return csr_array(np.zeros((len(points), len(centres)), dtype=np.int8))
    found: Any = cKDTree(centres).query_ball_point(points, radius, return_sorted=True)
    counts = np.array([len(row) for row in found])
    columns = np.concatenate([np.asarray(row, dtype=np.int64) for row in found]) if counts.sum() else np.zeros(0, int)
    start = np.concatenate([[0], np.cumsum(counts)])
    made: csr_array = csr_array(
        (np.ones(len(columns), dtype=np.int8), columns, start), shape=(len(points), len(centres))
    )
    return made


def _distinct(points: FloatArray, member: csr_array) -> Faces:
    """One row for each set of circles; sets by a random sum of their members."""
    weights = np.random.default_rng(0).integers(1, 2**62, member.shape[1], dtype=np.int64)
    key = np.zeros(len(points), dtype=np.int64)
    rows = np.repeat(np.arange(len(points)), np.diff(member.indptr))
    with np.errstate(over="ignore"):
        np.add.at(key, rows, weights[member.indices])
    _, first = np.unique(key, return_index=True)
    first.sort()
    rows_kept: Any = member[first]
    return Faces(points[first], rows_kept)


def _around_corners(area: Any, centres: FloatArray, radius: float) -> FloatArray:
    """Places just beside every corner, one in each direction between two borders."""
    corners, sides = _corners(area, centres, radius)
    if len(corners) == 0:
        return np.zeros((0, 2))
    # the borders that meet there: circles through the corner leave it at right angles to their radius, both ways
    near: Any = cKDTree(centres).query_ball_point(corners, radius * (1 + 1e-7)) if len(centres) else []
    count = np.array([len(row) for row in near], dtype=np.int64)
    owner = np.repeat(np.arange(len(corners)), count)
    column = np.concatenate([np.asarray(row, dtype=np.int64) for row in near]) if count.sum() else np.zeros(0, int)
    ray = centres[column] - corners[owner]
    through = np.hypot(*ray.T) > radius * (1 - 1e-7)
    owner, ray = owner[through], ray[through]
    angle = np.arctan2(ray[:, 1], ray[:, 0])
    owners = np.concatenate([owner, owner, sides[:, 0].astype(np.int64)])
    angles = np.concatenate([angle + np.pi / 2, angle - np.pi / 2, sides[:, 1]]) % (2 * np.pi)
    order = np.lexsort((angles, owners))
    owners, angles = owners[order], angles[order]
    last = np.append(owners[1:] != owners[:-1], True)
    start = np.flatnonzero(np.append(True, last[:-1]))
    following = np.append(angles[1:], 0.0)
    following[last] = angles[start] + 2 * np.pi
    middle = (angles + following) / 2
    wide = following - angles > 1e-6
    step = STEP * radius * np.column_stack([np.cos(middle), np.sin(middle)])
    moved: FloatArray = (corners[owners] + step)[wide]
    return moved


def _corners(area: Any, centres: FloatArray, radius: float) -> tuple[FloatArray, FloatArray]:
    """Corners (k, 2), and the straight borders that leave them: rows of corner and direction, rad."""
    import shapely

    places, lines = [], []
    total = 0
    for polygon in shapely.get_parts(area):
        for ring in (polygon.exterior, *polygon.interiors):
            line = shapely.get_coordinates(ring)
            step = np.diff(line, axis=0)
            length = np.hypot(*step.T)
            a, d = line[:-1][length > 0], step[length > 0] / length[length > 0, None]
            count, heading = len(a), np.arctan2(d[:, 1], d[:, 0])
            number = total + np.arange(count)
            places.append(a)
            lines += [np.column_stack([number, heading]), np.column_stack([number, np.roll(heading, 1) + np.pi])]
            total += count
            for begin, unit, angle, size in zip(a, d, heading.tolist(), length[length > 0].tolist(), strict=True):
                away = centres - begin
                along, beside = away @ unit, away[:, 0] * unit[1] - away[:, 1] * unit[0]
                half = np.sqrt(np.maximum(radius**2 - beside**2, 0.0))
                meets = np.abs(beside) < radius
                at = np.concatenate([(along - half)[meets], (along + half)[meets]])
                at = at[(at > 0) & (at < size)]
                places.append(begin + at[:, None] * unit)
                number = total + np.arange(len(at))
                both = np.concatenate([np.full(len(at), angle), np.full(len(at), angle + np.pi)])
                lines.append(np.column_stack([np.concatenate([number, number]), both]))
                total += len(at)
    places.append(_meetings(centres, radius))
    sides = np.concatenate([np.zeros((0, 2)), *lines])
    return np.concatenate([np.zeros((0, 2)), *places]), sides


def _meetings(centres: FloatArray, radius: float) -> FloatArray:
    """(k, 2) where two circles cross."""
    pairs = cKDTree(centres).query_pairs(2 * radius, output_type="ndarray") if len(centres) else np.zeros((0, 2), int)
    a, b = centres[pairs[:, 0]], centres[pairs[:, 1]]
    step = (b - a) / 2
    half = np.hypot(*step.T)
    apart = half > 1e-9 * radius
    a, step, half = a[apart], step[apart], half[apart]
    height = np.sqrt(np.maximum(radius**2 - half**2, 0.0)) / half
    side = height[:, None] * np.column_stack([-step[:, 1], step[:, 0]])
    both = np.concatenate([a + step + side, a + step - side])
    # many circles through one point are one corner
    distinct: FloatArray = np.unique(np.round(both, 9), axis=0) if len(both) else both
    return distinct


def _in_rings(centres: FloatArray, radius: float) -> FloatArray:
    """Places just within and outside of circles, for those whose border meets no other."""
    return np.concatenate([centres + np.array([radius * (1 + step), 0.0]) for step in (STEP, -STEP)])


def without_supersets(member: csr_array) -> IntArray:
    """Rows (k,) of the sets that hold no other set: to have something in each of these is to have it in all."""
    size = np.diff(member.indptr)
    order = np.argsort(size, kind="stable")
    matrix = member[order].astype(np.int32)
    size = size[order]
    keep = np.ones(len(order), dtype=np.bool_)
    turned = matrix.T.tocsr()
    for begin in range(0, len(order), 2048):
        # common (k, m) counts the members that two sets share
        common = (matrix[begin : begin + 2048] @ turned).tocoo()
        row, column = common.coords[0] + begin, common.coords[1]
        inside = (common.data == size[column]) & (
            (size[column] < size[row]) | ((size[column] == size[row]) & (column < row))
        )
        keep[row[inside]] = False
    kept: IntArray = order[keep].astype(np.int64)
    return kept
