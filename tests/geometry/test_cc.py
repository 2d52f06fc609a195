"""Paths of continuous curvature: they end where they must, keep their limits, and are as short as known ones."""

from __future__ import annotations

import csv
import math
from collections import defaultdict
from pathlib import Path

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from optplan.domain.arrays import FloatArray
from optplan.domain.errors import InputError
from optplan.geometry.cc import CCPath, Family, cc_lengths, cc_lower_bounds, cc_matrix, cc_path

DATA = Path(__file__).parents[3] / "shared" / "data" / "connectors"
known = pytest.mark.skipif(not DATA.is_dir(), reason="the lists of known lengths are not here")
FAMILIES: tuple[Family, ...] = ("full", "reference")
NODES, WEIGHTS = np.polynomial.legendre.leggauss(12)

shares = st.one_of(st.sampled_from([0.0, 1.0, -1.0]), st.floats(-1, 1))
scales = st.floats(-3, 3).map(lambda e: 10.0**e)
difficulties = st.floats(-1.5, 1.2).map(lambda e: 10.0**e)
poses = st.tuples(st.floats(-8, 8), st.floats(-8, 8), st.floats(-7, 7))


def driven(path: CCPath) -> FloatArray:
    """The end of a path by quadrature with half a radian a panel."""
    x, y, theta, kappa = path.start
    for k, sigma, length in zip(path.curvatures, path.sharpnesses, path.lengths, strict=True):
        assert k == pytest.approx(kappa, abs=1e-9 * max(1.0, abs(k))), "the curvature jumps"
        edges = np.linspace(0.0, length, 2 + int(2 * length * max(abs(k), abs(k + sigma * length))))
        half = np.diff(edges)[:, None] / 2
        u = edges[:-1, None] + half * (1 + NODES)
        heading = theta + u * (k + 0.5 * sigma * u)
        x += float((half * WEIGHTS * np.cos(heading)).sum())
        y += float((half * WEIGHTS * np.sin(heading)).sum())
        theta += length * (k + 0.5 * sigma * length)
        kappa = k + sigma * length
    return np.array([x, y, theta, kappa])


def check(path: CCPath, end: FloatArray, curvature: float, sharpness: float) -> None:
    """The path is one: it ends in its end, within its limits."""
    reached = driven(path)
    assert math.hypot(*(reached[:2] - end[:2])) <= 1e-9 * max(1.0, path.length)
    assert abs(math.remainder(reached[2] - end[2], 2 * math.pi)) <= 2e-9
    assert reached[3] == pytest.approx(end[3], abs=1e-9 * curvature)
    assert (path.lengths > 0).all()
    assert path.lengths.sum() == pytest.approx(path.length, rel=1e-12)
    bends = np.concatenate([path.curvatures, path.curvatures + path.sharpnesses * path.lengths])
    assert (np.abs(bends) <= curvature * (1 + 1e-9)).all()
    assert (np.abs(path.sharpnesses) <= sharpness * (1 + 1e-9)).all()


def states(random: np.random.Generator, count: int, box: float, curvature: float) -> FloatArray:
    """Random rows x, y, heading, curvature."""
    return np.column_stack(
        [
            random.uniform(0, box, (count, 2)),
            random.uniform(-math.pi, math.pi, count),
            curvature * random.choice([-1.0, 0.0, 1.0, *random.uniform(-1, 1, 3)], count),
        ]
    )


@given(poses, poses, shares, shares, scales, difficulties, st.sampled_from(["full", "reference"]))
def test_paths_end_where_they_must(
    start: tuple[float, float, float],
    end: tuple[float, float, float],
    a: float,
    b: float,
    scale: float,
    difficulty: float,
    family: Family,
) -> None:
    first = np.array([scale * start[0], scale * start[1], start[2], a / scale])
    last = np.array([scale * end[0], scale * end[1], end[2], b / scale])
    sharpness = 1 / scale**2 / difficulty
    path = cc_path(first, last, 1 / scale, sharpness, family)
    check(path, last, 1 / scale, sharpness)
    assert path.length == pytest.approx(cc_lengths(first[None], last[None], 1 / scale, sharpness, family)[0], rel=1e-9)
    assert path.length >= cc_lower_bounds(first[None], last[None], 1 / scale)[0] * (1 - 1e-9)
    assert list(path.runners_up) == sorted(path.runners_up, key=lambda row: row[1])


