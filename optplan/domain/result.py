"""A plan: everything from the job to the report, as far as it has been made."""

from __future__ import annotations

import math
from dataclasses import dataclass

from optplan.domain.arrays import FloatArray, frozen_floats
from optplan.domain.errors import InputError
from optplan.domain.job import Job, Note
from optplan.domain.options import Options
from optplan.domain.ordering import Ordering
from optplan.domain.path import Path, Trajectory
from optplan.domain.report import Report
from optplan.domain.robot import Canvas, Robot
from optplan.domain.stroke import Stroke, Traversals


@dataclass(frozen=True, eq=False)
class Area:
    """An area to fill.

    Parameters
    ----------
    element : id of the element it came from
    rings : (n, 2) m each, not repeating the first point: the outline counter-clockwise, then the holes clockwise
    tool : index of the tool setting that fills it
    """

    element: str
    rings: tuple[FloatArray, ...]
    tool: int

    def __post_init__(self) -> None:
        rings = tuple(frozen_floats(ring, f"area {self.element!r} ring", (None, 2)) for ring in self.rings)
        object.__setattr__(self, "rings", rings)


@dataclass(frozen=True, eq=False)
class Cover:
    """What has to be driven, and what the result has to look like.

    Parameters
    ----------
    strokes : all of them; the planners order and drive these
    areas : what is to be filled; the judge holds the coverage against it
    precedence : pairs of stroke indices: the first before the second
    start : (x, y) m where the job says to begin, or None
    canvas : the canvas used, or None
    notes : what happened on the way: small areas lost, gaps closed ...
    links : enforced connections: stroke, vertex, stroke, vertex; the one is left and the other entered there, or the
        other way round, with nothing in between
    radii : m, of the circle that each stop washes; none where strokes are lines
    elsewhere : strokes of the job that other plans do: other robots of a fleet, or what was done before
    """

    strokes: tuple[Stroke, ...]
    areas: tuple[Area, ...] = ()
    precedence: tuple[tuple[int, int], ...] = ()
    start: tuple[float, float] | None = None
    canvas: Canvas | None = None
    notes: tuple[Note, ...] = ()
    links: tuple[tuple[int, int, int, int], ...] = ()
    radii: tuple[float, ...] = ()
    elsewhere: tuple[Stroke, ...] = ()

    def __post_init__(self) -> None:
        if len(self.radii) not in (0, len(self.strokes)) or not all(math.isfinite(r) and r > 0 for r in self.radii):
            raise InputError(f"{len(self.radii)} radii for {len(self.strokes)} stops; expected one each, above 0")
        ids = [stroke.id for stroke in self.strokes]
        if len(set(ids)) != len(ids):
            raise InputError("two strokes share an id")
        for link in self.links:
            for k, vertex in (link[:2], link[2:]):
                if 0 <= k < len(self.strokes) and not 0 <= vertex < len(self.strokes[k].points):
                    raise InputError(f"an enforced connection names vertex {vertex} of stroke {ids[k]!r}")


@dataclass(frozen=True, eq=False)
class Plan:
    """A plan, complete up to its last section that is not None.

    Parameters
    ----------
    job, robot, options : what was asked
    cover : strokes, from `optplan.cover`
    ordering : the solver's answer
    visits : the chosen traversals in driving order
    path : what is driven
    trajectory : the same with speed
    report : the judge's findings
    """

    job: Job
    robot: Robot
    options: Options
    cover: Cover | None = None
    ordering: Ordering | None = None
    visits: Traversals | None = None
    path: Path | None = None
    trajectory: Trajectory | None = None
    report: Report | None = None
