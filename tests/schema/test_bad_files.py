"""Files that are wrong in unusual ways: one InputError each, and no waiting."""

from __future__ import annotations

import os
from pathlib import Path

import pytest

import optplan as op
from optplan.cli.settings import read_config
from optplan.domain.arrays import frozen_floats, frozen_ints
from optplan.domain.errors import InputError
from optplan.schema.files import write_atomically

HUGE = "9" * 400
ENDLESS = "9" * 5000


@pytest.mark.parametrize(
    ("text", "said"),
    [
        ('{"version": ' + ENDLESS + "}", "is not JSON"),
        ('{"version": "1.' + ENDLESS + '"}', "version is"),
        ('{"version": "1.²"}', "version is"),
        ("[" * 100_000, "is not JSON"),
        ('{"format": "optplan plan", "version": "1.0", "robot": {"canvas": {"width": ' + HUGE + "}}}", "width"),
        ('{"version": "1.0", "job": 1, "ordering": {"nodes": [' + HUGE + "]}}", "job"),
    ],
)
def test_a_broken_plan_file_is_one_input_error(tmp_path: Path, text: str, said: str) -> None:
    file = tmp_path / "plan.json"
    file.write_text(text)
    with pytest.raises(InputError, match=said):
        op.load_plan(file)


@pytest.mark.parametrize("text", ["a = " + ENDLESS, "a = " + "[" * 100_000])
def test_a_broken_toml_file_is_one_input_error(tmp_path: Path, text: str) -> None:
    file = tmp_path / "robot.toml"
    file.write_text(text)
    for read in (op.load_robot, read_config):
        with pytest.raises(InputError, match="is not TOML"):
            read(file)


def test_a_pipe_is_refused_at_once(tmp_path: Path) -> None:
    for name in ("plan.json", "robot.toml"):
        os.mkfifo(tmp_path / name)
    for read, name in ((op.load_plan, "plan.json"), (op.read, "plan.json"), (op.load_robot, "robot.toml")):
        with pytest.raises(InputError, match="not an ordinary file"):
            read(tmp_path / name)


@pytest.mark.parametrize("value", [10**30, 1e31, "x", [[1], [2, 3]]])
def test_arrays_refuse_what_is_no_number_of_theirs(value: object) -> None:
    for freeze in (frozen_floats, frozen_ints):
        with pytest.raises(InputError):
            freeze([value, 10**400] if value == 10**30 else [value, 1], "numbers", (2,))


def test_a_file_name_that_cannot_be_is_an_input_error() -> None:
    with pytest.raises(InputError, match="cannot be written"):
        write_atomically(Path("a\0b"), "", overwrite=True)
