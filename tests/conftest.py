"""Shared by all tests."""

from __future__ import annotations

import os
from pathlib import Path

# Compiled kernels stay in the project's folder, apart for each state of their sources (see optplan.compiled).
_FOLDER = Path(__file__).parent.parent / ".numba_cache"
os.environ.setdefault("XDG_CACHE_HOME", str(_FOLDER))
