"""Where a plan lies does not matter to the judge; neither do sections in space or robots without speeds."""

from __future__ import annotations

import math
from dataclasses import replace

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from optplan.domain.arrays import FloatArray
from optplan.domain.options import OrderOptions, TimeOptions
from optplan.domain.report import Check, Report, Verdict
from optplan.domain.result import Cover, Plan
from optplan.domain.stroke import Stroke
from optplan.judge import verify
from tests.judge.hand_made import (
    CAR,
    PLOTTER,
    RAKE,
    Pen,
    changed,
    failures,
    plan_of,
    profile,
    road,
    spoiled,
    two_squares,
)


def moved(plan: Plan, angle: float, shift: tuple[float, float]) -> Plan:
    """The plan turned about the origin and shifted, canvas taken away."""
    rotation = np.array([[math.cos(angle), -math.sin(angle)], [math.sin(angle), math.cos(angle)]])

    def place(points: FloatArray) -> FloatArray:
        flat = points[:, :2] @ rotation.T + shift
        return np.column_stack([flat, points[:, 2:]])

    assert plan.path is not None
    assert plan.cover is not None
    assert plan.trajectory is not None
    path = replace(plan.path, start=place(plan.path.start), heading=plan.path.heading + angle)
    strokes = tuple(replace(stroke, points=place(stroke.points)) for stroke in plan.cover.strokes)
    visits = plan.visits
    if visits is not None:
        visits = replace(visits, entry=place(visits.entry), exit=place(visits.exit))
    return replace(
        plan,
        path=path,
        visits=visits,
        cover=replace(plan.cover, strokes=strokes, canvas=None),
        trajectory=replace(plan.trajectory, path=path),
    )


def check(report: Report, name: str) -> Check:
    return next(entry for entry in report.checks if entry.name == name)


@given(st.floats(-10, 10), st.tuples(st.floats(-100, 100), st.floats(-100, 100)), st.booleans(), st.booleans())
@settings(deadline=None, max_examples=25)
def test_a_rigid_motion_changes_no_value(angle: float, shift: tuple[float, float], squares: bool, bad: bool) -> None:
    plan = two_squares() if squares else road()
    assert plan.path is not None
    if bad:
        plan = spoiled(
            plan,
            tool=changed(plan.path.tool, -1, 2),
            start=plan.path.start + 0.03 * (plan.path.stroke > 0)[:, None] * [1, 1, 0],
        )
    still, gone = verify(moved(plan, 0.0, (0.0, 0.0))), verify(moved(plan, angle, shift))
    for before, after in zip(still.checks, gone.checks, strict=True):
        assert (before.name, before.verdict) == (after.name, after.verdict)
        assert after.value == pytest.approx(before.value, rel=1e-3, abs=1e-5)
    for (name, value, unit), (other, other_value, _) in zip(still.figures, gone.figures, strict=True):
        assert name == other
        assert other_value == pytest.approx(value, rel=1e-3, abs=1e-5), (name, unit)


def test_rounded_corners_within_the_tolerance_pass() -> None:
    """A car that rounds a bend of 0.1 rad by an arc of 2 m."""
    bend, radius = 0.1, 2.0
    cut = radius * math.tan(bend / 2)
    stroke = Stroke("bend", np.array([[0.0, 0], [1, 0], [1 + math.cos(bend), math.sin(bend)]]))
    pen = Pen(np.zeros(2))
    pen.curve(1 - cut, tool=1, stroke=0)
    pen.curve(radius * bend, 1 / radius, tool=1, stroke=0)
    pen.curve(1 - cut, tool=1, stroke=0)
    report = verify(replace(plan_of(CAR, pen.path, Cover((stroke,))), trajectory=None))
    assert failures(report) == set()
    assert check(report, "deviation").value == pytest.approx(radius * (1 / math.cos(bend / 2) - 1), abs=1e-4)
    assert check(report, "curvature steps").value == pytest.approx(0.5)
    assert report.figure("continuity order") == 1


def test_strokes_in_space() -> None:
    line = np.array([[0.0, 0, 0], [1, 0, 1]])
    pen = Pen(np.zeros(2))
    pen.curve(math.sqrt(2), tool=1, stroke=0)
    path = replace(pen.path, elevation=np.array([math.pi / 4]))
    report = verify(plan_of(PLOTTER, path, Cover((Stroke("up", line),))))
    assert report.ok
    assert check(report, "deviation").value == pytest.approx(0, abs=1e-12)
    assert check(report, "coverage").verdict is Verdict.NOTED
    flat = verify(plan_of(PLOTTER, replace(path, elevation=np.zeros(1)), Cover((Stroke("up", line),))))
    assert "deviation" in failures(flat)


def test_an_empty_path_misses_every_stroke() -> None:
    plan = plan_of(RAKE, Pen(np.zeros(2)).path, Cover((Stroke("a", np.array([[0.0, 0], [1, 0]])),)))
    assert failures(verify(plan)) == {"strokes", "coverage"}
    assert verify(replace(plan, cover=Cover(()))).ok


