"""Path data against what the SVG specification says about each command."""

from __future__ import annotations

import cmath
import contextlib
import math

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from optplan.domain.errors import InputError, LimitError
from optplan.jobs.svg._path import Subpath, parse_path


def only(text: str) -> Subpath:
    subpaths, problem = parse_path(text)
    assert problem is None
    assert len(subpaths) == 1
    return subpaths[0]


def sampled(path: Subpath, count: int = 60) -> np.ndarray[tuple[int], np.dtype[np.complex128]]:
    t = np.linspace(0, 1, count)
    pieces = []
    for a, pair, b in zip(path.points, path.handles, path.points[1:], strict=False):
        p, q = pair if pair else ((2 * a + b) / 3, (a + 2 * b) / 3)
        pieces.append((1 - t) ** 3 * a + 3 * (1 - t) ** 2 * t * p + 3 * (1 - t) * t**2 * q + t**3 * b)
    return np.concatenate(pieces)


@pytest.mark.parametrize(
    ("text", "points"),
    [
        ("M1 2L3 4", [1 + 2j, 3 + 4j]),
        ("m1 2l3 4", [1 + 2j, 4 + 6j]),
        ("M1 2 3 4 5 6", [1 + 2j, 3 + 4j, 5 + 6j]),
        ("m1 2 3 4 5 6", [1 + 2j, 4 + 6j, 9 + 12j]),
        ("M1 2H5V7", [1 + 2j, 5 + 2j, 5 + 7j]),
        ("M1 2h5v7", [1 + 2j, 6 + 2j, 6 + 9j]),
        ("M1 2H5 6 7", [1 + 2j, 5 + 2j, 6 + 2j, 7 + 2j]),
        ("M1,2,3,4", [1 + 2j, 3 + 4j]),
        ("M1.5.5-3 4e1", [1.5 + 0.5j, -3 + 40j]),
        ("M-.5-.5.5.5", [-0.5 - 0.5j, 0.5 + 0.5j]),
        (" \n M 1\t2\r L +3 1E-1 ", [1 + 2j, 3 + 0.1j]),
        ("M1. 2.L3.,4.", [1 + 2j, 3 + 4j]),
    ],
)
def test_lines(text: str, points: list[complex]) -> None:
    path = only(text)
    assert path.points == pytest.approx(points)
    assert not any(path.handles)
    assert not path.closed


@pytest.mark.parametrize(
    ("text", "cubics"),
    [
        ("M1 1C2 3 4 5 6 7", [(2 + 3j, 4 + 5j, 6 + 7j)]),
        ("M1 1c2 3 4 5 6 7", [(3 + 4j, 5 + 6j, 7 + 8j)]),
        ("M0 0C0 1 1 2 2 2S4 1 4 0", [(1j, 1 + 2j, 2 + 2j), (3 + 2j, 4 + 1j, 4 + 0j)]),
        ("M0 0c0 1 1 2 2 2s2-1 2-2", [(1j, 1 + 2j, 2 + 2j), (3 + 2j, 4 + 1j, 4 + 0j)]),
        ("M1 1S2 3 4 5", [(1 + 1j, 2 + 3j, 4 + 5j)]),
        ("M0 0Q3 3 6 0", [(2 + 2j, 4 + 2j, 6 + 0j)]),
        ("M1 0q3 3 6 0", [(3 + 2j, 5 + 2j, 7 + 0j)]),
        ("M0 0Q3 3 6 0T12 0", [(2 + 2j, 4 + 2j, 6 + 0j), (8 - 2j, 10 - 2j, 12 + 0j)]),
        ("M0 0q3 3 6 0t6 0", [(2 + 2j, 4 + 2j, 6 + 0j), (8 - 2j, 10 - 2j, 12 + 0j)]),
        ("M1 1T4 1", [(1 + 1j, 2 + 1j, 4 + 1j)]),
        # S after a quadratic and T after a cubic mirror nothing
        ("M0 0Q3 3 6 0S8 1 9 0", [(2 + 2j, 4 + 2j, 6 + 0j), (6 + 0j, 8 + 1j, 9 + 0j)]),
        ("M0 0C0 1 1 2 3 0T6 0", [(1j, 1 + 2j, 3 + 0j), (3 + 0j, 4 + 0j, 6 + 0j)]),
    ],
)
def test_curves(text: str, cubics: list[tuple[complex, complex, complex]]) -> None:
    path = only(text)
    for pair, end, (first, second, stop) in zip(path.handles, path.points[1:], cubics, strict=True):
        assert pair == pytest.approx((first, second))
        assert end == pytest.approx(stop)


