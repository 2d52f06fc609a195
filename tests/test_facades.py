"""Facades from the job to the judge's report, their exports and pictures."""

from __future__ import annotations

import csv
import io
import itertools
import json
import math
from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest

import optplan as op
from optplan.connectors.wall_travel import Travel
from optplan.domain.errors import InputError, LimitError
from optplan.domain.facade import Facade, Wall
from optplan.domain.options import ConnectOptions, Options, OrderOptions, TimeOptions
from optplan.domain.result import Plan
from optplan.domain.robot import Boom
from optplan.domain.washing import WashOptions
from optplan.exports.stops import stop_rows
from optplan.geometry.paths import ends
from optplan.geometry.walls import normals, places, reach_radius, unrolled
from optplan.problem import problem_of
from tests.facades import JOBS, WINDOW, corner, flat, planned, round_wall
from tests.strategies import array

BOOM = op.load_robot("boom-washer")


def failed(plan: Plan) -> list[str]:
    assert plan.report is not None
    return [f"{check.name}: {check.detail}" for check in plan.report.checks if check.verdict.value == "failed"]


@pytest.mark.parametrize("kind", JOBS)
@pytest.mark.parametrize("travel", ["straight", "around", "lift"])
@pytest.mark.parametrize("metric", ["euclid", "time"])
def test_every_wall_is_planned_and_verified(kind: str, travel: str, metric: str) -> None:
    plan = planned(JOBS[kind], metric, fewest="minimal", pattern="hexagon", travel=travel)
    assert failed(plan) == []
    assert plan.path is not None
    assert plan.cover is not None
    assert plan.trajectory is not None
    assert plan.ordering is not None
    assert sorted(plan.path.stroke[plan.path.stroke >= 0].tolist()) == list(range(len(plan.cover.strokes)))
    if metric == "time":
        moving = plan.trajectory.duration - plan.path.dwell.sum()
        assert moving == pytest.approx(plan.ordering.cost, rel=1e-9)
    else:
        assert plan.path.length.sum() == pytest.approx(plan.ordering.cost, rel=1e-9)


@pytest.mark.parametrize("wash", [{"rule": "rows"}, {"direction": "down"}, {"rule": "none"}, {"tolerance": 0.15},
                                  {"horizontal": 3.0}, {"pattern": "square"}, {"fewest": "pattern"},
                                  {"tau": 0.3, "width": 3.0}])  # fmt: skip
def test_settings_are_kept(wash: dict[str, object]) -> None:
    plan = planned(flat(), "auto", 2.0, "search", **{"fewest": "minimal", "pattern": "hexagon", **wash})
    assert failed(plan) == []
    assert plan.cover is not None
    assert plan.visits is not None
    heights = np.array([stroke.points[0, 2] for stroke in plan.cover.strokes])[plan.visits.stroke]
    if wash.get("rule") == "rows":
        assert (np.diff(heights) > -0.2).all()
    if wash.get("direction") == "down":
        assert heights[0] > heights[-1]
    elif wash.get("rule") != "none":
        assert heights[0] < heights[-1]
    if wash.get("rule") == "none":
        assert plan.cover.precedence == ()


def test_more_weight_on_horizontal_metres_moves_less_across() -> None:
    across = []
    for weight in (1.0, 10.0):
        plan = planned(flat(windows=False), fewest="minimal", pattern="square", rule="none", horizontal=weight)
        assert plan.path is not None
        steps = ends(plan.path).position - plan.path.start
        across.append(float(np.hypot(steps[:, 0], steps[:, 1]).sum()))
    assert across[1] < across[0] + 1e-9


