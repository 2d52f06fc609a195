"""Areas of rings against counts of crossings and angles by the test."""

from __future__ import annotations

import math

import numpy as np
import pytest
import shapely
from hypothesis import given
from hypothesis import strategies as st

from optplan.domain.arrays import FloatArray
from optplan.domain.errors import LimitError
from optplan.domain.job import FillRule
from optplan.geometry import regions
from optplan.geometry.regions import containment, region
from tests.strategies import array, box, circle, seeds, star_shaped

RULES = (FillRule.NONZERO, FillRule.EVENODD)


def _star(radius: float = 1.0) -> FloatArray:
    """A pentagram, drawn in one go."""
    ring: FloatArray = circle(radius, 5)[[0, 2, 4, 1, 3]]
    return ring


def _inside(rings: list[FloatArray], rule: FillRule, point: FloatArray) -> bool:
    """Winding by summed angles, crossings by the ray upwards."""
    if rule is FillRule.NONZERO:
        angles = 0.0
        for ring in rings:
            around = np.arctan2(*(ring - point).T[::-1])
            steps = np.diff(np.append(around, around[0]))
            angles += float(((steps + math.pi) % math.tau - math.pi).sum())
        return round(angles / math.tau) != 0
    crossings = 0
    for ring in rings:
        for (x0, y0), (x1, y1) in zip(ring, np.roll(ring, -1, axis=0), strict=True):
            if (x0 <= point[0]) != (x1 <= point[0]):
                crossings += bool(y0 + (point[0] - x0) / (x1 - x0) * (y1 - y0) > point[1])
    return crossings % 2 == 1


def _check(rings: list[FloatArray], rule: FillRule, rng: np.random.Generator) -> None:
    polygons, _ = region(rings, rule)
    area = shapely.union_all(polygons) if polygons else shapely.Polygon()
    lines = shapely.union_all([shapely.LinearRing(ring) for ring in rings])
    assert sum(p.area for p in polygons) == pytest.approx(area.area, abs=1e-9)  # disjoint
    assert [p.area for p in polygons] == sorted((p.area for p in polygons), reverse=True)
    assert all(p.is_valid for p in polygons)
    low, high = np.min([r.min(axis=0) for r in rings], axis=0), np.max([r.max(axis=0) for r in rings], axis=0)
    for point in rng.uniform(low - 0.1, high + 0.1, (40, 2)):
        place = shapely.Point(point)
        if lines.distance(place) > 1e-6:
            assert bool(area.contains(place)) == _inside(rings, rule, point)


@given(seeds, st.sampled_from(RULES), st.integers(1, 3))
def test_random_tangles(seed: int, rule: FillRule, count: int) -> None:
    rng = np.random.default_rng(seed)
    _check([rng.uniform(-1, 1, (int(rng.integers(3, 9)), 2)) for _ in range(count)], rule, rng)


@given(seeds, st.sampled_from(RULES), st.integers(1, 3))
def test_tangles_on_a_grid(seed: int, rule: FillRule, count: int) -> None:
    """Shared vertices, edges on top of each other, spikes."""
    rng = np.random.default_rng(seed)
    rings = []
    for _ in range(count):
        ring = rng.integers(0, 4, (int(rng.integers(3, 9)), 2)).astype(float)
        ring = ring[np.any(ring != np.roll(ring, 1, axis=0), axis=1)]
        if len(ring) >= 3:
            rings.append(ring)
    if rings:
        _check(rings, rule, rng)


def test_a_star_has_a_heart_by_one_rule_only() -> None:
    rng = np.random.default_rng(1)
    for rule, heart in ((FillRule.NONZERO, True), (FillRule.EVENODD, False)):
        polygons, crossed = region([_star()], rule)
        assert crossed
        assert any(p.contains(shapely.Point(0, 0)) for p in polygons) == heart
        _check([_star()], rule, rng)
    assert len(region([_star()], FillRule.EVENODD)[0]) == 5


@pytest.mark.parametrize("rule", RULES)
@pytest.mark.parametrize("inner", [1, -1])
@pytest.mark.parametrize("outer", [1, -1])
def test_nested_rings(rule: FillRule, outer: int, inner: int) -> None:
    rings = [box(0, 0, 6, 6)[::outer], box(1, 1, 4, 4)[::inner], box(2, 2, 2, 2)[::outer]]
    polygons, crossed = region(rings, rule)
    assert not crossed
    hole = rule is FillRule.EVENODD or outer != inner
    assert sum(p.area for p in polygons) == pytest.approx(36 - 16 + 4 if hole else 36)
    _check(rings, rule, np.random.default_rng(2))


def test_degenerate_rings_enclose_nothing() -> None:
    assert region([], FillRule.NONZERO) == ([], False)
    assert region([array([[0, 0], [1, 1]])], FillRule.NONZERO) == ([], False)
    assert region([array([[0, 0], [1, 1], [2, 2]])], FillRule.NONZERO)[0] == []
    assert region([array([[0, 0], [1, 0], [0, 0], [1, 0]])], FillRule.EVENODD)[0] == []


def test_the_same_ring_twice() -> None:
    for rule, area in ((FillRule.NONZERO, 4), (FillRule.EVENODD, 0)):
        polygons, _ = region([box(0, 0, 2, 2), box(0, 0, 2, 2)], rule)
        assert sum(p.area for p in polygons) == area


def test_tangles_without_end_are_refused(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(regions, "MAX_FACES", 5)
    with pytest.raises(LimitError, match="at most 5"):
        region([_star()], FillRule.NONZERO)


def test_a_containment_tree() -> None:
    rings = [
        box(0, 0, 10, 10),
        box(1, 1, 8, 8)[::-1],
        box(2, 2, 2, 2),
        box(5, 5, 3, 3),
        array([[5.5, 5.5], [7, 7]]),  # a line in the ring before
        array([[2.5, 2.5], [20, 3]]),  # a line that leaves everything
        box(9.5, 4, 2, 2),  # crosses the outermost
        array([[3, 3]]),
        box(20, 20, 1, 1),
    ]
    closed = [True, True, True, True, False, False, True, False, True]
    assert containment(rings, closed) == [-1, 0, 1, 1, 3, -1, -1, 2, -1]


def test_only_rings_contain() -> None:
    rings = [box(0, 0, 10, 10), box(1, 1, 8, 8)]
    assert containment(rings, [False, True]) == [-1, -1]
    assert containment(rings, [False, False]) == [-1, -1]
    assert containment([], []) == []


def test_a_ring_whose_box_holds_another_does_not_contain_it() -> None:
    bracket = array([[0, 0], [9, 0], [9, 1], [1, 1], [1, 9], [0, 9]])
    assert containment([bracket, box(5, 5, 2, 2), box(0.2, 0.2, 0.5, 0.5)], [True] * 3) == [-1, -1, 0]


@given(star_shaped(), st.floats(0.1, 0.95), st.floats(0.1, 0.9))
def test_shrunk_copies_nest(ring: FloatArray, first: float, second: float) -> None:
    nest = [ring * first * second, ring, ring * first]
    assert containment(nest, [True] * 3) == [2, -1, 1]
    shifted = [nest[0] + 100, nest[1], nest[2]]
    assert containment(shifted, [True] * 3) == [-1, -1, 1]


def test_a_polygon_that_crosses_itself_millions_of_times_is_refused_before_it_is_cut() -> None:
    ring = np.random.default_rng(0).uniform(0, 100, (5000, 2))
    with pytest.raises(LimitError, match="cross more than 200000 times"):
        region([ring], FillRule.NONZERO)