@given(poses, shares, shares, scales, difficulties)
def test_moved_mirrored_reversed_and_scaled_queries_are_as_long(
    end: tuple[float, float, float], a: float, b: float, scale: float, difficulty: float
) -> None:
    x, y, theta = end
    first, last = np.array([0, 0, 0, a]), np.array([x, y, theta, b])
    length = cc_path(first, last, 1.0, 1 / difficulty).length
    mirror = np.array([1.0, -1.0, -1.0, -1.0])
    assert cc_path(first * mirror, last * mirror, 1.0, 1 / difficulty).length == pytest.approx(length, rel=1e-7)
    back = np.array([0, 0, math.pi, 0]), np.array([1.0, 1.0, 1.0, -1.0])
    assert cc_path(
        (last + back[0]) * back[1], (first + back[0]) * back[1], 1.0, 1 / difficulty
    ).length == pytest.approx(length, rel=1e-7)
    c, s = math.cos(1.1), math.sin(1.1)
    moved = [np.array([3 + c * x - s * y, c * y + s * x - 2, t + 1.1, k]) for x, y, t, k in (first, last)]
    assert cc_path(moved[0], moved[1], 1.0, 1 / difficulty).length == pytest.approx(length, rel=1e-7)
    larger = np.array([scale, scale, 1.0, 1 / scale])
    scaled = cc_path(first * larger, last * larger, 1 / scale, 1 / difficulty / scale**2).length
    assert scaled == pytest.approx(length * scale, rel=1e-7)


@pytest.mark.parametrize("difficulty", [0.05, 0.6, 1.2, 2.0, 5.0, 10.0])
def test_there_is_always_a_path(difficulty: float) -> None:
    random = np.random.default_rng(int(10 * difficulty))
    for box in (0.0, 1e-6, 1e-3, 1.0, 10.0):
        starts, ends = states(random, 2000, box, 1.1), states(random, 2000, box, 1.1)
        for family in FAMILIES:
            lengths = cc_lengths(starts, ends, 1.1, 1.21 / difficulty, family)
            assert np.isfinite(lengths).all()
            assert (lengths >= cc_lower_bounds(starts, ends, 1.1) * (1 - 1e-9)).all()
            for start, end, length in zip(starts[:60], ends[:60], lengths[:60], strict=True):
                path = cc_path(start, end, 1.1, 1.21 / difficulty, family)
                check(path, end, 1.1, 1.21 / difficulty)
                assert path.length == pytest.approx(length, rel=1e-9)


def test_no_way_is_no_path() -> None:
    state = np.array([1.0, 2.0, 3.0, 0.4])
    path = cc_path(state, state, 1.0, 1.0)
    assert path.length == 0.0
    assert len(path.lengths) == 0
    assert cc_lengths(state[None], state[None], 1.0, 1.0)[0] == 0.0


def test_straight_on_is_a_line() -> None:
    for family in FAMILIES:
        path = cc_path(
            np.array([1.0, 1, 0.5, 0]), np.array([1 + 3 * math.cos(0.5), 1 + 3 * math.sin(0.5), 0.5, 0]), 1, 1, family
        )
        assert path.length == pytest.approx(3.0, rel=1e-12)
        assert len(path.lengths) == 1


@pytest.mark.parametrize("curvature", [0.0, 0.7, -1.0])
def test_a_clothoid_that_joins_two_states_is_found(curvature: float) -> None:
    """Down to 0 and straight on: one turn has no peak at all. Blunter words from the limit may be shorter."""
    from optplan.geometry._kernels.clothoid import clothoid_end

    bend = clothoid_end(0, 0, 0, curvature, -math.copysign(1.0, curvature), abs(curvature))
    end = np.array(clothoid_end(*bend[:3], 0.0, 0.0, 2.0))
    path = cc_path(np.array([0, 0, 0, curvature]), end, 1.0, 1.0)
    check(path, end, 1.0, 1.0)
    known = [path.length, *(length for _, length in path.runners_up)]
    assert min(abs(length - abs(curvature) - 2.0) for length in known) <= 1e-9
    assert path.length <= (abs(curvature) + 2.0) * (1 + 1e-9)


