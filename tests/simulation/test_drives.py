"""Whole drives, judged by what they leave behind."""

from __future__ import annotations

import csv
import io
import math
from dataclasses import replace

import numpy as np
import pytest

import optplan as op
from optplan.domain.drive import Drive
from optplan.domain.path import Path
from optplan.domain.result import Plan
from optplan.domain.robot import DiffDrive
from optplan.domain.stop import StopRule
from optplan.simulation.trace import COLUMNS, trace_text
from tests.simulation.plans import BEND, CORNERS, EIGHT, LINE, QUARTER, path_of, plan_of, rake, taken

PATHS = {"line": LINE, "corners": CORNERS, "bend": BEND, "eight": EIGHT}


def points_of(path: Path) -> np.ndarray:
    """Points every 2 mm along a path, by a fine sum."""
    made = []
    for k in range(len(path)):
        count = max(2, math.ceil(path.length[k] / 0.002))
        u = (np.arange(count) + 0.5) * path.length[k] / count
        angle = path.heading[k] + u * (path.curvature[k] + u * path.sharpness[k] / 2)
        step = path.length[k] / count * np.column_stack([np.cos(angle), np.sin(angle)])
        made.append(path.start[k, :2] + np.concatenate([np.zeros((1, 2)), np.cumsum(step, axis=0)]))
    return np.concatenate(made)


def distances(drive: Drive, path: Path) -> np.ndarray:
    """Distance of the tool from the whole path, moment by moment."""
    points = points_of(path)
    from scipy.spatial import cKDTree

    return np.asarray(cKDTree(points).query(np.column_stack([drive.tool_x, drive.tool_y]))[0])


def held(drive: Drive, mobility: DiffDrive) -> None:
    """Limits kept, and speeds that fit the accelerations and the places."""
    assert np.abs(drive.wheel_speed).max() <= mobility.wheel_speed * (1 + 1e-12)
    assert np.abs(np.diff(drive.wheel_speed, axis=0)).max() <= mobility.wheel_acceleration * 0.01 * (1 + 1e-9)
    assert np.diff(drive.wheel_speed, axis=0) == pytest.approx(drive.wheel_acceleration[1:] * 0.01, abs=1e-9)
    assert np.diff(drive.time) == pytest.approx(0.01)


@pytest.mark.parametrize("name", PATHS)
def test_an_ideal_robot_is_within_a_millimetre(name: str) -> None:
    plan = plan_of(PATHS[name])
    drive = op.simulate(plan, op.DriveOptions(ideal=True))
    assert drive.finished
    assert np.abs(drive.cross_track).max() < 1e-3
    assert distances(drive, PATHS[name]).max() < 2e-3  # the points are 2 mm apart
    assert plan.trajectory is not None
    assert drive.time[-1] == pytest.approx(plan.trajectory.duration, abs=0.3)
    held(drive, rake().mobility)  # type: ignore[arg-type]
    last = points_of(PATHS[name])[-1]
    assert math.hypot(drive.x[-1] - last[0], drive.y[-1] - last[1]) < 2e-3
    assert abs(drive.speed[-1]) < 2e-3


@pytest.mark.parametrize("tracker", ["path-frame", "pure-pursuit"])
@pytest.mark.parametrize("name", PATHS)
def test_limits_and_kinematics_with_lag_and_noise(name: str, tracker: str) -> None:
    robot = rake()
    assert isinstance(robot.mobility, DiffDrive)
    options = op.DriveOptions(tracker=tracker, lag=0.1, slip=0.03, noise=0.005, heading_noise=0.01)
    drive = op.simulate(plan_of(PATHS[name], robot), options)
    assert drive.finished, drive.reason
    held(drive, robot.mobility)
    assert np.abs(drive.cross_track).max() < 0.15
    # without a look at the schedule: the place follows from speed and heading
    middle = (drive.heading[1:] + drive.heading[:-1]) / 2
    v = (drive.speed[1:] + drive.speed[:-1]) / 2
    assert np.diff(drive.x) == pytest.approx(0.01 * v * np.cos(middle), abs=1e-4)
    assert np.diff(drive.y) == pytest.approx(0.01 * v * np.sin(middle), abs=1e-4)


def test_the_offset_is_the_distance_from_the_path() -> None:
    drive = op.simulate(plan_of(BEND), op.DriveOptions(tracker="pure-pursuit", lag=0.2, slip=0.1, noise=0.02))
    end = points_of(BEND)[-1]
    between = np.hypot(drive.x - end[0], drive.y - end[1]) > 0.2  # beyond the end there is no line to be beside
    away = distances(drive, BEND)[between]
    assert away.max() > 0.02
    assert np.abs(drive.cross_track[between]) == pytest.approx(away, abs=1e-3)


