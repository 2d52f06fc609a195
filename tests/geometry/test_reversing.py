"""Paths with cusps: they end where they must, keep their limits, and are as short as they have to be."""

from __future__ import annotations

import math

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from optplan.domain.arrays import FloatArray
from optplan.domain.errors import InputError
from optplan.geometry.cc import cc_lengths
from optplan.geometry.dubins import dubins_lengths
from optplan.geometry.reversing import (
    ReversingPath,
    reeds_shepp_lengths,
    reeds_shepp_matrix,
    reeds_shepp_path,
    reversing_lengths,
    reversing_matrix,
    reversing_path,
)

NODES, WEIGHTS = np.polynomial.legendre.leggauss(12)

shares = st.one_of(st.sampled_from([0.0, 1.0, -1.0]), st.floats(-1, 1))
scales = st.floats(-3, 3).map(lambda e: 10.0**e)
difficulties = st.floats(-1.5, 1.2).map(lambda e: 10.0**e)
poses = st.tuples(st.floats(-8, 8), st.floats(-8, 8), st.floats(-7, 7))


def driven(start: FloatArray, path: ReversingPath) -> FloatArray:
    """The end of a path, x, y, body's heading, wheels' curvature, by quadrature of the body's motion."""
    x, y, theta = start[:3]
    wheels, moving = (start[3] if len(start) > 3 else 0.0), 0.0
    for gear, k, sigma, length in zip(path.gears, path.curvatures, path.sharpnesses, path.lengths, strict=True):
        if len(start) > 3:
            assert gear * k == pytest.approx(wheels, abs=1e-8 * max(1.0, abs(k))), "the wheels jump"
            assert moving in (0.0, gear) or abs(k) < 1e-8, "the curvature at a cusp is not 0"
        edges = np.linspace(0.0, length, 2 + int(2 * length * max(abs(k), abs(k + sigma * length))))
        half = np.diff(edges)[:, None] / 2
        u = edges[:-1, None] + half * (1 + NODES)
        heading = theta + u * (k + 0.5 * sigma * u)
        x += gear * float((half * WEIGHTS * np.cos(heading)).sum())
        y += gear * float((half * WEIGHTS * np.sin(heading)).sum())
        theta += length * (k + 0.5 * sigma * length)
        wheels, moving = gear * (k + sigma * length), gear
    return np.array([x, y, theta, wheels])


def check(start: FloatArray, end: FloatArray, path: ReversingPath, curvature: float, sharpness: float) -> None:
    """The path is one: it ends in its end, within its limits."""
    reached = driven(start, path)
    assert math.hypot(*(reached[:2] - end[:2])) <= 2e-9 * max(1.0, path.length)
    assert abs(math.remainder(reached[2] - end[2], 2 * math.pi)) <= 3e-9
    if len(end) > 3 and path.length > 0:
        assert reached[3] == pytest.approx(end[3], abs=1e-8 * curvature)
    assert (path.lengths > 0).all()
    assert path.lengths.sum() == pytest.approx(path.length, rel=1e-12)
    bends = np.concatenate([path.curvatures, path.curvatures + path.sharpnesses * path.lengths])
    assert (np.abs(bends) <= curvature * (1 + 1e-9)).all()
    assert (np.abs(path.sharpnesses) <= sharpness * (1 + 1e-9)).all()


def states(random: np.random.Generator, count: int, box: float, curvature: float) -> FloatArray:
    """Random rows x, y, heading, curvature."""
    bends = curvature * random.choice([-1.0, 0.0, 0.0, 1.0, *random.uniform(-1, 1, 3)], count)
    return np.column_stack([random.uniform(0, box, (count, 2)), random.uniform(-math.pi, math.pi, count), bends])


@given(poses, poses, scales)
def test_reeds_shepp_paths_end_where_they_must(
    start: tuple[float, float, float], end: tuple[float, float, float], scale: float
) -> None:
    first, last = (np.array([scale * x, scale * y, theta]) for x, y, theta in (start, end))
    path = reeds_shepp_path(first, last, scale)
    reached = driven(first, path)
    assert math.hypot(*(reached[:2] - last[:2])) <= 1e-7 * scale
    assert abs(math.remainder(reached[2] - last[2], 2 * math.pi)) <= 1e-7
    assert path.length == pytest.approx(reeds_shepp_lengths(first[None], last[None], scale)[0], abs=1e-9 * scale)
    assert path.length <= dubins_lengths(first[None], last[None], scale)[0] * (1 + 1e-9) + 1e-9 * scale
    assert path.length >= math.dist(first[:2], last[:2]) * (1 - 1e-9) - 1e-9 * scale
    assert path.cusps <= 2


