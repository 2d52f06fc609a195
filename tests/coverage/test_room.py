"""Walls of a building: inner corners, small returns, the ground, and what is no building."""

from __future__ import annotations

import math
from dataclasses import replace

import numpy as np
import pytest

import optplan as op
from optplan.domain.arrays import FloatArray
from optplan.domain.errors import InputError, LimitError
from optplan.domain.facade import Facade, Wall
from optplan.domain.options import Options
from optplan.domain.robot import Boom
from optplan.domain.washing import WashOptions
from tests.facades import corner, flat, planned
from tests.strategies import array


def _wall(name: str, width: float, height: float, origin: tuple[float, ...], across: tuple[float, ...]) -> Wall:
    outline = array([[0, 0], [width, 0], [width, height], [0, height]])
    return Wall(name, outline, (), None, array(origin), array(across))


def inner(depth: float = 6.0) -> Facade:
    """Two walls that meet at an inner right angle."""
    ground = array([[0, 0], [8, 0], [8, -depth], [14, -depth], [14, 10], [0, 10]])
    walls = (_wall("a", 8, 4, (0, 0, 0), (1, 0, 0)), _wall("b", depth, 4, (8, 0, 0), (0, -1, 0)))
    return Facade("inner", walls, building=ground)


def test_an_inner_corner_is_washed_from_a_stand_off_away() -> None:
    plan = planned(inner(), fewest="minimal", pattern="hexagon")
    assert plan.report is not None
    assert plan.report.ok
    assert plan.cover is not None
    feet = np.array([stroke.points[0] for stroke in plan.cover.strokes])
    assert feet[:, 0].max() <= 8 - 0.75 + 1e-5
    assert feet[:, 1].max() <= -0.75 + 1e-5


def test_what_an_arm_does_not_reach_in_an_inner_corner_is_named() -> None:
    robot = op.load_robot("boom-washer")
    assert isinstance(robot.mobility, Boom)
    short = replace(robot, mobility=replace(robot.mobility, reach=1.0))
    with pytest.raises(InputError, match=r"wall 'a': the wall is out of reach at \(8.*inner corner"):
        op.cover(inner(), short)


def test_a_small_wall_of_a_building_gets_one_stop() -> None:
    """Smaller than a circle; only a radius that somebody asked for is too large."""
    walls = (_wall("a", 8, 4, (0, 0, 0), (1, 0, 0)), _wall("b", 0.5, 0.8, (8, 0, 0), (0, 1, 0)))
    plan = planned(Facade("small", walls), fewest="minimal", pattern="hexagon")
    assert plan.report is not None
    assert plan.report.ok
    assert plan.cover is not None
    assert [stroke.element for stroke in plan.cover.strokes].count("b") == 1
    tiny = Facade("tiny", (_wall("wall", 0.5, 0.5, (0, 0, 0), (1, 0, 0)),))
    made = op.cover(tiny, op.load_robot("boom-washer"))
    assert len(made.strokes) == 1
    assert made.notes[-1].text == "1 stop washes all of it"
    with pytest.raises(InputError, match="more than the wall"):
        op.cover(replace(tiny, radius=1.0), op.load_robot("boom-washer"))


@pytest.mark.parametrize("pattern", ["hexagon", "best"])
def test_no_stop_is_below_the_ground(pattern: str) -> None:
    job = flat()
    plan = planned(job, fewest="minimal", pattern=pattern)
    assert plan.report is not None
    assert plan.report.ok
    assert plan.cover is not None
    assert min(stroke.points[0, 2] for stroke in plan.cover.strokes) >= 0
    # a wall above the ground may be washed from below it
    higher = planned(replace(job, ground=-1.0), fewest="minimal", pattern=pattern)
    assert higher.report is not None
    assert higher.report.ok
    # and what is washed from 0.4 m up reaches down to its foot
    raised = op.cover(replace(job, ground=0.4), op.load_robot("boom-washer"))
    assert min(stroke.points[0, 2] for stroke in raised.strokes) >= 0.4


def test_judge_sees_stops_below_the_ground() -> None:
    plan = planned(flat(), fewest="minimal", pattern="hexagon")
    deeper = op.verify(replace(plan, job=replace(flat(), ground=1.0)))
    check = next(check for check in deeper.checks if check.name == "ground")
    assert check.verdict.value == "failed"
    given = replace(flat(), walls=(replace(flat().walls[0], stops=array([[1, -0.5], [3, 1]])),))
    report = planned(given).report
    assert report is not None
    assert next(check for check in report.checks if check.name == "ground").verdict.value == "noted"


