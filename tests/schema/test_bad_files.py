"""Files that are wrong in unusual ways: one InputError each, and no waiting."""

from __future__ import annotations

import os
from pathlib import Path

import pytest

import optplan as op
from optplan.cli.settings import read_config
from optplan.domain.errors import InputError

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