@pytest.mark.parametrize(
    ("curvature", "pieces"),
    [
        (0.5, [(1, 0.3), (-1, 0.3)]),
        (0.5, [(1, 0.5), (0, 1.0), (-1, 0.5)]),
        (1.0, [(0, 1.0)]),
        (0.5, [(0, 1.0)]),
        (0.2, [(1, 0.6)]),
        (-0.2, [(1, 0.6)]),
        (0.0, [(1, 0.8), (-1, 0.8)]),
        (0.0, [(1, 0.5), (-1, 1.1), (1, 0.6)]),
    ],
)
def test_ways_with_pieces_missing_are_found(curvature: float, pieces: list[tuple[float, float]]) -> None:
    """One turn, one arc, one clothoid: words whose extrema merge. Nothing longer may be returned."""
    from optplan.geometry._kernels.clothoid import clothoid_end

    x, y, theta, kappa = 0.0, 0.0, 0.0, curvature
    for sigma, length in pieces:
        x, y, theta, kappa = clothoid_end(x, y, theta, kappa, sigma, length)
    end = np.array([x, y, theta, kappa])
    path = cc_path(np.array([0, 0, 0, curvature]), end, 1.0, 1.0)
    check(path, end, 1.0, 1.0)
    assert path.length <= sum(length for _, length in pieces) * (1 + 1e-9)


@pytest.mark.parametrize(
    ("start", "end", "length"),
    [
        ([1.9, 0.1, -2.1, 1.0], [0.0, 1.7, -2.1, -1.0], 17.271),
        ([0.2, 0.1, -0.8, -1.0], [1.9, 1.5, -1.0, 1.0], 17.82),
        ([0.8, 0.9, 0.6, 0.0], [1.5, 1.1, 2.3, 0.0], 10.367),
    ],
)
def test_where_words_are_long_peaks_below_the_limit_are_found(
    start: list[float], end: list[float], length: float
) -> None:
    path = cc_path(np.array(start), np.array(end), 1.0, 0.2)
    check(path, np.array(end), 1.0, 0.2)
    assert path.length <= length


def test_a_sharpness_without_limit_gives_dubins() -> None:
    random = np.random.default_rng(5)
    starts, ends = states(random, 500, 10, 0.0), states(random, 500, 10, 0.0)
    bounds = cc_lower_bounds(starts, ends, 1.0)
    np.testing.assert_allclose(cc_lengths(starts, ends, 1.0, 1e7), bounds, rtol=1e-5)


def test_a_matrix_is_all_pairs_and_full_is_never_longer() -> None:
    random = np.random.default_rng(6)
    exits, entries = states(random, 30, 10, 1.0), states(random, 20, 10, 1.0)
    matrix = cc_matrix(exits, entries, 1.0, 0.5)
    rows, columns = np.indices(matrix.shape).reshape(2, -1)
    np.testing.assert_array_equal(matrix.ravel(), cc_lengths(exits[rows], entries[columns], 1.0, 0.5))
    assert (matrix <= cc_matrix(exits, entries, 1.0, 0.5, "reference") * (1 + 1e-12)).all()
    assert cc_matrix(exits[:0], entries, 1.0, 0.5).shape == (0, 20)


def rows(name: str) -> list[dict[str, str]]:
    with (DATA / name).open() as stream:
        return list(csv.DictReader(stream))


