"""Fields on the command line: what means nothing is refused, what can be told at once is; units."""

from __future__ import annotations

import csv
import inspect
import json
from itertools import pairwise
from pathlib import Path

import pytest

import optplan as op
from optplan.cli import commands, meaning
from optplan.exports import export_plan
from optplan.instances import instance
from tests.test_cli import TWO, Runner

PITCH = {
    "version": "1.5",
    "kind": "field",
    "name": "small",
    "segments": [
        {"id": "a", "start": [0, 0], "end": [20, 0]},
        {"id": "b", "start": [0, 5], "end": [20, 5]},
        {"id": "c", "start": [0, 9], "end": [20, 9]},
    ],
}
CORNERS = "id,x,y,z,code\n1,0,0,0,\n2,9,0,0,\n3,9,0,6,\n4,0,0,6,\n5,4,-9,1,station\n"


@pytest.fixture
def run(tmp_path: Path, monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]) -> Runner:
    monkeypatch.chdir(tmp_path)
    Path("pitch.json").write_text(json.dumps(PITCH))
    Path("two.svg").write_text(TWO)
    Path("wall.csv").write_text(CORNERS)
    Path("wall.json").write_text(instance("facades/windows").read_text())
    return Runner(monkeypatch, capsys)


MEANINGLESS = [
    ("pitch.json", ["--link", "a:0,b:0"]),
    ("pitch.json", ["--fill", "nosuch:direction=3"]),
    ("pitch.json", ["--canvas", "10x10"]),
    ("pitch.json", ["--on-canvas"]),
    ("pitch.json", ["--inner-first"]),
    ("pitch.json", ["--unit", "1cm"]),
    ("pitch.json", ["--pattern", "hexagon"]),
    ("two.svg", ["--headings", "4"]),
    ("two.svg", ["--whole"]),
    ("two.svg", ["--water", "down"]),
    ("wall.json", ["--link", "a:0,b:0"]),
    ("wall.json", ["--keep", "order"]),
    ("wall.json", ["--inner-first"]),
    ("wall.json", ["--clearance", "1m"]),
    ("wall.json", ["--reversing"]),
    ("wall.json", ["--refill", "10m"]),
    ("wall.json", ["--drying", "10s"]),
    ("wall.json", ["--padding", "1m"]),
    ("wall.json", ["--work-speed", "1"]),
    ("wall.json", ["--fill", "a:direction=3"]),
    ("wall.json", ["--canvas", "10x10"]),
    ("wall.json", ["--direction", "3"]),
    ("wall.json", ["--headings", "3"]),
    ("wall.json", ["--unit", "1cm"]),
    ("wall.csv", ["--unit", "1cm"]),
]


@pytest.mark.parametrize(("file", "flags"), MEANINGLESS)
def test_an_option_that_means_nothing_for_a_job_is_refused(run: Runner, file: str, flags: list[str]) -> None:
    ran = run("plan", file, *flags)
    assert ran.code == 2
    assert ran.err.startswith(f"error: {'--cut' if flags == ['--whole'] else flags[0]}: means nothing for")
    assert not Path(f"{Path(file).stem}-plan").exists()


def test_stages_and_fleets_refuse_them_too(run: Runner) -> None:
    assert run("cover", "pitch.json", "-o", "1.json").code == 0
    for words in (
        ("cover", "pitch.json", "-o", "2.json", "--canvas", "9x9"),
        ("order", "1.json", "-o", "2.json", "--on-canvas"),
        ("fleet", "two.svg", "--whole"),
    ):
        ran = run(*words)
        assert (ran.code, "means nothing" in ran.err) == (2, True)


def test_options_of_the_table_exist() -> None:
    known = set(inspect.signature(commands.plan_command).parameters)
    assert set(meaning.MEANT) <= known
    assert set(meaning.FILES) <= known


@pytest.mark.parametrize(
    ("file", "kind"), [("pitch.json", "facade"), ("pitch.json", "drawing"), ("wall.csv", "drawing")]
)
def test_a_file_is_not_read_as_what_it_is_not(run: Runner, file: str, kind: str) -> None:
    ran = run("plan", file, "--as", kind)
    assert ran.code == 2
    assert f"expected a {kind}" in ran.err


@pytest.mark.parametrize(
    ("words", "says"),
    [
        (["pitch.json", "--refill", "45m"], "start point"),
        (["pitch.json", "--refill", "10m", "--start", "0,-5"], "'a' takes 20 m"),
        (["pitch.json", "-e", "stops"], "facades"),
        (["pitch.json", "-e", "geojson"], "anchor"),
        (["two.svg", "-e", "geojson"], "fields"),
        (["wall.json", "-e", "messages"], "drawings and fields"),
        (["pitch.json", "--units", "miles"], "expected one of m, ft, yd"),
    ],
)
def test_what_can_be_told_at_once_is_told_before_any_order(
    run: Runner, words: list[str], says: str, monkeypatch: pytest.MonkeyPatch
) -> None:
    def never(*_: object, **__: object) -> None:
        raise AssertionError("an order was looked for")

    monkeypatch.setattr("optplan.pipeline.solve", never)
    ran = run("plan", *words, "-o", "made")
    assert ran.code == 2
    assert says in ran.err
    assert not Path("made").exists()


