"""The judge passes good plans and finds the one thing that is wrong with bad ones."""

from __future__ import annotations

import math
from collections.abc import Callable
from dataclasses import replace

import numpy as np
import pytest

from optplan.domain.errors import InputError
from optplan.domain.path import Path
from optplan.domain.report import Report, Verdict
from optplan.domain.result import Cover, Plan
from optplan.domain.robot import Canvas, DiffDrive
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
    square,
    two_squares,
)

GOOD: dict[str, Callable[[], Plan]] = {
    "rake": two_squares,
    "plotter": lambda: two_squares(PLOTTER),
    "car": road,
    "rake on a road": lambda: road(RAKE),
}


def path_of(plan: Plan) -> Path:
    assert plan.path is not None
    return plan.path


def check(report: Report, name: str) -> object:
    return next(entry for entry in report.checks if entry.name == name)


@pytest.mark.parametrize("make", GOOD.values(), ids=GOOD.keys())
def test_good_plans_pass(make: Callable[[], Plan]) -> None:
    report = verify(make())
    assert failures(report) == set()
    assert report.ok


def test_every_report_lists_the_same_checks_once() -> None:
    plan = two_squares()
    full = [entry.name for entry in verify(plan).checks]
    assert len(set(full)) == len(full)
    bare = verify(Plan(plan.job, plan.robot, plan.options, path=plan.path))
    assert [entry.name for entry in bare.checks] == full
    assert bare.ok
    noted = [entry for entry in bare.checks if entry.name in ("strokes", "bound", "speed")]
    assert all(entry.verdict is Verdict.NOTED and "Not checked" in entry.detail for entry in noted)


def test_a_plan_without_a_path_is_refused() -> None:
    with pytest.raises(InputError, match="run connect first"):
        verify(replace(two_squares(), path=None))


def test_figures_of_two_squares() -> None:
    report = verify(two_squares())
    assert report.figure("tool-down") == pytest.approx(8.0)
    assert report.figure("tool-up") == pytest.approx(2.0)
    assert report.figure("travel strokes") == 0
    assert report.figure("strokes") == 2
    # three corners of each square and a turn to leave the first
    assert report.figure("turns") == 7
    assert report.figure("turned") == pytest.approx(7 * math.pi / 2)
    # 1 rad/s, reached and left with 16 rad/s^2
    assert report.figure("turn time") == pytest.approx(7 * (math.pi / 2 + 1 / 16))
    parts = ("work time", "transit time", "turn time")
    assert sum(map(report.figure, parts)) == pytest.approx(report.figure("duration"))
    assert report.figure("bound") == pytest.approx(2.0)
    assert report.figure("gap") == 0


def test_a_path_of_lines_and_arcs_has_order_one_where_it_is_not_stopped() -> None:
    plan = road()
    stopping = verify(plan)
    assert stopping.figure("continuity order") == 2
    driven = verify(replace(plan, trajectory=None))
    assert driven.figure("continuity order") == 1
    assert driven.figure("curvature steps") == 2
    assert next(entry.value for entry in driven.checks if entry.name == "curvature steps") == pytest.approx(1.0)


def connector(plan: Plan) -> int:
    """The row between the strokes that moves."""
    path = path_of(plan)
    return int(np.flatnonzero((path.stroke < 0) & (path.length > 0))[0])


def gap() -> Plan:
    plan = road()
    start = changed(path_of(plan).start, (1, 0), 3.00001)
    return spoiled(plan, start=start)


def heading_jump(robot_plan: Plan) -> Plan:
    # a small bend at one end of a long connector shifts nothing by more than a micrometre when it is put back half-way
    path = path_of(robot_plan)
    row = connector(robot_plan)
    return spoiled(robot_plan, heading=changed(path.heading, row, path.heading[row] + 2e-6), length=path.length)


def bend_without_stop() -> Plan:
    plan = two_squares()
    path = path_of(plan)
    stop = int(np.flatnonzero(path.is_stop)[0])
    keep = np.delete(np.arange(len(path)), stop)
    names = [
        "start",
        "heading",
        "elevation",
        "curvature",
        "sharpness",
        "length",
        "turn",
        "dwell",
        "tool",
        "stroke",
        "gear",
    ]
    return spoiled(plan, **{name: getattr(path, name)[keep] for name in names})


