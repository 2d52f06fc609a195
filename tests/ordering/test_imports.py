"""Heavy libraries are loaded when they are needed, not before."""

from __future__ import annotations

import subprocess
import sys


def test_the_registry_is_light() -> None:
    heavy = ("numba", "pyomo", "highspy", "scipy")
    code = f"import sys, optplan.ordering; print([m for m in {heavy} if m in sys.modules])"
    done = subprocess.run([sys.executable, "-c", code], capture_output=True, text=True, check=True)
    assert done.stdout.strip() == "[]"
