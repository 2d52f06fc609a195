"""Settings of all tests."""

from __future__ import annotations

import os
from pathlib import Path

from hypothesis import settings

# Compiled kernels stay in the project's folder, apart for each state of their sources (see optplan.compiled).
os.environ.setdefault("XDG_CACHE_HOME", str(Path(__file__).parent.parent / ".numba_cache"))

# Hypothesis draws the same examples every time.
settings.register_profile("repeatable", derandomize=True, deadline=None, max_examples=60, database=None)
settings.load_profile("repeatable")
