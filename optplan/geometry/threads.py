"""Long work by rows, in threads: kernels run without Python's lock."""

from __future__ import annotations

from collections.abc import Callable
from concurrent.futures import ThreadPoolExecutor


def by_rows(
    fill: Callable[[slice], None], count: int, each: int, threads: int | None, told: Callable[[float], None] | None
) -> None:
    """Call `fill` for slices of `each` rows until all of `count` are done.

    `told` is called with the share that is done; what it raises ends the work.
    """
    pool = ThreadPoolExecutor(threads)
    try:
        slices = [slice(i, i + each) for i in range(0, count, each)]
        for done, _ in enumerate(pool.map(fill, slices), start=1):
            if told is not None:
                told(done / len(slices))
    finally:
        # after a cancel, slices that have not begun are dropped
        pool.shutdown(wait=True, cancel_futures=True)
