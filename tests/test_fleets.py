"""Several robots on one job."""

from __future__ import annotations

import math
from dataclasses import replace
from itertools import pairwise, permutations, product

import numpy as np
import pytest

import optplan as op
from optplan.domain.errors import InputError
from optplan.domain.job import Field, FieldSegment
from optplan.domain.options import Options, OrderOptions
from optplan.domain.ordering import MatrixCosts, OrderingProblem
from optplan.domain.stop import StopRule
from optplan.judge.fleet import nearest_approach
from optplan.ordering.makespan import shared


def _lines(count: int, seed: int, size: float = 30.0) -> Field:
    random = np.random.default_rng(seed)
    segments = []
    for k in range(count):
        start = random.uniform(0, size, 2)
        angle = random.uniform(0, 2 * math.pi)
        segments.append(FieldSegment(f"s{k}", start, start + 5 * np.array([math.cos(angle), math.sin(angle)])))
    return Field("lines", tuple(segments))


def _least_makespan(costs: np.ndarray, work: np.ndarray, count: int) -> float:
    """Of two paths over clusters of two nodes each, by trying everything."""
    best = math.inf
    for order in permutations(range(count)):
        for sides in product((0, 1), repeat=count):
            nodes = [2 * c + side for c, side in zip(order, sides, strict=True)]
            for cut in range(count + 1):
                parts = [nodes[:cut], nodes[cut:]]
                lengths = [sum(work[n] for n in part) + sum(costs[a, b] for a, b in pairwise(part)) for part in parts]
                best = min(best, max(lengths))
    return best


@pytest.mark.parametrize("seed", range(4))
def test_shares_of_small_problems_are_best_and_bounded(seed: int) -> None:
    random = np.random.default_rng(seed)
    count = 4
    cluster = np.repeat(np.arange(count), 2)
    costs = random.uniform(1, 9, (2 * count, 2 * count))
    work = np.repeat(random.uniform(1, 5, count), 2)
    problem = OrderingProblem(cluster, MatrixCosts(costs))
    twin = np.arange(2 * count) ^ 1
    rule = StopRule(math.inf, 2000)
    found = shared(problem, work, twin, 2, rule, seed, lambda _: None)
    best = _least_makespan(costs, work, count)
    assert found.longest == pytest.approx(best)
    assert found.bound <= best + 1e-9
    assert sorted(int(cluster[n]) for path in found.paths for n in path) == list(range(count))


@pytest.mark.parametrize("count", [1, 2, 3])
def test_a_fleet_does_everything_once_and_keeps_apart(count: int) -> None:
    field = _lines(9, 3)
    options = Options(order=OrderOptions(metric="time", seconds=4))
    fleet = op.plan_fleet(field, "line-marker", count, options)
    assert fleet.ok
    done = [stroke.id for plan in fleet.plans if plan.cover for stroke in plan.cover.strokes]
    assert sorted(done) == sorted(segment.id for segment in field.segments)
    assert 0 < fleet.bound <= fleet.makespan
    if count > 1:
        alone = op.plan_fleet(field, "line-marker", 1, options)
        assert fleet.makespan < 0.75 * alone.makespan
        assert fleet.apart >= fleet.room - 1e-6


def test_the_judge_finds_robots_that_meet() -> None:
    """Two robots on crossing lines: at one time they collide, with one starting later they do not."""
    plans = []
    for angle in (0.0, math.pi / 2):
        step = 10 * np.array([math.cos(angle), math.sin(angle)])
        field = Field("x", (FieldSegment("a", -step, step, directed=True),))
        plans.append(op.plan(field, "line-marker"))
    near, when, place = nearest_approach(plans, [0.0, 0.0])
    # the robots drive beside their lines: they pass where their own lines cross
    assert near < 0.8
    assert place is not None
    assert math.hypot(*place) < 1.5
    assert plans[0].trajectory is not None
    assert 0 < when < plans[0].trajectory.duration
    late = plans[0].trajectory.duration
    assert nearest_approach(plans, [0.0, late])[0] > 5
    assert nearest_approach(plans[:1], [0.0])[0] == math.inf


def test_robots_that_would_meet_set_off_at_different_times() -> None:
    """Lines through one place: whoever is there first, the other comes later."""
    segments = []
    for k in range(6):
        step = 6 * np.array([math.cos(k * math.pi / 6), math.sin(k * math.pi / 6)])
        segments.append(FieldSegment(f"s{k}", -step, step))
    options = Options(cover=op.CoverOptions(cut=False), order=OrderOptions(metric="time", seconds=3))
    fleet = op.plan_fleet(Field("star", tuple(segments)), "line-marker", 2, options, room=2.0)
    assert fleet.apart >= 2.0 - 1e-6
    assert fleet.ok


def test_bad_fleets() -> None:
    field = _lines(3, 1)
    for count in (0, 99, True):
        with pytest.raises(InputError, match="fleet"):
            op.plan_fleet(field, "line-marker", count)
    with pytest.raises(InputError, match="rules of order"):
        op.plan_fleet(field, "line-marker", 2, Options(order=OrderOptions(metric="cc", keep="order")))


def test_robots_on_one_spot_are_refused_before_anything_is_planned(monkeypatch: pytest.MonkeyPatch) -> None:
    def never(*_: object) -> None:
        raise AssertionError("a division was looked for")

    monkeypatch.setattr("optplan.fleets.shared", never)
    field, start = _lines(6, 1), Options(order=OrderOptions(metric="cc", start=(0.0, -5.0)))
    with pytest.raises(InputError, match=r"2 robots would all start at \(0, -5\).*no start point"):
        op.plan_fleet(field, "line-marker", 2, start)
    with pytest.raises(InputError, match="no start point"):
        op.plan_fleet(replace(field, start=(1.0, 2.0)), "line-marker", 2)
    with pytest.raises(InputError, match="room"):
        op.plan_fleet(field, "line-marker", 2, room=math.nan)
