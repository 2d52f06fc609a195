"""Dubins paths against constructions that share nothing with the closed forms under test."""

from __future__ import annotations

import csv
import math
from itertools import product
from pathlib import Path

import numpy as np
import pytest
from hypothesis import assume, given
from hypothesis import strategies as st

from optplan.domain.arrays import FloatArray
from optplan.domain.errors import InputError
from optplan.geometry.dubins import WORDS, DubinsPath, dubins_lengths, dubins_path
from tests.strategies import angles, array, coordinates, radii, states

ORACLE = Path(__file__).parents[2] / "../shared/data/connectors/cc00.csv"
State = tuple[float, float, float]


def _centre(state: FloatArray, side: int) -> FloatArray:
    """Centre of the unit circle on the left (1) or right (-1) of a state."""
    return array([state[0] - side * math.sin(state[2]), state[1] + side * math.cos(state[2])])


def _swept(begin: FloatArray, end: FloatArray, side: int) -> float:
    """Angle from one radius vector to another, turning left (1) or right (-1), in [0, 2 pi)."""
    angle = math.atan2(end[1], end[0]) - math.atan2(begin[1], begin[0])
    angle = (side * angle) % math.tau
    return 0.0 if angle > math.tau - 1e-7 else angle


def _by_circles(start: State, end: State, radius: float) -> dict[str, float]:
    """Length of each word that exists, from tangents of circles: geometry with points, no trigonometric identities."""
    a, b = (array([s[0] / radius, s[1] / radius, s[2]]) for s in (start, end))
    found: dict[str, float] = {}
    for first, last in product((1, -1), repeat=2):
        c0, c1 = _centre(a, first), _centre(b, last)
        between = c1 - c0
        distance = float(np.hypot(*between))
        letters = ["L" if side == 1 else "R" for side in (first, last)]
        # a straight line that touches both circles in their direction of turning
        if first == last or distance >= 2:
            offset = 0.0 if first == last else 2.0
            if distance > 0:
                along = between / distance
                tilt = math.asin(min(1.0, offset / distance)) * first
                direction = array([_rotate(along, tilt)]).ravel()
            else:
                direction = array([math.cos(a[2]), math.sin(a[2])])
            leave = c0 + first * array([direction[1], -direction[0]])
            meet = c1 + last * array([direction[1], -direction[0]])
            line = float(np.hypot(*(meet - leave)))
            found[f"{letters[0]}S{letters[1]}"] = (
                _swept(a[:2] - c0, leave - c0, first) + line + _swept(meet - c1, b[:2] - c1, last)
            ) * radius
        # a third circle that touches both from outside, on either side
        if first == last and 0 < distance <= 4:
            middle = "R" if first == 1 else "L"
            height = math.sqrt(max(0.0, 4 - distance**2 / 4))
            for side in (1, -1):
                normal = side * array([-between[1], between[0]]) / distance
                third = (c0 + c1) / 2 + height * normal
                one, two = (c0 + third) / 2, (c1 + third) / 2
                total = (
                    _swept(a[:2] - c0, one - c0, first)
                    + _swept(one - third, two - third, -first)
                    + _swept(two - c1, b[:2] - c1, last)
                ) * radius
                name = f"{letters[0]}{middle}{letters[1]}"
                found[name] = min(found.get(name, math.inf), total)
    return found


def _rotate(vector: FloatArray, angle: float) -> FloatArray:
    c, s = math.cos(angle), math.sin(angle)
    return array([c * vector[0] - s * vector[1], s * vector[0] + c * vector[1]])


def _walked(start: State, path: DubinsPath, steps: int = 400) -> FloatArray:
    """End state by the midpoint rule, piece by piece."""
    x, y, heading = start
    for curvature, length in zip(path.curvatures, path.lengths, strict=True):
        h = length / steps
        along = heading + curvature * (np.arange(steps) + 0.5) * h
        x, y = x + h * float(np.cos(along).sum()), y + h * float(np.sin(along).sum())
        heading += curvature * length
    return array([x, y, heading])


def _angle(a: float, b: float) -> float:
    return abs(math.remainder(a - b, math.tau))


