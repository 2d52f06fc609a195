"""How a facade is washed: the settings of covering it and of the order of its stops."""

from __future__ import annotations

import math
from dataclasses import dataclass

from optplan.domain.arrays import MAX_NUMBER
from optplan.domain.errors import InputError

PATTERNS = ("best", "hexagon", "square", "brick", "stretched")
FEWEST = ("exact", "minimal", "pattern")
RULES = ("overlap", "rows", "none")
DIRECTIONS = ("up", "down")
TRAVELS = ("straight", "around", "lift")


@dataclass(frozen=True)
class WashOptions:
    """How a facade is covered with stops and what the water asks of their order.

    Parameters
    ----------
    pattern : of the circles: "hexagon", "square", "brick" (a square one, rows shifted), "stretched" (rows
        nearer to or further from each other as it fits the wall), or "best": fewest circles
    fewest : "pattern" leaves out circles that wash nothing; "minimal" also, one by one, those whose part others wash;
        "exact" asks a set-cover model for the fewest of its candidate positions
    turned : whether patterns may be turned: fewer circles at times, but without level rows the water asks for more way
    effort : s for the exact model
    tolerance : m; the cover stays complete when every stop is off by up to this
    rule : "overlap": a circle after the lower ones beside it; "rows": row after row, as published; "none"
    direction : "up": from bottom to top, or "down"
    tau, width : of the rule, in radii; None: the job's
    horizontal : weight of horizontal metres in the costs of an order; above 1 it favours going straight up
    travel : how the robot passes no-go areas: "straight" across, "around", or "lift": at a distance from the wall
    lift : that distance, m beyond the stand-off
    """

    pattern: str = "best"
    fewest: str = "exact"
    turned: bool = False
    effort: float = 5.0
    tolerance: float = 0.0
    rule: str = "overlap"
    direction: str = "up"
    tau: float | None = None
    width: float | None = None
    horizontal: float = 1.0
    travel: str = "straight"
    lift: float = 1.0

    def __post_init__(self) -> None:
        for name, known in (
            *(("pattern", PATTERNS), ("fewest", FEWEST), ("rule", RULES)),
            *(("direction", DIRECTIONS), ("travel", TRAVELS)),
        ):
            if getattr(self, name) not in known:
                raise InputError(f"wash {name} is {getattr(self, name)!r}; expected one of {', '.join(known)}")
        if not isinstance(self.turned, bool):
            raise InputError(f"wash turned is {self.turned!r}; expected true or false")
        for name in ("effort", "horizontal", "lift"):
            value = getattr(self, name)
            if isinstance(value, bool) or not (1e-6 <= value <= MAX_NUMBER):
                raise InputError(f"wash {name} is {value}; expected a finite number above 0")
        if isinstance(self.tolerance, bool) or not 0 <= self.tolerance <= MAX_NUMBER:
            raise InputError(f"wash tolerance is {self.tolerance} m; expected 0 or more")
        for name in ("tau", "width"):
            value = getattr(self, name)
            if value is not None and not math.isfinite(value):
                raise InputError(f"wash {name} is {value}; expected a finite number of radii")
