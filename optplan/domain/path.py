"""What is driven: a chain of pieces, and the same with speed."""

from __future__ import annotations

from dataclasses import dataclass, field

import numpy as np

from optplan.domain.arrays import BoolArray, FloatArray, IntArray, frozen_floats, frozen_ints
from optplan.domain.errors import InputError

RAISED = 0
"""Index of the raised tool setting, of every tool."""


@dataclass(frozen=True, eq=False)
class Path:
    """Pieces in driving order, one a row.

    Headings and curvatures are those of the direction of travel: where the gear is -1 the robot drives backwards, its
    body points the other way, and its wheels too are turned the other way. A cusp is where the gear changes.

    A row of positive length is a clothoid: its curvature grows linearly, so lines and arcs are clothoids too; with an
    elevation it is a straight line in space. A row of length 0 is a stop: the robot turns on the spot, or works there.

    Parameters
    ----------
    start : (n, 3) m, where the piece begins (z is 0 in the plane)
    heading : (n,) rad, direction at its beginning
    elevation : (n,) rad, of the direction above the plane; 0 where curvature or sharpness is not
    curvature : (n,) 1/m at its beginning, left positive
    sharpness : (n,) 1/m^2, dkappa/ds
    length : (n,) m; 0 for a stop
    turn : (n,) rad turned on the spot during a stop, left positive; 0 elsewhere
    dwell : (n,) s worked during a stop, besides the turn; 0 elsewhere
    tool : (n,) index of the tool setting; 0 is raised
    stroke : (n,) index of the stroke being driven; -1 between strokes
    orientation : (n, 2, 4) unit quaternions (w, x, y, z) of the tool at both ends of each piece, or None
    gear : (n,) 1 forwards, -1 backwards; empty: all forwards

    Raises
    ------
    InputError : anything of that violated
    """

    start: FloatArray
    heading: FloatArray
    elevation: FloatArray
    curvature: FloatArray
    sharpness: FloatArray
    length: FloatArray
    turn: FloatArray
    dwell: FloatArray
    tool: IntArray
    stroke: IntArray
    orientation: FloatArray | None = None
    gear: IntArray = field(default_factory=lambda: np.zeros(0, dtype=np.int64))

    def __post_init__(self) -> None:
        count = len(self.length)
        object.__setattr__(self, "start", frozen_floats(self.start, "path start", (count, 3)))
        for name in ("heading", "elevation", "curvature", "sharpness", "length", "turn", "dwell"):
            object.__setattr__(self, name, frozen_floats(getattr(self, name), f"path {name}", (count,)))
        for name in ("tool", "stroke"):
            object.__setattr__(self, name, frozen_ints(getattr(self, name), f"path {name}", (count,)))
        gear = self.gear if len(self.gear) else np.ones(count, dtype=np.int64)
        object.__setattr__(self, "gear", frozen_ints(gear, "path gear", (count,)))
        if (np.abs(self.gear) != 1).any():
            raise InputError("a path piece has a gear that is neither 1 (forwards) nor -1 (backwards)")
        if (self.length < 0).any() or (self.dwell < 0).any():
            raise InputError("a path piece has a negative length or dwell time")
        moving = self.length > 0
        if (moving & ((self.turn != 0) | (self.dwell != 0))).any():
            raise InputError("a path piece both moves and stops; expected a length or a stop")
        if ((self.elevation != 0) & ((self.curvature != 0) | (self.sharpness != 0))).any():
            raise InputError("a path piece in space is curved; expected a straight one")
        if (self.tool < 0).any() or (self.stroke < -1).any():
            raise InputError("a path piece names a negative tool setting or stroke")
        if self.orientation is not None:
            object.__setattr__(self, "orientation", frozen_floats(self.orientation, "orientation", (count, 2, 4)))

    def __len__(self) -> int:
        return len(self.length)

    @property
    def is_stop(self) -> BoolArray:
        """(n,) bool: rows at which the robot stands."""
        stops: BoolArray = self.length == 0
        return stops

    @property
    def cusps(self) -> IntArray:
        """(c,) rows of pieces driven in another gear than the last piece before them."""
        moving = np.flatnonzero(self.length > 0)
        rows: IntArray = moving[1:][np.diff(self.gear[moving]) != 0]
        return rows

    @property
    def offsets(self) -> FloatArray:
        """(n + 1,) arc length at the beginning of every piece, and the total at the end, m."""
        return np.concatenate([[0.0], np.cumsum(self.length)])


@dataclass(frozen=True, eq=False)
class Trajectory:
    """A path with its speed profile. Between knots the acceleration along the path is constant.

    Parameters
    ----------
    path : what is driven
    s, t, v : (k,) arc length m, time s and speed m/s at the knots; s and t never decrease. A stop is two knots at the
        same place with speed 0. A knot lies at the beginning and end of every piece.
    """

    path: Path
    s: FloatArray
    t: FloatArray
    v: FloatArray

    def __post_init__(self) -> None:
        count = len(self.s)
        for name in ("s", "t", "v"):
            object.__setattr__(self, name, frozen_floats(getattr(self, name), f"trajectory {name}", (count,)))
        if (np.diff(self.s) < 0).any() or (np.diff(self.t) < 0).any() or (self.v < 0).any():
            raise InputError("a trajectory runs backwards: s and t may not decrease, v may not be negative")

    @property
    def duration(self) -> float:
        """Total time, s."""
        return float(self.t[-1] - self.t[0]) if len(self.t) else 0.0
