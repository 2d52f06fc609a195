"""Stops where the tank is filled again."""

from __future__ import annotations

import math
from dataclasses import replace
from itertools import combinations

import numpy as np
import pytest

import optplan as op
from optplan.domain.errors import InputError
from optplan.domain.job import Field, FieldSegment
from optplan.domain.options import Options, OrderOptions
from optplan.pipeline import plan_from
from optplan.refilling import _cheapest

FIELD = Field(
    "lines", tuple(FieldSegment(f"s{k}", np.array([0.0, 5.0 * k]), np.array([20.0, 5.0 * k])) for k in range(6))
)


@pytest.mark.parametrize("seed", range(6))
def test_the_cheapest_stops_of_all(seed: int) -> None:
    random = np.random.default_rng(seed)
    marks, detour, lasts = random.uniform(1, 9, 9), random.uniform(1, 9, 8), 20.0

    def holds(cuts: tuple[int, ...]) -> bool:
        parts = np.split(marks, [c + 1 for c in cuts])
        return all(part.sum() <= lasts for part in parts)

    every = [cuts for size in range(9) for cuts in combinations(range(8), size) if holds(cuts)]
    best = min(detour[list(cuts)].sum() for cuts in every)
    found = _cheapest(marks, detour, lasts)
    assert holds(tuple(found))
    assert detour[found].sum() == pytest.approx(best)


@pytest.mark.parametrize("metric", ["cc", "time"])
def test_no_tank_is_asked_for_more_than_it_holds(metric: str) -> None:
    order = OrderOptions(metric=metric, start=(-5.0, -5.0), refill=45.0, refill_time=30.0)
    plan = op.plan(FIELD, "line-marker", Options(order=order))
    assert plan.report is not None
    assert plan.report.ok, [check for check in plan.report.checks if check.verdict.value == "failed"]
    assert plan.path is not None
    assert plan.cover is not None
    since, stops = 0.0, 0
    for row in range(len(plan.path)):
        if plan.path.dwell[row] > 0:
            assert plan.path.dwell[row] == 30
            since, stops = 0.0, stops + 1
        elif plan.path.tool[row] > 0:
            since += float(plan.path.length[row])
        assert since <= 45 + 1e-6
    assert stops == 2
    plain = op.plan(FIELD, "line-marker", Options(order=replace(order, refill=None)))
    assert plain.ordering is not None
    assert plan.ordering is not None
    assert plan.ordering.bound <= plain.ordering.cost + 1e-9 <= plan.ordering.cost
    # ordered again, the stops of before are gone
    again = plan_from(plan, "order")
    assert again.cover is not None
    assert len(again.cover.strokes) == len(plan.cover.strokes)


def test_what_cannot_be_is_said() -> None:
    with pytest.raises(InputError, match="start point"):
        op.plan(FIELD, "line-marker", Options(order=OrderOptions(metric="cc", refill=45.0)))
    with pytest.raises(InputError, match=r"'s\d'.*20"):
        op.plan(FIELD, "line-marker", Options(order=OrderOptions(metric="cc", refill=10.0, start=(0.0, 0.0))))
    for bad in (0.0, -1.0, math.nan):
        with pytest.raises(InputError, match="refill"):
            OrderOptions(refill=bad)