def test_reeds_shepp_lengths_are_a_distance() -> None:
    """Symmetric, and no detour over a third state is shorter: what holds of shortest paths only."""
    random = np.random.default_rng(1)
    for box in (0.3, 2.0, 5.0):
        a, b, c = (states(random, 20_000, box, 1.0)[:, :3] for _ in range(3))
        direct = reeds_shepp_lengths(a, c, 1.0)
        assert direct == pytest.approx(reeds_shepp_lengths(c, a, 1.0), abs=1e-9)
        detour = reeds_shepp_lengths(a, b, 1.0) + reeds_shepp_lengths(b, c, 1.0)
        assert (direct <= detour + 1e-9).all()


def test_reeds_shepp_lengths_against_a_search_over_short_motions() -> None:
    """Cells of a fine grid reached by short arcs and lines in both gears: paths that need no words."""
    steps = [(gear, bend) for gear in (1, -1) for bend in (-1, 0, 1)]
    known: dict[tuple[int, ...], tuple[float, tuple[float, float, float]]] = {}
    fringe = [(0.0, 0.0, 0.0)]
    step = 0.2
    for depth in range(1, 9):
        following = []
        for x, y, theta in fringe:
            for gear, bend in steps:
                turned = theta + gear * bend * step
                if bend:
                    place = (
                        x + (math.sin(turned) - math.sin(theta)) / bend,
                        y - (math.cos(turned) - math.cos(theta)) / bend,
                        turned,
                    )
                else:
                    place = (x + gear * step * math.cos(theta), y + gear * step * math.sin(theta), theta)
                cell = (round(place[0] / 0.05), round(place[1] / 0.05), round(turned / 0.05))
                if cell not in known:
                    known[cell] = (depth * step, place)
                    following.append(place)
        fringe = following
    reached = np.array([place for _, place in known.values()])
    found = np.array([length for length, _ in known.values()])
    best = reeds_shepp_lengths(np.zeros_like(reached), reached, 1.0)
    assert (best <= found + 1e-9).all()
    assert len(found) > 9000
    assert (best > found - 1e-9).mean() > 0.05


def test_known_reeds_shepp_paths() -> None:
    turn = reeds_shepp_path(np.zeros(3), np.array([0.0, 0.0, math.pi]), 1.0)
    assert turn.length == pytest.approx(math.pi)
    assert turn.cusps == 2
    back = reeds_shepp_path(np.zeros(3), np.array([-3.0, 0.0, 0.0]), 1.0)
    assert back.word == "S-"
    assert back.length == pytest.approx(3.0)
    random = np.random.default_rng(3)
    ends = np.column_stack([random.uniform(-3, 3, (20_000, 2)), random.uniform(-math.pi, math.pi, 20_000)])
    words = {reeds_shepp_path(np.zeros(3), end, 1.0).word for end in ends}
    assert len(words) == 48
    assert {"L+R-S-L-R+", "L+R-L-R+", "L+R+L-R-", "L+R-S-R-"} <= words


@given(poses, poses, shares, shares, scales, difficulties)
def test_paths_end_where_they_must(
    start: tuple[float, float, float],
    end: tuple[float, float, float],
    a: float,
    b: float,
    scale: float,
    difficulty: float,
) -> None:
    first = np.array([scale * start[0], scale * start[1], start[2], a / scale])
    last = np.array([scale * end[0], scale * end[1], end[2], b / scale])
    limits = 1 / scale, 1 / scale**2 / difficulty
    path = reversing_path(first, last, *limits)
    check(first, last, path, *limits)
    assert path.length == pytest.approx(reversing_lengths(first[None], last[None], *limits)[0], rel=1e-8)
    assert path.length <= cc_lengths(first[None], last[None], *limits)[0] * (1 + 1e-8)
    assert path.length >= reeds_shepp_lengths(first[None, :3], last[None, :3], scale)[0] * (1 - 1e-9)


@pytest.mark.parametrize("difficulty", [0.05, 0.4, 1.3, 5.0])
def test_moved_mirrored_reversed_turned_round_and_scaled_queries_are_as_long(difficulty: float) -> None:
    """But for the few in which Newton's method from the same guess ends elsewhere by the last digit."""
    random = np.random.default_rng(7)
    first, last = states(random, 5000, 6.0, 1.0), states(random, 5000, 6.0, 1.0)
    known = reversing_lengths(first, last, 1.0, 1 / difficulty)
    mirror, back = np.array([1.0, -1.0, -1.0, -1.0]), np.array([1.0, 1.0, 1.0, -1.0])
    turned, moved = np.array([0, 0, math.pi, 0]), np.array([3.0, -2.0, 1.1, 0.0])
    c, s = math.cos(1.1), math.sin(1.1)
    rotation = np.array([[c, s, 0, 0], [-s, c, 0, 0], [0, 0, 1, 0], [0, 0, 0, 1]])
    larger = np.array([7.0, 7.0, 1.0, 1 / 7])
    for what, start, end, size in (
        ("driven back", last, first, 1.0),
        ("mirrored", first * mirror, last * mirror, 1.0),
        ("in the other gears", first * back + turned, last * back + turned, 1.0),
        ("moved", first @ rotation + moved, last @ rotation + moved, 1.0),
        ("scaled", first * larger, last * larger, 7.0),
    ):
        lengths = reversing_lengths(start, end, 1 / size, 1 / difficulty / size**2) / size
        assert (np.abs(lengths / known - 1) < 1e-7).mean() >= 0.995, what


