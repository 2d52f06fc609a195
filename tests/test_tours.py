"""Tours through cities and the strokes they mean."""

from __future__ import annotations

import numpy as np
import pytest

import optplan as op
from optplan.domain.stroke import Stroke
from optplan.problem import visits_of_tour

SQUARE = Stroke("square", np.array([[0.0, 0], [1, 0], [1, 1], [0, 1]]), closed=True)
LINE = Stroke("line", np.array([[3.0, 0], [4, 1], [5, 0]]))


def test_polyline_then_polygon() -> None:
    # cities: 1 start, 2-5 the square's vertices, 6 and 7 the line's ends; -1 ends the tour
    assert visits_of_tour([1, 6, 7, 4, 5, 2, 3, -1], [SQUARE, LINE]) == [(1, 0, False), (0, 2, False)]
    assert visits_of_tour([1, 4, 3, 2, 5, 7, 6, -1, 99], [SQUARE, LINE]) == [(0, 2, True), (1, 2, True)]


@pytest.mark.parametrize(
    ("tour", "message"),
    [
        ([1, 6, 4, 5, 2, 3, 7], "half done"),
        ([1, 2, 3, 6, 7, 4, 5], "half done"),
        ([6, 7, 2, 3, 4, 5, 1], "begins at city 6"),
        ([1, 6, 7, 2, 3, 4, -1], "each of 1..7 once"),
        ([1, 6, 7, 2, 3, 4, 4], "each of 1..7 once"),
        ([1, 6, 7, 2, 3, 4, 9], "each of 1..7 once"),
    ],
)
def test_what_is_no_tour_is_refused(tour: list[int], message: str) -> None:
    with pytest.raises(op.InputError, match=message):
        visits_of_tour(tour, [SQUARE, LINE])