def test_speeds_are_those_of_the_wheels() -> None:
    drive = op.simulate(plan_of(BEND), op.DriveOptions(lag=0.08))
    left, right = 0.1 * drive.wheel_speed.T
    assert drive.speed == pytest.approx((left + right) / 2, abs=1e-12)
    assert drive.turn_rate == pytest.approx((right - left) / 0.5, abs=1e-12)
    assert drive.turn_rate.max() > 0.2  # to the left


def test_a_tool_on_the_right_goes_further_in_a_bend_to_the_left() -> None:
    robot = rake()
    robot = replace(robot, tool=replace(robot.tool, right=0.3))
    arc = path_of([(math.pi, 0.5, 0.0, 0.0)])
    drive = op.simulate(plan_of(arc, robot), op.DriveOptions(ideal=True))
    tool = np.hypot(np.diff(drive.tool_x), np.diff(drive.tool_y)).sum()
    middle = np.hypot(np.diff(drive.x), np.diff(drive.y)).sum()
    assert tool / middle == pytest.approx(1 + 0.5 * 0.3, abs=2e-3)
    # its line is the circle of radius 2 + 0.3 about (0, 2)
    away = np.hypot(drive.tool_x, drive.tool_y - 2) - 2.3
    assert np.abs(away).max() < 3e-3
    assert drive.cross_track == pytest.approx(-away, abs=1e-6)  # left is towards the centre


def test_sign_and_convergence_of_the_offset() -> None:
    plan = plan_of(LINE)
    drive = op.simulate(plan, op.DriveOptions(start=(0.0, 0.2, 0.0)))
    assert drive.cross_track[0] == pytest.approx(0.2)
    assert drive.cross_track == pytest.approx(drive.tool_y, abs=1e-9)
    assert np.abs(drive.cross_track[-1]) < 5e-3
    assert drive.cross_track.min() > -0.02


def test_tool_settings_are_switched_where_the_path_says() -> None:
    drive = op.simulate(plan_of(CORNERS))
    changes = np.flatnonzero(np.diff(drive.tool)) + 1
    assert drive.tool[[0, *changes]].tolist() == [1, 0, 2, 0, 3]
    for k, (x, y) in zip(changes, ((2, 0), (2, 0), (2, 1.5), (2, 1.5)), strict=True):
        assert math.hypot(drive.x[k] - x, drive.y[k] - y) < 0.01
    standing = drive.tool == 0
    assert np.abs(drive.speed[standing]).max() < 5e-3
    assert drive.turn_rate.max() == pytest.approx(1.0, abs=0.05)  # the robot's turn rate
    assert drive.heading[-1] == pytest.approx(QUARTER - 2, abs=5e-3)


def test_a_corner_without_a_stop_is_turned_too() -> None:
    path = path_of([(1.0, 0, 0, 0), (0.0, 0, 0, 1.0), (1.0, 0, 0, 0)])
    rows = np.array([0, 2])
    drive = op.simulate(plan_of(taken(path, rows)))
    assert drive.finished
    assert np.abs(drive.cross_track).max() < 2e-3
    assert drive.heading[-1] == pytest.approx(1.0, abs=5e-3)


@pytest.mark.parametrize("tracker", ["path-frame", "pure-pursuit"])
def test_backwards_and_forwards_again(tracker: str) -> None:
    path = path_of([(2, 0, 0, 0), (0, 0, 0, math.pi), (2, 0.5, 0, 0), (0, 0, 0, math.pi), (2, 0, 0, 0)])
    rows = np.array([0, 2, 4])
    cusped = replace(taken(path, rows), gear=np.array([1, -1, 1]))
    drive = op.simulate(plan_of(cusped), op.DriveOptions(tracker=tracker))
    assert drive.finished, drive.reason
    assert drive.speed.min() < -0.3
    assert drive.speed.max() > 0.3
    assert np.abs(drive.cross_track).max() < (1e-3 if tracker == "path-frame" else 0.05)
    # the travel to the left while it backs turns the body to the left, by 1 rad in all
    assert drive.heading[-1] == pytest.approx(1.0, abs=0.02)
    standing = np.abs(drive.turn_rate[np.abs(drive.speed) < 1e-3])
    assert standing.max() < 0.05  # it does not turn round on the spot
    assert math.hypot(drive.x[-1] - path.start[4, 0], drive.y[-1] - path.start[4, 1]) == pytest.approx(2, abs=0.03)


