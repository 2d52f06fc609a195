"""From strokes to ways to an ordering problem to the path: one story, told twice."""

from __future__ import annotations

import math
from dataclasses import replace

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from optplan.connectors.driving import connect
from optplan.connectors.families import Family, metric_of, start_states
from optplan.connectors.ways import driven
from optplan.coverage.splitting import split_at_stops
from optplan.domain.errors import InputError
from optplan.domain.job import Drawing
from optplan.domain.options import ConnectOptions, Options, OrderOptions, PageOptions
from optplan.domain.path import RAISED, Path
from optplan.domain.report import Verdict
from optplan.domain.result import Cover, Plan
from optplan.domain.robot import Robot
from optplan.domain.stroke import Stroke, Traversals
from optplan.geometry.dubins import dubins_path
from optplan.geometry.paths import ends
from optplan.judge import verify
from optplan.problem import DUBINS_ENTRIES, ordering_problem, traversals
from tests.strategies import CAR, PLOTTER, RAKE, array, box, circle, polylines, star_shaped

PAGE = PageOptions(tolerance=0.05)
OPEN = Stroke("open", array([[0, 0], [2, 0], [4, 0.5], [4, 5]]))
RING = Stroke("ring", circle(2.0, 40, (8, 8)), closed=True)


def _options(robot: Robot, **order: object) -> Options:
    metric = "euclid" if robot is not CAR else "dubins"
    return Options(page=PAGE, order=OrderOptions(metric=metric, **order))  # type: ignore[arg-type]


@st.composite
def covers(draw: st.DrawFn) -> Cover:
    """Up to six strokes here and there: open ones, rings, stops of a robot in between, some with wishes."""
    strokes: list[Stroke] = []
    for k in range(draw(st.integers(1, 6))):
        shift = array(draw(st.tuples(st.integers(0, 20), st.integers(0, 20))))
        tool = draw(st.integers(0, 2))
        directed = draw(st.booleans())
        if draw(st.booleans()):
            ring = draw(star_shaped()) + shift
            entry = draw(st.one_of(st.none(), st.integers(0, len(ring) - 1)))
            strokes.append(Stroke(f"s{k}", ring, tool, closed=True, directed=directed, entry=entry))
        else:
            line = draw(polylines()) + shift
            entry = draw(st.sampled_from([None, 0, len(line) - 1])) if not directed else None
            strokes.append(Stroke(f"s{k}", line, tool, directed=directed, entry=entry))
    start = draw(st.one_of(st.none(), st.just((1.5, -3.0))))
    return Cover(tuple(strokes), start=start)


def test_an_open_stroke_is_entered_at_either_end() -> None:
    ways = traversals([OPEN], RAKE, _options(RAKE))
    assert ways.entry_vertex.tolist() == [0, 3]
    assert ways.reverse.tolist() == [False, True]
    assert ways.entry[:, :2] == pytest.approx(array([[0, 0], [4, 5]]))
    assert ways.exit[:, :2] == pytest.approx(array([[4, 5], [0, 0]]))
    headings = [[0, math.pi / 2], [-math.pi / 2, math.pi]]
    found = np.column_stack([ways.entry[:, 3], ways.exit[:, 3]])
    # bends of 14 degrees begin as early as the tolerance of 5 cm allows
    assert np.abs(np.sin((found - headings) / 2)).max() < 0.05
    straight = traversals([OPEN], PLOTTER, _options(PLOTTER))
    found = np.column_stack([straight.entry[:, 3], straight.exit[:, 3]])
    assert np.sin((found - headings) / 2) == pytest.approx(0, abs=1e-12)
    assert ways.length[0] == ways.length[1]


def test_a_ring_is_entered_anywhere_and_left_there() -> None:
    ways = traversals([RING], RAKE, _options(RAKE))
    assert ways.entry_vertex.tolist() == list(range(40))
    assert not ways.reverse.any()
    assert (ways.entry[:, :3] == ways.exit[:, :3]).all()
    assert ways.entry[:, :2] == pytest.approx(RING.points, abs=0.05)
    assert ways.entry[:, 4] == pytest.approx(0.5, rel=0.02)
    assert (traversals([RING], PLOTTER, _options(PLOTTER)).entry[:, :2] == RING.points).all()


def test_both_directions_only_where_headings_count() -> None:
    many = traversals([RING], CAR, _options(CAR, entries=40))
    assert len(many) == 80
    assert many.reverse.sum() == 40
    assert len(traversals([RING], CAR, _options(CAR))) == 2 * DUBINS_ENTRIES
    assert len(traversals([RING], PLOTTER, _options(PLOTTER))) == 40


