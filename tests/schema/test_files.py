"""Plans, jobs, robots and options as files."""

from __future__ import annotations

import json
import math
import os
import random
import tempfile
from dataclasses import fields, is_dataclass, replace
from pathlib import Path
from typing import Any

import jsonschema
import numpy as np
import pytest
from pydantic import TypeAdapter

from optplan.domain.errors import InputError, LimitError
from optplan.domain.ordering import Ordering, Status
from optplan.domain.result import Cover, Plan
from optplan.domain.robot import Arm, Boom, DiffDrive, Mobility
from optplan.domain.stop import StopReason
from optplan.domain.stroke import Traversals
from optplan.jobs.reading import read
from optplan.schema import base, files
from optplan.schema.files import read_bytes, read_text, write_atomically
from optplan.schema.jobs import JobModel, job_from, job_model
from optplan.schema.options import OptionsModel, options_from, options_model
from optplan.schema.plans import PlanModel, load_plan, plan_from_json, plan_json, save_plan
from optplan.schema.robots import RobotModel, robot_from, robot_model
from tests.schema.whole import OPTIONS, jobs, plan
from tests.strategies import CAR, PLOTTER, RAKE

STAGES = ("cover", "ordering", "visits", "path", "trajectory", "report")


def assert_same(one: Any, other: Any, place: str = "") -> None:
    """Equal to the last bit, arrays included."""
    assert type(one) is type(other), place
    if is_dataclass(one):
        for field in fields(one):
            assert_same(getattr(one, field.name), getattr(other, field.name), f"{place}.{field.name}")
    elif isinstance(one, np.ndarray):
        assert one.dtype == other.dtype, place
        assert one.shape == other.shape, place
        assert (one == other).all(), place
    elif isinstance(one, tuple):
        assert len(one) == len(other), place
        for k, (a, b) in enumerate(zip(one, other, strict=True)):
            assert_same(a, b, f"{place}[{k}]")
    else:
        assert one == other, place


def _valid(model: Any, data: Any) -> None:
    schema = TypeAdapter(model).json_schema()
    jsonschema.Draft202012Validator.check_schema(schema)
    jsonschema.validate(data, schema, jsonschema.Draft202012Validator)


@pytest.mark.parametrize("stages", range(len(STAGES) + 1))
def test_plans_come_back_equal(tmp_path: Path, stages: int) -> None:
    later: dict[str, Any] = dict.fromkeys(STAGES[stages:])
    whole = replace(plan(), **later)
    save_plan(whole, tmp_path / "plan.json")
    assert_same(load_plan(tmp_path / "plan.json"), whole)
    _valid(PlanModel, json.loads((tmp_path / "plan.json").read_text()))


@pytest.mark.parametrize("kind", jobs())
def test_jobs_come_back_equal(tmp_path: Path, kind: str) -> None:
    job = jobs()[kind]
    text = job_model(job).model_dump_json(exclude_none=True)
    (tmp_path / "job.json").write_text(text)
    assert_same(read(tmp_path / "job.json"), job)
    _valid(JobModel, json.loads(text))
    assert_same(job_from(job_model(job)), job)


MOBILITIES: tuple[Mobility, ...] = (
    RAKE.mobility,
    CAR.mobility,
    PLOTTER.mobility,
    DiffDrive(0.5, 0.1, 20.0, 40.0, 1 / 3, 1.0, True, 0.7, 0.3, 4.4),
    Boom((0.1, 0.2, 1 / 3), 0.3, 1.1, 20.0, 1 / 3),
    Arm(0.1, 0.2, 1 / 3, 1.5),
)


@pytest.mark.parametrize("mobility", MOBILITIES)
def test_robots_come_back_equal(mobility: Mobility) -> None:
    tool = replace(RAKE.tool, right=0.4, ahead=-0.1, stroke_widths=(1 / 3,), red_is_travel=True, fill=1)
    robot = replace(RAKE, tool=tool, mobility=mobility, sources=(("a", "b"), ("c", "d")))
    text = robot_model(robot).model_dump_json(exclude_none=True)
    assert_same(robot_from(RobotModel.model_validate_json(text)), robot)
    _valid(RobotModel, json.loads(text))