def test_tolerance_asks_for_more_stops_and_stands_the_worst() -> None:
    job = flat()
    plain, safe = (planned(job, pattern="hexagon", tolerance=t) for t in (0.0, 0.2))
    assert plain.cover is not None
    assert safe.cover is not None
    assert len(safe.cover.strokes) > len(plain.cover.strokes)
    moved = []
    for k, stroke in enumerate(safe.cover.strokes):
        angle = 2.4 * k
        off = 0.1999 * np.array([math.cos(angle), 0.0, math.sin(angle)])
        moved.append(replace(stroke, points=stroke.points + off))
    shaken = replace(safe, cover=replace(safe.cover, strokes=tuple(moved)), options=Options())
    report = op.verify(shaken)
    assert next(check for check in report.checks if check.name == "coverage").verdict.value == "passed"


def _spoilt(plan: Plan, **changes: object) -> list[str]:
    report = op.verify(replace(plan, **changes))  # type: ignore[arg-type]
    return [check.name for check in report.checks if check.verdict.value == "failed"]


@pytest.fixture(scope="module")
def good() -> Plan:
    plan = planned(flat(), fewest="minimal", pattern="hexagon")
    assert failed(plan) == []
    return plan


def test_judge_misses_a_stop(good: Plan) -> None:
    path, cover = good.path, good.cover
    assert path is not None
    assert cover is not None
    row = int(np.flatnonzero(path.stroke == 4)[0])
    columns = {name: np.delete(getattr(path, name), row, axis=0) for name in
               ("start", "heading", "elevation", "curvature", "sharpness", "length", "turn", "dwell", "tool", "stroke",
                "gear")}  # fmt: skip
    assert "strokes" in _spoilt(good, path=type(path)(**columns), trajectory=None)


def test_judge_hears_of_the_water(good: Plan) -> None:
    """The order turned round, with everything else right for it."""
    assert good.visits is not None
    assert good.ordering is not None
    turned = good.visits.take(np.arange(len(good.visits))[::-1])
    from optplan.pipeline import plan_from

    made = plan_from(replace(good, visits=turned), "connect")
    assert made.report is not None
    bad = {check.name: check for check in made.report.checks if check.verdict.value == "failed"}
    assert set(bad) == {"order"}
    assert "is visited before" in bad["order"].detail


def test_judge_works_out_the_rule_itself(good: Plan) -> None:
    """Rules that the planner forgot are asked for all the same."""
    from optplan.pipeline import plan_from

    assert good.cover is not None
    assert good.visits is not None
    turned = good.visits.take(np.arange(len(good.visits))[::-1])
    made = plan_from(replace(good, visits=turned, cover=replace(good.cover, precedence=())), "connect")
    assert made.report is not None
    assert "order" in [check.name for check in made.report.checks if check.verdict.value == "failed"]


def test_judge_sees_bare_wall(good: Plan) -> None:
    assert good.cover is not None
    small = replace(good.cover, radii=tuple(0.97 * r for r in good.cover.radii))
    assert "coverage" in _spoilt(good, cover=small)
    large = replace(good.cover, radii=tuple(1.2 * r for r in good.cover.radii))
    assert "reach" in _spoilt(good, cover=large)
    assert "coverage" in _spoilt(good, options=replace(good.options, wash=replace(good.options.wash, tolerance=0.3)))


def test_judge_measures_pose_and_speed(good: Plan) -> None:
    assert good.cover is not None
    assert good.trajectory is not None
    assert isinstance(good.robot.mobility, Boom)
    nearer = replace(good.robot, mobility=replace(good.robot.mobility, standoff=0.5))
    assert "stand-off" in _spoilt(good, robot=nearer)
    slow = replace(good.robot, mobility=replace(good.robot.mobility, speeds=(0.1, 0.1, 0.1)))
    assert "axis speed" in _spoilt(good, robot=slow)
    lame = replace(good.robot, mobility=replace(good.robot.mobility, acceleration=0.01))
    assert "axis acceleration" in _spoilt(good, robot=lame)
    hasty = replace(good.trajectory, t=good.trajectory.t * 0.9)
    assert "time" in _spoilt(good, trajectory=hasty)


