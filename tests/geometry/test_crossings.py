"""Where lines and arcs meet, against dense sampling."""

from __future__ import annotations

import math

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from optplan.geometry.crossings import Primitive, junctions

places = st.floats(-5, 5).map(lambda x: round(x, 3))
headings = st.floats(-math.pi, math.pi)
bends = st.one_of(st.just(0.0), st.floats(0.1, 2), st.floats(-2, -0.1))


@st.composite
def primitives(draw: st.DrawFn) -> Primitive:
    bend = draw(bends)
    most = 8.0 if bend == 0 else 2 * math.pi / abs(bend)
    return Primitive(np.array([draw(places), draw(places)]), draw(headings), bend, draw(st.floats(0.05, 1)) * most)


@given(primitives(), places, places)
def test_nearest_is_no_farther_than_any_sample(one: Primitive, x: float, y: float) -> None:
    point = np.array([x, y])
    place, apart = one.nearest(point)
    assert 0 <= place <= one.length
    assert apart == pytest.approx(float(np.linalg.norm(one.at(place) - point)))
    samples = one.at(np.linspace(0, one.length, 400))
    assert apart <= np.linalg.norm(samples - point, axis=1).min() + 1e-9


@given(primitives(), primitives())
def test_every_crossing_of_the_samples_is_found(one: Primitive, other: Primitive) -> None:
    import shapely

    found = junctions(one, other, 1e-6)
    for place in found:
        assert other.nearest(one.at(place))[1] <= 1e-6
    lines = [shapely.LineString(part.at(np.linspace(0, part.length, 2000))) for part in (one, other)]
    crossing = shapely.intersection(*lines)
    points = [part for part in shapely.get_parts(crossing) if part.geom_type == "Point"]
    for point in points:
        at = np.array([point.x, point.y])
        # a graze of two polylines need be none of the curves
        if all(abs(part.nearest(at)[0] - end) > 0.02 for part in (one, other) for end in (0.0, part.length)):
            near = min((np.linalg.norm(one.at(place) - at) for place in found), default=math.inf)
            grazing = abs(math.sin(_heading(one, at) - _heading(other, at))) < 0.1
            assert grazing or near < 1e-2


def _heading(part: Primitive, at: np.ndarray) -> float:
    return part.heading + part.curvature * part.nearest(at)[0]


def test_halfway_line_meets_the_circle_twice_and_the_touchlines_at_its_ends() -> None:
    line = Primitive(np.array([0.0, -34.0]), math.pi / 2, 0.0, 68.0)
    circle = Primitive(np.array([9.15, 0.0]), math.pi / 2, 1 / 9.15, 2 * math.pi * 9.15)
    touch = Primitive(np.array([-52.5, -34.0]), 0.0, 0.0, 105.0)
    assert sorted(set(np.round(junctions(line, circle, 1e-6), 9))) == [34 - 9.15, 34 + 9.15]
    assert set(np.round(junctions(line, touch, 1e-6), 9)) == {0.0}
    assert set(np.round(junctions(touch, line, 1e-6), 9)) == {52.5}


def test_lines_along_each_other_meet_at_their_ends_only() -> None:
    one = Primitive(np.zeros(2), 0.0, 0.0, 4.0)
    other = Primitive(np.array([1.0, 0.0]), 0.0, 0.0, 1.0)
    assert sorted(set(np.round(junctions(one, other, 1e-6), 9))) == [1.0, 2.0]