def ratios(name: str, column: str, family: Family) -> FloatArray:
    """Length over the listed one, of all rows."""
    groups: dict[tuple[float, float], list[dict[str, str]]] = defaultdict(list)
    for row in rows(name):
        groups[float(row["kappa_max"]), float(row["sigma_max"])].append(row)
    found = []
    for limits, group in groups.items():
        ends = [
            np.array([[float(row.get(f"{what}{i}", 0)) for what in ("x", "y", "th", "k")] for row in group])
            for i in range(2)
        ]
        found.append(cc_lengths(ends[0], ends[1], *limits, family) / [float(row[column]) for row in group])
    return np.concatenate(found)


@known
def test_known_lengths() -> None:
    assert np.abs(ratios("cc00.csv", "cc00_len", "reference") - 1).max() <= 1e-9
    assert ratios("cc00.csv", "cc00_len", "full").max() <= 1 + 1e-9
    assert ratios("ccpm.csv", "cc_len", "full").mean() <= 0.85


@known
@pytest.mark.parametrize("name", ["ccpm.csv", "ccarb.csv"])
def test_between_curved_ends_no_listed_path_is_shorter(name: str) -> None:
    for row in rows(name):
        start, end = (np.array([[float(row[f"{what}{i}"]) for what in ("x", "y", "th", "k")]]) for i in range(2))
        limits = float(row["kappa_max"]), float(row["sigma_max"])
        listed = float(row["cc_len"]) * (1 + 1e-9)
        if cc_lengths(start, end, *limits)[0] > listed:
            # listed paths miss their ends, by up to 33 um: this one is shorter for that alone
            angles = np.linspace(0, 2 * math.pi, 32, endpoint=False)
            around = np.repeat(end, len(angles), axis=0)
            around[:, :2] += 3.3e-5 * np.column_stack([np.cos(angles), np.sin(angles)])
            assert cc_lengths(np.repeat(start, len(angles), axis=0), around, *limits).min() <= listed, row["id"]


@known
@pytest.mark.parametrize(("easiest", "hardest", "share"), [(0.0, 2.001, 0.97), (4.999, 99.0, 0.9)])
def test_few_are_longer_than_the_best_known(easiest: float, hardest: float, share: float) -> None:
    queries = {row["id"]: row for row in rows("cc00.csv")}
    good = []
    for row in rows("best.csv"):
        limits = float(row["kappa_max"]), float(row["sigma_max"])
        if easiest <= limits[0] ** 2 / limits[1] <= hardest:
            query = queries[row["id"]]
            start, end = (
                np.array([[*(float(query[f"{what}{i}"]) for what in ("x", "y", "th")), 0.0]]) for i in range(2)
            )
            good.append(cc_lengths(start, end, *limits)[0] <= 1.002 * float(row["best_known_len"]))
    assert np.mean(good) >= share


@pytest.mark.parametrize(
    ("start", "end", "limits", "says"),
    [
        ([0, 0, 0, 0], [1, 0, 0, 0], (0.0, 1.0), "curvature limit"),
        ([0, 0, 0, 0], [1, 0, 0, 0], (1.0, -1.0), "sharpness limit"),
        ([0, 0, 0, 0], [1, 0, 0, 0], (math.inf, 1.0), "curvature limit"),
        ([0, 0, math.nan, 0], [1, 0, 0, 0], (1.0, 1.0), "not finite"),
        ([0, 0, 0, 0], [1, 0, 0, 1.01], (1.0, 1.0), "at most the limit"),
        ([0, 0, 0], [1, 0, 0], (1.0, 1.0), "shape"),
    ],
)
def test_bad_input_is_refused(start: list[float], end: list[float], limits: tuple[float, float], says: str) -> None:
    with pytest.raises(InputError, match=says):
        cc_path(np.array(start), np.array(end), *limits)
    with pytest.raises(InputError, match=says):
        cc_lengths(np.array([start]), np.array([end]), *limits)


def test_unequal_batches_and_unknown_families_are_refused() -> None:
    with pytest.raises(InputError, match="as many of both"):
        cc_lengths(np.zeros((2, 4)), np.zeros((3, 4)), 1.0, 1.0)
    with pytest.raises(InputError, match="family"):
        cc_path(np.zeros(4), np.zeros(4), 1.0, 1.0, "other")  # type: ignore[arg-type]