def test_judge_asks_for_the_time_that_washing_takes(good: Plan) -> None:
    """Stops of no time at all, everywhere: in the path, in the strokes, and in the timetable made for them."""
    from optplan.pipeline import plan_from

    assert good.path is not None
    assert good.cover is not None
    assert good.trajectory is not None
    cover = replace(good.cover, strokes=tuple(replace(s, dwell=0.0) for s in good.cover.strokes))
    hasty = replace(good, path=replace(good.path, dwell=0 * good.path.dwell), trajectory=None, cover=cover)
    report = plan_from(hasty, "time").report
    assert report is not None
    check = next(check for check in report.checks if check.name == "dwell")
    assert (check.verdict.value, check.value) == ("failed", 20.0)
    longer = tuple(replace(s, dwell=25.0) if k == 3 else s for k, s in enumerate(good.cover.strokes))
    assert "dwell" in _spoilt(good, cover=replace(good.cover, strokes=longer))
    # a timetable that stands only half as long as the path says
    pause = np.append(0.0, np.diff(good.trajectory.t) * np.where(np.diff(good.trajectory.s) > 0, 1.0, 0.5))
    assert "time" in _spoilt(good, trajectory=replace(good.trajectory, t=np.cumsum(pause)))


def test_judge_takes_circles_no_larger_than_the_arm_reaches(good: Plan) -> None:
    """A plan that does not say how large they are: what a shorter arm washes decides."""
    assert good.cover is not None
    unsaid = replace(good, cover=replace(good.cover, radii=()))
    assert _spoilt(unsaid) == []
    assert isinstance(good.robot.mobility, Boom)
    short = replace(good.robot, mobility=replace(good.robot.mobility, reach=1.15))
    assert "coverage" in _spoilt(unsaid, robot=short)


def test_judge_checks_what_the_solver_claims(good: Plan) -> None:
    assert good.ordering is not None
    assert "cost" in _spoilt(good, ordering=replace(good.ordering, cost=good.ordering.cost * 1.01))


def test_judge_sees_moves_over_windows() -> None:
    """Two stops beside a window: straight over it is 1.6 m, around it none."""
    outline = array([[0, 0], [5, 0], [5, 4.5], [0, 4.5]])
    job = Facade("w", (Wall("wall", outline, (WINDOW,), array([[1.0, 2.0], [4.0, 2.0]])),))
    plan = planned(job, rule="none")
    assert plan.report is not None
    over = {check.name: check for check in plan.report.checks}["no-go"]
    assert over.value == pytest.approx(1.6)
    assert over.verdict.value == "noted"
    for travel in ("around", "lift"):
        asked = replace(plan.options, wash=replace(plan.options.wash, travel=travel))
        assert "no-go" in _spoilt(plan, options=asked)
        assert "no-go" not in _spoilt(planned(job, rule="none", travel=travel))


@pytest.mark.parametrize("kind", JOBS)
def test_unrolling_is_the_way_back(kind: str) -> None:
    for wall in JOBS[kind].walls:
        random = np.random.default_rng(0)
        low, high = wall.outline.min(axis=0) - 0.5, wall.outline.max(axis=0) + 0.5
        points = random.uniform(low, high, (200, 2))
        facing = normals(wall, points[:, 0])
        assert np.allclose(np.linalg.norm(facing, axis=1), 1)
        for away in (0.0, 0.75):
            feet = places(wall, points, away)
            assert np.allclose(unrolled(wall, feet, facing, away), points, atol=1e-9)
            assert np.allclose(feet - places(wall, points), away * facing)


@pytest.mark.parametrize("hollow", [False, True])
def test_circles_on_round_walls_are_within_reach(hollow: bool) -> None:
    """Points of the circle, rolled up, against the arm's sphere; and hardly a larger one would do."""
    wall = round_wall(hollow=hollow)
    radius = reach_radius(wall, 1.25, 0.75)
    far = []
    for size in (radius, 1.01 * radius):
        worst = 0.0
        for x in np.linspace(size, 9.4 - size, 60):
            angle, share = np.linspace(0, 2 * math.pi, 181)[:, None], np.linspace(0, 1, 15)
            disc = np.stack([x + size * share * np.cos(angle), 1.5 + size * share * np.sin(angle)], axis=-1).reshape(
                -1, 2
            )
            foot = places(wall, array([[x, 1.5]]), 0.75)
            worst = max(worst, float(np.linalg.norm(places(wall, disc) - foot, axis=1).max()))
        far.append(worst)
    assert far[0] <= 1.25 + 1e-9
    assert far[1] > 1.25 or hollow
    assert radius < 1 or hollow