@pytest.mark.parametrize("several", [False, True])
def test_what_is_no_building_of_these_walls_is_refused(several: bool) -> None:
    job = corner()
    walls = job.walls if several else job.walls[:1]
    far = replace(job, walls=walls, building=array([[100, 100], [108, 100], [108, 110], [100, 110]]))
    with pytest.raises(InputError, match="wall 'front' is 139 m away from the building"):
        planned(far)
    turned = replace(job.walls[0], origin=array([4, 0, 0]), across=array([-1, 0, 0]))
    with pytest.raises(InputError, match="wall 'front' faces into the building"):
        planned(replace(job, walls=(turned, *walls[1:])))
    # given stops are looked at, too
    stopped = replace(turned, stops=array([[2.0, 1.0]]))
    with pytest.raises(InputError, match="faces into the building"):
        planned(replace(job, walls=(stopped, *walls[1:])))


def test_walls_in_the_same_place_are_refused() -> None:
    job = corner()
    with pytest.raises(InputError, match="walls 'front' and 'again' are in the same place: 12 m2"):
        planned(replace(job, walls=(*job.walls, replace(job.walls[0], name="again"))))


@pytest.mark.parametrize("up", [(0, 0, -1), (0, 1, 0)])
def test_floors_and_walls_on_their_head_have_no_water_rule(up: tuple[float, ...]) -> None:
    job = flat(windows=False)
    job = replace(job, walls=(replace(job.walls[0], up=array(up)),))
    with pytest.raises(InputError, match=r"wall 'wall': its up .* does not point upwards"):
        planned(job)
    plan = planned(job, rule="none", fewest="minimal", pattern="hexagon")
    assert plan.report is not None
    assert plan.report.ok


def test_a_leaning_wall_is_washed_from_above_the_ground() -> None:
    """It hangs over: a lift before its foot would stand below the ground."""
    lean = math.radians(20)
    up = array([0, -math.sin(lean), math.cos(lean)])
    job = Facade("over", (replace(flat().walls[0], up=up),))
    plan = planned(job, fewest="minimal", pattern="hexagon")
    assert plan.report is not None
    assert plan.report.ok
    assert plan.cover is not None
    assert min(stroke.points[0, 2] for stroke in plan.cover.strokes) >= 0


def test_too_many_corners_to_go_around_are_said_before_the_cover() -> None:
    """151 windows have 604 corners; passing them further from the wall needs no ways around them."""
    windows = tuple(
        array([[x, y], [x + 0.1, y], [x + 0.1, y + 0.1], [x, y + 0.1]])
        for x, y in [(0.3 + 0.2 * (k % 23), 0.3 + 0.2 * (k // 23)) for k in range(151)]
    )
    job = replace(flat(), walls=(replace(flat().walls[0], no_go=windows),))
    robot = op.load_robot("boom-washer")
    with pytest.raises(LimitError, match="wall 'wall': its no-go areas have 604 corners"):
        op.cover(job, robot, Options(wash=WashOptions(travel="around")))
    stopped = replace(job, walls=(replace(job.walls[0], stops=array([[0.95, 0.95], [4.05, 0.95]])),))
    lifted = planned(stopped, travel="lift", rule="none")
    assert lifted.path is not None
    assert lifted.path.length.sum() == pytest.approx(3.1 + 2)


def _bent(plan: FloatArray) -> Wall:
    length = math.floor(1e6 * float(np.hypot(*np.diff(plan, axis=0).T).sum())) / 1e6
    return Wall("bent", array([[0, 0], [length, 0], [length, 3], [0, 3]]), plan=plan)


def _arc(radius: float, turn: float, sides: int) -> FloatArray:
    """From (0, 0) along the first axis, bending towards the outside."""
    angle = np.linspace(0, turn, sides + 1)
    return radius * np.column_stack([np.sin(angle), 1 - np.cos(angle)])


@pytest.mark.parametrize(
    "plan",
    [
        _arc(4.0, 1.2 * 2 * math.pi, 60),
        # a loop whose sides cross between their ends
        np.concatenate([array([[0, 0]]), _arc(1.0, 1.5 * math.pi, 20) + array([3, 0]), array([[2, -1]])]),
    ],
)
def test_plans_that_meet_themselves_are_refused(plan: FloatArray) -> None:
    with pytest.raises(InputError, match="the plan meets itself"):
        _bent(plan)


def test_plans_may_close() -> None:
    plan = _arc(4.0, 2 * math.pi, 48)
    plan[-1] = plan[0]
    assert _bent(plan).plan is not None


def test_bends_without_room_for_the_lift_are_refused() -> None:
    robot = op.load_robot("boom-washer")
    tight = Facade("tight", (_bent(_arc(0.6, 2.0, 12)),))
    with pytest.raises(InputError, match=r"wall 'bent': the plan bends more tightly, .* than the stand-off of 0.75 m"):
        op.cover(tight, robot)
    bend = _arc(0.6, math.pi, 12) + np.array([3.0, 0.0])
    slot = np.concatenate([np.zeros((1, 2)), bend, np.array([[0.0, 1.2]])])
    with pytest.raises(InputError, match="bends more tightly"):
        op.cover(Facade("slot", (_bent(slot),)), robot)
    wide = Facade("wide", (_bent(_arc(1.0, 1.5, 12)),))
    assert op.cover(wide, robot).strokes
