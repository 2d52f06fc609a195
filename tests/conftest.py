"""Shared by all tests."""

from __future__ import annotations

import hashlib
import os
from pathlib import Path

ROOT = Path(__file__).parent.parent


def kernel_sources() -> list[Path]:
    """Every compiled module: `_kernels.py` files, and modules in `_kernels` folders."""
    package = ROOT / "optplan"
    return sorted([*package.rglob("_kernels.py"), *package.rglob("_kernels/*.py")])


def _key() -> str:
    # numba looks at the file of a function only, not at the kernels it calls: a stale caller would survive
    digest = hashlib.sha256()
    for source in kernel_sources():
        digest.update(str(source.relative_to(ROOT)).encode() + source.read_bytes())
    return digest.hexdigest()[:16]


os.environ.setdefault("NUMBA_CACHE_DIR", str(ROOT / ".numba_cache" / _key()))