def test_costs_are_those_of_the_moves() -> None:
    """The matrix against moves measured one by one, and detours against straight lines."""
    for travel in ("straight", "around", "lift"):
        for metric in ("euclid", "time"):
            job = corner()
            options = Options(order=OrderOptions(metric=metric),
                              wash=WashOptions(fewest="minimal", pattern="hexagon", travel=travel))  # fmt: skip
            made = op.cover(job, BOOM, options)
            travelled = Travel(job, made, BOOM, options)
            _, problem = problem_of(job, made, BOOM, options)
            count = len(made.strokes)
            random = np.random.default_rng(0)
            for i, j in random.integers(0, count, (60, 2)).tolist():
                way = travelled.waypoints(i, j)
                assert way is not None
                assert np.allclose(way[[0, -1]], travelled.feet[[i, j]])
                cost = float(problem.costs.pairs(np.array([i]), np.array([j]))[0])
                assert cost == pytest.approx(travelled.cost(i, j), rel=1e-12, abs=1e-12)
                if metric == "euclid":
                    direct = float(np.linalg.norm(travelled.feet[i] - travelled.feet[j]))
                    assert cost == pytest.approx(float(np.linalg.norm(np.diff(way, axis=0), axis=1).sum()))
                    assert cost >= direct - 1e-9


def test_ways_around_are_shortest() -> None:
    """Against a fine grid search around one window."""
    job = Facade(
        "w", (Wall("wall", array([[0, 0], [10, 0], [10, 10], [0, 10]]), (WINDOW + 2,), array([[2, 4], [8, 4]])),)
    )
    options = Options(wash=WashOptions(travel="around", rule="none"))
    made = op.cover(job, BOOM, options)
    travel = Travel(job, made, BOOM, options)
    # the window is from (3.6, 3.2) to (5.2, 5.2): over its upper or its lower corners
    below = math.dist((2, 4), (3.6, 3.2)) + 1.6 + math.dist((5.2, 3.2), (8, 4))
    above = math.dist((2, 4), (3.6, 5.2)) + 1.6 + math.dist((5.2, 5.2), (8, 4))
    assert travel.cost(0, 1) == pytest.approx(min(below, above), abs=1e-6)


def test_from_wall_to_wall_goes_around_the_building() -> None:
    job = corner()
    made = op.cover(job, BOOM, Options(wash=WashOptions(fewest="minimal")))
    travel = Travel(job, made, BOOM, Options())
    front = int(np.argmin([s.points[0, 0] if s.element == "front" else 99 for s in made.strokes]))
    side = int(np.argmax([s.points[0, 1] if s.element == "side" else -99 for s in made.strokes]))
    way = travel.waypoints(front, side)
    assert way is not None
    a, b = travel.feet[front], travel.feet[side]
    turn = np.array([4.75, -0.75])  # the corner of the building and its stand-off
    flat_way = np.linalg.norm(a[:2] - turn) + np.linalg.norm(turn - b[:2])
    assert travel.cost(front, side) == pytest.approx(math.hypot(flat_way, b[2] - a[2]), abs=1e-5)


def test_walls_that_face_inwards_are_found() -> None:
    job = corner()
    front = job.walls[0]
    wrong = replace(job, walls=(replace(front, origin=array([4, 0, 0]), across=array([-1, 0, 0])), job.walls[1]))
    with pytest.raises(InputError, match="faces into the building"):
        planned(wrong)


