"""The judge shares no code with what it judges, and loads nothing heavy before it is asked."""

from __future__ import annotations

import ast
import subprocess
import sys
from pathlib import Path

import pytest

import optplan.judge

FILES = sorted(Path(optplan.judge.__file__).parent.glob("**/*.py"))
ALLOWED = ("optplan.domain", "optplan.judge", "numpy", "scipy", "shapely")


def imported(source: str) -> set[str]:
    """Names of the modules that a source text imports, wherever in it."""
    names: set[str] = set()
    for node in ast.walk(ast.parse(source)):
        if isinstance(node, ast.Import):
            names |= {alias.name for alias in node.names}
        elif isinstance(node, ast.ImportFrom):
            names.add("." * node.level + (node.module or ""))
    return names


@pytest.mark.parametrize("file", FILES, ids=lambda file: file.name)
def test_imports_nothing_of_the_planners(file: Path) -> None:
    for name in imported(file.read_text()):
        own = any(name == allowed or name.startswith(allowed + ".") for allowed in ALLOWED)
        assert own or name.split(".")[0] in sys.stdlib_module_names, name


def test_shapely_is_not_loaded_before_it_is_needed() -> None:
    code = "import sys, optplan.judge; sys.exit('shapely' in sys.modules or 'scipy' in sys.modules)"
    subprocess.run([sys.executable, "-c", code], check=True, timeout=60)
