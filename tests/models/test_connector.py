"""The optimised connector: its paths integrated again, its optima compared with what is known."""

from __future__ import annotations

import math

import numpy as np
import pytest

from optplan_models.connector import PLANES, Connector, Pace, optimise

Guess = tuple[np.ndarray, np.ndarray, np.ndarray]
LINE: Guess = (np.zeros(1), np.zeros(1), np.ones(1))


def integrated(start: np.ndarray, path: Connector) -> np.ndarray:
    """(k, 4) dense states along a connector, by a rule of its own."""
    x, y, heading, kappa = start
    rows = [start]
    for bend, rate in zip(path.curvature, path.sharpness, strict=True):
        assert bend == pytest.approx(kappa, abs=1e-9)
        h = path.step / 64
        for k in range(64):
            u = (k + 0.5) * h
            angle = heading + bend * u + rate * u * u / 2
            x, y = x + h * math.cos(angle), y + h * math.sin(angle)
            rows.append(np.array([x, y, heading + bend * (u + h / 2) + rate * (u + h / 2) ** 2 / 2, bend]))
        heading += bend * path.step + rate * path.step**2 / 2
        kappa = bend + rate * path.step
    rows.append(np.array([x, y, heading, kappa]))
    return np.array(rows)


def arc(turn: float, radius: float = 1.0) -> Guess:
    return np.array([math.copysign(1 / radius, turn)]), np.zeros(1), np.array([abs(turn) * radius])


CASES = [
    (np.array([0.0, 0.0, 0.0, 0.0]), np.array([5.0, 0.0, 0.0, 0.0]), LINE),
    (np.array([0.0, 0.0, 0.0, 0.0]), np.array([4.0, 4.0, math.pi / 2, 0.0]), arc(math.pi / 2, 4.0)),
    (np.array([1.0, -2.0, 0.3, 0.4]), np.array([6.0, 2.0, 1.2, -0.3]), arc(0.9, 6.0)),
    (np.array([0.0, 0.0, 1.0, 0.0]), np.array([0.5, 2.5, 1.0 + math.pi, 0.0]), arc(math.pi)),
]


@pytest.mark.parametrize("solver", ["fatrop", "ipopt"])
@pytest.mark.parametrize("case", range(len(CASES)))
def test_it_ends_where_it_should_within_its_limits(case: int, solver: str) -> None:
    start, end, guess = CASES[case]
    path = optimise(start, end, 1.0, 1.0, guess, solver=solver)
    assert path.converged
    states = integrated(start, path)
    assert np.abs(states[-1] - end).max() < 2e-4  # the midpoint rule's own error
    assert path.missed < 1e-6
    assert np.abs(states[:, 3]).max() <= 1 + 1e-7
    assert np.abs(path.sharpness).max() <= 1 + 1e-7
    assert path.objective == pytest.approx(path.length, rel=1e-9)
    assert path.length >= math.dist(start[:2], end[:2]) - 1e-9


@pytest.mark.parametrize("length", [0.3, 1.0, 2.0, 3.0, 7.7])
def test_a_line_that_is_optimal_already_is_no_trouble(length: float) -> None:
    end = np.array([length, 0.0, 0.0, 0.0])
    path = optimise(np.zeros(4), end, 1.0, 1.0, (np.zeros(1), np.zeros(1), np.array([length])))
    assert path.converged
    assert path.length == pytest.approx(length, rel=1e-8)


def test_both_solvers_agree() -> None:
    for start, end, guess in CASES:
        first, second = (optimise(start, end, 1.0, 1.0, guess, solver=name).length for name in ("fatrop", "ipopt"))
        assert first == pytest.approx(second, rel=1e-6)


def test_a_turn_is_as_long_as_its_closed_form() -> None:
    # a small turn at full rate: two clothoids of length sqrt(delta / sigma) each
    delta, sigma = 0.3, 0.8
    side = math.sqrt(delta / sigma)
    u = (np.arange(20000) + 0.5) * side / 20000
    x1, y1 = (f(sigma * u * u / 2).mean() * side for f in (np.cos, np.sin))
    # its mirror image, turned
    x = x1 + x1 * math.cos(delta) + y1 * math.sin(delta)
    y = y1 + x1 * math.sin(delta) - y1 * math.cos(delta)
    path = optimise(np.zeros(4), np.array([x, y, delta, 0.0]), 5.0, sigma, arc(delta, 2 * side / delta))
    assert path.converged
    assert path.length == pytest.approx(2 * side, rel=1e-6)