def test_stop_strokes_are_worked_at() -> None:
    pen = Pen(np.zeros(2))
    pen.turn(0.0, 2.0, tool=1, stroke=0)
    pen.go((1.0, 0.0))
    pen.turn(0.5, 2.0, tool=1, stroke=1)
    spots = tuple(Stroke(f"{k}", np.array([[float(k), 0]]), dwell=2.0) for k in range(2))
    report = verify(plan_of(RAKE, pen.path, Cover(spots)))
    assert failures(report) == set()
    assert report.figure("work time") == pytest.approx(4.0)
    assert report.figure("turn time") == pytest.approx(0.5 + 1 / 16)
    assert report.figure("done area") == pytest.approx(2 * math.pi * 0.05**2, rel=1e-2)


def test_travel_strokes_are_driven_with_the_tool_up() -> None:
    cover = Cover((Stroke("way", np.array([[0.0, 0], [1, 0]]), tool=0),))
    pen = Pen(np.zeros(2))
    pen.curve(1.0, stroke=0)
    report = verify(plan_of(RAKE, pen.path, cover))
    assert failures(report) == set()
    assert (report.figure("travel strokes"), report.figure("tool-up"), report.figure("done area")) == (1, 0, 0)
    assert "strokes" in failures(verify(spoiled(plan_of(RAKE, pen.path, cover), tool=np.ones(1, int))))


def test_chosen_speeds_replace_those_of_the_robot() -> None:
    plan = two_squares()
    slow = replace(plan, options=replace(plan.options, time=TimeOptions(work_speed=0.3)))
    assert failures(verify(slow)) == {"speed"}
    assert plan.path is not None
    fast = replace(plan, trajectory=profile(plan.path, RAKE, 1.2))
    assert failures(verify(replace(fast, options=replace(plan.options, time=TimeOptions(0.5, 0.8))))) == set()


def test_cost_of_another_metric_is_only_noted() -> None:
    plan = two_squares()
    assert plan.ordering is not None
    wrong = replace(plan, ordering=replace(plan.ordering, cost=1.0, bound=1.0))
    assert failures(verify(wrong)) == {"cost"}
    other = replace(wrong, options=replace(plan.options, order=OrderOptions(metric="dubins")))
    assert check(verify(other), "cost").verdict is Verdict.NOTED


def test_travel_through_the_margin_is_noted() -> None:
    plan = two_squares()
    assert plan.path is not None
    pen = Pen(np.array([1.0, 0.2]))
    assert plan.cover is not None
    for index, stroke in enumerate(plan.cover.strokes):
        pen.draw(stroke, index)
    report = verify(plan_of(RAKE, pen.path, plan.cover))
    margin = check(report, "margin")
    assert margin.verdict is Verdict.NOTED
    assert margin.value == pytest.approx(0.3)
    assert margin.place == pytest.approx((1.0, 0.2))
    assert report.ok


def test_wheels_are_fastest_inside_a_piece() -> None:
    """Slowing down on a clothoid that gets tighter: the outer wheel peaks between the ends."""
    pen = Pen(np.zeros(2))
    pen.curve(1.0, tool=1, stroke=0)
    path = replace(pen.path, sharpness=np.array([2.0]))
    plan = plan_of(RAKE, path, Cover(()))
    assert plan.trajectory is not None
    # from 2 m/s to rest over 1 m: v = 2 sqrt(1 - s), while kappa = 2 s; only the wide track peaks half-way
    s, v = np.array([0.0, 1.0]), np.array([2.0, 0.0])
    for track in (0.5, 2.0):
        mobility = replace(RAKE.mobility, track=track, turn_rate=1.0)  # type: ignore[arg-type]
        trajectory = replace(plan.trajectory, s=s, t=np.array([0.0, 1.0]), v=v)
        report = verify(replace(plan, robot=replace(RAKE, mobility=mobility), trajectory=trajectory))
        fastest = max(2 * math.sqrt(1 - x) * (1 + 2 * x * track / 2) for x in np.linspace(0, 1, 100_001))
        assert check(report, "wheel speed").value == pytest.approx(fastest / 0.1, rel=1e-8)


def test_sharpness_is_held_against_what_the_wheels_can_do() -> None:
    """v^2 sigma track / 2 is an acceleration of the wheels; a chosen limit holds at any speed."""
    pen = Pen(np.zeros(2))
    pen.curve(1.0)
    path = replace(pen.path, sharpness=np.array([1.9]))
    plan = replace(plan_of(RAKE, path, Cover(())), trajectory=None)
    found = check(verify(plan), "sharpness")
    # at a transit speed of 0.6 m/s, with wheels that gain 4 m/s^2 half a metre apart
    assert (found.value, found.limit) == pytest.approx((1.9, 4.0 / (0.25 * 0.6**2)))
    assert found.verdict is Verdict.PASSED
    strict = replace(RAKE, mobility=replace(RAKE.mobility, sharpness=1.8))  # type: ignore[arg-type]
    found = check(verify(replace(plan, robot=strict)), "sharpness")
    assert (found.verdict, found.limit) == (Verdict.FAILED, 1.8)
    assert check(verify(replace(plan, robot=PLOTTER)), "sharpness").verdict is Verdict.NOTED
