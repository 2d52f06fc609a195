"""Where numba keeps its machine code.

numba looks only at the file of a function to see whether its cached code is fresh, not at the kernels that the function
calls: a changed kernel would leave its callers stale, and code from an older optplan could even fail to load. So the
cache folder is named by a hash of all kernel sources. `NUMBA_CACHE_DIR` wins where the user has set it.
"""

from __future__ import annotations

import hashlib
import os
from pathlib import Path


def kernel_sources() -> list[Path]:
    """Every compiled module: `_kernels.py` files, and modules in `_kernels` folders."""
    package = Path(__file__).parent
    return sorted([*package.rglob("_kernels.py"), *package.rglob("_kernels/*.py")])


def cache_key() -> str:
    """A hash of all kernel sources."""
    digest = hashlib.sha256()
    for source in kernel_sources():
        digest.update(str(source.relative_to(Path(__file__).parent)).encode() + source.read_bytes())
    return digest.hexdigest()[:16]


def _use_own_cache() -> None:
    import numba

    if os.environ.get("NUMBA_CACHE_DIR"):
        return
    try:
        home = Path(os.environ.get("XDG_CACHE_HOME") or Path.home() / ".cache")
        folder = home / "optplan" / f"kernels-{cache_key()}"
        folder.mkdir(parents=True, exist_ok=True)
    except (OSError, RuntimeError):  # a full or read-only disk, a user without a home
        return  # numba finds a place of its own
    if os.access(folder, os.W_OK):
        numba.config.CACHE_DIR = str(folder)  # type: ignore[attr-defined]


_use_own_cache()

from numba import njit  # noqa: E402 - only once the cache is in its place

__all__ = ["cache_key", "njit"]
