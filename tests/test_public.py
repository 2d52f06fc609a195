"""What `import optplan` offers, and what it costs."""

from __future__ import annotations

import importlib
import json
import math
import subprocess
import sys
from pathlib import Path

import pytest

import optplan as op
from optplan.compare import load_case
from optplan.domain.errors import InputError
from optplan.domain.job import Drawing, Facade, Field
from optplan.instances import instance, instance_names

PACKAGE = Path(op.__file__).parent


def test_every_public_name_is_there() -> None:
    assert sorted(op.__all__) == sorted(op._HOMES)
    for name, home in op._HOMES.items():
        thing = getattr(op, name)
        assert thing is getattr(importlib.import_module(home), name)
        assert thing.__doc__, name
        assert name in dir(op)
    with pytest.raises(AttributeError, match="no attribute 'nonsense'"):
        op.nonsense  # noqa: B018


def test_no_public_name_is_a_module() -> None:
    modules = {path.stem for path in PACKAGE.iterdir() if path.is_dir() or path.suffix == ".py"}
    assert "robots" in modules
    assert not modules & set(op._HOMES)


def test_type_checkers_see_the_same_names() -> None:
    source = (PACKAGE / "__init__.py").read_text()
    for name, home in op._HOMES.items():
        assert f"    from {home} import {name} as {name}\n" in source


def test_importing_costs_nothing() -> None:
    program = "import sys; before = set(sys.modules); import optplan, json; print(json.dumps([*sys.modules]))"
    done = subprocess.run([sys.executable, "-c", program], capture_output=True, text=True, check=True)
    loaded = {name.split(".")[0] for name in json.loads(done.stdout)}
    assert "optplan" in loaded
    heavy = {
        "numpy",
        "scipy",
        "shapely",
        "numba",
        "pydantic",
        "matplotlib",
        "pyomo",
        "highspy",
        "lxml",
        "typer",
        "rich",
    }
    assert not loaded & heavy
    assert [name for name in json.loads(done.stdout) if name.startswith("optplan.")] == []


def test_instances_are_found_by_both_names() -> None:
    names = instance_names()
    assert len(names) >= 8
    assert list(names) == sorted(set(names))
    for name in names:
        file = instance(name)
        assert file.exists()
        assert instance(name.split("/")[1]) == file
        if name.startswith("drawings/"):
            assert isinstance(op.read(file), Drawing)
        elif name.startswith("fields/"):
            assert isinstance(op.read(file), Field)
        elif name.startswith("facades/"):
            assert isinstance(op.read(file), Facade)
        else:
            assert math.isfinite(load_case(name).best_known)


@pytest.mark.parametrize("name", ["", "nothing", "drawings", "drawings/", "../pyproject", "drawings/lion.svg"])
def test_unknown_instances(name: str) -> None:
    with pytest.raises(InputError, match="expected one of drawings/"):
        instance(name)