def test_options_come_back_equal() -> None:
    for options in (OPTIONS, type(OPTIONS)()):
        text = options_model(options).model_dump_json(exclude_none=True)
        assert_same(options_from(OptionsModel.model_validate_json(text)), options)
        _valid(OptionsModel, json.loads(text))


def test_units_and_angles_at_the_door() -> None:
    data = {
        "page": {"width": "3 ft", "height": 2, "margin": "25 mm"},
        "cover": {"direction": 90, "elements": {"a": {"direction": "0.5 rad", "spacing": "1 cm"}}},
        "order": {"seconds": "2 min", "start": ["1 m", "50 cm"]},
        "connect": {"corner": "45 deg"},
        "time": {"work_speed": "36 km/h"},
    }
    _valid(OptionsModel, data)
    options = options_from(OptionsModel.model_validate(data))
    assert options.page.width == pytest.approx(0.9144)
    assert options.page.margin == pytest.approx(0.025)
    assert options.cover.direction == pytest.approx(math.pi / 2)
    assert options.cover.elements[0][1].direction == 0.5
    assert options.cover.elements[0][1].spacing == pytest.approx(0.01)
    assert options.order.seconds == 120
    assert options.order.start == (1.0, 0.5)
    assert options.connect.corner == pytest.approx(math.pi / 4)
    assert options.time.work_speed == pytest.approx(10)
    again = json.loads(options_model(options).model_dump_json())
    assert again["cover"]["direction"] == "90 deg"
    assert again["cover"]["elements"]["a"]["direction"] == "0.5 rad"  # no short number of degrees says the same


def test_a_proof_that_nothing_is_possible_survives() -> None:
    none = np.zeros(0, dtype=np.int64)
    for bound, status in ((math.inf, Status.INFEASIBLE), (-math.inf, Status.UNKNOWN), (3.0, Status.UNKNOWN)):
        ordering = Ordering(none, math.inf, bound, status, StopReason.FINISHED, "x")
        whole = replace(plan(), ordering=ordering, visits=None, path=None, trajectory=None, report=None)
        assert_same(plan_from_json(plan_json(whole)), whole)


def test_empty_sections_come_back() -> None:
    none = np.zeros(0)
    visits = Traversals(none, none, none, np.zeros((0, 5)), np.zeros((0, 5)), none, none)  # type: ignore[arg-type]
    whole = Plan(plan().job, RAKE, OPTIONS, Cover(()), visits=visits)
    assert_same(plan_from_json(plan_json(whole)), whole)


def _names(folder: Path) -> list[str]:
    return [file.name for file in folder.iterdir()]


def _changed(*place: object, value: object) -> str:
    data = json.loads(plan_json(plan()))
    spot = data
    for key in place[:-1]:
        spot = spot[key]
    spot[place[-1]] = value
    return json.dumps(data)


