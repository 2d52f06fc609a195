"""Speed profiles against closed forms and dense differentiation."""

from __future__ import annotations

import math
from dataclasses import replace

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from optplan.connectors.driving import connect
from optplan.domain.arrays import FloatArray
from optplan.domain.job import Drawing
from optplan.domain.options import Options, PageOptions, TimeOptions
from optplan.domain.path import Path, Trajectory
from optplan.domain.report import Verdict
from optplan.domain.result import Cover, Plan
from optplan.domain.robot import DiffDrive, Gantry, Robot
from optplan.domain.stroke import Stroke
from optplan.geometry.paths import States, along
from optplan.judge import verify
from optplan.problem import traversals
from optplan.timing.fastest import profile, turn_time
from optplan.timing.grid import CONTROL_PERIOD
from optplan.timing.sampling import moments
from tests.strategies import PLOTTER, RAKE, TOOL, WHEELS, array, circle, polylines
from tests.timing.clothoid_paths import SLIPPERY, WEAK, clothoids, random_path


def at(path: Path, s: FloatArray) -> States:
    """States at arc lengths s (k,) m inside pieces of a path that moves."""
    moving = np.flatnonzero(path.length > 0)
    piece = moving[np.clip(np.searchsorted(path.offsets[moving], s, side="right") - 1, 0, len(moving) - 1)]
    return along(path, piece, np.minimum(s - path.offsets[piece], path.length[piece]))


def _line(length: float, tool: int = 1) -> Path:
    zero = np.zeros(1)
    return Path(np.zeros((1, 3)), zero, zero, zero, zero, array([length]), zero, zero, [tool], [0])  # type: ignore[arg-type]


def _path(points: FloatArray, robot: Robot) -> Path:
    strokes = (Stroke("a", points), Stroke("b", points + array([30, 0])))
    options = Options(page=PageOptions(tolerance=0.1))
    ways = traversals(strokes, robot, options)
    return connect(ways.take([0, 2]), Cover(strokes), robot, options)


def _dense(trajectory: Trajectory, count: int = 4000) -> tuple[FloatArray, FloatArray]:
    """Even times, and the arc length then, from the knots alone."""
    t, s, v = trajectory.t, trajectory.s, trajectory.v
    times = np.linspace(0, t[-1], count)
    row = np.clip(np.searchsorted(t, times, side="right") - 1, 0, len(t) - 2)
    run = t[row + 1] - t[row]
    rate = np.divide(v[row + 1] - v[row], run, out=np.zeros(count), where=run > 0)
    into = times - t[row]
    return times, s[row] + v[row] * into + rate * into**2 / 2


def test_a_long_line_is_a_trapezoid() -> None:
    made = profile(_line(2.0), PLOTTER)  # 0.4 m/s, 1 m/s^2
    assert made.duration == pytest.approx(2.0 / 0.4 + 0.4 / 1.0)
    assert made.v.tolist() == [0, 0.4, 0.4, 0]
    assert made.s == pytest.approx([0, 0.08, 1.92, 2])
    assert made.t == pytest.approx([0, 0.4, 5.0, 5.4])


def test_a_short_line_is_a_triangle() -> None:
    made = profile(_line(0.09), PLOTTER)
    assert made.duration == pytest.approx(2 * math.sqrt(0.09))
    assert made.v == pytest.approx([0, 0.3, 0])


def test_tools_and_options_choose_the_speed() -> None:
    assert profile(_line(2.0, tool=0), PLOTTER).v.max() == 0.6
    slow = Options(time=TimeOptions(work_speed=0.1, transit_speed=0.2))
    assert profile(_line(2.0), PLOTTER, slow).v.max() == 0.1
    assert profile(_line(2.0, tool=0), PLOTTER, slow).v.max() == 0.2


def test_nothing_takes_no_time() -> None:
    none = np.zeros(0)
    path = Path(np.zeros((0, 3)), none, none, none, none, none, none, none, none, none)  # type: ignore[arg-type]
    assert profile(path, RAKE).duration == 0


def test_stops_have_their_time() -> None:
    zero = np.zeros(1)
    for angle, dwell in ((0.0, 3.0), (2.0, 0.0), (-2.0, 1.0), (0.01, 0.0)):
        row = np.zeros(1, dtype=np.int64)
        path = Path(np.zeros((1, 3)), zero, zero, zero, zero, zero, array([angle]), array([dwell]), row, row - 1)
        made = profile(path, RAKE)
        assert made.duration == pytest.approx(dwell + turn_time(abs(angle), RAKE))
        assert made.s.tolist() == [0, 0]
        assert made.v.tolist() == [0, 0]


