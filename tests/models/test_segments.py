"""Rows of circles as segments."""

from __future__ import annotations

from typing import Any

import numpy as np
import pytest

from optplan.domain.arrays import FloatArray
from optplan_models import highs
from optplan_models.ordering import mtz, segments
from tests.washing import washing

NONE = np.zeros((0, 2), dtype=np.int64)


def grid(columns: int, lines: int, hole: tuple[int, ...] = ()) -> FloatArray:
    """Circles at distance 1, numbered row by row, without those numbered in `hole`."""
    x, y = np.meshgrid(np.arange(float(columns)), np.arange(float(lines)))
    return np.delete(np.column_stack([x.ravel(), y.ravel()]), hole, axis=0)


def optimum(restricted: segments.Restricted, *, lifted: bool = True) -> tuple[float, Any]:
    zeros = np.zeros(len(restricted.segments.circles))
    model = segments.build(restricted, zeros, zeros, lifted=lifted)
    compiled = highs.compile_model(model)
    result = highs.run(compiled)
    assert result.values is not None
    highs.load_values(compiled, result.values)
    return result.objective, mtz.path_of(model)


def length(points: FloatArray) -> float:
    return float(np.linalg.norm(np.diff(points, axis=0), axis=1).sum())


def test_rows_need_not_be_level() -> None:
    points = grid(4, 3) + np.random.default_rng(0).uniform(-0.1, 0.1, (12, 2))
    assert segments.rows_of(points).tolist() == [0] * 4 + [1] * 4 + [2] * 4
    assert segments.rows_of(points[:4]).tolist() == [0] * 4
    assert segments.rows_of(points[:1]).tolist() == [0]


def test_rows_split_at_gaps() -> None:
    found = segments.segments(grid(5, 3, hole=(7, 13)))
    assert found.row.tolist() == [0, 1, 1, 2, 2]
    assert np.diff(found.first).tolist() == [5, 2, 2, 3, 1]
    assert found.ends == 9
    assert found.segment[found.circles].tolist() == [0] * 5 + [1] * 2 + [2] * 2 + [3] * 3 + [4]
    # close circles, far rows: the spacing is that of the data, whatever the radius
    assert np.diff(segments.segments(grid(5, 3) * [0.5, 1.0]).first).tolist() == [5, 5, 5]


def test_the_best_path_row_by_row() -> None:
    points = grid(4, 3)
    restricted = segments.restrict(points, NONE)
    cost, nodes = optimum(restricted, lifted=False)
    assert cost == pytest.approx(11)
    circles = restricted.circles_of(nodes)
    assert sorted(circles.tolist()) == list(range(12))
    assert length(points[circles]) == pytest.approx(cost)
    assert (np.diff(points[circles, 1]) >= 0).all()


def test_horizontal_ways_can_be_made_dear() -> None:
    # two columns of short segments
    points = grid(9, 3, hole=(3, 4, 5, 12, 13, 14, 21, 22, 23))
    plain, steered = (segments.restrict(points, NONE, horizontal=weight) for weight in (1.0, 3.0))
    up = plain.costs[plain.enter == 0][0]
    assert np.isfinite(up).any()
    crossing = np.abs(points[plain.leave][:, None, 0] - points[plain.enter][None, :, 0])
    finite = np.isfinite(plain.costs)
    assert (steered.costs[finite] >= plain.costs[finite]).all()
    assert (steered.costs[finite & (crossing == 0)] == plain.costs[finite & (crossing == 0)]).all()
    level = finite & (plain.costs == crossing)
    assert steered.costs[level] == pytest.approx(3 * plain.costs[level])


def test_precedence_within_a_segment_leaves_one_direction() -> None:
    points = grid(3, 1)
    assert segments.restrict(points, np.array([[1, 0]])).enter.tolist() == [2]
    assert segments.restrict(points, np.array([[0, 1]])).enter.tolist() == [0]
    with pytest.raises(ValueError, match="neither direction"):
        segments.restrict(points, np.array([[0, 1], [2, 1]]))
    with pytest.raises(ValueError, match="circle 3 before circle 0"):
        segments.restrict(grid(3, 2), np.array([[3, 0]]))


def test_pieces_end_where_the_precedence_changes() -> None:
    # a window in the middle of the second row: what is below it has nothing directly behind it there
    points = grid(6, 3, hole=(8, 9))
    before = np.argwhere((points[None, :, 1] > points[:, None, 1]) & (points[None, :, 0] == points[:, None, 0]))
    restricted = segments.restrict(points, before, may_split=True)
    assert np.diff(restricted.segments.first).tolist() == [2, 2, 2, 2, 2, 2, 2, 2]
    strict, split = optimum(segments.restrict(points, before))[0], optimum(restricted)
    assert split[0] < strict
    circles = restricted.circles_of(split[1])
    place = np.argsort(circles)
    assert (place[before[:, 0]] < place[before[:, 1]]).all()
    assert length(points[circles]) == pytest.approx(split[0])


def test_the_published_sizes() -> None:
    case = washing("case1")
    restricted = segments.restrict(case.points, case.before)
    assert len(case.points) == 132
    assert restricted.segments.ends == 31
    zeros = np.zeros(132)
    rows = segments.build(restricted, zeros, zeros)
    assert len(rows.x) + len(rows.first) + len(rows.last) < 700
    problem = case.problem
    circles = mtz.build(
        problem.costs.pairs(*np.divmod(np.arange(132**2), 132)).reshape(132, 132),
        problem.cluster, zeros, zeros, zeros, problem.precedence, lifted=False,
    )  # fmt: skip
    assert len(circles.x) + len(circles.first) + len(circles.last) == 17_556


def test_the_published_model_finds_the_best_path_row_by_row() -> None:
    """The plain model, arcs downwards forbidden and no more."""
    case = washing("case1")
    cost, _ = optimum(segments.restrict(case.points, case.before), lifted=False)
    assert cost == pytest.approx(case.optimum, abs=1e-3)