def _stable(start: State, end: State, radius: float) -> bool:
    """Whether the shortest length is the same a hair beside the end: Dubins lengths jump in places."""
    near = [(end[0] + dx, end[1] + dy, end[2] + da) for dx, dy, da in product((-1e-7, 1e-7), repeat=3)]
    lengths = [min(_by_circles(start, state, radius).values()) for state in [end, *near]]
    return max(lengths) - min(lengths) < 1e-2 * radius


@given(states, states, radii)
def test_the_path_ends_where_it_should(start: State, end: State, radius: float) -> None:
    path = dubins_path(array(start), array(end), radius)
    reached = _walked(start, path)
    size = radius + math.hypot(end[0] - start[0], end[1] - start[1])
    assert np.hypot(*(reached[:2] - end[:2])) < 1e-3 * size
    assert _angle(float(reached[2]), end[2]) < 1e-8
    assert sum(path.lengths) == pytest.approx(path.length, rel=1e-12, abs=1e-12)
    assert all(length > 0 for length in path.lengths)
    assert all(abs(curvature) in (0, 1 / radius) for curvature in path.curvatures)
    signs = {"L": 1, "S": 0, "R": -1}
    turning = iter(signs[letter] for letter in path.word)
    assert all(np.sign(curvature) in turning for curvature in path.curvatures)  # a subsequence of the word


@given(states, states, radii)
def test_it_is_the_shortest_of_all_words(start: State, end: State, radius: float) -> None:
    assume(_stable(start, end, radius))
    path = dubins_path(array(start), array(end), radius)
    words = _by_circles(start, end, radius)
    assert path.length == pytest.approx(min(words.values()), rel=1e-6, abs=1e-6 * radius)
    assert words[path.word] == pytest.approx(path.length, rel=1e-6, abs=1e-6 * radius)


def test_every_word_is_the_shortest_somewhere() -> None:
    rng = np.random.default_rng(3)
    ends = np.column_stack([rng.uniform(-3, 3, (3000, 2)), rng.uniform(-np.pi, np.pi, 3000)])
    starts = np.zeros((3000, 3))
    lengths = dubins_lengths(starts, ends, 1.0)
    seen: dict[str, int] = dict.fromkeys(WORDS, 0)
    for row in range(3000):
        path = dubins_path(starts[row], ends[row], 1.0)
        words = _by_circles((0, 0, 0), tuple(ends[row]), 1.0)
        assert path.length == lengths[row]
        assert path.length == pytest.approx(min(words.values()), abs=1e-7)
        seen[path.word] += 1
    assert min(seen.values()) > 20


@given(states, states, radii, states, st.floats(0.1, 10))
def test_lengths_do_not_depend_on_the_frame(start: State, end: State, radius: float, move: State, scale: float) -> None:
    assume(_stable(start, end, radius))
    length = dubins_path(array(start), array(end), radius).length

    def moved(state: State) -> FloatArray:
        return array([*(scale * _rotate(array(state[:2]), move[2]) + move[:2]), state[2] + move[2]])

    def mirrored(state: State) -> FloatArray:
        return array([state[0], -state[1], -state[2]])

    def backwards(state: State) -> FloatArray:
        return array([state[0], state[1], state[2] + math.pi])

    def same(other: float) -> bool:
        return other == pytest.approx(length, rel=1e-6, abs=1e-6 * radius)

    assert same(dubins_path(moved(start), moved(end), scale * radius).length / scale)
    assert same(dubins_path(mirrored(start), mirrored(end), radius).length)
    assert same(dubins_path(backwards(end), backwards(start), radius).length)
    turned = array([end[0], end[1], end[2] + 2 * math.tau])
    assert same(dubins_path(array(start), turned, radius).length)


@given(states, states, states, radii)
def test_a_detour_is_never_shorter(a: State, b: State, c: State, radius: float) -> None:
    assume(_stable(a, c, radius))
    one, two, direct = (dubins_path(array(p), array(q), radius).length for p, q in ((a, b), (b, c), (a, c)))
    assert direct <= one + two + 1e-6
    assert direct >= math.hypot(c[0] - a[0], c[1] - a[1]) - 1e-9


@given(coordinates, coordinates, angles, radii, st.integers(-2, 2))
def test_no_distance_takes_no_way(x: float, y: float, heading: float, radius: float, rounds: int) -> None:
    path = dubins_path(array([x, y, heading]), array([x, y, heading + rounds * math.tau]), radius)
    assert path.length == pytest.approx(0, abs=1e-8 * radius)


