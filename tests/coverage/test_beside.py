"""Tools beside, ahead of and behind their robot, judged by an integration of the robot's path of their own."""

from __future__ import annotations

import math
from dataclasses import replace

import numpy as np
import pytest
import shapely
from hypothesis import given, settings
from hypothesis import strategies as st

import optplan as op
from optplan.connectors.driving import connect
from optplan.connectors.ways import driven
from optplan.coverage.beside import refusals
from optplan.coverage.splitting import direction_notes, split_at_stops
from optplan.coverage.stops import tolerance_of
from optplan.domain.errors import InputError
from optplan.domain.options import Options
from optplan.domain.path import Trajectory
from optplan.domain.result import Cover
from optplan.domain.robot import Robot
from optplan.domain.stroke import Stroke
from optplan.geometry.curves import Curve, joints
from optplan.geometry.offsets import smooth_offset
from optplan.geometry.rounding import Pieces
from optplan.geometry.towing import towed
from optplan.problem import traversals
from optplan.robots import load_robot
from optplan.timing.fastest import profile

MARKER = load_robot("line-marker")
RAKE = load_robot("beach-rake")
OPTIONS = Options()


def with_tool(robot: Robot, right: float, ahead: float = 0.0) -> Robot:
    return replace(robot, tool=replace(robot.tool, right=right, ahead=ahead))


def tool_of(pieces: Pieces, right: float, ahead: float) -> np.ndarray:
    """(k, 2) places of the tool along pieces, by the trapezoidal rule at 0.2 mm."""
    found = []
    for k in range(len(pieces.length)):
        s = np.linspace(0, pieces.length[k], 2 + int(pieces.length[k] / 2e-4))
        theta = pieces.heading[k] + pieces.curvature[k] * s + pieces.sharpness[k] * s**2 / 2
        step = np.stack([np.cos(theta), np.sin(theta)], axis=1)
        gone = np.concatenate([np.zeros((1, 2)), np.cumsum((step[1:] + step[:-1]) / 2 * np.diff(s)[:, None], axis=0)])
        left = np.stack([-step[:, 1], step[:, 0]], axis=1)
        found.append(pieces.start[k] + gone + ahead * step - right * left)
    return np.concatenate(found)


def astray(stroke: Stroke, reverse: bool, robot: Robot) -> float:
    """Greatest distance between the tool and its stroke, looked at from both, m."""
    vertex = len(stroke.points) - 1 if reverse and not stroke.closed else 0
    pieces = driven(stroke, vertex, reverse, robot, OPTIONS)
    tool = tool_of(pieces, robot.tool.right, robot.tool.ahead)
    line = shapely.LineString(stroke.closed_points[:, :2])
    there = shapely.distance(line, shapely.points(tool)).max()
    back = shapely.distance(shapely.LineString(tool), shapely.points(stroke.points[:, :2])).max()
    return float(max(there, back))


def s_curve(amplitude: float, wave: float = 6.0) -> Stroke:
    x = np.linspace(0, 2 * wave, 160)
    return Stroke("s", np.column_stack([x, amplitude * np.sin(2 * math.pi * x / wave)]), 1)


def ring(radius: float) -> Stroke:
    angle = np.linspace(0, 2 * math.pi, 90, endpoint=False)
    return Stroke("ring", radius * np.column_stack([np.cos(angle), np.sin(angle)]), 1, closed=True)


@pytest.mark.parametrize("reverse", [False, True])
@pytest.mark.parametrize("stroke", [Stroke("line", np.array([[0.0, 0], [5, 3]])), s_curve(0.8), ring(2.0)])
@pytest.mark.parametrize("place", [(0.41124, 0.0), (-0.3, 0.0), (0.0, -0.3), (0.2, 0.3)])
def test_the_tool_is_on_its_line_in_both_directions(stroke: Stroke, reverse: bool, place: tuple[float, float]) -> None:
    robot = with_tool(MARKER, *place)
    limit = 1e-6 if len(stroke.points) == 2 else tolerance_of(OPTIONS.page, robot.tool)
    assert astray(stroke, reverse, robot) <= limit


@settings(max_examples=15, deadline=None)
@given(st.floats(-0.5, 0.5), st.booleans())
def test_any_offset_follows_a_gentle_curve(right: float, reverse: bool) -> None:
    robot = with_tool(MARKER, right)
    assert astray(s_curve(0.6), reverse, robot) <= tolerance_of(OPTIONS.page, robot.tool)


@given(st.floats(-2, 2), st.floats(-0.45, 0.45))
def test_the_parallel_of_an_arc_is_an_arc(kappa: float, right: float) -> None:
    arc = Curve(np.zeros(3), np.array([kappa]), np.zeros(1), np.array([1.5]))
    made = smooth_offset(arc, right, 1e-4).curve
    assert made.curvature[0] == pytest.approx(kappa / (1 - kappa * right), rel=1e-12)


def test_a_corner_arc_of_a_metre_needs_the_curvature_of_its_inner_side() -> None:
    arc = Curve(np.zeros(3), np.ones(1), np.zeros(1), np.array([math.pi / 2]))
    assert smooth_offset(arc, 0.411, 1e-4).curve.max_curvature == pytest.approx(1.70, abs=0.005)


