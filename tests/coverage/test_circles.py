"""Circles over walls: everything washed, nothing in vain, the fewest of the candidates."""

from __future__ import annotations

import itertools
import math

import numpy as np
import pytest
import shapely
from hypothesis import given, settings
from hypothesis import strategies as st
from scipy.sparse import csr_array

from optplan.coverage.circles import MAX_STOPS, fewest_circles, fewest_members, without_redundant
from optplan.coverage.patterns import CELLS, PATTERNS, lay, placements, plain, stretched
from optplan.coverage.room import Room
from optplan.domain.arrays import FloatArray
from optplan.domain.errors import InputError, LimitError
from optplan.domain.washing import WashOptions
from optplan.geometry.arrangements import faces_of, holders, without_supersets
from optplan.judge._washed import bare_spots, missed_area

WALL = shapely.Polygon([(0, 0), (7.3, 0), (7.3, 4.1), (3.1, 5.2), (0, 4.4)], [[(2, 1), (3.5, 1), (3.5, 3), (2, 3)]])
NOTCHED = shapely.Polygon([(0, 0), (6, 0), (6, 5), (4, 5), (4, 2.5), (2, 2.5), (2, 5), (0, 5)])


def washed(area: shapely.Polygon, centres: FloatArray, radius: float, seed: int = 0, count: int = 20_000) -> bool:
    """Whether random points of the area, its border and its corners all lie in a circle (to 1e-9 m)."""
    random = np.random.default_rng(seed)
    left, low, right, high = area.bounds
    points = random.uniform((left, low), (right, high), (count, 2))
    points = points[shapely.contains_xy(area, points[:, 0], points[:, 1])]
    line = shapely.segmentize(area.boundary, 0.01)
    points = np.concatenate([points, shapely.get_coordinates(line)])
    near = np.linalg.norm(points[:, None] - centres[None], axis=2).min(axis=1)
    return bool((near <= radius + 1e-9).all())


@pytest.mark.parametrize("pattern", PATTERNS)
@pytest.mark.parametrize("turn", [0, 17, 90])
def test_patterns_cover_the_plane(pattern: str, turn: float) -> None:
    cell = stretched(1.6) if pattern == "stretched" else CELLS[pattern]
    for area in (WALL, NOTCHED):
        laid = lay(area, 0.8, pattern, turn, (0.3, 0.6), cell)
        assert washed(area, laid.centres, 0.8)
        assert (shapely.distance(area, shapely.points(laid.centres)) <= 0.8).all()


def test_patterns_are_as_tight_as_they_can_be() -> None:
    for cell in [*CELLS.values(), stretched(1.5)]:
        # the corner that is farthest from the circles' centres is just reached
        places = np.array(
            [[i * cell.across + (j % 2) * cell.shift, j * cell.up] for i in range(-3, 4) for j in range(-2, 3)]
        )
        grid = np.stack(np.meshgrid(np.linspace(0, cell.across, 301), np.linspace(0, cell.up, 301)), axis=-1)
        far = np.linalg.norm(grid[..., None, :] - places, axis=-1).min(axis=-1).max()
        assert far == pytest.approx(1.0, abs=1e-2)


def test_hexagons_need_the_fewest_on_large_walls() -> None:
    area = shapely.box(0, 0, 40, 40)
    counts = {pattern: len(plain(area, 1.0, pattern).centres) for pattern in ("hexagon", "square", "brick")}
    assert counts["hexagon"] < counts["brick"] < counts["square"]


def test_placements_are_sorted() -> None:
    counts = [len(laid.centres) for laid in placements(WALL, 0.9, "hexagon")]
    assert counts == sorted(counts)


@settings(max_examples=40, deadline=None)
@given(st.integers(0, 10**6), st.integers(1, 9))
def test_faces_are_the_sets_of_circles_that_points_lie_in(seed: int, count: int) -> None:
    """Every random point of the area shares its set of circles with one of the faces."""
    random = np.random.default_rng(seed)
    centres = np.round(random.uniform(-0.5, 4.5, (count, 2)), random.integers(0, 3))
    area = shapely.Polygon([(0, 0), (4, 0), (4, 3), (1, 4)], [[(1, 1), (2, 1), (2, 2)]])
    faces = faces_of(area, centres, 1.0)
    known = {tuple(row) for row in faces.member.toarray().astype(bool).tolist()}
    points = random.uniform(0, 4, (3000, 2))
    points = points[shapely.contains_xy(area, points[:, 0], points[:, 1])]
    away = np.linalg.norm(points[:, None] - centres, axis=2)
    clear = (np.abs(away - 1) > 1e-3).all(axis=1)
    assert {tuple(row) for row in (away[clear] < 1).tolist()} <= known
    # and no face is made up
    away = np.linalg.norm(faces.points[:, None] - centres, axis=2)
    assert np.array_equal(away <= 1, faces.member.toarray().astype(bool))


@settings(max_examples=30, deadline=None)
@given(st.integers(0, 10**6))
def test_what_is_left_is_minimal(seed: int) -> None:
    random = np.random.default_rng(seed)
    laid = lay(NOTCHED, 0.9, "square", 0.0, (random.random(), random.random()))
    centres = np.concatenate([laid.centres, random.uniform(0, 5, (6, 2))])
    faces = faces_of(NOTCHED, centres, 0.9)
    kept = centres[without_redundant(faces)]
    assert washed(NOTCHED, kept, 0.9, seed)
    for k in range(len(kept)):
        rest = np.delete(kept, k, axis=0)
        assert bare_spots(NOTCHED, rest, np.full(len(rest), 0.9 * (1 - 1e-5)))