def test_a_tool_beside_a_robot_that_backs() -> None:
    robot = rake()
    robot = replace(robot, tool=replace(robot.tool, right=0.3, ahead=0.1))
    back = replace(path_of([(3, 0.4, 0, 0)]), gear=np.array([-1]))
    drive = op.simulate(plan_of(back, robot), op.DriveOptions(ideal=True))
    assert drive.finished
    # travelling along +x with its front towards -x, its right is +y
    assert (drive.tool_x[0], drive.tool_y[0]) == pytest.approx((-0.1, 0.3))
    # the arc is about (0, 2.5); the tool stays on its own circle about the same centre
    radius = np.hypot(drive.tool_x, drive.tool_y - 2.5)
    assert radius == pytest.approx(math.hypot(2.5 - 0.3, 0.1), abs=1e-3)
    assert np.abs(drive.cross_track).max() < 1e-3


def test_dwelling() -> None:
    path = replace(CORNERS, dwell=np.array([0, 3.0, 0, 0, 0]))
    without, dwelt = op.simulate(plan_of(CORNERS)), op.simulate(plan_of(path))
    assert dwelt.time[-1] - without.time[-1] == pytest.approx(3.0, abs=0.1)


def test_the_same_seed_is_the_same_drive() -> None:
    plan = plan_of(BEND)
    options = op.DriveOptions(slip=0.02, noise=0.01, heading_noise=0.01, seed=7)
    one, two = op.simulate(plan, options), op.simulate(plan, options)
    other = op.simulate(plan, replace(options, seed=8))
    assert np.array_equal(one.x, two.x)
    assert np.array_equal(one.wheel_speed, two.wheel_speed)
    assert not np.array_equal(one.x[:100], other.x[:100])


def test_more_noise_more_error() -> None:
    plan = plan_of(BEND)
    errors = [
        np.mean(
            [
                op.simulate(plan, op.DriveOptions(slip=s, noise=s / 2, seed=seed)).figure("cross-track, rms")
                for seed in range(8)
            ]
        )
        for s in (0.0, 0.01, 0.04, 0.16)
    ]
    assert errors == sorted(errors)
    assert errors[-1] > 3 * errors[1]


def test_more_lag_costs_pure_pursuit_more_than_feed_forward() -> None:
    plan = plan_of(BEND)
    rms = {
        name: op.simulate(plan, op.DriveOptions(tracker=name, lag=0.2)).figure("cross-track, rms")
        for name in ("path-frame", "pure-pursuit")
    }
    assert rms["path-frame"] < 0.3 * rms["pure-pursuit"]


def test_a_lost_robot_says_so() -> None:
    far = op.simulate(plan_of(LINE), op.DriveOptions(start=(0.0, 50.0, 0.0)))
    assert not far.finished
    assert "more than 2 m beside it" in far.reason
    assert len(far) == 1


def test_a_robot_that_cannot_arrive_ends() -> None:
    # wheels that need minutes to answer
    drive = op.simulate(plan_of(LINE), op.DriveOptions(lag=1e4))
    assert not drive.finished
    assert "did not reach the end" in drive.reason
    assert drive.time[-1] < 100


@pytest.mark.parametrize("name", PATHS)
def test_a_robot_that_measures_nonsense_ends(name: str) -> None:
    for tracker in ("path-frame", "pure-pursuit"):
        options = op.DriveOptions(tracker=tracker, noise=0.5, heading_noise=1.0, slip=0.5, lag=0.5, lost=1e6)
        drive = op.simulate(plan_of(PATHS[name]), options)
        assert np.isfinite(drive.cross_track).all()
        assert drive.time[-1] < 200


def test_a_cancel_is_heard() -> None:
    drive = op.simulate(plan_of(LINE), stop=StopRule(cancelled=lambda: True))
    assert not drive.finished
    assert drive.reason == "stopped on the way: cancelled"


def test_progress_is_told() -> None:
    heard: list[op.Progress] = []
    op.simulate(plan_of(LINE), progress=heard.append)
    assert heard[-1].fraction == 1.0
    assert {event.stage for event in heard} == {"drive"}