def corner_at_speed() -> Plan:
    """A plotter that does not slow down for a corner."""
    cover = Cover((Stroke("corner", np.array([[0.0, 0], [1, 0], [1, 1]])),))
    pen = Pen(np.zeros(2))
    pen.curve(1.0, tool=1, stroke=0)
    pen.heading = math.pi / 2
    pen.curve(1.0, tool=1, stroke=0)
    plan = plan_of(PLOTTER, pen.path, cover)
    assert verify(plan).ok
    assert plan.trajectory is not None
    ramp = 0.4**2 / 2
    times = np.array([0, 0.4, (1 - ramp) / 0.4 + 0.2, (2 - 2 * ramp) / 0.4 + 0.4, (2 - 2 * ramp) / 0.4 + 0.8])
    times[2] = 0.4 + (1 - ramp) / 0.4
    moving = replace(plan.trajectory, s=np.array([0, ramp, 1, 2 - ramp, 2]), t=times, v=np.array([0, 0.4, 0.4, 0.4, 0]))
    return replace(plan, trajectory=moving)


def tight() -> Plan:
    pen = Pen(np.zeros(2))
    pen.curve(1.0, tool=1, stroke=0)
    pen.curve(math.pi * 0.4, 2.5)
    pen.curve(1.0, tool=1, stroke=1)
    cover = Cover((Stroke("out", np.array([[0.0, 0], [1, 0]])), Stroke("back", np.array([[0.0, 0.8], [1, 0.8]]))))
    return plan_of(CAR, pen.path, cover)


def written(*strokes: tuple[int, bool], cover: Cover | None = None) -> Plan:
    """Strokes of two squares driven in this order."""
    plan = two_squares()
    wanted = plan.cover if cover is None else cover
    assert wanted is not None
    pen = Pen(wanted.strokes[strokes[0][0]].points[0])
    for index, reverse in strokes:
        pen.draw(wanted.strokes[index], index, reverse)
    return plan_of(RAKE, pen.path, wanted)


def twice_in_one_go() -> Plan:
    cover = Cover((square("left", 1, 1),))
    pen = Pen(np.array([1.0, 1.0]))
    pen.draw(cover.strokes[0], 0)
    pen.face((2, 1), 0)
    pen.draw(cover.strokes[0], 0)
    return plan_of(RAKE, pen.path, cover)


def wrong_tool() -> Plan:
    plan = two_squares()
    path = path_of(plan)
    return spoiled(plan, tool=np.where((path.stroke == 1) & (path.tool > 0), 2, path.tool))


def tool_down() -> Plan:
    plan = two_squares()
    return spoiled(plan, tool=changed(path_of(plan).tool, connector(plan), 1))


def unknown_tool() -> Plan:
    plan = two_squares()
    return spoiled(plan, tool=changed(path_of(plan).tool, connector(plan), 7))


def smaller_canvas(width: float, margin: float) -> Plan:
    plan = two_squares()
    assert plan.cover is not None
    return replace(plan, cover=replace(plan.cover, canvas=Canvas(width, 3.0, margin)))


def beside() -> Plan:
    """The second square driven 2 cm to the right of where it should be."""
    plan = two_squares()
    assert plan.cover is not None
    strokes = (plan.cover.strokes[0], square("right", 2.98, 1))
    return replace(plan, cover=replace(plan.cover, strokes=strokes))


def timing(**columns: object) -> Plan:
    plan = two_squares()
    assert plan.trajectory is not None
    return replace(plan, trajectory=replace(plan.trajectory, **columns))  # type: ignore[arg-type]


def late() -> Plan:
    plan = two_squares()
    assert plan.trajectory is not None
    return timing(t=changed(plan.trajectory.t, -1, plan.trajectory.t[-1] + 1e-3))


def short_stop() -> Plan:
    """Every turn takes 1 ms less than it should."""
    plan = two_squares()
    assert plan.trajectory is not None
    step, gone = np.diff(plan.trajectory.t), np.diff(plan.trajectory.s)
    step = np.where(gone == 0, np.maximum(step - 1e-3, 0), step)
    return timing(t=np.concatenate([[0.0], np.cumsum(step)]))


def other_path() -> Plan:
    plan = two_squares()
    assert plan.trajectory is not None
    path = path_of(plan)
    other = replace(path, start=path.start + 1.0)
    return replace(plan, trajectory=replace(plan.trajectory, path=other))


def too_short() -> Plan:
    plan = two_squares()
    assert plan.trajectory is not None
    t = plan.trajectory
    return timing(s=t.s[:-3], t=t.t[:-3], v=t.v[:-3])


def rolling_start() -> Plan:
    plan = road(RAKE)
    path = path_of(plan)
    t = profile(path, RAKE)
    v = changed(t.v, 0, 0.4)
    times = np.concatenate([[0.0], np.cumsum(np.diff(t.s) / ((v[1:] + v[:-1]) / 2))])
    return replace(plan, trajectory=replace(t, v=v, t=times))


def wheels_too_fast() -> Plan:
    """Slow enough for the robot, too fast for the outer wheel on a curve within the chosen radius."""
    assert isinstance(CAR.mobility, DiffDrive)
    mobility = replace(CAR.mobility, wheel_speed=10.0, work_speed=0.95, transit_speed=0.95)
    return road(replace(CAR, mobility=mobility))