def test_supersets_say_nothing() -> None:
    random = np.random.default_rng(3)
    for _ in range(30):
        member = random.random((25, 6)) < 0.35
        member[:, 5] |= ~member.any(axis=1)
        kept = without_supersets(csr_array(member.astype(np.int8)))
        for row in member:
            assert any((member[k] <= row).all() for k in kept)
        for a, b in itertools.permutations(kept, 2):
            assert not (member[a] <= member[b]).all()


def test_fewest_is_that_of_enumeration() -> None:
    random = np.random.default_rng(5)
    for _ in range(4):
        member = random.random((14, 9)) < 0.3
        member[np.arange(14), random.integers(0, 9, 14)] = True
        best = next(
            size
            for size in range(1, 10)
            for chosen in itertools.combinations(range(9), size)
            if member[:, chosen].any(axis=1).all()
        )
        found, bound = fewest_members(csr_array(member.astype(np.int8)), np.arange(9), 20.0)
        assert len(found) == bound == best
        assert member[:, found].any(axis=1).all()


def test_rows_are_level_unless_they_may_turn() -> None:
    for turned in (False, True):
        for pattern in PATTERNS:
            laid = placements(WALL, 0.9, pattern, turned=turned)
            assert turned or all(one.turn == 0 for one in laid)
            assert not turned or {one.turn for one in laid} > {0}


@pytest.mark.parametrize("fewest", ["pattern", "minimal", "exact"])
@pytest.mark.parametrize("area", [WALL, NOTCHED], ids=["wall", "notched"])
def test_walls_are_washed(area: shapely.Polygon, fewest: str) -> None:
    found = fewest_circles(area, 1.0, WashOptions(fewest=fewest))
    assert washed(area, found.centres, 1.0)
    assert bare_spots(area, found.centres, np.ones(len(found.centres))) == []
    assert missed_area(area, found.centres, np.ones(len(found.centres))) < 1e-3
    if fewest == "exact":
        assert (
            found.bound == len(found.centres) <= len(fewest_circles(area, 1.0, WashOptions(fewest="minimal")).centres)
        )


def test_too_small_circles_are_refused() -> None:
    with pytest.raises(LimitError, match=str(MAX_STOPS)):
        fewest_circles(shapely.box(0, 0, 100, 100), 0.01, WashOptions())


@settings(max_examples=60, deadline=None)
@given(st.integers(0, 10**6))
def test_the_judge_finds_what_is_bare(seed: int) -> None:
    """One hole, however it is cut: the judge's lines against areas of polygons."""
    random = np.random.default_rng(seed)
    centres = lay(WALL, 1.0, "hexagon", float(random.integers(0, 60)), (random.random(), random.random())).centres
    gone = np.delete(centres, random.integers(len(centres)), axis=0)
    for tried in (centres, gone):
        radius = np.full(len(tried), 1.0 - 1e-9 if tried is centres else 1.0)
        inside = shapely.union_all(shapely.buffer(shapely.points(tried), radius, quad_segs=512))
        bare = WALL.difference(inside).area
        if bare > 1e-4:
            assert bare_spots(WALL, tried, radius)
        if not bare_spots(WALL, tried, radius):
            assert bare < 1e-4


def test_the_judge_sees_islands() -> None:
    """A part of the wall that touches no circle at all, and one ringed by a single circle."""
    square = shapely.box(0, 0, 1, 1)
    assert bare_spots(square, np.zeros((0, 2)), np.zeros(0))
    assert bare_spots(square, np.array([[9.0, 9.0]]), np.ones(1))
    assert bare_spots(square, np.array([[0.5, 0.5]]), np.array([math.sqrt(0.5) + 1e-9])) == []
    assert bare_spots(square, np.array([[0.5, 0.5]]), np.array([0.6]))
    ring = np.array([[math.cos(a), math.sin(a)] for a in np.linspace(0, 2 * math.pi, 13)[:-1]])
    around = shapely.Point(0, 0).buffer(1.2)
    assert bare_spots(around, ring, np.full(12, 0.7))


def test_holders() -> None:
    member = holders(np.array([[0.0, 0.0], [5, 5]]), np.array([[0.5, 0], [9, 9]]), 1.0)
    assert member.toarray().tolist() == [[1, 0], [0, 0]]


def test_centres_keep_to_their_room() -> None:
    """Above the ground, and left of an inner corner: the last 0.7 m are washed from its border."""
    room = Room(((-math.inf, 6.6),), 0.0)
    area = shapely.box(0, 0, 7.3, 4)
    for fewest in ("pattern", "minimal", "exact"):
        found = fewest_circles(area, 1.0, WashOptions(fewest=fewest, effort=2.0), room)
        assert washed(area, found.centres, 1.0)
        assert found.centres[:, 0].max() <= 6.6
        assert found.centres[:, 1].min() >= 0
    split = Room(((-1.0, 2.0), (3.2, 9.0)), 0.5)
    found = fewest_circles(area, 1.0, WashOptions(fewest="minimal"), split)
    assert washed(area, found.centres, 1.0)
    assert not ((found.centres[:, 0] > 2) & (found.centres[:, 0] < 3.2)).any()
    assert found.centres[:, 1].min() >= 0.5


def test_what_is_out_of_reach_is_said() -> None:
    with pytest.raises(InputError, match=r"out of reach at \(7.3.*inner corner"):
        fewest_circles(shapely.box(0, 0, 7.3, 4), 1.0, WashOptions(fewest="minimal"), Room(((-1.0, 6.2),)))


def test_one_circle_is_enough_for_a_small_wall() -> None:
    found = fewest_circles(shapely.box(0, 0, 0.5, 0.8), 1.0, WashOptions(fewest="pattern"), Room(low=0.2))
    assert len(found.centres) == found.bound == 1
    assert found.centres[0, 1] >= 0.2
