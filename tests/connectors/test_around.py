"""Ways around forbidden areas: clear of them by another measure, continuous, within limits; none is said to be none."""

from __future__ import annotations

import math

import numpy as np
import pytest
import shapely
from hypothesis import given, settings
from hypothesis import strategies as st

from optplan.connectors.around import CurvedRoads, StraightRoads, Way, way_around
from optplan.connectors.optimised import optimised_connector
from optplan.connectors.surroundings import Surroundings
from optplan.domain.errors import InputError
from optplan.geometry.cc import cc_path
from optplan.geometry.curves import evaluate, joints
from tests.strategies import array, box

ROOM = box(-10, -10, 22, 20)
BLOCKS = (box(-2, -2, 4, 4), box(4, 1, 2.5, 3.5), box(-5, -5, 2, 2))
HALL = Surroundings(BLOCKS, ROOM, 0.3)
CURVED, STRAIGHT = CurvedRoads(HALL, 1.0, 1.0), StraightRoads(HALL)


def clearance(points: np.ndarray) -> float:
    """Least distance from blocks and walls, m; 0 inside a block or outside the room."""
    line = shapely.LineString(points)
    if not shapely.covers(shapely.Polygon(ROOM), line):
        return 0.0
    blocks = shapely.union_all([shapely.Polygon(block) for block in BLOCKS])
    return float(min(shapely.distance(blocks, line), shapely.distance(shapely.Polygon(ROOM).exterior, line)))


def check(way: Way, start: np.ndarray, end: np.ndarray) -> None:
    (curve,) = way.curves
    dense = evaluate(curve, np.linspace(0, curve.total, 3000))
    assert clearance(dense.points) >= 0.3 - 1e-3
    assert curve.max_curvature <= 1 + 1e-6
    assert curve.max_sharpness <= 1 + 1e-6  # as optimised ones say of themselves
    assert joints(curve).curvature.max(initial=0.0) < 1e-6
    assert curve.start == pytest.approx(start[:3])
    assert curve.end[:2] == pytest.approx(end[:2], abs=1e-6)
    assert abs(math.remainder(curve.end[2] - end[2], 2 * math.pi)) < 1e-6
    assert (curve.curvature[0], curve.end_curvature[-1]) == pytest.approx((start[3], end[3]), abs=1e-6)


places = st.tuples(st.floats(-8, 10), st.floats(-8, 8), st.floats(-3, 3), st.floats(-0.9, 0.9))


@settings(max_examples=15, deadline=None)
@given(places, places)
def test_a_way_keeps_out(first: tuple[float, ...], last: tuple[float, ...]) -> None:
    start, end = array(first), array(last)
    way = CURVED.between(start, end)
    if way.curves:
        check(way, start, end)
        # a cut through the air is no longer than a way around
        shortest = STRAIGHT.between(start, end)
        assert sum(curve.total for curve in shortest.curves) <= way.length + 1e-6
    else:
        assert way.source
        assert math.isinf(way.length)


def test_what_is_not_in_the_way_changes_nothing() -> None:
    start, end = array([-8, 8, 0, 0]), array([8, 8, 0.5, 0.2])
    way = CURVED.between(start, end)
    assert way.source == "direct"
    assert way.length == pytest.approx(cc_path(start, end, 1.0, 1.0).length)


def test_straight_ways_are_shortest() -> None:
    """Around a block: by hand, over two of its corners grown by the clearance."""
    for clear in (0.0, 0.5):
        roads = StraightRoads(Surroundings((box(-1, -1, 2, 2),), None, clear))
        way = roads.between(array([-3, 0, 0, 0]), array([3, 0, 0, 0]))
        if clear == 0:
            expected = 2 * math.hypot(2, 1) + 2
        else:
            # tangents to the circles of the clearance around the corners
            reach, angle = math.hypot(2, 1), math.atan2(1, 2)
            tangent, more = math.sqrt(reach**2 - clear**2), math.asin(clear / reach)
            expected = 2 * (tangent + clear * (angle + more)) + 2
        assert way.length == pytest.approx(expected, rel=2e-4)
        assert way.length >= expected * (1 - 1e-9)
        assert way.source == "road map"


def test_a_way_is_not_far_from_the_shortest_line() -> None:
    start, end = array([-9, 0, 0, 0]), array([9, 0, 0, 0])
    way, line = CURVED.between(start, end), STRAIGHT.between(start, end)
    check(way, start, end)
    assert line.length < way.length < 1.03 * line.length


def test_there_is_no_way() -> None:
    wall = Surroundings((box(-0.5, -12, 1, 24),), ROOM, 0.2)
    way = way_around(array([-5, 0, 0, 0]), array([5, 0, 0, 0]), 1.0, 1.0, wall)
    assert way.curves == ()
    assert "separate" in way.source
    inside = way_around(array([-5, 0, 0, 0]), array([0.1, 0, 0, 0]), 1.0, 1.0, wall)
    assert "the end (0.1, 0) lies inside" in inside.source
    # room to be in, but none to turn round in
    corridor = Surroundings((), box(0, 0, 20, 1.0), 0.1)
    stuck = way_around(array([10, 0.5, 0, 0]), array([10, 0.5, math.pi, 0]), 1.0, 1.0, corridor)
    assert "within the limits of curvature" in stuck.source
    assert (
        optimised_connector(array([10, 0.5, 0, 0]), array([10, 0.5, 3, 0]), 1.0, 1.0, surroundings=corridor).curve
        is None
    )


def test_the_same_place_needs_no_way() -> None:
    here = array([-8, 8, 0, 0])
    assert CURVED.between(here, here).source == "the ends are the same"
    assert STRAIGHT.between(here, here).source == "the ends are the same"


@pytest.mark.parametrize("objective", ["length", "effort"])
def test_ways_are_optimised_between_areas(objective: str) -> None:
    start, end = array([-7, -7, 2, 0.5]), array([8, 6, 0, 0])
    way = CURVED.between(start, end)
    better = optimised_connector(start, end, 1.0, 1.0, objective, surroundings=HALL)  # type: ignore[arg-type]
    assert better.curve is not None
    check(Way((better.curve,), ""), start, end)
    if objective == "length":
        assert better.curve.total <= way.length * (1 + 1e-12)
    assert better.tried[0].startswith("way")


@pytest.mark.parametrize(
    ("made", "message"),
    [
        (lambda: Surroundings((), None, -1.0), "clearance"),
        (lambda: Surroundings((array([[0, 0], [1, 1]]),)), "2 vertices"),
        (lambda: Surroundings((array([[0, 0], [1, 1], [1, 0], [0, 1]]),)), "no polygon"),
        (lambda: Surroundings((), array([[0, 0], [1, 1], [2, 2]])), "keep-in polygon is no polygon"),
        (lambda: Surroundings((array([[0, 0], [1, math.nan], [2, 2]]),)), "keep-out polygon 0"),
    ],
)
def test_bad_areas(made: object, message: str) -> None:
    with pytest.raises(InputError, match=message):
        made()  # type: ignore[operator]