def test_a_line_between_curves_ends_the_mirroring() -> None:
    path = only("M0 0C0 1 1 2 2 2L3 2S4 1 4 0")
    assert path.handles[2] == (3 + 2j, 4 + 1j)


def test_closing_starts_the_next_subpath_where_this_one_began() -> None:
    subpaths, problem = parse_path("M1 1l2 0v2zl5 5M9 9h1Z")
    assert problem is None
    assert [path.closed for path in subpaths] == [True, False, True]
    assert subpaths[1].points == [1 + 1j, 6 + 6j]


def test_a_relative_move_after_closing_counts_from_the_start() -> None:
    subpaths, _ = parse_path("m1 1l2 0v2zm5 5h1")
    assert subpaths[1].points == [6 + 6j, 7 + 6j]


def reference_arc(
    start: complex, rx: float, ry: float, turn: float, large: bool, positive: bool, end: complex, count: int
) -> np.ndarray[tuple[int], np.dtype[np.complex128]]:
    """Points of an arc by the conversion from end points to centre of the SVG specification, B.2.4."""
    phi = math.radians(turn)
    cos, sin = math.cos(phi), math.sin(phi)
    x, y = (start - end).real / 2, (start - end).imag / 2
    x1, y1 = cos * x + sin * y, -sin * x + cos * y
    excess = x1**2 / rx**2 + y1**2 / ry**2
    if excess > 1:
        rx, ry = rx * math.sqrt(excess), ry * math.sqrt(excess)
    under = rx**2 * ry**2 - rx**2 * y1**2 - ry**2 * x1**2
    factor = math.sqrt(max(0.0, under) / (rx**2 * y1**2 + ry**2 * x1**2)) * (1 if large != positive else -1)
    cx1, cy1 = factor * rx * y1 / ry, -factor * ry * x1 / rx
    middle = (start + end) / 2
    cx, cy = cos * cx1 - sin * cy1 + middle.real, sin * cx1 + cos * cy1 + middle.imag
    theta = math.atan2((y1 - cy1) / ry, (x1 - cx1) / rx)
    last = math.atan2((-y1 - cy1) / ry, (-x1 - cx1) / rx)
    sweep = (last - theta) % (2 * math.pi)
    if not positive:
        sweep -= 2 * math.pi
    angle = theta + np.linspace(0, sweep, count)
    return (
        cx
        + cos * rx * np.cos(angle)
        - sin * ry * np.sin(angle)
        + 1j * (cy + sin * rx * np.cos(angle) + cos * ry * np.sin(angle))
    )


@pytest.mark.parametrize("large", [False, True])
@pytest.mark.parametrize("positive", [False, True])
@pytest.mark.parametrize(
    ("rx", "ry", "turn"), [(5, 5, 0), (8, 3, 0), (8, 3, 30), (3, 8, -75), (1, 1, 20), (1, 0.5, 400), (-8, -3, 30)]
)
def test_arcs(rx: float, ry: float, turn: float, large: bool, positive: bool) -> None:
    start, end = 1 + 2j, 6 + 3j
    path = only(f"M1 2A{rx} {ry} {turn} {large:d} {positive:d} 6 3")
    assert path.points[-1] == end
    reference = reference_arc(start, abs(rx), abs(ry), turn, large, positive, end, 4000)
    radius = max(abs(rx), abs(ry), 3)
    points = sampled(path)
    apart = np.abs(points[:, None] - reference)
    assert apart.min(axis=1).max() < 2e-3 * radius  # limited by how dense the reference is
    assert apart.min(axis=0).max() < 0.05 * radius


def test_arcs_deviate_less_than_a_hundred_thousandth_of_the_radius() -> None:
    points = sampled(only("M1 0A1 1 0 0 1 -1 0A1 1 0 0 1 1 0"), 500)
    assert np.abs(np.abs(points) - 1).max() < 1e-5


def test_relative_arcs_and_flags_without_separators() -> None:
    assert only("M5 5a1,1 0 01.5.5").points[-1] == 5.5 + 5.5j
    assert only("M5 5a1 1 0 1 0 .5 .5 1 1 0 00-1-1").points[-1] == 4.5 + 4.5j
    assert only("M0 0a25,25 -30 0,1 50,-25").points[-1] == 50 - 25j