def test_the_tank_is_filled_where_the_robot_starts_and_the_time_table_says_so(run: Runner) -> None:
    flags = ["--refill", "45m", "--start", "0,-5", "-e", "schedule", "-e", "pdf", "--metric", "cc"]
    assert run("plan", "pitch.json", *flags, "-o", "made").code == 0
    plan = op.load_plan("made/plan.json")
    assert plan.path is not None
    (stop,) = [k for k in range(len(plan.path)) if plan.path.dwell[k] > 0]
    assert plan.path.start[stop, :2] == pytest.approx(plan.path.start[0, :2])
    assert plan.path.start[stop, :2] == pytest.approx([0, -5])
    rows = list(csv.DictReader(Path("made/plan.schedule.csv").read_text().splitlines()))
    (fill,) = [row for row in rows if row["what"] == "fill tank"]
    assert float(fill["end"]) - float(fill["begin"]) == pytest.approx(plan.options.order.refill_time, abs=1e-3)
    assert all(a["end"] == b["begin"] for a, b in pairwise(rows))
    assert sum(float(row["end"]) - float(row["begin"]) for row in rows if row["what"] == "mark") == pytest.approx(
        60, abs=5
    )


def test_people_read_lengths_in_feet_and_yards(run: Runner, tmp_path: Path) -> None:
    ran = run("plan", "pitch.json", "-o", "made", "--units", "yd", "-e", "schedule", "-e", "csv")
    assert ran.code == 0
    assert "65.617" in ran.out  # 60 m
    rows = list(csv.DictReader(Path("made/plan.schedule.csv").read_text().splitlines()))
    assert sum(float(row["yards"]) for row in rows if row["what"] == "mark") == pytest.approx(60 / 0.9144, abs=0.01)
    assert "196.85" in run("check", "made/plan.json", "--units", "ft").out
    plan = op.load_plan("made/plan.json")
    for unit in ("m", "ft"):  # files for machines are in metres
        export_plan(plan, "csv", tmp_path / f"{unit}.csv", unit=unit)
        export_plan(plan, "pdf", tmp_path / f"{unit}.pdf", unit=unit)
    assert (tmp_path / "m.csv").read_text() == (tmp_path / "ft.csv").read_text() == Path("made/plan.csv").read_text()
    assert (tmp_path / "m.pdf").read_bytes() != (tmp_path / "ft.pdf").read_bytes()


def test_a_folder_is_no_file_to_replace(run: Runner) -> None:
    Path("folder").mkdir()
    for words in (
        ("field", "tennis", "-o", "folder"),
        ("field", "tennis", "-o", "folder", "--force"),
        ("cover", "pitch.json", "-o", "folder", "--force"),
    ):
        ran = run(*words)
        assert (ran.code, "is a folder; expected the name of a file" in ran.err) == (2, True)
    ran = run("fleet", "pitch.json", "-o", "two.svg", "--force")
    assert (ran.code, "expected a folder" in ran.err) == (2, True)


@pytest.mark.parametrize("words", [["check"], ["show"], ["export", "--to", "csv"], ["connect", "-o", "x.json"]])
def test_a_job_that_is_no_plan_is_called_so(run: Runner, words: list[str]) -> None:
    ran = run(words[0], "pitch.json", *words[1:])
    assert ran.code == 2
    assert ran.err.startswith("error: pitch.json: is a ")
    assert "expected a plan" in ran.err


def test_a_plan_that_is_no_job_is_called_so(run: Runner) -> None:
    assert run("cover", "pitch.json", "-o", "1.json").code == 0
    ran = run("plan", "1.json")
    assert (ran.code, "1.json: is a plan, expected a job" in ran.err) == (2, True)


def test_what_a_placed_field_misses_is_printed(run: Runner) -> None:
    ran = run("field", "basketball", "--align", "0,0 28,0 = 0,0 0,75", "-o", "b.json")
    assert ran.code == 0
    assert "23.500 m" in ran.out
    assert run("field", "tennis", "--scale", "0", "-o", "t.json").code == 2
    ran = run("field", "tennis", "--at", "1e30,0", "-o", "t.json")
    assert (ran.code, "1e+30 m away" in ran.err) == (2, True)
    assert not Path("t.json").exists()