@given(st.floats(0.2, 0.9), st.sampled_from([-0.4, 0.4]))
@settings(max_examples=20, deadline=None)
def test_parallels_of_clothoids_stay_smooth(sharpness: float, right: float) -> None:
    curve = Curve(np.zeros(3), np.array([0.0, sharpness]), np.array([sharpness, -sharpness]), np.ones(2))
    made = smooth_offset(curve, right, 1e-5)
    assert made.error <= 1e-5
    assert joints(made.curve, tolerance=1e-6).order.min(initial=2) == 2


@pytest.mark.parametrize("ahead", [-0.3, 0.3])
def test_a_towed_tool_on_an_arc_makes_the_robot_drive_another(ahead: float) -> None:
    arc = Curve(np.zeros(3), np.array([0.5]), np.zeros(1), np.array([6.0]))
    made = towed(arc, 0.0, ahead, 1e-5).curve
    assert np.allclose(made.curvature, 1 / math.sqrt(2.0**2 - ahead**2), rtol=1e-3)


def test_a_direction_that_is_too_tight_is_no_way_and_is_named() -> None:
    hook = ring(0.35)  # counter-clockwise, and so tight that its inner parallel has no radius left
    forwards, backwards = refusals(hook, MARKER, OPTIONS)
    assert "cusp" in forwards
    assert not backwards
    ways = traversals([hook], MARKER, OPTIONS)
    assert len(ways) > 0
    assert ways.reverse.all()
    (note,) = direction_notes([hook], MARKER, OPTIONS)
    assert "'ring'" in note.text
    assert "against" in note.text
    with pytest.raises(InputError, match="'ring' cannot be driven forwards"):
        driven(hook, 0, False, MARKER, OPTIONS)
    with pytest.raises(InputError, match="'ring' cannot be driven"):
        traversals([replace(hook, directed=True)], MARKER, OPTIONS)


def test_bends_that_ask_for_both_directions_are_driven_apart() -> None:
    angle = np.linspace(0, math.pi, 60)
    half = 0.38 * np.column_stack([np.cos(angle), np.sin(angle)])
    other = np.array([-0.76, 0]) + 0.38 * np.column_stack([np.cos(angle), -np.sin(angle)])
    stroke = Stroke("twist", np.concatenate([half, other[1:]]))
    assert all(refusals(stroke, MARKER, OPTIONS))
    parts, source = split_at_stops([stroke], MARKER, OPTIONS)
    assert len(parts) >= 2
    assert set(source) == {0}
    assert all(not all(refusals(part, MARKER, OPTIONS)) for part in parts)
    assert sum(part.length for part in parts) == pytest.approx(stroke.length)


def test_a_robot_that_turns_on_the_spot_lifts_a_tool_beside_it_at_corners() -> None:
    corner = Stroke("corner", np.array([[0.0, 0], [4, 0], [4, 4]]))
    assert len(split_at_stops([corner], RAKE, OPTIONS)[0]) == 1
    robot = with_tool(RAKE, 0.2)
    parts = split_at_stops([corner], robot, OPTIONS)[0]
    assert len(parts) == 2
    path = connect(traversals(parts, robot, OPTIONS).take([0, 2]), Cover(tuple(parts)), robot, OPTIONS)
    assert not ((path.turn != 0) & (path.tool > 0)).any()


def tool_speeds(made: Trajectory, robot: Robot) -> np.ndarray:
    """Speeds of the tool while it is down, m/s, at fifty places between any two knots."""
    path = made.path
    share = np.linspace(0, 1, 51)
    s = made.s[:-1, None] + share * np.diff(made.s)[:, None]
    v = np.sqrt(made.v[:-1, None] ** 2 + share * np.diff(made.v**2)[:, None])
    row = np.clip(np.searchsorted(path.offsets, (made.s[:-1] + made.s[1:]) / 2, side="right") - 1, 0, len(path) - 1)
    kappa = path.curvature[row, None] + path.sharpness[row, None] * (s - path.offsets[row, None])
    right, ahead = robot.tool.right, robot.tool.ahead
    speed = v * np.hypot(1 + kappa * right, kappa * ahead)
    return speed[(path.tool[row] > 0) & (np.diff(made.s) > 0)]


@pytest.mark.parametrize("place", [(0.41124, 0.0), (0.0, -0.3)])
def test_the_tool_keeps_its_work_speed_between_knots(place: tuple[float, float]) -> None:
    robot = with_tool(MARKER, *place)
    stroke = s_curve(1.0)
    for row in (0, 1):
        ways = traversals([stroke], robot, OPTIONS).take([row])
        speed = tool_speeds(profile(connect(ways, Cover((stroke,)), robot, OPTIONS), robot, OPTIONS), robot)
        assert 0.9 < speed.max() <= 1 + 1e-9


@pytest.mark.parametrize("name", ["wave", "fish"])
def test_the_judge_passes_plans_with_the_nozzle_at_the_side(name: str) -> None:
    options = Options(order=replace(OPTIONS.order, iterations=50))
    made = op.plan(op.read(op.instance(name)), MARKER, options)
    assert made.report is not None
    assert not [c.name for c in made.report.checks if c.verdict.value == "failed"]


def test_the_judge_sees_a_tool_that_is_elsewhere() -> None:
    options = Options(order=replace(OPTIONS.order, iterations=50))
    made = op.plan(op.read(op.instance("wave")), MARKER, options)
    report = op.verify(replace(made, robot=with_tool(MARKER, -0.41124)))
    (deviation,) = (c for c in report.checks if c.name == "deviation")
    assert deviation.value == pytest.approx(2 * 0.41124, rel=0.05)
