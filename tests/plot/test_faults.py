"""Marks of faults on the picture."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest

import optplan as op
from optplan.domain.job import Field, FieldSegment
from optplan.domain.options import Options, OrderOptions
from optplan.domain.report import Check, Report, Verdict
from optplan.plot.faults import BROKEN
from optplan.plot.picture import figure

FIELD = Field(
    "x",
    (FieldSegment("a", np.zeros(2), np.array([9.0, 0])), FieldSegment("b", np.array([4.5, -4]), np.array([4.5, 4]))),
)


@pytest.fixture(scope="module")
def plan() -> op.Plan:
    return op.plan(FIELD, "line-marker", Options(order=OrderOptions(metric="cc")))


def _rings(plan: op.Plan) -> list[tuple[float, float]]:
    (axes,) = figure(plan).axes
    rings = [line for line in axes.lines if line.get_markeredgecolor() == BROKEN]
    return [tuple(np.asarray(line.get_xydata())[0].tolist()) for line in rings]


def test_a_clean_plan_has_no_marks(plan: op.Plan) -> None:
    assert plan.report is not None
    assert plan.report.ok
    assert _rings(plan) == []


def test_every_broken_check_is_marked_at_its_place_and_named(plan: op.Plan) -> None:
    broken = (
        Check("curvature", Verdict.FAILED, 2.0, 1.0, "1/m", (1.0, 2.0)),
        Check("wheel speed", Verdict.FAILED, 9.0, 5.0, "rad/s", (3.0, -1.0)),
        Check("strokes", Verdict.FAILED, 1.0, 0.0),
    )
    spoiled = replace(plan, report=Report(broken))
    assert _rings(spoiled) == [(1.0, 2.0), (3.0, -1.0)]
    (axes,) = figure(spoiled).axes
    text = " ".join(label.get_text() for label in axes.texts)
    assert all(check.name in text for check in broken)
