"""The judge holds a plan against the field in it, not against its own strokes."""

from __future__ import annotations

import math
from dataclasses import replace

import numpy as np
import pytest

import optplan as op
from optplan.domain.job import Field, FieldSegment
from optplan.domain.options import Options, OrderOptions
from optplan.domain.report import Check
from optplan.domain.result import Plan
from optplan.resuming import resumed
from optplan.schema.plans import plan_from_json, plan_json

array = np.array
LINE = FieldSegment("line", array([0.0, 0.0]), array([20.0, 0.0]))
SIDE = FieldSegment("side", array([20.0, 0.0]), array([20.0, 9.0]), width=0.3)
RING = FieldSegment("ring", array([13.0, 5.0]), array([13.0, 5.0]), array([10.0, 5.0]), 2 * math.pi, passes=2)
SPOT = FieldSegment("spot", array([10.0, 5.0]), array([10.0, 5.0]), spot=0.22)
WAY = FieldSegment("way", array([0.0, 3.0]), array([5.0, 3.0]), actuation="NONE")
FIELD = Field("x", (LINE, SIDE, RING, SPOT, WAY))
QUICK = Options(order=OrderOptions(metric="cc", solver="nn"))


@pytest.fixture(scope="module")
def plan() -> Plan:
    return op.plan(FIELD, "line-marker", QUICK)


def judged(plan: Plan, *segments: FieldSegment) -> Check:
    """The check of a plan whose job was changed behind its back."""
    report = op.verify(replace(plan, job=Field("x", segments) if segments else plan.job))
    return next(check for check in report.checks if check.name == "field")


def test_a_plan_of_its_field_passes(plan: Plan) -> None:
    found = judged(plan)
    assert found.verdict.value == "passed", found.detail
    assert found.value == 0.0
    assert plan.report is not None
    assert plan.report.ok


def moved(segment: FieldSegment, by: float) -> FieldSegment:
    centre = None if segment.center is None else segment.center + by
    return replace(segment, start=segment.start + by, end=segment.end + by, center=centre)


@pytest.mark.parametrize(
    ("segments", "least", "says"),
    [
        ((replace(LINE, end=array([21.0, 0.0])), SIDE, RING, SPOT), 0.8, "line is not marked"),
        ((replace(LINE, end=array([19.0, 0.0])), SIDE, RING, SPOT), 0.8, "no line"),
        ((*FIELD.segments, FieldSegment("new", array([0.0, -5.0]), array([70.0, -5.0]))), 70.0, "new is not marked"),
        (tuple(moved(segment, 5.0) for segment in FIELD.segments), 40.0, "not marked"),
        (tuple(moved(segment, 0.02) for segment in FIELD.segments), 20.0, "not marked"),
        ((LINE, replace(SIDE, width=0.5), RING, SPOT), 9.0, "side is not marked"),
        ((LINE, replace(SIDE, width=None), RING, SPOT), 9.0, "no line"),
        ((LINE, SIDE, replace(RING, passes=3), SPOT), 18.0, "ring is not marked"),
        ((LINE, SIDE, replace(RING, sweep=-2 * math.pi), SPOT), 0.0, ""),
        ((LINE, SIDE, RING), 0.1, "no line"),
        ((LINE, SIDE, RING, moved(SPOT, 0.1)), 0.2, "spot is not marked"),
        ((*FIELD.segments[:4], replace(WAY, actuation="ALL")), 5.0, "way is not marked"),
        ((LINE, SIDE, SPOT, replace(RING, actuation="NONE")), 37.0, "no line"),
    ],
)
def test_a_field_that_was_changed_fails(
    plan: Plan, segments: tuple[FieldSegment, ...], least: float, says: str
) -> None:
    found = judged(plan, *segments)
    assert found.verdict.value == ("failed" if says else "passed"), found.detail
    assert found.value >= least
    assert says in found.detail


def test_what_others_do_counts_and_is_told(plan: Plan) -> None:
    rest = resumed(plan, 2, QUICK)
    assert rest.cover is not None
    assert len(rest.cover.elsewhere) == 2
    again = plan_from_json(plan_json(rest))
    found = judged(again)
    assert found.verdict.value == "passed"
    assert "2 strokes of them are left to other plans" in found.detail
    assert rest.report is not None
    assert rest.report.ok


def test_lines_narrower_than_the_tool_are_told_and_spill_over() -> None:
    field = Field("x", (LINE,), line_width=0.05)
    plan = op.plan(field, "line-marker", QUICK)
    assert plan.cover is not None
    assert plan.report is not None
    assert [note.text for note in plan.cover.notes] == ["lines of 5 cm are marked 12 cm wide by this tool"]
    figures = {name: value for name, value, _ in plan.report.figures}
    assert figures["wanted area"] == pytest.approx(20 * 0.05, rel=0.01)
    assert figures["overspill area"] == pytest.approx(20 * 0.07, rel=0.02)
    assert figures["missed area"] == pytest.approx(0.0, abs=1e-9)
    assert plan.report.ok