def test_start_of_the_robot() -> None:
    job = flat(windows=False)
    options = Options(order=OrderOptions("search", iterations=200, start=(5.0, 0.0)))
    plan = op.plan(job, BOOM, options)
    assert failed(plan) == []
    assert plan.path is not None
    assert plan.path.start[0] == pytest.approx([5.0, -0.75, 0.0])


def test_given_stops_that_leave_something_bare_are_told() -> None:
    """As published, the circles of case 1 leave 7.7 cm2; those of case 2 leave nothing."""
    for name, words in (("case1", "132 stops as they are given leave 7.7 cm2 unwashed, most of it near (10.8, 19.5)"),
                        ("case2", "111 stops as they are given")):  # fmt: skip
        made = op.cover(op.read(op.instance(f"washing/{name}")), BOOM)
        assert [note.text for note in made.notes] == [words]


@pytest.mark.parametrize(("start", "words"), [((3.0, -5.0), "5 m below the ground"), ((3000.0, 1.0), "beside the wall"),
                                              ((3.0, 300.0), "beside the wall")])  # fmt: skip
def test_a_start_that_is_nowhere_is_refused(start: tuple[float, float], words: str) -> None:
    with pytest.raises(InputError, match=f"--start: .*{words}"):
        op.plan(flat(), BOOM, Options(order=OrderOptions(start=start), wash=WashOptions(fewest="pattern")))


def test_a_list_of_no_stops_is_refused() -> None:
    with pytest.raises(InputError, match="stops is an empty list"):
        Wall("wall", flat().walls[0].outline, stops=np.zeros(0))


def test_published_solvers_order_a_facade() -> None:
    """The five of the literature by name; blind ones may find nothing legal, which is said."""
    job = flat()
    best = planned(job, solver="dp", seconds=60.0, fewest="minimal", pattern="hexagon")
    assert best.ordering is not None
    assert best.ordering.status == "optimal"
    for solver in ("nn", "nn-feasible", "2opt", "ga", "ga-feasible", "mtz", "rows", "rows-split", "beam"):
        plan = planned(job, solver=solver, fewest="minimal", pattern="hexagon")
        assert plan.ordering is not None
        if math.isfinite(plan.ordering.cost):
            assert plan.ordering.cost >= best.ordering.cost - 1e-6
            assert failed(plan) == []
        else:
            assert solver in ("nn", "2opt", "ga")


def test_plan_files_come_back(tmp_path: Path, good: Plan) -> None:
    op.save_plan(good, tmp_path / "plan.json")
    again = op.load_plan(tmp_path / "plan.json")
    assert op.verify(again) == good.report
    assert again.cover is not None
    assert good.cover is not None
    assert again.cover.radii == good.cover.radii


def test_exports(good: Plan, tmp_path: Path) -> None:
    rows = stop_rows(good)
    assert good.cover is not None
    assert good.trajectory is not None
    assert good.visits is not None
    assert [row["stop"] for row in rows] == [good.cover.strokes[k].id for k in good.visits.stroke.tolist()]
    assert rows[0]["arrive"] == 0.0
    assert rows[-1]["leave"] == pytest.approx(good.trajectory.duration)
    for one, two in itertools.pairwise(rows):
        assert two["arrive"] - one["leave"] > 0
        away = math.dist((one["x"], one["y"], one["z"]), (two["x"], two["y"], two["z"]))
        assert two["move"] == pytest.approx(away)
    assert sum(row["water"] for row in rows) == pytest.approx(0.1 * 20 * len(rows))
    for name in ("stops", "stops-json", "csv", "tsplib"):
        op.export_plan(good, name, tmp_path / name)
    read = list(csv.DictReader(io.StringIO((tmp_path / "stops").read_text())))
    assert [row["stop"] for row in read] == [row["stop"] for row in rows]
    assert len(json.loads((tmp_path / "stops-json").read_text())["stops"]) == len(rows)