def test_arcs_without_a_radius_are_lines_and_without_a_way_nothing() -> None:
    assert only("M0 0A0 5 0 0 1 3 4").handles == [None]
    assert only("M1 1A5 5 0 0 1 1 1").handles == []


@pytest.mark.parametrize(
    ("text", "points"),
    [
        ("M0 0L1 1L2", [0j, 1 + 1j]),
        ("M0 0L1 1 2", [0j, 1 + 1j]),
        ("M0 0L1 1 x 5 5", [0j, 1 + 1j]),
        ("M0 0L1 1,,2 2", [0j, 1 + 1j]),
        ("M0 0L1 1,", [0j, 1 + 1j]),
        ("M0 0L1 1 A5 5 0 2 1 9 9", [0j, 1 + 1j]),
        ("M0 0L1 1L3 3 4 # 5 5", [0j, 1 + 1j, 3 + 3j]),
        ("M0 0L1 1..5", [0j, 1 + 1j]),
    ],
)
def test_broken_data_is_read_up_to_the_break(text: str, points: list[complex]) -> None:
    subpaths, problem = parse_path(text)
    assert problem
    assert subpaths[0].points == points


@pytest.mark.parametrize("text", ["L1 1", "5 5", "M", "x", "M,1 1", "é"])
def test_data_broken_at_the_beginning_draws_nothing(text: str) -> None:
    subpaths, problem = parse_path(text)
    assert problem
    assert not any(path.handles for path in subpaths)


@pytest.mark.parametrize(
    "text", ["M0 0L nan 1", "M0 0L 1 NaN", "M0 0L inf 1", "M0 0L-Infinity 1", "M0 0L1e999 1", "M1e400 0", "M0 0a inf 1"]
)
def test_what_is_not_finite_is_an_error(text: str) -> None:
    with pytest.raises(InputError, match="finite"):
        parse_path(text)


@pytest.mark.parametrize(
    "text", ["M0 0" + "h1" * 50, "M0 0h" + " 1" * 50, "M0 0" + "z" * 50, "M0 0" + "a1 1 0 0 0 1 1" * 9]
)
def test_the_limit_of_segments_holds(text: str) -> None:
    with pytest.raises(LimitError):
        parse_path(text, 20)


ARGUMENTS = {"M": 2, "L": 2, "H": 1, "V": 1, "C": 6, "S": 4, "Q": 4, "T": 2, "Z": 0}
NUMBER = st.floats(-1e6, 1e6).map(lambda value: f"{value:.6g}")


@st.composite
def path_data(draw: st.DrawFn) -> str:
    parts = ["M 1 2"]
    for letter in draw(st.lists(st.sampled_from("MLHVCSQTAZmlhvcsqtaz"), max_size=12)):
        if letter in "Aa":
            flags = draw(st.sampled_from(["0 0", "01", "1,0", "11 "]))
            radii, end = (" ".join(draw(st.tuples(NUMBER, NUMBER))) for _ in range(2))
            parts.append(f"{letter}{radii} {draw(NUMBER)} {flags} {end}")
        else:
            count = ARGUMENTS[letter.upper()]
            parts.append(letter + draw(st.sampled_from([" ", ","])).join(draw(NUMBER) for _ in range(count)))
    return draw(st.sampled_from(["", " ", "\n"])).join(parts)


@given(path_data())
@settings(max_examples=200)
def test_well_formed_data_is_read_to_its_end(text: str) -> None:
    subpaths, problem = parse_path(text)
    assert problem is None
    for path in subpaths:
        assert len(path.handles) == len(path.points) - 1
        assert all(cmath.isfinite(point) for point in path.points)


@given(st.text("MmLlHhVvCcSsQqTtAaZz0123456789.,-+eE nif#", max_size=60))
@settings(max_examples=300)
def test_other_data_breaks_or_is_an_input_error(text: str) -> None:
    with contextlib.suppress(InputError):
        parse_path(text)


def test_an_arc_of_a_radius_next_to_nothing_stays_finite() -> None:
    (path,), problem = parse_path("M0 0a3540 1.9969e-300 0 0 0 0 202815")
    assert problem is None
    assert all(cmath.isfinite(point) for point in path.points)
    assert path.points[-1] == 202815j