@pytest.mark.parametrize("difficulty", [0.05, 0.6, 1.2, 5.0])
def test_there_is_always_a_path(difficulty: float) -> None:
    random = np.random.default_rng(int(10 * difficulty))
    limits = 1.1, 1.21 / difficulty
    for box in (0.0, 1e-6, 1e-3, 1.0, 10.0):
        starts, ends = states(random, 5000, box, 1.1), states(random, 5000, box, 1.1)
        lengths = reversing_lengths(starts, ends, *limits)
        assert np.isfinite(lengths).all()
        assert (lengths <= cc_lengths(starts, ends, *limits) * (1 + 1e-8)).all()
        for start, end, length in zip(starts[:60], ends[:60], lengths[:60], strict=True):
            path = reversing_path(start, end, *limits)
            check(start, end, path, *limits)
            assert path.length == pytest.approx(length, rel=1e-8)


def test_reversing_pays() -> None:
    random = np.random.default_rng(5)
    starts, ends = (np.column_stack([states(random, 5000, 3.0, 1.0)[:, :3], np.zeros(5000)]) for _ in range(2))
    assert (reversing_lengths(starts, ends, 1.0, 2.0) / cc_lengths(starts, ends, 1.0, 2.0)).mean() < 0.6


def test_sharp_limits_give_reeds_shepp_lengths() -> None:
    random = np.random.default_rng(2)
    starts, ends = (np.column_stack([states(random, 5000, 5.0, 1.0)[:, :3], np.zeros(5000)]) for _ in range(2))
    limit = reeds_shepp_lengths(starts[:, :3], ends[:, :3], 1.0)
    assert reversing_lengths(starts, ends, 1.0, 1e6) == pytest.approx(limit, rel=1e-4, abs=1e-4)


def test_a_matrix_is_all_lengths() -> None:
    random = np.random.default_rng(6)
    exits, entries = states(random, 30, 4.0, 1.0), states(random, 20, 4.0, 1.0)
    told: list[float] = []
    matrix = reversing_matrix(exits, entries, 1.0, 1.5, told=told.append)
    plain = reeds_shepp_matrix(exits[:, :3], entries[:, :3], 1.0)
    for i in range(30):
        row = np.tile(exits[i], (20, 1))
        assert (matrix[i] == reversing_lengths(row, entries, 1.0, 1.5)).all()
        assert (plain[i] == reeds_shepp_lengths(row[:, :3], entries[:, :3], 1.0)).all()
    assert told[-1] == 1.0


def test_no_way_is_no_path() -> None:
    state = np.array([1.0, 2.0, 3.0, 0.4])
    assert len(reversing_path(state, state, 1.0, 1.0).lengths) == 0
    assert len(reeds_shepp_path(state[:3], state[:3], 1.0).lengths) == 0


def test_what_cannot_be_solved_is_refused() -> None:
    good, bad = np.zeros(4), np.array([0.0, math.nan, 0.0, 0.0])
    with pytest.raises(InputError, match="radius"):
        reeds_shepp_path(good[:3], good[:3], 0.0)
    with pytest.raises(InputError, match="finite"):
        reeds_shepp_lengths(bad[None, :3], good[None, :3], 1.0)
    with pytest.raises(InputError, match="curvature"):
        reversing_path(good, np.array([0, 0, 0, 2.0]), 1.0, 1.0)
    with pytest.raises(InputError, match="as many"):
        reversing_lengths(np.zeros((2, 4)), np.zeros((1, 4)), 1.0, 1.0)


def test_words_that_are_left_out_are_nobodys_words() -> None:
    """Whatever was in the memory before: a length that was only a limit may come back a digit smaller."""
    from optplan.geometry._kernels import cusps

    words = np.full((cusps.WORDS, cusps.COLUMNS), 2.0)
    cusps.cusp_words(3.0, 1.0, 0.5, 1e-3, cusps.arcs(), words)
    assert (words[:, 0] == 1e-3).all()
    assert (words[:, 1] == cusps.NONE).all()
    cusps.cusp_words(3.0, 1.0, 0.5, math.inf, cusps.arcs(), words)
    there = np.isfinite(words[:, 0])
    assert there.any()
    assert ((words[:, 1] != cusps.NONE) == there).all()
    assert (words[there, 0] >= math.hypot(3.0, 1.0)).all()
