"""`optplan simulate` and `optplan show --animate`."""

from __future__ import annotations

import json
import sys
from pathlib import Path
from typing import NamedTuple

import numpy as np
import pytest
from PIL import Image

import optplan as op
from optplan.cli import main
from tests.simulation.plans import CORNERS, plan_of


class Ran(NamedTuple):
    code: int
    out: str
    err: str


class Runner:
    """Runs `optplan ...` in this process, in a folder of its own with a plan in it."""

    def __init__(self, monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]) -> None:
        self.monkeypatch, self.capsys = monkeypatch, capsys

    def __call__(self, *arguments: str) -> Ran:
        self.monkeypatch.setattr(sys, "argv", ["optplan", *arguments])
        code = 0
        try:
            main()
        except SystemExit as stop:
            code = int(stop.code or 0)
        return Ran(code, *self.capsys.readouterr())


@pytest.fixture
def run(tmp_path: Path, monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]) -> Runner:
    monkeypatch.chdir(tmp_path)
    op.save_plan(plan_of(CORNERS), "plan.json")
    return Runner(monkeypatch, capsys)


def test_figures_for_people(run: Runner) -> None:
    ran = run("simulate", "plan.json")
    assert ran.code == 0
    assert "cross-track, greatest" in ran.out
    assert "path-frame: came to rest at the end of the plan" in ran.out


def test_figures_for_machines_and_a_trace(run: Runner) -> None:
    circumstances = ("--lag", "80ms", "--slip", "0.02", "--noise", "5mm", "--heading-noise", "0.5deg", "--mass", "40")
    more = ("--tracker", "pure-pursuit", "--lookahead", "60cm", "--seed", "3")
    ran = run("simulate", "plan.json", "--json", "-o", "trace.csv", *circumstances, *more)
    assert ran.code == 0, ran.err
    told = json.loads(ran.out)
    assert told["finished"]
    assert told["method"] == "pure-pursuit"
    assert told["files"] == ["trace.csv"]
    assert told["figures"]["energy"]["value"] > 0
    table = np.genfromtxt("trace.csv", delimiter=",", names=True)
    assert len(table) == told["moments"]
    assert np.abs(table["cross_track"]).max() == pytest.approx(
        told["figures"]["cross-track, greatest"]["value"], abs=1e-6
    )
    # the same circumstances from Python
    options = op.DriveOptions(
        tracker="pure-pursuit",
        lag=0.08,
        slip=0.02,
        noise=0.005,
        heading_noise=np.pi / 360,
        mass=40.0,
        lookahead=0.6,
        seed=3,
    )
    assert op.simulate(op.load_plan("plan.json"), options).x == pytest.approx(table["x"], abs=1e-6)
    assert run("simulate", "plan.json", "-o", "trace.csv").code == 2
    assert run("simulate", "plan.json", "-o", "trace.csv", "-f").code == 0


@pytest.mark.parametrize(
    ("flags", "message"),
    [
        (("--tracker", "magic"), "there is no tracker 'magic'"),
        (("--lag", "0s"), "lag is 0.0; expected a finite number above 0"),
        (("--lag=-1s",), "lag is -1.0"),
        (("--mass", "0"), "mass is 0.0"),
        (("--noise", "much"), "'much' is not a quantity"),
        (("--ideal", "--slip", "0.1"), "an ideal drive has no lag"),
    ],
)
def test_wrong_circumstances(run: Runner, flags: tuple[str, ...], message: str) -> None:
    ran = run("simulate", "plan.json", *flags)
    assert ran.code == 2
    assert message in ran.err
    assert ran.err.count("\n") == 1


def test_a_robot_that_does_not_arrive_is_exit_code_1(run: Runner) -> None:
    ran = run("simulate", "plan.json", "--lag", "1000s", "--json")
    assert ran.code == 1
    assert not json.loads(ran.out)["finished"]


def test_a_film_beside_the_plan(run: Runner) -> None:
    ran = run("show", "plan.json", "--animate", "--duration", "2s", "--fps", "5", "--size", "3", "--dpi", "60")
    assert ran.code == 0, ran.err
    assert ran.out.strip() == "plan.gif"
    with Image.open("plan.gif") as film:
        assert max(film.size) <= 220
        assert 5 <= getattr(film, "n_frames", 1) <= 11
    assert run("show", "plan.json", "--animate").code == 2
    assert run("show", "plan.json", "--animate", "-f", "--speed-up", "10", "--simulated", "--slip", "0.05").code == 0


def test_frames(run: Runner) -> None:
    assert (
        run("show", "plan.json", "--animate", "--frames", "--duration", "1", "--fps", "4").out.strip() == "plan-frames"
    )
    assert len(list(Path("plan-frames").glob("*.png"))) == 5
    ran = run("show", "plan.json", "--animate", "--frames", "-o", "poses.json", "--json")
    assert json.loads(ran.out) == {"files": ["poses.json"]}
    assert json.loads(Path("poses.json").read_text())["robot"] == "beach-rake"


@pytest.mark.parametrize(
    ("flags", "message"),
    [
        (("--fps", "5"), "--fps: is about a film; say --animate, too"),
        (("--frames",), "--frames: is about a film"),
        (("--animate", "--lag", "1s"), "--lag: is about a simulated drive; say --simulated, too"),
        (("--animate", "--convergence"), "expected one of --animate and --convergence"),
        (("--animate", "--frames", "-o", "x.gif"), "x.gif: is no place for frames"),
        (("--animate", "-o", "x.png"), "x.png: has the ending '.png'"),
        (("--animate", "--duration=-1s"), "seconds is -1.0"),
    ],
)
def test_flags_that_do_not_fit(run: Runner, flags: tuple[str, ...], message: str) -> None:
    ran = run("show", "plan.json", *flags)
    assert ran.code == 2
    assert message in ran.err
    assert [file.name for file in Path().iterdir()] == ["plan.json"]