def test_exports_switch_the_water(good: Plan, tmp_path: Path) -> None:
    """On while the lift stands before the wall, off on its way; the time table has the same seconds."""
    stops = stop_rows(good)
    for name in ("tool", "schedule"):
        op.export_plan(good, name, tmp_path / name)
    commands = list(csv.DictReader(io.StringIO((tmp_path / "tool").read_text())))
    assert [row["tool"] for row in commands] == ["wash", "off"] * len(stops)
    times = [float(row["t"]) for row in commands]
    assert times[0::2] == pytest.approx([row["arrive"] for row in stops], abs=1e-5)
    assert times[1::2] == pytest.approx([row["leave"] for row in stops], abs=1e-5)
    table = list(csv.DictReader(io.StringIO((tmp_path / "schedule").read_text())))
    washed = [row for row in table if row["what"] == "stop"]
    assert [float(row["begin"]) for row in washed] == pytest.approx([row["arrive"] for row in stops], abs=1e-3)
    assert [float(row["end"]) for row in washed] == pytest.approx([row["leave"] for row in stops], abs=1e-3)
    assert {row["direction"] for row in table} == {""}
    with pytest.raises(InputError, match="leaves the plane"):
        op.export_plan(good, "txt", tmp_path / "txt")
    assert not (tmp_path / "txt").exists()


@pytest.mark.parametrize("kind", ["flat", "corner", "round"])
def test_pictures_and_films(kind: str, tmp_path: Path) -> None:
    plan = planned(JOBS[kind], fewest="minimal", pattern="hexagon", travel="lift")
    op.draw(plan, tmp_path / "flat.png")
    op.draw(plan, tmp_path / "space.png", in_space=True)
    op.draw(replace(plan, path=None, trajectory=None, visits=None, ordering=None), tmp_path / "cover.svg")
    op.animate(plan, tmp_path / "film.gif", seconds=1.0, fps=4, size=3)
    op.animate(plan, tmp_path / "film.json", seconds=1.0, fps=10)
    frames = json.loads((tmp_path / "film.json").read_text())["frames"]
    assert plan.trajectory is not None
    assert frames[-1]["t"] == pytest.approx(plan.trajectory.duration, abs=1e-2)
    assert (tmp_path / "flat.png").stat().st_size > 5000


def test_water_is_told_once(good: Plan, tmp_path: Path) -> None:
    """As what the robot uses up; robot files that say it in their mobility are read."""
    assert good.report is not None
    assert good.path is not None
    figures = {name: value for name, value, _ in good.report.figures}
    assert figures["water"] == pytest.approx(0.1 * 20 * (good.path.stroke >= 0).sum())
    assert sum(row["water"] for row in stop_rows(good)) == pytest.approx(figures["water"])
    assert "supplies" in [check.name for check in good.report.checks]
    file = tmp_path / "boom.toml"
    text = """version = "1.5"
name = "b"
tool.settings = [{name = "off", width = 0}, {name = "wash", width = 2}]
[mobility]
kind = "boom"
speeds = [1, 1, 1]
acceleration = 1
reach = 2
dwell = 3
flow = 0.2
"""
    file.write_text(text)
    robot = op.load_robot(str(file))
    assert robot.supplies is not None
    assert robot.supplies.flow == pytest.approx(0.0002)
    file.write_text(text + '[supplies]\nname = "water"\nflow = "1 L/min"\n')
    with pytest.raises(InputError, match="the flow is here and in mobility"):
        op.load_robot(str(file))


def test_the_way_stays_on_top_of_what_is_washed_later(good: Plan) -> None:
    from optplan.plot.facade_film import WASHED, facade_stage

    assert isinstance(good.job, Facade)
    assert good.trajectory is not None
    stage = facade_stage(good, good.job, np.linspace(0, good.trajectory.duration, 40), 300, "film")
    for moment in range(0, len(stage.motion), 7):
        stage.frame(moment)
    stage.frame(len(stage.motion) - 1)
    standing = stage.motion.tool > 0
    moved = np.hypot(np.diff(stage.motion.x), np.diff(stage.motion.y)) > 0.2
    between = np.flatnonzero(moved & ~standing[1:])
    places = stage.ground.pixels(np.column_stack([stage.motion.x, stage.motion.y])[between])
    red = tuple(int(WASHED.travel[k : k + 2], 16) for k in (1, 3, 5))
    assert len(places) > 10
    assert all(stage.sheet.getpixel((round(float(x)), round(float(y)))) == red for x, y in places)


