"""The command line as its users meet it: exit codes, files, messages."""

from __future__ import annotations

import json
import os
import subprocess
import sys
import tomllib
from pathlib import Path
from typing import NamedTuple

import pytest

import optplan as op
from optplan.cli import main
from optplan.instances import instance

TWO = (
    '<svg xmlns="http://www.w3.org/2000/svg" viewBox="0 0 10 10">'
    '<rect width="9" height="9" fill="none" stroke="black"/><path d="M2 2L8 2" stroke="black"/></svg>'
)


class Ran(NamedTuple):
    code: int
    out: str
    err: str


@pytest.fixture
def run(tmp_path: Path, monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]) -> Runner:
    monkeypatch.chdir(tmp_path)
    return Runner(monkeypatch, capsys)


class Runner:
    """Runs `optplan ...` in this process."""

    def __init__(self, monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]) -> None:
        self.monkeypatch, self.capsys = monkeypatch, capsys

    def __call__(self, *arguments: str) -> Ran:
        self.monkeypatch.setattr(sys, "argv", ["optplan", *arguments])
        code = 0
        try:
            main()
        except SystemExit as stop:
            code = int(stop.code or 0)
        captured = self.capsys.readouterr()
        return Ran(code, captured.out, captured.err)


@pytest.fixture
def two(tmp_path: Path) -> str:
    file = tmp_path / "two.svg"
    file.write_text(TWO)
    return str(file)


@pytest.mark.parametrize("more", [(), ("-o", "two.svg")])
def test_a_stage_never_writes_over_a_drawing(run: Runner, two: str, more: tuple[str, ...]) -> None:
    ran = run("cover", two, "--force", *more)
    assert ran.code == 2
    assert "is a drawing" in ran.err
    assert Path(two).read_text() == TWO


def test_plan_writes_a_verified_plan_and_its_pictures(run: Runner, two: str) -> None:
    ran = run("plan", two, "-o", "made", "-e", "csv", "-e", "txt")
    assert ran.code == 0
    assert sorted(file.name for file in Path("made").iterdir()) == [
        "picture.png",
        "picture.svg",
        "plan.csv",
        "plan.json",
        "plan.txt",
    ]
    assert "planned and verified" in ran.out
    plan = op.load_plan("made/plan.json")
    assert plan.report is not None
    assert plan.report.ok
    assert Path("made/picture.png").read_bytes()[:4] == b"\x89PNG"
    assert "<svg" in Path("made/picture.svg").read_text()


def test_json_output_is_one_object_that_agrees_with_the_plan(run: Runner, two: str) -> None:
    ran = run("plan", two, "-o", "made", "--json")
    facts = json.loads(ran.out)
    plan = op.load_plan("made/plan.json")
    assert facts["ok"] is True
    assert plan.ordering is not None
    assert facts["ordering"]["cost"] == plan.ordering.cost
    assert facts["strokes"] == 2
    assert json.loads(run("check", "made/plan.json", "--json").out)["ok"] is True


def test_an_existing_plan_is_kept_unless_asked(run: Runner, two: str) -> None:
    assert run("plan", two, "-o", "made").code == 0
    before = Path("made/plan.json").read_bytes()
    ran = run("plan", two, "-o", "made", "--canvas", "10x10")
    assert ran.code == 2
    assert "exists already" in ran.err
    assert Path("made/plan.json").read_bytes() == before
    assert run("plan", two, "-o", "made", "--canvas", "10x10", "--force").code == 0
    assert Path("made/plan.json").read_bytes() != before


@pytest.mark.parametrize("flags", [("--metric", "cc"), ("--padding", "1"), ("--curved-padding",)])
def test_an_instance_of_a_library_has_its_costs(run: Runner, flags: tuple[str, ...]) -> None:
    refused = run("order", "tiers40", *flags)
    assert refused.code == 2
    assert flags[0] in refused.err