def test_figures_and_trace_agree() -> None:
    plan = plan_of(CORNERS)
    drive = op.simulate(plan, op.DriveOptions(tracker="pure-pursuit", mass=40.0, rolling=0.1))
    rows = list(csv.DictReader(io.StringIO(trace_text(drive, plan.robot))))
    assert tuple(rows[0]) == COLUMNS
    column = {name: np.array([float(row[name]) for row in rows]) for name in COLUMNS}
    down = column["tool"] > 0
    cross = column["cross_track"]
    figure = drive.figure
    assert figure("cross-track, greatest") == pytest.approx(np.abs(cross).max(), abs=1e-6)
    assert figure("cross-track, rms") == pytest.approx(np.sqrt((cross**2).mean()), abs=1e-6)
    assert figure("cross-track with the tool down, rms") == pytest.approx(np.sqrt((cross[down] ** 2).mean()), abs=1e-6)
    wheels = np.column_stack([column["wheel_left"], column["wheel_right"]])
    assert figure("wheel speed, greatest") == pytest.approx(np.abs(wheels).max(), abs=1e-5)
    assert figure("duration") == pytest.approx(column["t"][-1], abs=1e-6)
    assert figure("lag, greatest") == pytest.approx(np.abs(column["lag"]).max(), abs=1e-6)
    assert set(column["code"]) == {plan.robot.tool.settings[k].code for k in range(4)}
    # the energy: at least what rolling over the whole way takes, and no more than that and every acceleration
    rim = np.abs(wheels) * 0.1
    rolled = 0.1 * 40 / 2 * 9.80665 * np.trapezoid(rim, dx=0.01, axis=0).sum()
    gained = 40 / 4 * np.maximum(np.diff(rim**2, axis=0), 0).sum()
    assert 0.99 * rolled <= figure("energy") <= 1.01 * (rolled + gained)
    with pytest.raises(KeyError):
        op.simulate(plan).figure("energy")


def test_the_lag_of_a_motor() -> None:
    options = op.DriveOptions(mass=40.0, motor=2.0)
    assert options.time_constant(0.1) == pytest.approx(0.1)  # half the mass at a radius of 0.1 m against 2 N m s
    same = [op.simulate(plan_of(BEND), o).x for o in (options, op.DriveOptions(lag=0.1))]
    assert same[0] == pytest.approx(same[1], abs=1e-9)


@pytest.mark.parametrize(
    ("wrong", "message"),
    [
        ({"tracker": "magic"}, "there is no tracker 'magic'; expected one of path-frame, pure-pursuit"),
        ({"lag": 0.0}, "lag is 0.0; expected a finite number above 0"),
        ({"lag": -1.0}, "lag is -1.0"),
        ({"lag": math.nan}, "lag is nan"),
        ({"mass": 0.0}, "mass is 0.0"),
        ({"mass": -3.0}, "mass is -3.0"),
        ({"motor": 1.0}, "a motor gives the lag together with a mass"),
        ({"slip": -0.1}, "slip is -0.1; expected a number from 0 to 0.5"),
        ({"noise": math.inf}, "noise is inf"),
        ({"seed": -1}, "seed is -1"),
        ({"lookahead": 0.0}, "lookahead is 0.0"),
        ({"start": (0.0, math.nan, 0.0)}, "start is"),
        ({"ideal": True, "slip": 0.1}, "an ideal drive has no lag"),
    ],
)
def test_wrong_circumstances(wrong: dict[str, object], message: str) -> None:
    with pytest.raises(op.InputError, match=message.replace("(", r"\(")):
        op.DriveOptions(**wrong)  # type: ignore[arg-type]


def test_a_plan_without_speeds() -> None:
    plan = replace(plan_of(LINE), trajectory=None)
    with pytest.raises(op.InputError, match="no speeds to drive; run the stage time first"):
        op.simulate(plan)


def test_a_plan_that_is_too_long() -> None:
    slow = rake(work_speed=1e-4)
    with pytest.raises(op.InputError, match="at most 20000 s"):
        op.simulate(plan_of(LINE, slow))


def test_other_robots_follow_exactly() -> None:
    plan = op.plan(op.read(op.instance("wave")), "pen-plotter")
    assert plan.trajectory is not None
    drive = op.simulate(plan)
    assert drive.finished
    assert drive.method == "kinematic"
    assert "only robots with two driven wheels are simulated" in drive.reason
    assert not drive.cross_track.any()
    assert drive.time[-1] == pytest.approx(plan.trajectory.duration)
    assert distances(drive, plan.trajectory.path).max() < 1.1e-3


@pytest.fixture(scope="module")
def drawing() -> Plan:
    return op.plan(op.read(op.instance("lion")), options=op.Options(order=op.OrderOptions(seconds=2)))


@pytest.mark.parametrize(
    ("options", "most"),
    [
        (op.DriveOptions(ideal=True), 1e-3),
        (op.DriveOptions(), 2e-3),
        (op.DriveOptions(tracker="pure-pursuit"), 0.06),
        (op.DriveOptions(slip=0.02, noise=0.01, heading_noise=0.01), 0.03),
    ],
)
def test_a_shipped_drawing(drawing: Plan, options: op.DriveOptions, most: float) -> None:
    drive = op.simulate(drawing, options)
    assert drive.finished, drive.reason
    assert np.abs(drive.cross_track).max() < most
    assert drawing.trajectory is not None
    assert drive.time[-1] == pytest.approx(drawing.trajectory.duration, rel=0.03)
