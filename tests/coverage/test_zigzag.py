"""Parallel lines across polygons."""

from __future__ import annotations

import math

import numpy as np
import pytest
import shapely
from hypothesis import given
from hypothesis import strategies as st
from shapely import affinity

from optplan.coverage import zigzag as module
from optplan.coverage.zigzag import zigzag
from optplan.domain.arrays import FloatArray
from optplan.domain.errors import LimitError
from tests.strategies import array, box, circle, star_shaped


def _levels(stroke: FloatArray, direction: float) -> FloatArray:
    """Distance of each point from the line through the origin in that direction."""
    return stroke @ array([-math.sin(direction), math.cos(direction)])


@pytest.mark.parametrize("degrees", range(0, 180, 10))
@pytest.mark.parametrize("ring", [box(1, 2, 5, 3), circle(2.5, 60), array([[0, 0], [6, 1], [2, 5]])])
def test_convex_shapes(ring: FloatArray, degrees: int) -> None:
    polygon = shapely.Polygon(ring)
    direction, spacing, inset = math.radians(degrees), 0.13, 0.1
    fill = zigzag(polygon, direction, spacing, inset)
    assert fill.inset == inset
    assert len(fill.strokes) == 1  # one go, back and forth
    inner = polygon.buffer(-inset, join_style="mitre")
    levels = np.unique(np.round(_levels(fill.strokes[0], direction), 5))
    steps = np.diff(levels)
    assert steps.max() <= spacing + 1e-5
    assert np.ptp(steps) < 3e-5
    heights = _levels(shapely.get_coordinates(inner), direction)
    assert (levels[0], levels[-1]) == pytest.approx((heights.min(), heights.max()), abs=1e-4)
    line = shapely.LineString(fill.strokes[0])
    assert inner.buffer(1e-6).covers(line)
    assert inner.difference(line.buffer(spacing * 0.75)).area < 0.01 * inner.area
    sides = np.diff(fill.strokes[0], axis=0)[::2]
    assert np.abs(sides @ array([-math.sin(direction), math.cos(direction)])).max() < 1e-9  # lines run in direction


@given(star_shaped(5), st.floats(0.2, 0.6), st.floats(0, 3.14), st.floats(0.05, 0.6), st.sampled_from([0.0, 0.03, 0.2]))
def test_nothing_outside_and_nothing_in_holes(
    ring: FloatArray, hole: float, direction: float, spacing: float, inset: float
) -> None:
    polygon = shapely.Polygon(ring, [ring * hole])
    fill = zigzag(polygon, direction, spacing, inset)
    assert fill.strokes
    for stroke in fill.strokes:
        assert len(stroke) >= 2
        assert polygon.buffer(1e-6).covers(shapely.LineString(stroke))
        assert shapely.distance(polygon.boundary, shapely.points(stroke)).min() >= fill.inset - 1e-6
    inner = polygon.buffer(-fill.inset, join_style="mitre")
    turned = affinity.rotate(inner, -direction, origin=(0, 0), use_radians=True)
    # every level that crosses the inset polygon is within a spacing of a line there
    levels = np.unique(np.concatenate([_levels(stroke, direction) for stroke in fill.strokes]))
    for part in shapely.get_parts(turned):
        _, low, _, high = part.bounds
        own = levels[(levels >= low - 1e-9) & (levels <= high + 1e-9)]
        assert len(own) >= 1
        assert np.diff(np.concatenate([[low], own, [high]])).max() <= spacing * 1.05 + 1e-6


def test_every_line_of_a_ring_is_there_once() -> None:
    polygon = shapely.Polygon(box(0, 0, 10, 10), [box(4, 4, 2, 2)[::-1]])
    fill = zigzag(polygon, 0.0, 1.0, 0.0)
    lengths = sum(float(np.abs(np.diff(stroke, axis=0)[::2, 0]).sum()) for stroke in fill.strokes)
    # eleven lines; three of them (4 just outside the hole's edge, 5, 6) may be cut by it
    assert 11 * 10 - 3 * 2 <= lengths + 1e-6 <= 11 * 10 + 1e-5


def test_thin_polygons_are_filled_all_the_same() -> None:
    thin = shapely.Polygon(box(0, 0, 5, 0.01))
    for direction in (0.0, 0.3, math.pi / 2):
        fill = zigzag(thin, direction, 0.4, 0.2)
        assert fill.inset < 0.01
        assert fill.strokes
        assert all(thin.buffer(1e-6).covers(shapely.LineString(stroke)) for stroke in fill.strokes)
    middle = zigzag(thin, 0.0, 0.4, 0.2)
    assert len(middle.strokes) == 1


def test_too_many_lines_are_refused(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(module, "MAX_LINES", 11)
    square = shapely.Polygon(box(0, 0, 10, 10))
    assert zigzag(square, 0.0, 1.0, 0.0).strokes
    with pytest.raises(LimitError, match="needs 12 lines; at most 11"):
        zigzag(square, 0.0, 0.99, 0.0)