@pytest.mark.parametrize(
    ("place", "value", "message"),
    [
        (("version",), "2.0", "format version 2.0"),
        (("version",), "1.6", "Update optplan"),
        (("version",), "0.9", "Write it again"),
        (("version",), "1", "expected '1.5'"),
        (("version",), "1.²", "expected '1.5'"),
        (("version",), "1." + "9" * 5000, "expected '1.5'"),
        (("version",), None, "expected '1.5'"),
        (("version",), ["1", "0"], "expected '1.5'"),
        (("format",), "a poem", "format: "),
        (("colour",), "red", "colour: is not known"),
        (("cover", "strokes", 0, "points", 0, 0), math.nan, "holds NaN"),
        (("cover", "strokes", 0, "points", 0, 0), -math.inf, "holds -Infinity"),
        (("cover", "strokes", 0, "points", 0, 0), 10**400, "points"),
        (("robot", "mobility", "track"), 10**400, "track"),
        (("cover", "strokes", 0, "tool"), 10**30, "tool"),
        (("cover", "strokes", 0, "tool"), 3, "cover.strokes.tool names 3; expected 0..2"),
        (("cover", "precedence"), [[0, 3]], "cover.precedence names 3"),
        (("cover", "precedence"), [[-1, 0]], "cover.precedence names -1"),
        (("cover", "areas", 0, "tool"), -1, "cover.areas.tool names -1"),
        (("visits", "stroke"), [0, 1, 5], "visits.stroke names 5"),
        (("visits", "stroke"), [0, 1, -1], "visits.stroke names -1"),
        (("visits", "entry_vertex"), [0, 4, 0], "stroke 1 at vertex 4"),
        (("visits", "length"), [1.0], "visits: traversals length"),
        (("path", "stroke"), [0, -1, 3], "path.stroke names 3"),
        (("path", "tool"), [0, 9, 1], "path.tool names 9"),
        (("path", "tool"), [0, 10**30, 1], "path.tool"),
        (("path", "length"), [1, 2, -1], "path: .*negative"),
        (("path", "gear"), [1, 0, 1], "path.gear"),
        (("path", "gear"), [1, -1], "path: path gear"),
        (("path", "gear"), [], "path.gear"),
        (("ordering", "nodes"), [10**30], "ordering.nodes"),
        (("ordering", "status"), "optimal", "ordering: .*cannot be called optimal"),
        (("trajectory", "t"), [0, 2, 1, 3], "trajectory: .*backwards"),
        (("path",), None, "speed profile without a path"),
        (("cover", "strokes", 1, "id"), "s1", "cover: two strokes share an id"),
        (("options", "cover", "direction"), "1 parsec", "options.cover.direction: .*parsec"),
        (("options", "order", "metric"), "x", "options: there is no metric"),
        (("job", "kind"), "poem", "job: "),
        (("job", "elements", 0, "stroke"), "red", "elements.*stroke"),
    ],
)
def test_what_is_wrong_is_said(place: tuple[object, ...], value: object, message: str) -> None:
    with pytest.raises(InputError, match=message) as caught:
        plan_from_json(_changed(*place, value=value), "my.json")
    assert str(caught.value).startswith("my.json: ")


def test_numbers_beyond_floats_are_refused() -> None:
    text = plan_json(plan()).replace('"unit":0.001', '"unit":1e999')
    with pytest.raises(InputError, match="unit"):
        plan_from_json(text)
    with pytest.raises(InputError, match="is not JSON"):
        plan_from_json(plan_json(plan()).replace('"unit":0.001', '"unit":' + "9" * 5000))


def test_all_errors_are_said_at_once() -> None:
    data = json.loads(plan_json(plan()))
    data["surprise"] = 1
    data["robot"]["mobility"]["track"] = "wide"
    del data["ordering"]["solver"]
    with pytest.raises(InputError) as caught:
        plan_from_json(json.dumps(data))
    for place in ("surprise", "track", "ordering.solver"):
        assert place in str(caught.value)


@pytest.mark.parametrize("version", ["1.0", "1.1", "1.2", "1.3"])
def test_older_minor_versions_are_read(monkeypatch: pytest.MonkeyPatch, version: str) -> None:
    monkeypatch.setattr(base, "VERSION", "1.3")
    plan_from_json(_changed("version", value=version))
    with pytest.raises(InputError, match=r"reads 1\.0 to 1\.3"):
        plan_from_json(_changed("version", value="1.5"))


@pytest.mark.parametrize("text", ["", "{", "[]", "1", "null", '"x"', "[" * 100_000, "\ufeff{}", b"\xff\xff", b"\x00"])
def test_what_is_no_plan_at_all(text: str | bytes) -> None:
    with pytest.raises(InputError):
        plan_from_json(text)


BADLY: tuple[Any, ...] = (None, "x", "", -1, 0, 1.5, 10**30, 10**400, 1e308, -1e308, 5e-324, True, [], {}, [[]], "9 m")


def test_random_damage_never_surprises() -> None:
    """Every value in turn is removed or replaced: the plan is read or refused, and nothing else happens."""
    rng = random.Random(5)
    whole = plan_json(plan())
    refused = 0
    for _ in range(1500):
        data = json.loads(whole)
        for _ in range(rng.choice((1, 1, 1, 2))):
            spot = data
            while True:
                key = rng.choice(list(spot)) if isinstance(spot, dict) else rng.randrange(len(spot))
                inner = spot[key]
                if not isinstance(inner, dict | list) or not inner or rng.random() < 0.15:
                    break
                spot = inner
            if rng.random() < 0.3:
                del spot[key]
            else:
                spot[key] = rng.choice(BADLY)
            if not data:
                break
        try:
            plan_from_json(json.dumps(data))
        except InputError:
            refused += 1
    assert 700 < refused < 1500


