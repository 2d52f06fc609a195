"""Films of plans, looked at frame by frame."""

from __future__ import annotations

import io
import json
import math
import os
import stat
import sys
import time
from dataclasses import replace
from itertools import pairwise
from pathlib import Path

import numpy as np
import pytest
from PIL import Image, ImageColor

import optplan as op
from optplan.domain.result import Plan
from optplan.plot.films import gif_bytes
from optplan.plot.scene import SAND, Ground, ground_of
from optplan.plot.stage import HEAD
from optplan.timing.motion import motion
from tests.simulation.plans import BEND, CORNERS, LINE, QUARTER, plan_of


def frames_of(file: Path) -> list[np.ndarray]:
    with Image.open(file) as film:
        made = []
        for k in range(getattr(film, "n_frames", 1)):
            film.seek(k)
            made.append(np.asarray(film.convert("RGB")).astype(int))
        return made


def near(picture: np.ndarray, colour: str, most: int = 12) -> np.ndarray:
    """Where a picture has a colour, about."""
    return np.asarray((np.abs(picture - np.array(ImageColor.getrgb(colour)[:3])) <= most).all(axis=-1))


@pytest.fixture(scope="module")
def film(tmp_path_factory: pytest.TempPathFactory) -> list[np.ndarray]:
    folder = tmp_path_factory.mktemp("film") / "corners"
    op.animate(plan_of(CORNERS), folder, seconds=4, fps=10, size=5)
    return [frames_of(file)[0] for file in sorted(folder.iterdir())]


def test_length_and_size(tmp_path: Path) -> None:
    file = tmp_path / "film.gif"
    op.animate(plan_of(CORNERS), file, seconds=2.5, fps=12, size=4, dpi=60)
    with Image.open(file) as made:
        count = getattr(made, "n_frames", 1)
        assert 25 <= count <= 31  # frames that look the same are one
        assert 240 <= max(made.width, made.height - HEAD) <= 244
        waits = []
        for k in range(count):
            made.seek(k)
            waits.append(made.info["duration"])
    assert sum(waits) == pytest.approx(31 / 12 * 1000 + 1500, abs=10)
    assert waits[-1] >= 1500


def test_marks_grow_and_stay(film: list[np.ndarray]) -> None:
    marked = [near(frame, SAND.work) for frame in film]
    sizes = [int(mark.sum()) for mark in marked]
    assert sizes[0] == 0
    assert sizes[-1] > 2000
    for before, after in pairwise(sizes):
        assert after >= before - 600  # the robot covers some


def ground() -> Ground:
    """Where the film of the corners lies: its path, and nothing else, 400 pixels wide or high."""
    ends = np.array(
        [[0.0, 0.0], [2.0, 0.0], [2.0, 1.5], [2 + 2 * math.cos(QUARTER - 2), 1.5 + 2 * math.sin(QUARTER - 2)]]
    )
    return ground_of(ends, None, 400)


def test_marks_have_their_true_widths(film: list[np.ndarray]) -> None:
    assert film[-1].shape == (ground().height + HEAD, ground().width, 3)
    scale = ground().scale / 2
    # a cut through the second line, drawn with 3 pins: x = 2, y from 0 to 1.5
    x, y = ground().pixels(np.array([[2.0, 0.35]]))[0] / 2
    row = near(film[-1][int(y) + HEAD], SAND.work)
    assert row[int(x)]
    assert row.sum() / scale == pytest.approx(0.16, abs=0.025)


def test_the_robot_is_where_it_should_be(film: list[np.ndarray]) -> None:
    plan = plan_of(CORNERS)
    assert plan.trajectory is not None
    moved = motion(plan.trajectory, plan.robot, np.linspace(0, plan.trajectory.duration, len(film)))
    red = np.array([near(frame[HEAD:], SAND.front) for frame in film])
    for k in range(len(film)):
        rows, columns = np.nonzero(red[k])
        nose = np.array([columns.mean(), rows.mean()])
        middle = ground().pixels(np.array([[moved.x[k], moved.y[k]]]))[0] / 2
        away = (nose - middle) * [1, -1]
        assert 0 < np.hypot(*away) < 30
        assert math.cos(math.atan2(away[1], away[0]) - moved.heading[k]) > 0.8, k  # the front mark is in front