@pytest.mark.parametrize("kind", ["flat", "corner"])
def test_the_building_fills_its_picture(kind: str, tmp_path: Path) -> None:
    from PIL import Image

    op.draw(planned(JOBS[kind], fewest="minimal", pattern="hexagon"), tmp_path / "a.png", in_space=True)
    dark = np.array(Image.open(tmp_path / "a.png").convert("L")) < 250
    rows, columns = np.flatnonzero(dark.any(axis=1)), np.flatnonzero(dark.any(axis=0))
    assert np.ptp(rows) > 0.8 * dark.shape[0]
    assert np.ptp(columns) > 0.8 * dark.shape[1]


def test_one_step_for_all_axes() -> None:
    from optplan.plot.building import _step

    assert [_step(x) for x in (0.13, 0.2, 0.21, 1.4, 4.0, 30.0)] == pytest.approx([0.2, 0.2, 0.5, 2, 5, 50])


BAD = {
    "larger than the facade": (flat(), {}, 50.0, "more than the wall"),
    "beyond the reach": (flat(), {}, 1.5, "reaches"),
    "too small": (flat(), {}, 0.001, "too small"),
    "tolerance eats the circle": (flat(), {"tolerance": 1.0}, None, "tolerance"),
    "a rule that contradicts itself": (flat(), {"tau": 0.0}, None, "contradicts itself"),
    "another one": (flat(), {"tau": -1.0}, None, "contradicts itself"),
}


@pytest.mark.parametrize("name", BAD)
def test_bad_input_is_one_clear_error(name: str) -> None:
    job, wash, radius, words = BAD[name]
    with pytest.raises(InputError, match=words):
        planned(replace(job, radius=radius), **wash)  # type: ignore[arg-type]


def test_windows_that_leave_nothing() -> None:
    outline = flat().walls[0].outline
    with pytest.raises(InputError, match="nothing to wash"):
        planned(Facade("f", (Wall("wall", outline, (outline,)),)))


def test_what_a_boom_has_not_is_refused() -> None:
    job = flat()
    with pytest.raises(InputError, match="boom"):
        op.plan(job, "beach-rake")
    for options, words in (
        (Options(order=OrderOptions(metric="dubins")), "radius|boom"),
        (Options(order=OrderOptions(avoid=1.0)), "facade"),
        (Options(connect=ConnectOptions(keep_out=(((0, 0), (1, 0), (1, 1)),))), "facade"),
        (Options(time=TimeOptions(jerk=1.0)), "jerk"),
    ):
        with pytest.raises(InputError, match=words):
            op.plan(job, BOOM, replace(options, wash=WashOptions(fewest="pattern")))
    drawing = op.read(op.instance("drawings/lion"))
    with pytest.raises(InputError, match="time"):
        op.plan(drawing, "pen-plotter", Options(order=OrderOptions(metric="time")))


def test_limits_are_limit_errors() -> None:
    with pytest.raises(LimitError):
        planned(replace(flat(), radius=0.001))
    many = np.column_stack([np.cos(np.linspace(0, 6, 4000)), np.sin(np.linspace(0, 6, 4000))])
    with pytest.raises(InputError, match="at most"):
        Wall("w", many)


def test_start_counts_in_the_costs_of_the_wall_it_leads_to() -> None:
    """The start lies before the first wall; the first stop may be on another one."""
    job = corner()
    for metric in ("euclid", "time"):
        order = OrderOptions("search", metric, iterations=200, start=(4.7, 0.0))
        plan = op.plan(job, BOOM, Options(order=order, wash=WashOptions(fewest="minimal", rule="none")))
        assert failed(plan) == []
        assert plan.path is not None
        assert plan.path.start[0] == pytest.approx([4.7, -0.75, 0.0])