def test_nothing_is_overwritten_without_asking(tmp_path: Path) -> None:
    file = tmp_path / "deep" / "plan.json"
    write_atomically(file, "one", overwrite=False)
    with pytest.raises(InputError, match="exists already"):
        write_atomically(file, "two", overwrite=False)
    assert file.read_text() == "one"
    write_atomically(file, b"three", overwrite=True)
    assert file.read_text() == "three"
    assert _names(file.parent) == ["plan.json"]
    assert file.stat().st_mode & 0o777 == 0o666 & ~files._umask()


@pytest.mark.parametrize("step", ["fsync", "replace", "chmod"])
def test_a_crash_leaves_the_old_file(tmp_path: Path, monkeypatch: pytest.MonkeyPatch, step: str) -> None:
    file = tmp_path / "plan.json"
    file.write_text("old")

    def crash(*_: object, **__: object) -> None:
        raise OSError(28, "No space left on device")

    monkeypatch.setattr(os, step, crash)
    with pytest.raises(InputError, match="cannot be written: No space left"):
        write_atomically(file, "new", overwrite=True)
    monkeypatch.undo()
    assert file.read_text() == "old"
    assert _names(tmp_path) == ["plan.json"]


def test_a_file_that_appears_meanwhile_is_kept(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    file = tmp_path / "plan.json"
    real = os.link

    def late(source: str, target: Path) -> None:
        target.write_text("theirs")
        real(source, target)

    monkeypatch.setattr(os, "link", late)
    with pytest.raises(InputError, match="exists already"):
        write_atomically(file, "mine", overwrite=False)
    assert file.read_text() == "theirs"
    assert _names(tmp_path) == ["plan.json"]


def test_an_interrupt_passes_and_leaves_nothing(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    def stop(*_: object) -> None:
        raise KeyboardInterrupt

    monkeypatch.setattr(os, "fsync", stop)
    with pytest.raises(KeyboardInterrupt):
        write_atomically(tmp_path / "plan.json", "x", overwrite=False)
    assert _names(tmp_path) == []


def test_places_that_cannot_be_written(tmp_path: Path) -> None:
    (tmp_path / "file").write_text("x")
    (tmp_path / "folder").mkdir()
    with pytest.raises(InputError, match="not a folder"):
        write_atomically(tmp_path / "file" / "plan.json", "x", overwrite=False)
    for overwrite in (True, False):
        with pytest.raises(InputError, match="is a folder"):
            write_atomically(tmp_path / "folder", "x", overwrite=overwrite)
    with pytest.raises(InputError, match="cannot be written"):
        write_atomically(tmp_path / "a\0b", "x", overwrite=True)
    with pytest.raises(InputError, match="cannot be written"):
        write_atomically(tmp_path / ("n" * 300), "x", overwrite=True)


@pytest.mark.skipif(os.geteuid() == 0, reason="root may do anything")
def test_a_folder_without_permission(tmp_path: Path) -> None:
    locked = tmp_path / "locked"
    locked.mkdir(mode=0o500)
    with pytest.raises(InputError, match="Permission denied"):
        write_atomically(locked / "plan.json", "x", overwrite=False)


def test_a_refusal_of_the_system_is_an_input_error(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    def refuse(*_: object, **__: object) -> None:
        raise PermissionError(13, "Permission denied")

    monkeypatch.setattr(tempfile, "mkstemp", refuse)
    with pytest.raises(InputError, match="cannot be written: Permission denied"):
        write_atomically(tmp_path / "plan.json", "x", overwrite=False)


def test_reading_is_limited(tmp_path: Path) -> None:
    file = tmp_path / "plan.json"
    with pytest.raises(InputError, match="does not exist"):
        load_plan(file)
    with pytest.raises(InputError, match="folder"):
        load_plan(tmp_path)
    file.write_bytes(b"\xef\xbb\xbfabcdef")
    assert read_text(file) == "abcdef"
    with pytest.raises(LimitError):
        read_bytes(file, 5)
    with pytest.raises(InputError, match="ordinary file"):
        read_bytes(Path("/dev/zero"), 5)
    with pytest.raises(InputError, match="cannot be read"):
        read_bytes(tmp_path / ("n" * 300))