def wheel_too_hard() -> Plan:
    """Bends are driven with the acceleration of straight lines."""
    plan = road(RAKE)
    assert isinstance(RAKE.mobility, DiffDrive)
    narrow = replace(RAKE, mobility=replace(RAKE.mobility, track=1e-3))
    return replace(plan, trajectory=profile(path_of(plan), narrow))


def ordering(**values: object) -> Plan:
    plan = two_squares()
    assert plan.ordering is not None
    changed_one = replace(plan.ordering)
    for name, value in values.items():
        # the type itself refuses to be called optimal with a gap; a file from elsewhere may have it all the same
        object.__setattr__(changed_one, name, value)
    return replace(plan, ordering=changed_one)


def visits_swapped() -> Plan:
    plan = two_squares()
    assert plan.visits is not None
    return replace(plan, visits=plan.visits.take([1, 0]))


RULED = Cover((square("left", 1, 1), square("right", 3, 1)), precedence=((0, 1),))
DIRECTED = Cover((square("left", 1, 1, directed=True), square("right", 3, 1)))
ENTERED = Cover((square("left", 1, 1, entry=2), square("right", 3, 1)))
OPEN = Cover((Stroke("wave", np.array([[0.0, 0], [1, 0.5], [2, 0]]), directed=True),))
STOPPED = Cover((Stroke("spot", np.array([[0.0, 0]]), dwell=2.0),))


def dwelling(seconds: float) -> Plan:
    pen = Pen(np.zeros(2))
    pen.turn(0.0, seconds, tool=1, stroke=0)
    return plan_of(RAKE, pen.path, STOPPED)


BAD: dict[str, tuple[Callable[[], Plan], set[str]]] = {
    "gap": (gap, {"gaps"}),
    "heading jump": (lambda: heading_jump(two_squares()), {"headings", "gaps"}),
    "bend without stop": (bend_without_stop, {"headings"}),
    "corner at speed": (corner_at_speed, {"headings"}),
    "turn of a car": (lambda: replace(two_squares(), robot=CAR), {"headings"}),
    "too tight": (tight, {"curvature"}),
    "missing": (lambda: written((0, False), cover=Cover(RULED.strokes)), {"strokes", "coverage"}),
    "twice": (lambda: written((0, False), (1, False), (0, False)), {"strokes", "precedence"}),
    "twice in one go": (twice_in_one_go, {"strokes", "deviation"}),
    "wrong tool": (wrong_tool, {"strokes"}),
    "wrong order": (lambda: written((1, False), (0, False), cover=RULED), {"precedence"}),
    "wrong way": (lambda: written((0, True), (1, False), cover=DIRECTED), {"strokes"}),
    "wrong way, open": (lambda: written((0, True), cover=OPEN), {"strokes"}),
    "wrong entry": (lambda: written((0, False), (1, False), cover=ENTERED), {"strokes"}),
    "short dwell": (lambda: dwelling(1.0), {"strokes"}),
    "other visits": (visits_swapped, {"visits"}),
    "tool down": (tool_down, {"tool"}),
    "unknown tool": (unknown_tool, {"tool"}),
    "off the canvas": (lambda: smaller_canvas(3.9, 0.0), {"canvas", "margin"}),
    "in the margin": (lambda: smaller_canvas(4.4, 0.5), {"margin"}),
    "beside": (beside, {"deviation", "coverage"}),
    "late": (late, {"time"}),
    "short stop": (short_stop, {"time"}),
    "speeds of another path": (other_path, {"time"}),
    "speeds end early": (too_short, {"time"}),
    "rolling start": (rolling_start, {"rest"}),
    "too fast": (lambda: replace(two_squares(), trajectory=profile(path_of(two_squares()), RAKE, 1.01)), {"speed"}),
    "too hard": (
        lambda: replace(two_squares(), trajectory=profile(path_of(two_squares()), RAKE, push=1.01)),
        {"acceleration", "wheel acceleration"},
    ),
    "a wheel too hard": (wheel_too_hard, {"wheel acceleration"}),
    "wheels too fast": (wheels_too_fast, {"curvature", "wheel speed"}),
    "false optimum": (lambda: ordering(bound=1.5), {"bound"}),
    "bound above cost": (lambda: ordering(bound=2.1), {"bound"}),
    "false cost": (lambda: ordering(cost=1.9, bound=1.9), {"cost"}),
}


@pytest.mark.parametrize(("make", "expected"), BAD.values(), ids=BAD.keys())
def test_one_fault_is_found_as_itself(make: Callable[[], Plan], expected: set[str]) -> None:
    report = verify(make())
    assert failures(report) == expected, [entry for entry in report.checks if entry.verdict is Verdict.FAILED]
    assert not report.ok
    for entry in report.checks:
        assert math.isfinite(entry.value)
        assert entry.detail