def test_turns_are_trapezoids_too() -> None:
    # 1 rad/s, and wheels of 4 m/s^2 on half a track of 0.25 m: 16 rad/s^2
    assert turn_time(2.0, RAKE) == pytest.approx(2.0 + 1 / 16)
    assert turn_time(0.01, RAKE) == pytest.approx(2 * math.sqrt(0.01 / 16))
    assert turn_time(1 / 16, RAKE) == pytest.approx(2 / 16)
    assert turn_time(0.0, RAKE) == 0
    assert turn_time(2.0, PLOTTER) == 0


@given(polylines(), st.sampled_from([RAKE, PLOTTER]))
def test_limits_hold_everywhere(points: FloatArray, robot: Robot) -> None:
    path = _path(points, robot)
    made = profile(path, robot)
    assert (made.v[0], made.v[-1]) == (0, 0)
    assert made.s[-1] == pytest.approx(path.offsets[-1])
    assert (np.diff(made.t) >= 0).all()
    for offset in path.offsets:
        assert np.abs(made.s - offset).min() < 1e-9
    times, s = _dense(made)
    step = times[1] - times[0]
    speed = np.diff(s) / step
    states = at(path, (s[1:] + s[:-1]) / 2)
    limit = np.where(path.tool[states.piece] > 0, robot.mobility.work_speed, robot.mobility.transit_speed)
    # a difference quotient looks half a step to both sides
    most = np.maximum(limit, np.maximum(np.roll(limit, 1), np.roll(limit, -1)))
    assert (speed <= most + 1e-6).all()
    assert np.abs(np.diff(speed) / step).max() <= robot.mobility.acceleration * (1 + 1e-3) + 1e-6
    if isinstance(robot.mobility, DiffDrive):
        outer = speed * (1 + np.abs(states.curvature) * robot.mobility.track / 2) / robot.mobility.wheel_radius
        assert outer.max() <= robot.mobility.wheel_speed + 1e-6
    standing = np.flatnonzero(path.length == 0)
    for row in standing:
        assert made.v[np.abs(made.s - path.offsets[row]) < 1e-12].max() == 0


@given(polylines())
def test_wheels_keep_their_limits_in_arcs(points: FloatArray) -> None:
    tight = replace(WHEELS, wheel_speed=8.0, turn_rate=1.0)
    robot = Robot("tight", "", TOOL, tight)
    path = _path(points, robot)
    made = profile(path, robot)
    middle = (made.s[1:] + made.s[:-1]) / 2
    moving = np.diff(made.s) > 1e-9
    bend = np.abs(at(path, middle).curvature[moving])
    outer = 1 + bend * tight.track / 2
    top = np.maximum(made.v[1:], made.v[:-1])[moving]
    rate = np.abs(np.diff(made.v)[moving] / np.diff(made.t)[moving])
    assert (top * outer <= 0.8 * (1 + 1e-9)).all()
    assert (rate * outer <= tight.acceleration * (1 + 1e-6)).all()


@pytest.mark.parametrize("bend", [2.0, -2.0])
def test_an_arc_takes_its_share_of_the_outer_wheel(bend: float) -> None:
    zero, row = np.zeros(1), np.zeros(1, dtype=np.int64)
    path = Path(np.zeros((1, 3)), zero, zero, array([bend]), zero, array([3.0]), zero, zero, row + 1, row)
    made = profile(path, RAKE)  # the outer wheel runs at 1 + 2 * 0.25 times the speed
    assert made.t[1] == pytest.approx(0.4 / (4.0 / 1.5))
    assert made.v.max() == 0.4
    weak = profile(path, Robot("weak", "", TOOL, replace(WHEELS, wheel_speed=6.0, work_speed=0.5)))
    assert weak.v.max() == pytest.approx(0.6 / 1.5)


def test_speed_drops_where_curvature_jumps() -> None:
    ring = circle(3.0, 60)
    stroke = Stroke("u", np.concatenate([array([[3, -5]]), ring[:31], array([[-3, -5]])]))
    slow = Robot("slow", "", TOOL, replace(WHEELS, wheel_acceleration=5.0, wheel_speed=20.0))
    options = Options(page=PageOptions(tolerance=0.1))
    path = connect(traversals([stroke], slow, options).take([0]), Cover((stroke,)), slow, options)
    made = profile(path, slow)
    for row in range(1, len(path)):
        jump = abs(path.curvature[row] - path.curvature[row - 1])
        speed = made.v[np.abs(made.s - path.offsets[row]) < 1e-12].max()
        assert speed * jump * 0.25 <= 0.5 * CONTROL_PERIOD + 1e-9