@pytest.mark.parametrize("most", [1, 3, 7, 39, 40, 99])
def test_entries_are_thinned_out_evenly(most: int) -> None:
    vertices = traversals([RING], RAKE, _options(RAKE, entries=most)).entry_vertex
    assert len(vertices) == min(most, 40)
    assert len(set(vertices.tolist())) == len(vertices)
    gaps = np.diff(np.append(vertices, vertices[0] + 40))
    assert np.ptp(gaps) <= 1


def test_wishes_leave_less_choice() -> None:
    def ways(stroke: Stroke, robot: Robot = CAR) -> list[tuple[int, bool]]:
        found = traversals([stroke], robot, _options(robot))
        return list(zip(found.entry_vertex.tolist(), found.reverse.tolist(), strict=True))

    assert ways(replace(OPEN, directed=True)) == [(0, False)]
    assert ways(replace(OPEN, entry=3)) == [(3, True)]
    assert ways(replace(OPEN, entry=0)) == [(0, False)]
    assert ways(replace(RING, entry=5)) == [(5, False), (5, True)]
    assert ways(replace(RING, entry=5, directed=True)) == [(5, False)]
    assert ways(replace(RING, entry=5), RAKE) == [(5, False)]
    assert len(ways(replace(RING, directed=True))) == DUBINS_ENTRIES


def test_a_stop_is_entered_where_it_is() -> None:
    ways = traversals([Stroke("stop", array([[3, 4]]), dwell=2.5)], RAKE, _options(RAKE))
    assert len(ways) == 1
    assert ways[0].entry.tolist() == [3, 4, 0, 0, 0]
    assert (ways[0].length, ways[0].duration) == (0, 2.5)


def test_no_strokes_have_no_ways() -> None:
    assert len(traversals([], RAKE)) == 0
    assert ordering_problem(traversals([], RAKE), Cover(()), RAKE).nodes == 0
    assert len(connect(traversals([], RAKE), Cover((), start=(1.0, 1.0)), RAKE)) == 0


@settings(max_examples=60)
@given(covers(), st.sampled_from([RAKE, CAR, PLOTTER]), st.floats(0.1, 3.1), st.sampled_from([1e-3, 0.05, 0.5]))
def test_ways_are_as_long_as_what_is_driven(cover: Cover, robot: Robot, corner: float, tolerance: float) -> None:
    options = replace(_options(robot), page=PageOptions(tolerance=tolerance), connect=ConnectOptions(corner))
    ways = traversals(cover.strokes, robot, options)
    for row in range(len(ways)):
        way = ways[row]
        pieces = driven(cover.strokes[way.stroke], way.entry_vertex, way.reverse, robot, options)
        assert way.length == pytest.approx(pieces.total, rel=1e-9)
        assert pieces.start[0] == pytest.approx(way.entry[:2])
        assert math.sin((pieces.heading[0] - way.entry[3]) / 2) == pytest.approx(0, abs=1e-9)
        bend = pieces.curvature[-1] + pieces.sharpness[-1] * pieces.length[-1]
        last = pieces.heading[-1] + (pieces.curvature[-1] + bend) / 2 * pieces.length[-1]
        assert pieces.curvature[0] == pytest.approx(way.entry[4], abs=1e-9)
        assert bend == pytest.approx(way.exit[4], abs=1e-9)
        assert math.sin((last - way.exit[3]) / 2) == pytest.approx(0, abs=1e-9)
        turned = np.abs(pieces.turn).sum()
        expected = pieces.total / robot.mobility.work_speed + turned / robot.mobility.turn_rate
        assert way.duration == pytest.approx(expected, rel=1e-9)


def _tool_up(path: Path) -> float:
    return float(path.length[path.stroke < 0].sum())


def _picked(ways: Traversals, seed: int) -> list[int]:
    rng = np.random.default_rng(seed)
    strokes = rng.permutation(int(ways.stroke[-1]) + 1)
    return [int(rng.choice(np.flatnonzero(ways.stroke == stroke))) for stroke in strokes]


@settings(max_examples=40)
@given(covers(), st.sampled_from([RAKE, CAR, PLOTTER]), st.integers(0, 99))
def test_the_path_costs_what_the_problem_says(cover: Cover, robot: Robot, seed: int) -> None:
    options = _options(robot)
    # a car gets strokes that it can follow
    strokes = split_at_stops([replace(s, entry=None) for s in cover.strokes], robot, options)[0]
    cover = replace(cover, strokes=tuple(strokes if robot is CAR else cover.strokes))
    ways = traversals(cover.strokes, robot, options)
    problem = ordering_problem(ways, cover, robot, options)
    nodes = _picked(ways, seed)
    assert problem.faults(nodes) == []
    visits = ways.take(nodes)
    path = connect(visits, cover, robot, options)
    assert _tool_up(path) == pytest.approx(problem.cost_of(nodes), rel=1e-9, abs=1e-6)
    down = [path.length[path.stroke == k].sum() for k in visits.stroke]
    assert down == pytest.approx(visits.length.tolist(), rel=1e-9)
    assert (path.tool[path.stroke < 0] == RAISED).all()
    for row in np.flatnonzero((path.stroke >= 0) & (path.length > 0)):
        assert path.tool[row] == cover.strokes[path.stroke[row]].tool
    if cover.start is not None:
        assert path.start[0, :2] == pytest.approx(cover.start)
    reached = ends(path)
    assert np.abs(reached.position[:-1] - path.start[1:]).max(initial=0) < 1e-8
    if robot is not PLOTTER:
        assert np.abs(np.sin((reached.heading[:-1] - path.heading[1:]) / 2)).max(initial=0) < 1e-8
    report = verify(Plan(Drawing("d", ()), robot, options, cover=cover, visits=visits, path=path))
    failed = {check.name for check in report.checks if check.verdict is Verdict.FAILED}
    assert not failed & {"gaps", "headings", "curvature", "precedence", "visits", "tool"}


