"""Few circles that wash all of an area: patterns, circles left out one by one, and a model that proves the fewest."""

from __future__ import annotations

import math
from typing import Any, NamedTuple

import numpy as np
from scipy.sparse import csr_array

from optplan.coverage.patterns import PATTERNS, Laid, placements
from optplan.coverage.room import Room
from optplan.domain.arrays import FloatArray, IntArray
from optplan.domain.errors import InputError, LimitError
from optplan.domain.washing import WashOptions
from optplan.geometry.arrangements import MARGIN, STEP, Faces, faces_of, without_supersets

TRIED = 24
"""Placements of a pattern whose circles are left out one by one."""
MIXED = 5
"""Placements whose circles are the candidates of the exact model."""
ROUND = 256
"""Corners of a quarter circle where what is left bare is measured."""
MAX_STOPS = 3000
"""Most circles of one wall."""


class Circles(NamedTuple):
    """Circles that wash an area."""

    centres: FloatArray
    """(n, 2) m"""
    laid: Laid
    """the pattern that they began with"""
    candidates: int
    """positions from which they were chosen"""
    bound: int
    """no fewer of these positions do; 0: not known"""


def fewest_circles(area: Any, radius: float, options: WashOptions, room: Room | None = None) -> Circles:
    """Circles of this radius (m) that wash an area (shapely), chosen as the options say.

    room : where their centres may be; None: anywhere

    Raises
    ------
    LimitError : more than MAX_STOPS are needed
    InputError : a part of the area is out of reach from the room
    """
    room = room or Room()
    least = area.area / (1.5 * math.sqrt(3) * radius**2)
    if least > MAX_STOPS:
        raise LimitError(
            f"circles of {radius:g} m are too small: {area.area:g} m2 need {least:.0f} or more; at most {MAX_STOPS}"
        )
    size = radius * (1 - MARGIN)
    alone = _alone(area, size, room)
    if alone is not None:
        return alone
    patterns = PATTERNS if options.pattern == "best" else (options.pattern,)
    border = room.along_its_border(area, size)
    made = (one for name in patterns for one in placements(area, size, name, turned=options.turned))
    laid = sorted((_within(one, room, border) for one in made), key=lambda one: len(one.centres))
    tried = [(one, faces_of(area, one.centres, size)) for one in laid[: TRIED if options.fewest != "pattern" else 1]]
    if room != Room():
        _refuse_bare(tried[0][1], room)
    if options.fewest == "pattern":
        one, faces = tried[0]
        used = np.unique(faces.member.indices)
        return Circles(one.centres[used], one, len(one.centres), 0)
    kept = [without_redundant(faces) for _, faces in tried]
    order = sorted(range(len(tried)), key=lambda k: (len(kept[k]), tried[k][0].turn != 0))
    best = order[0]
    found = Circles(tried[best][0].centres[kept[best]], tried[best][0], len(tried[best][0].centres), 0)
    if options.fewest == "minimal":
        return found
    mixed = [tried[best][0].centres]
    cells = {tried[best][0][1:2] + tried[best][0].cell}
    for k in order[1:]:  # patterns that differ have more to offer than one pattern moved a little
        kind = tried[k][0][1:2] + tried[k][0].cell
        if kind not in cells and len(mixed) < MIXED:
            cells.add(kind)
            mixed.append(tried[k][0].centres)
    return _exact(area, np.concatenate(mixed), kept[best], found.laid, size, options.effort)


def bare_parts(area: Any, centres: FloatArray, radius: float) -> tuple[float, FloatArray] | None:
    """What circles leave of an area: m2, and the middle (2,) of the largest part; None where they wash all of it."""
    import shapely

    faces = faces_of(area, centres, radius)
    bare = faces.points[np.diff(faces.member.indptr) == 0]
    if len(bare) == 0:
        return None
    discs = shapely.union_all(shapely.buffer(shapely.points(centres), radius, quad_segs=ROUND))
    parts = shapely.get_parts(area.difference(discs))
    # only parts that really are there: discs are polygons here
    near = shapely.distance(parts[:, None], shapely.points(bare)[None]).min(axis=1) <= STEP * radius
    if not near.any():
        return None
    largest = max(parts[near], key=lambda part: part.area)
    return float(shapely.area(parts[near]).sum()), shapely.get_coordinates(largest.representative_point())[0]