@given(polylines(), st.floats(1, 3), st.floats(1, 3))
def test_more_is_never_slower(points: FloatArray, speed: float, push: float) -> None:
    path = _path(points, PLOTTER)
    mobility = PLOTTER.mobility
    assert isinstance(mobility, Gantry)
    faster = Robot(
        "faster", "", TOOL, Gantry(0.4 * speed, 0.6 * speed, 1.0 * push), PLOTTER.canvas
    )  # fmt: skip
    assert profile(path, faster).duration <= profile(path, PLOTTER).duration * (1 + 1e-9)


def _wheels(path: Path, made: Trajectory, track: float, share: FloatArray) -> tuple[FloatArray, FloatArray]:
    """Speeds and accelerations (2, k) of the wheels' rims at these shares of every stretch between two knots."""
    length = np.diff(made.s)
    stretch = np.flatnonzero(length > 1e-7)
    square, step = made.v**2, length[stretch]
    rate = np.diff(square)[stretch] / (2 * step)
    piece = np.searchsorted(path.offsets, (made.s[:-1] + made.s[1:])[stretch] / 2, side="right") - 1
    gone = share[:, None] * step
    b = np.maximum(square[stretch] + 2 * rate * gone, 0.0)
    sharp = path.sharpness[piece]
    kappa = path.curvature[piece] + sharp * (made.s[:-1][stretch] - path.offsets[piece] + gone)
    sides = np.array([1.0, -1.0])[:, None, None] * track / 2
    speed, push = np.sqrt(b) * (1 + sides * kappa), rate * (1 + sides * kappa) + sides * sharp * b
    return speed.reshape(2, -1), push.reshape(2, -1)


@pytest.mark.parametrize("tight", [0.5, 1.5, 3.9, 9.0])
@pytest.mark.parametrize("robot", [WEAK, SLIPPERY], ids=lambda robot: robot.name)
def test_no_limit_is_passed_between_samples(robot: Robot, tight: float) -> None:
    """At 9 1/m the inner wheel runs backwards, and stands still somewhere on the way there."""
    mobility = robot.mobility
    assert isinstance(mobility, DiffDrive)
    for seed in range(20):
        path = random_path(10, seed, tight)
        made = profile(path, robot)
        speed, push = _wheels(path, made, mobility.track, np.linspace(0, 1, 51))
        assert np.abs(speed).max() <= mobility.wheel_speed * mobility.wheel_radius * (1 + 1e-9)
        assert np.abs(push).max() <= mobility.acceleration * (1 + 1e-6)
        assert np.abs(push).max() >= 0.9 * mobility.acceleration
        times = np.linspace(0, made.duration, 3000)
        gone = np.interp(times, made.t, made.s)
        bend = np.abs(at(path, gone[1:-1]).curvature)
        _, v = moments(made, gone[1:-1], np.zeros(len(bend), dtype=bool))
        assert (v**2 * bend).max() <= mobility.lateral_acceleration * (1 + 1e-6)


@pytest.mark.parametrize("seed", range(10))
@pytest.mark.parametrize("robot", [WEAK, SLIPPERY, PLOTTER], ids=lambda robot: robot.name)
def test_driven_the_other_way_it_takes_as_long(robot: Robot, seed: int) -> None:
    path = random_path(9, seed)
    curvatures = np.append(path.curvature, 0.0)
    back = clothoids(path.length[::-1], -curvatures[::-1])
    assert profile(back, robot).duration == pytest.approx(profile(path, robot).duration, rel=1e-9)


@pytest.mark.parametrize("seed", range(5))
@pytest.mark.parametrize("robot", [WEAK, SLIPPERY], ids=lambda robot: robot.name)
def test_a_finer_grid_gains_little(robot: Robot, seed: int) -> None:
    path = random_path(9, seed)
    usual, fine = profile(path, robot), profile(path, robot, step=0.002)
    assert fine.duration <= usual.duration * (1 + 1e-6)
    assert usual.duration <= fine.duration * 1.002