def test_costs_are_straight_lines_or_dubins_paths() -> None:
    cover = Cover((OPEN, Stroke("more", array([[6, 1], [7, 1]]))), start=(0.0, -1.0))
    for robot in (RAKE, CAR):
        options = _options(robot)
        ways = traversals(cover.strokes, robot, options)
        problem = ordering_problem(ways, cover, robot, options)
        cost = problem.costs.pairs(np.array([0]), np.array([2]))[0]
        if robot is RAKE:
            assert cost == pytest.approx(math.hypot(2, 4))
            assert problem.start_costs[0] == 1
        else:
            expected = dubins_path(array([4, 5, math.pi / 2]), array([6, 1, 0]), 0.5).length
            assert cost == pytest.approx(expected)
            assert problem.start_costs[0] >= 1


def test_options_name_the_start_before_the_drawing() -> None:
    cover = Cover((OPEN,), start=(0.0, -1.0))
    options = _options(RAKE, start=(0.0, -7.0))
    ways = traversals(cover.strokes, RAKE, options)
    assert ordering_problem(ways, cover, RAKE, options).start_costs[0] == 7
    assert connect(ways.take([0]), cover, RAKE, options).start[0].tolist() == [0, -7, 0]
    free = ordering_problem(ways, Cover((OPEN,)), RAKE, _options(RAKE))
    assert (free.start_costs == 0).all()
    assert (free.end_costs == 0).all()


def test_start_headings_are_the_best_that_were_tried() -> None:
    entries = np.zeros((50, 5))
    entries[:, [0, 1, 3]] = np.random.default_rng(4).uniform(-3, 3, (50, 3))
    headings, lengths = start_states((0.2, 0.1), None, entries, Family("dubins", 0.7))
    for heading, length, entry in zip(headings, lengths, entries[:, [0, 1, 3]], strict=True):
        assert dubins_path(array([0.2, 0.1, heading]), entry, 0.7).length == pytest.approx(length)
        for other in np.arange(36) * math.tau / 36:
            assert length <= dubins_path(array([0.2, 0.1, other]), entry, 0.7).length + 1e-9


def test_metrics_suit_the_robot() -> None:
    assert metric_of(RAKE, Options()) == "euclid"
    assert metric_of(PLOTTER, Options()) == "euclid"
    assert metric_of(CAR, Options()) == "dubins"
    cover = Cover((OPEN,))
    dubins = Options(order=OrderOptions(metric="dubins"))
    with pytest.raises(InputError, match="follows any curve; expected 'euclid'"):
        ordering_problem(traversals(cover.strokes, PLOTTER, dubins), cover, PLOTTER, dubins)
    with pytest.raises(InputError, match="expected 'dubins'"):
        traversals(cover.strokes, CAR, Options(order=OrderOptions(metric="euclid")))


def test_every_stop_is_driven() -> None:
    strokes = (Stroke("a", array([[0, 0]]), dwell=2.0), Stroke("b", array([[1, 0]])), Stroke("c", array([[3, 0]])))
    cover = Cover(strokes)
    path = connect(traversals(strokes, PLOTTER), cover, PLOTTER)
    assert path.stroke.tolist() == [0, -1, 1, -1, 2]
    assert path.dwell.tolist() == [2, 0, 0, 0, 0]
    assert path.length.sum() == 3


def test_the_tool_is_up_while_the_robot_turns_sharply() -> None:
    stroke = Stroke("box", box(0, 0, 2, 2), closed=True)
    path = connect(traversals([stroke], RAKE).take([0]), Cover((stroke,)), RAKE)
    assert path.turn[path.length == 0] == pytest.approx([math.pi / 2] * 3)
    assert (path.tool[path.length == 0] == RAISED).all()
    plotted = connect(traversals([stroke], PLOTTER).take([0]), Cover((stroke,)), PLOTTER)
    assert (plotted.length > 0).all()
    assert (plotted.tool == 1).all()
