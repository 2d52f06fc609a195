"""Driving over finished work: measured by the judge, lowered when asked."""

from __future__ import annotations

import math
from dataclasses import replace

import pytest

import optplan as op
from optplan.domain.errors import InputError
from optplan.domain.options import Options, OrderOptions
from optplan.instances import instance

WALL = """<svg xmlns="http://www.w3.org/2000/svg" viewBox="0 0 10 10">
<path id="wall" d="M5 2V8" fill="none" stroke="#000" stroke-width="1"/>
<path id="west" d="M1 4.5V5.5" fill="none" stroke="#000" stroke-width="1"/>
<path id="east" d="M9 4.5V5.5" fill="none" stroke="#000" stroke-width="1"/></svg>"""


def metres(plan: op.Plan) -> float:
    assert plan.report is not None
    (check,) = [check for check in plan.report.checks if check.name == "over finished work"]
    return check.value


def planned(source: str, **order: object) -> op.Plan:
    options = Options(order=OrderOptions(iterations=500, **order))  # type: ignore[arg-type]
    return op.plan(op.read(source), "pen-plotter", options)


def test_the_judge_counts_what_is_crossed_in_the_order_of_driving() -> None:
    plan = planned(WALL)
    assert plan.cover is not None
    assert plan.ordering is not None
    ids = [stroke.id for stroke in plan.cover.strokes]
    width = plan.robot.tool.settings[1].width
    ways = op.traversals(plan.cover.strokes, plan.robot, plan.options)

    def over(*names: str) -> float:
        rows = [int((ways.stroke == ids.index(name)).argmax()) for name in names]
        visits = ways.take(rows)
        path = op.connect(visits, plan.cover, plan.robot, plan.options)  # type: ignore[arg-type]
        report = op.verify(replace(plan, visits=visits, path=path, trajectory=None, ordering=None, report=None))
        return metres(replace(plan, report=report))

    # from the end of one side straight to the other: across the wall only once that is there
    assert over("west", "east", "wall") == 0
    crossing = over("wall", "west", "east")
    assert width <= crossing < 1.1 * width


@pytest.mark.parametrize("name", ["fish", "logo"])
def test_less_is_driven_over_finished_work_when_asked(name: str) -> None:
    source = str(instance(name))
    plain, avoiding = (planned(source, solver="search", avoid=weight) for weight in (0.0, 5.0))
    assert avoiding.report is not None
    assert avoiding.report.ok
    assert metres(avoiding) < 0.7 * metres(plain)
    assert avoiding.ordering is not None
    assert plain.ordering is not None
    assert "over finished work" in avoiding.ordering.message
    assert avoiding.ordering.bound <= avoiding.ordering.cost
    assert avoiding.ordering.cost + 5 * metres(avoiding) <= plain.ordering.cost + 5 * metres(plain) + 1e-6
    again = planned(source, solver="search", avoid=5.0)
    assert again.ordering is not None
    assert again.ordering.nodes.tolist() == avoiding.ordering.nodes.tolist()


@pytest.mark.parametrize("weight", [-1.0, math.nan, math.inf, True])
def test_bad_weights(weight: float) -> None:
    with pytest.raises(InputError, match="avoid"):
        OrderOptions(avoid=weight)


def test_wheels_are_kept_off_wet_lines() -> None:
    """One end of a football pitch: what the order reckons with is what the judge measures."""
    import numpy as np

    from optplan.domain.job import Field, FieldSegment

    ends = [
        (0, 0, 0, 40),
        (0, 4, 16, 4),
        (16, 4, 16, 36),
        (16, 36, 0, 36),
        (0, 12, 5, 12),
        (5, 12, 5, 28),
        (5, 28, 0, 28),
    ]
    lines = [FieldSegment(f"l{k}", np.array(line[:2], float), np.array(line[2:], float)) for k, line in enumerate(ends)]
    field = Field("x", tuple(lines))
    found = {}
    for weight in (0.0, 10.0):
        order = OrderOptions(metric="cc", iterations=2000, avoid=weight)
        plan = op.plan(field, "line-marker", Options(cover=op.CoverOptions(cut=False), order=order))
        assert plan.report is not None
        assert plan.report.ok
        assert plan.ordering is not None
        wheels = next(check.value for check in plan.report.checks if check.name == "wheels over finished work")
        found[weight] = plan.ordering.cost + 10 * wheels
        if weight:
            assert f"{wheels:.3g} m instead" in plan.ordering.message
    assert found[10.0] < found[0.0]
