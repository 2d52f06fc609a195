"""Whole plans of the shipped drawings, held against the independent judge and against what each drawing contains."""

from __future__ import annotations

from collections import Counter
from dataclasses import replace

import numpy as np
import pytest

import optplan as op
from optplan.domain.path import RAISED

DRAWINGS = [name for name in op.instance_names() if name.startswith("drawings/")]


def _plan(name: str, robot: str = "beach-rake", **order: object) -> op.Plan:
    options = op.Options(order=op.OrderOptions(solver="search", iterations=50, **order))  # type: ignore[arg-type]
    return op.plan(op.read(op.instance(name)), robot, options)


@pytest.mark.parametrize("robot", ["beach-rake", "pen-plotter", "line-marker"])
@pytest.mark.parametrize("name", DRAWINGS)
def test_every_shipped_drawing_plans_and_checks(name: str, robot: str) -> None:
    plan = _plan(name, robot)
    assert plan.report is not None
    assert [check for check in plan.report.checks if check.verdict.value == "failed"] == []
    assert plan.ordering is not None
    assert plan.path is not None
    between = float(plan.path.length[(plan.path.tool == RAISED) & (plan.path.stroke < 0)].sum())
    assert between == pytest.approx(plan.ordering.cost, rel=1e-9, abs=1e-9)
    if robot == "beach-rake":
        assert plan.report.figure("continuity order") >= 1
        assert plan.report.figure("coverage") > 0.97


# what each drawing holds: strokes by tool setting, filled areas, start point
CONTENTS = {
    "letters": (None, 3, False),
    "logo": (None, 4, False),
    "floral": ({4: 90}, 0, False),
    "flower": ({3: 3, 2: 2}, 1, True),
    "lion": ({4: 13}, 0, True),
    "shark": ({4: 12, 3: 4}, 0, True),
    "wave": ({1: 1}, 0, False),
}


@pytest.mark.parametrize("name", CONTENTS)
def test_drawings_are_understood(name: str) -> None:
    tools, areas, start = CONTENTS[name]
    cover = op.cover(op.read(op.instance(name)), op.load_robot("beach-rake"))
    assert len(cover.areas) == areas
    assert (cover.start is not None) == start
    if tools is not None:
        lines = Counter(stroke.tool for stroke in cover.strokes if "/fill" not in stroke.id)
        assert lines == tools


def test_the_shark_is_enclosed_by_its_triangle() -> None:
    cover = op.cover(op.read(op.instance("shark")), op.load_robot("beach-rake"))
    frame = [k for k, stroke in enumerate(cover.strokes) if stroke.closed]
    parents = op.containment(cover.strokes)
    assert len(frame) == 1
    assert all(parent == frame[0] for k, parent in enumerate(parents) if k != frame[0])
    assert parents[frame[0]] == -1


def test_travel_drawn_by_hand_is_driven_with_the_tool_up() -> None:
    plan = _plan("fish")
    assert plan.cover is not None
    assert plan.path is not None
    by_hand = [k for k, stroke in enumerate(plan.cover.strokes) if stroke.tool == RAISED]
    assert len(by_hand) == 1
    rows = plan.path.stroke == by_hand[0]
    assert rows.any()
    assert (plan.path.tool[rows] == RAISED).all()


def test_same_seed_same_plan() -> None:
    first, second = (_plan("emblem", seed=5) for _ in range(2))
    assert first.path is not None
    assert second.path is not None
    np.testing.assert_array_equal(first.path.start, second.path.start)


def test_a_start_point_is_where_the_path_begins() -> None:
    plan = _plan("emblem", start=(1.0, 2.0))
    assert plan.path is not None
    assert plan.path.start[0, :2].tolist() == [1.0, 2.0]


def test_stages_are_reported_in_order() -> None:
    seen: list[str] = []
    op.plan(op.read(op.instance("wave")), progress=lambda event: seen.append(event.stage))
    assert list(dict.fromkeys(seen)) == ["cover", "order", "connect", "time", "verify"]


def _failed(plan: op.Plan) -> set[str]:
    return {check.name for check in op.verify(plan).checks if check.verdict.value == "failed"}


def test_the_judge_finds_costs_and_bounds_that_are_a_little_too_high() -> None:
    plan = _plan("wave", "line-marker", start=(5.0, 5.0))
    assert plan.ordering is not None
    assert _failed(plan) == set()
    lie = replace(plan.ordering, cost=1.01 * plan.ordering.cost, bound=1.01 * plan.ordering.bound)
    assert _failed(replace(plan, ordering=lie)) == {"cost"}


def test_the_judge_finds_turns_that_are_a_little_too_quick() -> None:
    plan = _plan("flower")
    made = plan.trajectory
    assert made is not None
    turns = np.flatnonzero((np.diff(made.s) == 0) & (np.diff(made.t) > 0))
    shorter = made.t.copy()
    shorter[turns[1] + 1 :] -= 0.05 * (made.t[turns[1] + 1] - made.t[turns[1]])
    assert _failed(replace(plan, trajectory=replace(made, t=shorter))) == {"time"}


def test_an_area_has_no_bare_stripes_along_sides_that_run_with_its_lines() -> None:
    for direction in (0.0, 30.0, 90.0):
        options = op.Options(cover=op.CoverOptions(direction=np.radians(direction)), order=op.OrderOptions(solver="nn"))
        report = op.plan(op.read(op.instance("letters")), "beach-rake", options).report
        assert report is not None
        assert report.figure("area coverage") > 0.995


def test_curves_that_stop_the_robot_are_told() -> None:
    cover = op.cover(op.read(op.instance("fish")), op.load_robot("beach-rake"))
    tight = {note.place for note in cover.notes if "bends more" in note.text}
    assert "ellipse2" in tight  # a bubble of 0.44 m


def test_a_start_outside_the_canvas_is_refused() -> None:
    with pytest.raises(op.InputError, match="outside the canvas"):
        _plan("wave", start=(-5.0, -5.0))


def test_little_room_for_turning_loops_is_told() -> None:
    robot = op.load_robot("line-marker")
    job = op.read(op.instance("wave"))
    tight = op.cover(job, robot, op.Options(page=op.PageOptions(margin=0.5)))
    assert any("loops of 0.59 m" in note.text for note in tight.notes)
    assert not any("loops" in note.text for note in op.cover(job, robot).notes)
