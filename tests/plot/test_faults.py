"""Marks of faults on the picture."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest

import optplan as op
from optplan.domain.job import Field, FieldSegment
from optplan.domain.options import Options, OrderOptions
from optplan.domain.report import Check, Report, Verdict
from optplan.judge import verify
from optplan.plot.faults import BROKEN, WORTH_SEEING
from optplan.plot.picture import figure

FIELD = Field(
    "x",
    (FieldSegment("a", np.zeros(2), np.array([9.0, 0])), FieldSegment("b", np.array([4.5, -4]), np.array([4.5, 4]))),
)


@pytest.fixture(scope="module")
def plan() -> op.Plan:
    return op.plan(FIELD, "line-marker", Options(order=OrderOptions(metric="cc")))


def _rings(plan: op.Plan, colour: str = BROKEN) -> list[tuple[float, float]]:
    (axes,) = figure(plan).axes
    rings = [line for line in axes.lines if line.get_markeredgecolor() == colour]
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


def _spoiled(plan: op.Plan, fault: str) -> op.Plan:
    assert plan.path is not None
    assert plan.trajectory is not None
    path = plan.path
    start, tool, curvature = path.start.copy(), path.tool.copy(), path.curvature.copy()
    connectors = np.flatnonzero((path.stroke < 0) & (path.length > 0.1))
    if fault == "tool":
        tool[connectors[1]] = 1
    elif fault == "curvature":
        curvature[connectors[1]] = 9.0
    else:
        start[np.flatnonzero(path.tool == 1)[0]] += [0.3, 0.2, 0.0]
    path = replace(path, start=start, tool=tool, curvature=curvature)
    made = replace(plan, path=path, trajectory=replace(plan.trajectory, path=path))
    return replace(made, report=verify(made))


@pytest.mark.parametrize("fault", ["tool", "curvature", "deviation"])
def test_a_planted_fault_is_ringed_where_the_judge_found_it(plan: op.Plan, fault: str) -> None:
    spoiled = _spoiled(plan, fault)
    assert spoiled.report is not None
    broken = {check.name: check for check in spoiled.report.checks if check.verdict is Verdict.FAILED}
    place = broken[fault].place
    assert place is not None
    nearest = min(np.hypot(x - place[0], y - place[1]) for x, y in _rings(spoiled))
    assert nearest < 0.2  # half a ring: what is nearer shares one
    (axes,) = figure(spoiled).axes
    legend = axes.texts[-1].get_text()
    assert all(f"{number} {name} " in legend for number, name in enumerate(broken, start=1))


def test_faults_at_one_place_share_a_ring_with_all_their_numbers(plan: op.Plan) -> None:
    names = ("gaps", "curvature", "wheel speed")
    places = ((4.0, 1.0), (4.01, 1.0), (1.0, -1.0))
    checks = tuple(Check(name, Verdict.FAILED, 1.0, 0.0, "", place) for name, place in zip(names, places, strict=True))
    spoiled = replace(plan, report=Report(checks))
    assert _rings(spoiled) == [(4.0, 1.0), (1.0, -1.0)]
    (axes,) = figure(spoiled).axes
    texts = [text.get_text() for text in axes.texts]
    assert "1, 2" in texts
    assert "3" in texts


@pytest.mark.parametrize("count", [1, 12])
def test_what_the_numbers_mean_stays_on_the_picture(plan: op.Plan, count: int) -> None:
    checks = tuple(
        Check(f"wheel acceleration {k}", Verdict.FAILED, 92.0, 40.0, "rad/s^2", (1, 1)) for k in range(count)
    )
    made = figure(replace(plan, report=Report(checks)))
    made.canvas.draw()
    (axes,) = made.axes
    legend = axes.texts[-1]
    assert legend.get_text().count("wheel acceleration") == count
    box, page = legend.get_window_extent(), made.bbox
    assert box.x0 >= 0
    assert box.x1 <= page.width
    assert box.y0 >= 0


def test_driving_over_finished_work_is_ringed_in_another_colour(plan: op.Plan) -> None:
    checks = (
        Check("over finished work", Verdict.NOTED, 0.6, None, "m", (2.0, 0.0)),
        Check("overlap", Verdict.NOTED, 0.2, None, "m2", (4.5, 0.0)),
    )
    seen = replace(plan, report=Report(checks))
    assert _rings(seen) == []
    assert _rings(seen, WORTH_SEEING) == [(2.0, 0.0)]
    never = replace(plan, report=Report((replace(checks[0], value=0.0, place=None),)))
    assert _rings(never, WORTH_SEEING) == []
    assert not any("finished" in text.get_text() for text in figure(never).axes[0].texts)