def test_planned_motion_at_given_times() -> None:
    plan = plan_of(CORNERS)
    assert plan.trajectory is not None
    t = np.linspace(0, plan.trajectory.duration, 4001)
    moved = motion(plan.trajectory, plan.robot, t)
    step = t[1] - t[0]
    way = np.hypot(np.diff(moved.x), np.diff(moved.y))
    assert way == pytest.approx((moved.speed[1:] + moved.speed[:-1]) / 2 * step, abs=1e-5)
    assert way.sum() == pytest.approx(5.5, abs=1e-6)
    assert np.diff(moved.heading) == pytest.approx((moved.turn_rate[1:] + moved.turn_rate[:-1]) / 2 * step, abs=1e-5)
    assert moved.heading[-1] == pytest.approx(QUARTER - 2)
    assert moved.turn_rate.max() == pytest.approx(1.0)
    assert [int(k) for k in moved.tool[[0, *(np.flatnonzero(np.diff(moved.tool)) + 1)]]] == [1, 0, 2, 0, 3]


def test_a_tool_beside_the_robot() -> None:
    plan = plan_of(BEND)
    robot = replace(plan.robot, tool=replace(plan.robot.tool, right=0.3, ahead=0.1))
    assert plan.trajectory is not None
    moved = motion(plan.trajectory, robot, np.linspace(0, 5, 50))
    c, s = np.cos(moved.heading), np.sin(moved.heading)
    dx, dy = moved.tool_x - moved.x, moved.tool_y - moved.y
    assert dx * c + dy * s == pytest.approx(0.1)
    assert dx * s - dy * c == pytest.approx(0.3)


def test_a_driven_film_shows_the_drive(tmp_path: Path) -> None:
    plan = plan_of(BEND)
    drive = op.simulate(plan, op.DriveOptions(start=(0.0, 0.5, 0.0)))
    op.animate(plan, tmp_path / "film.json", drive=drive, seconds=3)
    told = json.loads((tmp_path / "film.json").read_text())
    assert len(told["frames"]) == 46
    for frame in told["frames"]:
        k = int(np.searchsorted(drive.time, frame["t"] - 1e-3))
        assert frame["x"] == pytest.approx(drive.x[k], abs=1e-4)
        assert frame["tool"] == drive.tool[k]
    assert told["frames"][0]["y"] == 0.5
    assert told["speed_up"] == pytest.approx(drive.time[-1] / 3)
    assert [choice["width"] for choice in told["settings"]] == [s.width for s in plan.robot.tool.settings]
    op.animate(plan, tmp_path / "film.gif", drive=drive, seconds=1, size=3)
    assert 8 <= len(frames_of(tmp_path / "film.gif")) <= 16


def test_a_folder_of_frames(tmp_path: Path) -> None:
    plan, folder = plan_of(BEND), tmp_path / "frames"
    op.animate(plan, folder, seconds=2, fps=5, size=3)
    assert sorted(file.name for file in folder.iterdir()) == [f"frame-{k:05d}.png" for k in range(11)]
    assert len({frames_of(file)[0].shape for file in folder.iterdir()}) == 1
    with pytest.raises(op.InputError, match="exists already"):
        op.animate(plan, folder, seconds=2, fps=5)
    (folder / "notes.txt").write_text("mine")
    op.animate(plan, folder, seconds=1, fps=5, size=3, overwrite=True)
    assert len(list(folder.glob("*.png"))) == 6  # none of the longer film is left
    assert (folder / "notes.txt").exists()


def test_speed_up_is_the_other_way_to_say_it(tmp_path: Path) -> None:
    plan = plan_of(CORNERS)
    assert plan.trajectory is not None
    op.animate(plan, tmp_path / "film.json", speed_up=4, fps=10)
    told = json.loads((tmp_path / "film.json").read_text())
    assert len(told["frames"]) == round(plan.trajectory.duration / 4 * 10) + 1


FAKE = """#!{python}
import sys, pathlib
size = sys.argv[sys.argv.index("-s") + 1]
data = sys.stdin.buffer.read()
pathlib.Path(sys.argv[-1]).write_text(f"{{size}} {{len(data)}}")
"""
BROKEN = "#!/bin/sh\necho 'no such encoder' >&2\nexit 3\n"


def put_ffmpeg(folder: Path, text: str, monkeypatch: pytest.MonkeyPatch) -> None:
    program = folder / "bin" / "ffmpeg"
    program.parent.mkdir()
    program.write_text(text)
    program.chmod(program.stat().st_mode | stat.S_IXUSR)
    monkeypatch.setenv("PATH", f"{program.parent}{os.pathsep}{os.environ['PATH']}")