def _alone(area: Any, size: float, room: Room) -> Circles | None:
    """One circle that washes everything, where one does."""
    import shapely

    around = shapely.minimum_bounding_circle(area)
    centre = room.nearest(shapely.get_coordinates(around.centroid))
    if not (np.hypot(*(shapely.get_coordinates(area) - centre).T) <= size).all():
        return None
    return Circles(centre, Laid("one circle", 0.0, (0.0, 0.0), centre), 1, 1)


def _within(laid: Laid, room: Room, border: FloatArray) -> Laid:
    """A pattern whose centres are moved into the room, with those on its border that make up for it.

    A centre that moves straight up to a line below the whole area comes nearer to all of the area, and washes no less
    of it.
    """
    moved = room.nearest(laid.centres)
    if len(border) == 0 and np.array_equal(moved, laid.centres):
        return laid
    centres = np.concatenate([moved, border])
    _, first = np.unique(np.round(centres, 9), axis=0, return_index=True)
    return laid._replace(centres=centres[np.sort(first)])


def _refuse_bare(faces: Faces, room: Room) -> None:
    """Raises InputError with a place that no circle from the room reaches."""
    bare = np.flatnonzero(np.diff(faces.member.indptr) == 0)
    if len(bare):
        x, y = faces.points[bare[0]].tolist()
        near = room.nearest(faces.points[bare[:1]])[0]
        raise InputError(
            f"the wall is out of reach at ({x:.3g}, {y:.3g}): the nearest stop that is above the ground, and its "
            f"stand-off away from other walls at an inner corner, is at ({near[0]:.3g}, {near[1]:.3g}); expected a "
            "longer reach, a smaller stand-off, or a no-go area there"
        )


def without_redundant(faces: Faces) -> IntArray:
    """Circles (k,) that are left when, one by one, those are left out whose faces are all washed by others.

    What wash least comes first. The result is minimal: without any one of its circles something stays unwashed.
    """
    member = faces.member.tocsc()
    counts = np.asarray(faces.member.sum(axis=1)).ravel().astype(np.int64)
    held = np.diff(member.indptr)
    kept = []
    for circle in np.argsort(held, kind="stable").tolist():
        rows = member.indices[member.indptr[circle] : member.indptr[circle + 1]]
        if len(rows) and counts[rows].min() < 2:
            kept.append(circle)
        else:
            counts[rows] -= 1
    return np.array(sorted(kept), dtype=np.int64)


def _exact(area: Any, candidates: FloatArray, known: IntArray, laid: Laid, size: float, seconds: float) -> Circles:
    """The fewest of the candidates (n, 2) by the set-cover model, at most those already known (k,)."""
    faces = faces_of(area, candidates, size)
    chosen, bound = fewest_members(faces.member, known, seconds)
    return Circles(candidates[chosen], laid, len(candidates), bound)


def fewest_members(member: csr_array, known: IntArray, seconds: float) -> tuple[IntArray, int]:
    """The fewest columns that hold every row, and a bound of their number.

    Parameters
    ----------
    member : (m, n) 0 or 1
    known : (k,) columns that do
    seconds : for HiGHS
    """
    from optplan_models import cover_sets, highs

    rows = without_supersets(member)
    held = member[rows]
    sets = [held.indices[held.indptr[i] : held.indptr[i + 1]].astype(np.int64) for i in range(len(rows))]
    model = cover_sets.build(sets, member.shape[1])
    cover_sets.set_chosen(model, known)
    compiled = highs.compile_model(model)
    start = highs.start_values(compiled)
    # whole numbers: a bound of 24.01 is one of 25
    result = highs.run(compiled, seconds=seconds, start=start, options={"mip_abs_gap": 0.999})
    bound = max(math.ceil(result.bound - 1e-6), 0) if math.isfinite(result.bound) else 0
    if result.values is None or result.objective > len(known) - 0.5:
        return known, min(bound, len(known))
    highs.load_values(compiled, result.values)
    chosen = cover_sets.chosen_of(model)
    return chosen, min(bound, len(chosen))
