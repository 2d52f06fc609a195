"""One progress callback that the command line, notebooks and the studio all use."""

from __future__ import annotations

import math
from collections.abc import Callable
from dataclasses import dataclass


@dataclass(frozen=True)
class Progress:
    """What a stage has reached.

    Parameters
    ----------
    stage : "read", "cover", "order", "connect", "time", "verify", "drive" or "animate"
    fraction : 0..1, or None where the end is not known
    cost : best cost so far (ordering; metres or seconds), infinite when there is none
    bound : proven lower bound so far, minus infinity when there is none
    message : a few words for people
    """

    stage: str
    fraction: float | None = None
    cost: float = math.inf
    bound: float = -math.inf
    message: str = ""


ProgressCallback = Callable[[Progress], None]


def silent(_: Progress) -> None:
    """The callback that does nothing."""