def test_scale_and_place_do_not_matter() -> None:
    start, end, guess = CASES[2]
    plain = optimise(start, end, 1.0, 1.0, guess)
    for factor in (1e-3, 1e3):
        here, there = (np.array([factor * x + 5, factor * y - 7, t, k / factor]) for x, y, t, k in (start, end))
        resized = guess[0] / factor, guess[1] / factor**2, factor * guess[2]
        scaled = optimise(here, there, 1 / factor, 1 / factor**2, resized)
        assert scaled.converged
        assert scaled.length == pytest.approx(factor * plain.length, rel=1e-7)


def test_the_fastest_is_no_slower_and_the_smoothest_no_rougher() -> None:
    start, end, guess = CASES[1]
    pace = Pace(top=1.5, wheel=1.5, half_track=0.6)
    short = optimise(start, end, 1.0, 1.0, guess)
    fast = optimise(start, end, 1.0, 1.0, guess, objective="time", pace=pace)
    smooth = optimise(start, end, 1.0, 1.0, guess, objective="effort", length_limit=2 * short.length)
    assert fast.converged
    assert smooth.converged

    def seconds(path: Connector) -> float:
        slow = np.maximum(1 / pace.top, (1 + pace.half_track * np.abs(path.curvature)) / pace.wheel)
        return float(slow.sum() * path.step)

    def effort(path: Connector) -> float:
        return float((path.curvature + path.sharpness * path.step / 2) ** 2 @ np.full(len(path.curvature), path.step))

    assert fast.objective == pytest.approx(seconds(fast), rel=1e-3)
    assert seconds(fast) <= seconds(short) * (1 + 1e-6)
    assert effort(smooth) < effort(short)
    assert smooth.objective == pytest.approx(effort(smooth), rel=1e-2)


def test_half_planes_are_kept() -> None:
    start, end = np.zeros(4), np.array([10.0, 0.0, 0.0, 0.0])
    planes = np.zeros((41, PLANES, 3))
    planes[18:23, 0] = [0.0, 1.0, 1.0]  # y >= 1 in the middle
    free = optimise(start, end, 1.0, 1.0, LINE)
    bound = optimise(start, end, 1.0, 1.0, (np.zeros(1), np.zeros(1), np.array([10.0])), planes=planes)
    assert bound.converged
    assert bound.length > free.length + 0.1
    states = integrated(start, bound)[::64]
    assert states[18:23, 1].min() >= 1 - 1e-4


def test_what_cannot_be_is_no_solution() -> None:
    # no way to turn round within half a metre of way
    path = optimise(np.zeros(4), np.array([0.0, 0.5, math.pi, 0.0]), 1.0, 1.0, arc(math.pi), length_limit=0.7)
    assert not path.converged


@pytest.mark.parametrize(
    ("change", "message"),
    [
        ({"curvature": 0.0}, "limits"),
        ({"sharpness": -1.0}, "limits"),
        ({"curvature": math.nan}, "limits"),
        ({"start": np.array([0.0, math.nan, 0.0, 0.0])}, "start"),
        ({"end": np.array([0.0, 0.0, 0.0, 1.5])}, "end has a curvature"),
        ({"objective": "beauty"}, "objective"),
        ({"objective": "time"}, "pace"),
        ({"planes": np.zeros((3, 2, 3))}, "shape"),
        ({"intervals": 1}, "intervals"),
    ],
)
def test_bad_input(change: dict[str, object], message: str) -> None:
    question: dict[str, object] = {"start": np.zeros(4), "end": np.ones(4) / 2, "curvature": 1.0, "sharpness": 1.0}
    with pytest.raises(ValueError, match=message):
        optimise(**(question | {"guess": LINE} | change))  # type: ignore[arg-type]