@pytest.mark.parametrize(("asked", "metres"), [("50cm,10cm", 0.6), ("0.2", 0.4)])
def test_padding_is_driven_and_reported(run: Runner, two: str, asked: str, metres: float) -> None:
    found = json.loads(run("plan", two, "-o", "padded", "--padding", asked, "--json").out)
    assert found["ok"]
    assert found["figures"]["padding"]["value"] == pytest.approx(found["strokes"] * metres)
    assert (
        json.loads(run("check", "padded/plan.json", "--json").out)["figures"]["padding"] == found["figures"]["padding"]
    )


def test_exports_of_an_earlier_plan_are_named(run: Runner, two: str) -> None:
    assert run("plan", two, "-o", "out", "-q", "-e", "csv").code == 0
    again = run("plan", two, "-o", "out", "-q", "--force")
    assert again.code == 0
    assert "of an earlier plan" in again.out
    assert "plan.csv" in again.out
    assert "earlier" not in run("plan", two, "-o", "out", "-q", "--force", "-e", "csv").out


def test_stages_one_by_one_give_the_same_plan_as_all_at_once(run: Runner, two: str) -> None:
    assert run("plan", two, "-o", "made", "--seed", "3").code == 0
    assert run("cover", two, "-o", "1.json").code == 0
    assert run("order", "1.json", "-o", "2.json", "--seed", "3").code == 0
    assert run("connect", "2.json", "-o", "3.json").code == 0
    assert run("time", "3.json", "-o", "4.json").code == 0
    whole, stepwise = op.load_plan("made/plan.json"), op.load_plan("4.json")
    assert whole.path is not None
    assert stepwise.path is not None
    assert whole.path.start.tolist() == stepwise.path.start.tolist()
    assert whole.trajectory is not None
    assert stepwise.trajectory is not None
    assert whole.trajectory.duration == stepwise.trajectory.duration
    assert op.load_plan("1.json").ordering is None
    assert op.load_plan("2.json").path is None
    assert run("check", "4.json").code == 0


def test_a_stage_with_the_rest_makes_a_complete_plan(run: Runner, two: str) -> None:
    run("plan", two, "-o", "made")
    assert run("time", "made/plan.json", "-o", "slow.json", "--work-speed", "10 cm/s", "--rest").code == 0
    slow, fast = op.load_plan("slow.json"), op.load_plan("made/plan.json")
    assert slow.options.time.work_speed == pytest.approx(0.1)
    assert slow.trajectory is not None
    assert fast.trajectory is not None
    assert slow.trajectory.duration > 2 * fast.trajectory.duration
    assert slow.report is not None
    assert slow.report.ok


def test_check_fails_when_a_limit_is_broken(run: Runner, two: str) -> None:
    run("plan", two, "-o", "made")
    data = json.loads(Path("made/plan.json").read_text())
    data["trajectory"]["v"] = [3 * v for v in data["trajectory"]["v"]]
    data["trajectory"]["t"] = [t / 3 for t in data["trajectory"]["t"]]
    Path("fast.json").write_text(json.dumps(data))
    ran = run("check", "fast.json")
    assert ran.code == 1
    assert "FAILED" in ran.out


def test_show_and_export_write_beside_the_plan(run: Runner, two: str) -> None:
    run("plan", two, "-o", "made")
    assert run("show", "made/plan.json", "-o", "a.pdf").code == 0
    assert Path("a.pdf").read_bytes().startswith(b"%PDF")
    assert run("export", "made/plan.json", "--to", "csv", "--spacing", "1 m").out.strip() == "made/plan.csv"
    assert json.loads(run("show", "made/plan.json", "-o", "b.png", "--json").out) == {"files": ["b.png"]}
    assert json.loads(run("export", "made/plan.json", "-t", "txt", "--json").out) == {"files": ["made/plan.txt"]}
    assert run("export", "made/plan.json", "--to", "csv").code == 2
    assert run("export", "made/plan.json", "--to", "nonsense").code == 2


def test_demo_runs_again_and_again(run: Runner) -> None:
    assert run("demo", "wave").code == 0
    assert run("demo", "wave").code == 0
    assert Path("optplan-demo/plan.json").exists()
    assert Path("optplan-demo-2/plan.json").exists()