def test_ffmpeg_is_fed_whole_frames(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    put_ffmpeg(tmp_path, FAKE.format(python=sys.executable), monkeypatch)
    op.animate(plan_of(BEND), tmp_path / "film.mp4", seconds=1, fps=6, size=3)
    size, count = (tmp_path / "film.mp4").read_text().split()
    width, height = map(int, size.split("x"))
    assert width % 2 == height % 2 == 0
    assert int(count) == 7 * width * height * 3


def test_words_of_ffmpeg_are_passed_on(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    put_ffmpeg(tmp_path, BROKEN, monkeypatch)
    with pytest.raises(op.InputError, match="ffmpeg says no such encoder"):
        op.animate(plan_of(BEND), tmp_path / "film.mp4", seconds=1)
    assert not (tmp_path / "film.mp4").exists()


def test_no_ffmpeg(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setenv("PATH", str(tmp_path))
    with pytest.raises(op.InputError, match="ffmpeg is not on the PATH; install it"):
        op.animate(plan_of(BEND), tmp_path / "film.mp4")


@pytest.mark.parametrize(
    ("name", "settings", "message"),
    [
        ("film.avi", {}, "has the ending '.avi'; expected .gif, .mp4, .json, or none for a folder"),
        ("film.gif", {"fps": 0.0}, "fps is 0.0; expected a finite number above 0"),
        ("film.gif", {"fps": math.nan}, "fps is nan"),
        ("film.gif", {"fps": 60.0}, "at most 50 frames a second"),
        ("film.gif", {"seconds": -1.0}, "seconds is -1.0"),
        ("film.gif", {"seconds": 3.0, "speed_up": 2.0}, "both a duration and a speed-up"),
        ("film.gif", {"seconds": 3000.0}, "45001 frames; at most 5000"),
        ("film.gif", {"size": 90.0}, "at most 4000 pixels"),
    ],
)
def test_wrong_films(tmp_path: Path, name: str, settings: dict[str, float], message: str) -> None:
    with pytest.raises(op.InputError, match=message):
        op.animate(plan_of(BEND), tmp_path / name, **settings)  # type: ignore[arg-type]
    assert not list(tmp_path.iterdir())


def test_nothing_is_replaced_unasked(tmp_path: Path) -> None:
    file = tmp_path / "film.gif"
    file.write_text("mine")
    with pytest.raises(op.InputError, match="exists already"):
        op.animate(plan_of(BEND), file)
    assert file.read_text() == "mine"


def test_a_plan_without_speeds(tmp_path: Path) -> None:
    with pytest.raises(op.InputError, match="no speeds to show; run the stage time first"):
        op.animate(replace(plan_of(BEND), trajectory=None), tmp_path / "film.gif")


def test_a_drive_that_never_began(tmp_path: Path) -> None:
    plan = plan_of(BEND)
    drive = op.simulate(plan, op.DriveOptions(start=(0.0, 9.0, 0.0)))
    op.animate(plan, tmp_path / "film.gif", drive=drive, size=2)
    assert frames_of(tmp_path / "film.gif")


@pytest.mark.parametrize("robot", ["pen-plotter", "line-marker"])
def test_other_robots(robot: str, tmp_path: Path) -> None:
    plan = op.plan(op.read(op.instance("wave")), robot)
    op.animate(plan, tmp_path / "film.gif", seconds=2, size=4)
    first, *_, last = frames_of(tmp_path / "film.gif")
    assert (first != last).any(axis=-1).sum() > 200


def test_a_robot_that_drives_backwards_points_backwards() -> None:
    plan = plan_of(replace(LINE, gear=np.array([-1])))
    assert plan.trajectory is not None
    moved = motion(plan.trajectory, plan.robot, np.linspace(0, plan.trajectory.duration, 51))
    assert moved.speed.min() < -0.3
    assert math.cos(moved.heading[25]) == pytest.approx(-1)
    assert moved.x[-1] == pytest.approx(4.0)


def test_frames_that_differ_little_are_small() -> None:
    blank = Image.new("RGB", (400, 400), "#ecdcb4")
    dotted = blank.copy()
    dotted.paste((192, 57, 43), (10, 10, 20, 20))
    palette = [(236, 220, 180), (192, 57, 43)]
    data = gif_bytes([blank, dotted] * 20, 10, palette)
    assert len(data) < 12_000
    with Image.open(io.BytesIO(data)) as film:
        film.seek(1)
        assert np.abs(np.asarray(film.convert("RGB"))[15, 15].astype(int) - [192, 57, 43]).max() <= 8


@pytest.fixture(scope="module")
def lion() -> Plan:
    return op.plan(op.read(op.instance("lion")), options=op.Options(order=op.OrderOptions(seconds=2)))


def test_the_lion_is_quick_and_small(lion: Plan, tmp_path: Path) -> None:
    began = time.process_time()
    op.animate(lion, tmp_path / "lion.gif", seconds=20)
    assert time.process_time() - began < 20
    assert (tmp_path / "lion.gif").stat().st_size < 8e6
    assert 250 <= len(frames_of(tmp_path / "lion.gif")) <= 301