@pytest.mark.parametrize("even", [False, True])
@pytest.mark.parametrize("length", [3e-6, 0.004, 0.3])
def test_from_rest_to_rest_there_is_a_way(length: float, even: bool) -> None:
    """Also on a clothoid, or a line, shorter than the grid."""
    bend = 0.0 if even else 0.8
    path = clothoids(array([length]), array([0.0, bend]))
    options = Options(time=TimeOptions(jerk=5.0) if even else TimeOptions())
    made = profile(path, WEAK, options)
    assert math.isfinite(made.duration)
    assert made.v.max() > 0
    assert made.v[[0, -1]].tolist() == [0, 0]


def test_a_circle_is_driven_at_its_limit() -> None:
    """Up, around and down with the outer wheel's acceleration; v^2 kappa is at its limit in between."""
    zero, row = np.zeros(1), np.zeros(1, dtype=np.int64)
    path = Path(np.zeros((1, 3)), zero, zero, array([2.0]), zero, array([30.0]), zero, zero, row + 1, row)
    made = profile(path, SLIPPERY)
    top, push = math.sqrt(0.2 / 2.0), 0.8 / (1 + 2.0 * 0.25)
    assert made.v.max() == pytest.approx(top)
    assert made.duration == pytest.approx(30 / top + top / push)


@pytest.mark.parametrize("name", ["wheel_speed", "wheel_acceleration", "lateral_acceleration", "work_speed"])
@pytest.mark.parametrize("seed", range(5))
def test_wheels_that_can_less_are_never_faster(name: str, seed: int) -> None:
    path = random_path(9, seed)
    mobility = SLIPPERY.mobility
    assert isinstance(mobility, DiffDrive)
    less = replace(mobility, **{name: 0.8 * getattr(mobility, name)})
    assert profile(path, Robot("less", "", TOOL, less)).duration >= profile(path, SLIPPERY).duration * (1 - 1e-9)


def test_constant_speed_is_length_over_speed() -> None:
    path = random_path(5, 3)
    made = profile(path, WEAK, Options(time=TimeOptions(constant_speed=0.5)))
    assert made.duration == pytest.approx(path.offsets[-1] / 0.5)
    assert (made.v == 0.5).all()


@pytest.mark.parametrize("limits", [{"jerk": 0.4}, {"power": 0.2}, {"jerk": 1.0, "power": 0.3}])
def test_gentle_profiles_keep_all_limits(limits: dict[str, float]) -> None:
    ring = circle(3.0, 60)
    stroke = Stroke("u", np.concatenate([array([[3, -5]]), ring[:31], array([[-3, -5]])]))
    options = Options(page=PageOptions(tolerance=0.1), time=TimeOptions(**limits))
    path = connect(traversals([stroke], WEAK, options).take([0]), Cover((stroke,)), WEAK, options)
    made, free = profile(path, WEAK, options), profile(path, WEAK)
    assert free.duration < made.duration < 3 * free.duration
    report = verify(Plan(Drawing("u", ()), WEAK, options, Cover((stroke,)), path=path, trajectory=made))
    checked = {check.name: check for check in report.checks}
    for name in ("time", "rest", "speed", "acceleration", "wheel speed", "wheel acceleration", *limits):
        assert checked[name].verdict is Verdict.PASSED, checked[name]


@given(polylines(), st.lists(st.floats(0, 1), min_size=1, max_size=20))
def test_moments_follow_the_profile(points: FloatArray, shares: list[float]) -> None:
    made = profile(_path(points, RAKE), RAKE)
    s = array(sorted(shares)) * made.s[-1]
    late = np.zeros(len(s), dtype=bool)
    t, v = moments(made, s, late)
    assert (np.diff(t) >= -1e-12).all()
    times, dense = _dense(made, 20000)
    assert np.interp(t, times, dense) == pytest.approx(s, abs=1e-4)
    assert (v <= 0.6 + 1e-9).all()
    early, _ = moments(made, s, ~late)
    assert (early <= t + 1e-12).all()


def test_a_wait_has_two_times() -> None:
    stroke = Stroke("v", array([[0, 0], [1, 0], [1, 1]]))
    made = profile(connect(traversals([stroke], RAKE).take([0]), Cover((stroke,)), RAKE), RAKE)
    place = array([1.0, 1.0, 0.0, 2.0])
    t, v = moments(made, place, np.array([True, False, True, False]))
    assert t[1] - t[0] == pytest.approx(turn_time(math.pi / 2, RAKE))
    assert v.tolist() == [0, 0, 0, 0]
    assert (t[2], t[3]) == (0, made.duration)
    half, speed = moments(made, array([0.5]), np.array([False]))
    assert half[0] == pytest.approx(t[0] / 2)
    assert speed[0] == 0.4