@given(coordinates, coordinates, angles, radii, st.floats(1e-6, 30))
def test_straight_ahead_is_straight(x: float, y: float, heading: float, radius: float, way: float) -> None:
    end = array([x + way * math.cos(heading), y + way * math.sin(heading), heading])
    assert dubins_path(array([x, y, heading]), end, radius).length == pytest.approx(way, abs=1e-6)


@given(st.floats(1e-3, math.pi), st.floats(1e-3, math.pi), st.sampled_from([1, -1]), angles, radii)
def test_two_arcs_that_touch_are_found(one: float, two: float, side: int, heading: float, radius: float) -> None:
    """An S-bend without a straight part lies on the edge of where its word exists: rounding must not lose it."""
    curve = DubinsPath("", 0.0, (side / radius, -side / radius), (one * radius, two * radius))
    x, y, theta = 1.0, -2.0, heading
    for curvature, length in zip(curve.curvatures, curve.lengths, strict=True):
        x += (math.sin(theta + curvature * length) - math.sin(theta)) / curvature
        y -= (math.cos(theta + curvature * length) - math.cos(theta)) / curvature
        theta += curvature * length
    path = dubins_path(array([1, -2, heading]), array([x, y, theta]), radius)
    assert path.length <= (one + two) * radius * (1 + 1e-6)


@given(angles, radii, st.floats(1e-3, math.tau - 1e-3), st.sampled_from([1, -1]))
def test_one_arc_is_found(heading: float, radius: float, turn: float, side: int) -> None:
    middle = array([-side * math.sin(heading), side * math.cos(heading)]) * radius
    end = middle - _rotate(middle, side * turn)
    path = dubins_path(array([0, 0, heading]), array([*end, heading + side * turn]), radius)
    assert path.length <= turn * radius * (1 + 1e-6)


def test_lattices_of_degenerate_states_never_give_nan() -> None:
    grid = [
        (float(x), float(y), t * math.pi / 4)
        for x, y, t in product((-4, -2, -1, 0, 1e-17, 1e-9, 2, 4), (-4, -2, 0, 1e-12, 2, 4), range(-4, 5))
    ]
    ends = array(grid)
    lengths = dubins_lengths(np.zeros_like(ends), ends, 1.0)
    assert np.isfinite(lengths).all()
    assert (lengths >= np.hypot(ends[:, 0], ends[:, 1]) - 2e-9).all()
    for end, length in zip(ends, lengths.tolist(), strict=True):
        path = dubins_path(np.zeros(3), end, 1.0)
        assert path.length == length
        reached = _walked((0, 0, 0), path, 4000)
        assert np.hypot(*(reached[:2] - end[:2])) < 1e-5


def test_wrong_input_is_refused() -> None:
    good = np.zeros(3)
    for radius in (0.0, -1.0, math.nan, math.inf):
        with pytest.raises(InputError, match="radius"):
            dubins_path(good, good, radius)
        with pytest.raises(InputError, match="radius"):
            dubins_lengths(good[None], good[None], radius)
    for start, end in ((array([0, 0, math.nan]), good), (good, array([math.inf, 0, 0]))):
        with pytest.raises(InputError, match="finite"):
            dubins_path(start, end, 1.0)
    assert dubins_lengths(np.zeros((0, 3)), np.zeros((0, 3)), 1.0).shape == (0,)


@pytest.mark.skipif(not ORACLE.exists(), reason="the published connectors are not here")
def test_published_lengths() -> None:
    with ORACLE.open() as stream:
        rows = list(csv.DictReader(stream))
    assert len(rows) > 100
    for row in rows:
        start, end = ([float(row[f"{name}{k}"]) for name in ("x", "y", "th")] for k in "01")
        path = dubins_path(array(start), array(end), 1 / float(row["kappa_max"]))
        assert path.length == pytest.approx(float(row["dubins_len"]), rel=1e-8)
        words = _by_circles(tuple(start), tuple(end), 1 / float(row["kappa_max"]))  # type: ignore[arg-type]
        if row["dubins_word"] in words:  # others leave out empty parts
            assert words[row["dubins_word"]] == pytest.approx(path.length, rel=1e-6)