@pytest.mark.parametrize("command", ["robots", "solvers", "instances"])
def test_lists_name_everything(run: Runner, command: str) -> None:
    from optplan.ordering import SOLVERS

    names = {"robots": op.robot_names(), "solvers": tuple(SOLVERS), "instances": op.instance_names()}[command]
    ran = run(command)
    assert ran.code == 0
    assert all(name in ran.out for name in names)
    assert [item["name"] for item in json.loads(run(command, "--json").out)] == list(names)


def test_flags_win_over_the_configuration_file_and_that_over_defaults(run: Runner, two: str) -> None:
    Path("own.toml").write_text('robot = "pen-plotter"\n[order]\nseed = 7\nseconds = "3 s"\n[cover]\ndirection = 45\n')
    printed = tomllib.loads(run("plan", two, "-c", "own.toml", "--seed", "9", "--print-config").out)
    assert printed["robot"] == "pen-plotter"
    assert printed["order"]["seed"] == 9
    assert printed["order"]["seconds"] == 3
    assert printed["cover"]["direction"] == "45 deg"
    assert printed["order"]["solver"] == "auto"
    # a file of the usual name in the current folder needs no flag, and what was printed can be read again
    Path("optplan.toml").write_text(run("plan", two, "-c", "own.toml", "--print-config").out)
    again = tomllib.loads(run("plan", two, "--robot", "beach-rake", "--print-config").out)
    assert again == {**printed, "robot": "beach-rake", "order": {**printed["order"], "seed": 7}}


def test_fills_of_single_elements_differ(run: Runner, tmp_path: Path) -> None:
    file = tmp_path / "areas.svg"
    file.write_text(
        '<svg xmlns="http://www.w3.org/2000/svg" viewBox="0 0 20 10">'
        '<rect id="a" width="8" height="9" fill="black"/><rect id="b" x="10" width="8" height="9" fill="black"/></svg>'
    )
    ran = run("plan", str(file), "-o", "m", "--no-boundary", "--fill", "a:direction=90", "--fill", "b:spacing=20cm")
    assert ran.code == 0
    cover = op.load_plan("m/plan.json").cover
    assert cover is not None
    first, second = (next(s for s in cover.strokes if s.element == name) for name in "ab")
    assert abs(first.points[1] - first.points[0]) @ [1, 0] < 1e-9  # runs along y
    assert abs(second.points[1] - second.points[0]) @ [0, 1] < 1e-9
    assert abs(second.points[2, 1] - second.points[0, 1]) <= 0.2 + 1e-9


HOSTILE = {
    "missing": (["plan", "none.svg"], "none.svg"),
    "folder": (["plan", "folder.svg"], "folder"),
    "no drawing": (["plan", "text.svg"], "text.svg"),
    "empty": (["plan", "empty.svg"], "empty.svg"),
    "wrong ending": (["plan", "picture.bmp"], "picture.bmp"),
    "robot": (["plan", "two.svg", "--robot", "spaceship"], "spaceship"),
    "solver": (["plan", "two.svg", "--solver", "magic"], "magic"),
    "canvas": (["plan", "two.svg", "--canvas", "1x1"], "margin"),
    "canvas text": (["plan", "two.svg", "--canvas", "big"], "--canvas"),
    "unit": (["plan", "two.svg", "--tolerance", "3 parsec"], "parsec"),
    "tolerance": (["plan", "two.svg", "--tolerance", "0"], "tolerance"),
    "nan": (["plan", "two.svg", "--margin", "nan"], "nan"),
    "start": (["plan", "two.svg", "--start", "here"], "--start"),
    "element": (["plan", "two.svg", "--fill", "nobody:direction=3"], "nobody"),
    "fill": (["plan", "two.svg", "--fill", "rect1"], "--fill"),
    "metric": (["plan", "two.svg", "--metric", "crow"], "crow"),
    "dubins without radius": (["plan", "two.svg", "--robot", "pen-plotter", "--metric", "dubins"], "turning radius"),
    "format": (["plan", "two.svg", "--export", "stone"], "stone"),
    "padding": (["plan", "two.svg", "--padding", "much"], "much"),
    "padding of three": (["plan", "two.svg", "--padding", "1,2,3"], "--padding"),
    "padding below nothing": (["plan", "two.svg", "--padding", "-1"], "pad_before"),
    "config": (["plan", "two.svg", "-c", "bad.toml"], "bad.toml"),
    "config key": (["plan", "two.svg", "-c", "key.toml"], "colour"),
    "config table": (["plan", "two.svg", "-c", "table.toml"], "page: is no table"),
    "no plan": (["check", "two.svg"], "two.svg"),
    "half a plan": (["check", "half.json"], "half.json"),
    "unknown demo": (["demo", "unicorn"], "unicorn"),
    "schema": (["schema", "unicorn"], "unicorn"),
    "not planned yet": (["connect", "covered.json", "-o", "x.json"], "order"),
    "picture": (["show", "covered.json", "-o", "x.bmp"], ".bmp"),
}


