"""A building seen from above: what a lift with its stand-off has to travel around, and where it fits before a wall."""

from __future__ import annotations

import itertools
from typing import Any

import numpy as np

from optplan.domain.arrays import FloatArray
from optplan.domain.facade import Facade
from optplan.geometry.visibility import Ways
from optplan.geometry.walls import lifted, places, vertices_of

SAME = 1e-9
"""m: places nearer than this are one."""
ROUGH = 0.3
"""m by which a ground plan may differ from its walls."""
SPARE = 1.5
"""Times what walls lie within it where that is looked at: between these places, and at corners, it may be more."""
HAIR = 1e-6
"""m that the ends of a stretch keep from what ends it: on the border the last digit decides."""


def plan_in_space(job: Facade, number: int) -> FloatArray:
    """(k, 2) m, the plan of a wall seen from above."""
    wall = job.walls[number]
    _at, plan = vertices_of(wall)
    if wall.plan is None:
        low, high = float(wall.outline[:, 0].min()), float(wall.outline[:, 0].max())
        plan = np.array([[low, 0.0], [high, 0.0]])
    return lifted(wall, plan, np.zeros(len(plan)))[:, :2]


def ways_around(job: Facade, away: float) -> Ways:
    """Ways around the ground plan and every wall, `away` m before them. Raises LimitError for too many corners."""
    import shapely

    lines = [plan_in_space(job, k) for k in range(len(job.walls))]
    parts = [shapely.LineString(line).buffer(away, cap_style="flat", join_style="mitre") for line in lines if away > 0]
    ring = np.concatenate(lines) if job.building is None else job.building
    apart = np.append(True, np.linalg.norm(np.diff(ring, axis=0), axis=1) > SAME)
    if apart.sum() >= 3:
        # where measured walls pass each other by a little, loops of the ring are none of the building
        ground = shapely.make_valid(shapely.Polygon(ring[apart]))
        behind = _behind(ground, lines)
        if behind > SAME:
            ground = ground.buffer(-behind, join_style="mitre")
        parts.append(ground.buffer(away, join_style="mitre") if away > 0 else ground)
    return Ways(shapely.union_all(parts))


def _behind(ground: Any, lines: list[FloatArray]) -> float:
    """How far walls lie within a ground plan that was measured roughly, m, with something to spare."""
    import shapely

    share = np.linspace(0.1, 0.9, 9)[:, None]
    points = [a + share * (b - a) for line in lines for a, b in itertools.pairwise(line)]
    places = shapely.points(np.concatenate(points))
    depth = shapely.distance(ground.boundary, places)[shapely.contains_properly(ground, places)]
    # walls further inside are no walls of its outside
    return SPARE * float(depth[depth <= ROUGH].max(initial=0.0))


Span = tuple[float, float]


def open_spans(job: Facade, number: int, around: Ways, away: float, low: float, high: float) -> list[Span]:
    """Stretches of x on a wall, from low to high, before which a lift `away` m from the wall is in nobody's way.

    around : of `ways_around`, with the same distance
    """
    import shapely

    wall = job.walls[number]
    at, _ = vertices_of(wall)
    cuts = [low, *(x for x in at[1:-1].tolist() if low < x < high), high]
    found: list[Span] = []
    for a, b in itertools.pairwise(cuts):
        # a hair inside: on a vertex two sides of the plan meet
        ends = np.array([[a + SAME * (b - a), 0.0], [b - SAME * (b - a), 0.0]])
        feet = places(wall, ends, away)[:, :2]
        size = float(np.linalg.norm(feet[1] - feet[0]))
        free = shapely.difference(shapely.LineString(feet), around.inner)
        for part in shapely.get_parts(free):
            along = np.linalg.norm(shapely.get_coordinates(part) - feet[0], axis=1) / max(size, SAME) * (b - a)
            begin, end = a + float(along.min()), a + float(along.max())
            if found and begin - found[-1][1] <= HAIR:
                found[-1] = (found[-1][0], end)
            elif end - begin > 2 * HAIR:
                found.append((begin, end))
    return [(a + HAIR if a > low + HAIR else low, b - HAIR if b < high - HAIR else high) for a, b in found]