def test_what_facades_do_not_do_is_said(good: Plan) -> None:
    with pytest.raises(InputError, match="not resumed"):
        op.resumed(good, 3, good.options)
    with pytest.raises(InputError, match="facades only"):
        op.draw(op.plan(op.read('<svg xmlns="http://www.w3.org/2000/svg"><path d="M0 0H9" stroke="black"/></svg>')),
                "never.png", in_space=True)  # fmt: skip


def test_command_line(tmp_path: Path, capsys: pytest.CaptureFixture[str], monkeypatch: pytest.MonkeyPatch) -> None:
    from optplan.cli import main

    monkeypatch.chdir(tmp_path)

    def run(*words: str) -> int:
        monkeypatch.setattr("sys.argv", ["optplan", *words])
        with pytest.raises(SystemExit) as end:
            main()
        return int(end.value.code or 0)

    svg = '<svg xmlns="http://www.w3.org/2000/svg" viewBox="0 0 60 40"><path d="M0 0H50V40H0Z"/>{}</svg>'
    Path("wall.svg").write_text(svg.format('<rect x="20" y="10" width="15" height="15"/>'))
    flags = ["--as", "facade", "--unit", "10cm", "--fewest", "minimal", "--iterations", "100", "-q"]
    assert run("plan", "wall.svg", *flags, "-e", "stops") == 0
    names = {file.name for file in Path("wall-plan").iterdir()}
    assert names == {"plan.json", "picture.png", "picture.svg", "building.png", "plan.stops.csv"}
    assert "planned and verified" in capsys.readouterr().out
    assert run("check", "wall-plan/plan.json") == 0
    assert run("show", "wall-plan/plan.json", "--3d", "-o", "space.png") == 0
    for other in ("--animate", "--convergence"):
        assert run("show", "wall-plan/plan.json", "--3d", other, "-o", "other.png") == 2
        assert f"one of --3d and {other}" in capsys.readouterr().err
    assert run("plan", "wall.svg", *flags, "--travel", "lift", "--lift", "0", "-o", "other") == 2
    assert capsys.readouterr().err.startswith("error: --lift: ")
    assert run("plan", "wall.svg", *flags, "--placement", "-1", "-o", "other") == 2
    assert capsys.readouterr().err.startswith("error: --placement: ")
    Path("case.json").write_text(op.instance("washing/case1").read_text())
    assert run("order", "case.json") == 2
    assert "is a job, of which there is no plan yet" in capsys.readouterr().err
    assert run("order", "wall-plan/plan.json", "--metric", "time", "-o", "timed.json", "--iterations", "50", "-q") == 0
    assert " s between strokes" in capsys.readouterr().out
    assert run("plan", "wall.svg", *flags, "-o", "wall-plan") == 2
    Path("wall.svg").write_text(svg.format('<rect x="40" y="10" width="15" height="15"/>'))
    assert run("plan", "wall.svg", *flags, "-o", "other") == 2
    assert "crosses the outline" in capsys.readouterr().err
    assert not Path("other").exists()
    # what is found out while covering names the file, too
    Path("small.json").write_text(json.dumps({"version": "1.5", "kind": "facade", "name": "s", "radius": 9,
                                              "outline": [[0, 0], [1, 0], [1, 1], [0, 1]]}))  # fmt: skip
    assert run("plan", "small.json", "-q", "-o", "other") == 2
    assert capsys.readouterr().err.startswith("error: small.json: wall 'wall': a circle radius of 9 m is more than")
    case = json.loads(op.instance("washing/case1").read_text())
    case["circles"] = case["circles"][:-3]
    Path("case.json").write_text(json.dumps(case))
    assert run("plan", "case.json", "--iterations", "10", "-q", "-o", "case") == 1
    assert "A CHECK FAILED" in capsys.readouterr().out