@pytest.mark.parametrize("case", HOSTILE)
def test_bad_input_gives_one_clear_error_and_exit_code_2(run: Runner, two: str, case: str) -> None:
    Path("folder.svg").mkdir()
    Path("text.svg").write_text("this is a letter, not a drawing")
    Path("empty.svg").write_text('<svg xmlns="http://www.w3.org/2000/svg" viewBox="0 0 1 1"/>')
    Path("picture.bmp").write_text("BM")
    Path("bad.toml").write_text("= 3")
    Path("table.toml").write_text("page = 3")
    Path("key.toml").write_text("[cover]\ncolour = 3\n")
    Path("half.json").write_text('{"version": "1.0", "job": ')
    assert run("cover", two, "-o", "covered.json").code == 0
    before = {file.name for file in Path().iterdir()}
    arguments, expected = HOSTILE[case]
    ran = run(*arguments)
    assert ran.code == 2
    assert len(ran.err.strip().splitlines()) == 1
    assert ran.err.startswith("error: ")
    assert expected in ran.err
    assert {file.name for file in Path().iterdir()} == before


def test_schemas_are_printed(run: Runner) -> None:
    for name in ("plan", "job", "robot", "options"):
        assert "properties" in run("schema", name).out


def test_help_needs_nothing_heavy() -> None:
    import subprocess

    code = (
        "import sys; sys.argv = ['optplan', '--help']\n"
        "from optplan.cli import main\n"
        "try: main()\n"
        "except SystemExit: pass\n"
        "heavy = {'numpy', 'scipy', 'shapely', 'numba', 'pyomo', 'highspy', 'matplotlib', 'pydantic', 'lxml', 'rich'}\n"
        "print('HEAVY', sorted(heavy & set(sys.modules)))"
    )
    out = subprocess.run([sys.executable, "-c", code], capture_output=True, text=True, check=True).stdout
    assert out.strip().endswith("HEAVY []")


def test_an_error_is_one_line_whatever_the_name_of_the_file(run: Runner) -> None:
    ran = run("plan", "two\nlines\x1b[31m.svg")
    assert ran.code == 2
    assert ran.err.count("\n") == 1
    assert "\x1b" not in ran.err


@pytest.mark.parametrize("flags", [["--no-such-flag"], ["x.svg", "--seed", "abc"], []])
def test_a_wrong_flag_is_one_line_too(run: Runner, flags: list[str]) -> None:
    ran = run("plan", *flags)
    assert ran.code == 2
    assert ran.err.startswith("error: ")
    assert ran.err.count("\n") == 1


@pytest.mark.parametrize("flags", [["--iterations", "9" * 23], ["--start", "1e308,0"], ["--start", "1e300,0"]])
def test_numbers_beyond_all_measure_are_refused(run: Runner, two: str, flags: list[str]) -> None:
    ran = run("plan", two, *flags)
    assert ran.code == 2
    assert not Path("two-plan").exists()


