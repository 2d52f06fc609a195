"""Facades from drawings: the largest polygon is the wall, what lies in it is not washed."""

from __future__ import annotations

from typing import NamedTuple

import numpy as np

from optplan.domain.arrays import FloatArray
from optplan.domain.errors import InputError
from optplan.domain.facade import Facade, Wall
from optplan.domain.job import Drawing, Note
from optplan.geometry.flatten import flatten

TOLERANCE = 1e-3
"""m between a drawn curve and its polygon."""


LARGEST = 300.0
"""m; a drawing without a unit whose wall is larger has another unit than metres."""


def facade_of_drawing(drawing: Drawing, unit: float | None) -> Facade:
    """The facade that a drawing shows: closed paths, the largest the outline, the others no-go areas.

    Parameters
    ----------
    drawing : as it was read
    unit : metres of one drawing unit; None: metres

    Raises
    ------
    InputError : an open path, no path, polygons that lie beside the largest, or a wall too large for metres
    """
    rings = []
    for element in drawing.elements:
        for number, curve in enumerate(element.curves):
            name = element.id if len(element.curves) == 1 else f"{element.id}, part {number + 1}"
            if not curve.closed:
                raise InputError("is open; expected closed outlines of the wall and its no-go areas", name)
            scale = (unit or 1.0) / drawing.unit
            rings.append((name, flatten(curve, TOLERANCE / scale) * scale))
    return facade_of_rings(drawing.name, rings, drawing.notes, stated=unit is not None)


class Frame(NamedTuple):
    """Where the plane of a drawing is in space."""

    origin: FloatArray
    """(3,) m, where its (0, 0) is"""
    across: FloatArray
    up: FloatArray
    """(3,) unit vectors"""


def facade_of_rings(
    name: str,
    rings: list[tuple[str, FloatArray]],
    notes: tuple[Note, ...] = (),
    frame: Frame | None = None,
    *,
    stated: bool = True,
) -> Facade:
    """The facade of named polygons (n, 2), m: the largest is the outline, its lower left corner becomes (0, 0).

    Parameters
    ----------
    frame : where they are; None: the corner is at (0, 0, 0)
    stated : whether the unit is known; else a wall of more than LARGEST is refused

    Raises
    ------
    InputError : there is none, one lies beside the largest, or it is too large for its unit
    """
    if not rings:
        ignored = ", ".join(f"{note.times} {note.text}" for note in notes if note.kind == "ignored")
        told = f" (ignored: {ignored})" if ignored else ""
        raise InputError(f"holds no closed outline{told}; expected a polygon around the wall, and others in it")
    sizes = [float(np.prod(np.ptp(ring, axis=0))) for _, ring in rings]
    outer = int(np.argmax(sizes))
    outline = rings[outer][1]
    size = np.ptp(outline, axis=0)
    if not stated and size.max() > LARGEST:
        raise InputError(
            f"the wall is {size[0]:g} x {size[1]:g} m in metres, which no unit says; expected --unit 1mm, or what it is"
        )
    low = outline.min(axis=0)
    for number, (id, ring) in enumerate(rings):
        beside = (ring.max(axis=0) <= outline.min(axis=0)) | (ring.min(axis=0) >= outline.max(axis=0))
        if number != outer and beside.any():
            raise InputError(f"lies beside the largest outline, {rings[outer][0]!r}; expected one wall a file", id)
    holes = tuple(ring - low for number, (_, ring) in enumerate(rings) if number != outer)
    if frame is None:
        return Facade(name, (Wall("wall", outline - low, holes),), notes=notes)
    origin, across, up = frame
    corner = origin + low[0] * across + low[1] * up
    return Facade(name, (Wall("wall", outline - low, holes, None, corner, across, up),), notes=notes)
