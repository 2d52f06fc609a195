"""The washing cases beside the project: circles of a facade and the order that the water asks for."""

from __future__ import annotations

import json
from pathlib import Path
from typing import NamedTuple

import numpy as np
import pytest

from optplan.domain.arrays import FloatArray, IntArray
from optplan.domain.ordering import EuclidCosts, OrderingProblem

FOLDER = Path(__file__).parents[2] / "shared" / "data" / "washing"


class Washing(NamedTuple):
    problem: OrderingProblem
    points: FloatArray
    before: IntArray
    optimum: float


def washing(name: str) -> Washing:
    """A case; skips the test where the data are absent."""
    file = FOLDER / f"{name}.json"
    if not file.is_file():
        pytest.skip("the washing cases are not at hand")
    data = json.loads(file.read_text())
    points, radius = np.array(data["circles"], dtype=np.float64), data["radius"]
    up = points[None, :, 1] - points[:, None, 1] >= data["rule"]["tau"] * radius
    close = np.abs(points[None, :, 0] - points[:, None, 0]) < data["rule"]["d"] * radius
    before = np.argwhere(up & close)
    problem = OrderingProblem(np.arange(len(points)), EuclidCosts(points, points), precedence=before)
    return Washing(problem, points, before, data["optimum"])