def test_a_file_in_place_of_the_folder_is_found_before_the_work(run: Runner, two: str) -> None:
    Path("made").write_text("mine")
    ran = run("plan", two, "-o", "made")
    assert ran.code == 2
    assert "expected a folder" in ran.err
    assert Path("made").read_text() == "mine"


def test_a_file_name_that_is_no_text_is_planned_all_the_same(run: Runner) -> None:
    name = os.fsdecode(b"two-\xff.svg")
    Path(name).write_text(TWO)
    assert run("plan", name, "-o", "made").code == 0
    assert op.load_plan("made/plan.json").job.name == "two-\ufffd"


@pytest.mark.skipif(not Path("/dev/full").exists(), reason="there is no full device to write to")
def test_a_full_disk_behind_stdout_is_one_line() -> None:
    with Path("/dev/full").open("w") as full:
        ran = subprocess.run(
            [sys.executable, "-m", "optplan", "robots"], stdout=full, stderr=-1, text=True, check=False
        )
    assert ran.returncode == 2
    assert ran.stderr.count("\n") == 1


def test_order_solves_library_instances(run: Runner) -> None:
    Path("three.atsp").write_text(
        "TYPE: ATSP\nDIMENSION: 3\nEDGE_WEIGHT_TYPE: EXPLICIT\nEDGE_WEIGHT_FORMAT: FULL_MATRIX\n"
        "EDGE_WEIGHT_SECTION\n0 1 9\n9 0 1\n1 9 0\nEOF\n"
    )
    done = run("order", "three.atsp", "-o", "three.tour")
    assert done.code == 0, done.err
    assert "optimal by auto: 3" in done.out
    assert "TOUR_SECTION\n1\n2\n3\n-1" in Path("three.tour").read_text()
    again = run("order", "three.atsp", "-o", "three.tour")
    assert again.code == 2
    assert "exists" in again.err
    facts = json.loads(run("order", "three.atsp", "--json", "--solver", "nn").out)
    assert facts["cost"] == 3
    Path("three.atsp").write_text("TYPE: ATSP\nDIMENSION: 3\n")
    broken = run("order", "three.atsp")
    assert broken.code == 2
    assert broken.err.startswith("error: three.atsp")


def test_compare_prints_a_table_and_writes_all_runs(run: Runner) -> None:
    done = run("compare", "drawings/logo", "-s", "nn", "-s", "auto", "-b", "1s", "-o", "runs.csv")
    assert done.code == 0, done.err
    assert "optimal" in done.out
    assert len(Path("runs.csv").read_text().splitlines()) == 3
    assert run("compare", "drawings/logo", "-s", "nn", "-o", "runs.csv").code == 2
    wrong = run("compare", "drawings/logo", "-s", "best")
    assert wrong.code == 2
    assert "there is no solver 'best'" in wrong.err


def test_reversing_is_for_robots_that_can(run: Runner, two: str) -> None:
    refused = run("plan", two, "--robot", "beach-rake", "--metric", "cc", "--reversing", "-q")
    assert refused.code == 2
    assert "beach-rake does not drive backwards" in refused.err
    done = run("plan", two, "--robot", "line-marker", "--metric", "dubins", "--reversing", "--json", "-q")
    assert done.code == 0, done.err
    config = run("plan", two, "--reversing", "--print-config")
    assert "reversing = true" in config.out


def test_shipped_jobs_are_found_by_name_with_and_without_their_ending(run: Runner) -> None:
    for name in ("wave", "wave.svg", "drawings/wave", "drawings/wave.svg"):
        ran = run("cover", name, "-o", "strokes.json", "--force", "-q")
        assert ran.code == 0, ran.err
    assert run("cover", "wave.json", "-o", "x.json").code == 2
    before = instance("facades/windows").read_bytes()
    refused = run("cover", "windows", "--force", "-q")
    assert (refused.code, "say --output" in refused.err) == (2, True)
    assert instance("facades/windows").read_bytes() == before
