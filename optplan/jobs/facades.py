"""Facades from drawings: the largest polygon is the wall, what lies in it is not washed."""

from __future__ import annotations

from pathlib import Path
from typing import Any

import numpy as np

from optplan.domain.arrays import FloatArray
from optplan.domain.errors import InputError
from optplan.domain.facade import Facade, Wall
from optplan.domain.job import Drawing, Note
from optplan.geometry.flatten import flatten

TOLERANCE = 1e-3
"""m between a drawn curve and its polygon."""


def facade_of_drawing(drawing: Drawing, unit: float) -> Facade:
    """The facade that a drawing shows: closed paths, the largest the outline, the others no-go areas.

    Parameters
    ----------
    drawing : as it was read
    unit : metres of one drawing unit

    Raises
    ------
    InputError : an open path, no path, or polygons that lie beside the largest
    """
    rings = []
    for element in drawing.elements:
        for number, curve in enumerate(element.curves):
            name = element.id if len(element.curves) == 1 else f"{element.id}, part {number + 1}"
            if not curve.closed:
                raise InputError("is open; expected closed outlines of the wall and its no-go areas", name)
            scale = unit / drawing.unit
            rings.append((name, flatten(curve, TOLERANCE / scale) * scale))
    return facade_of_rings(drawing.name, rings, drawing.notes)


def facade_of_rings(name: str, rings: list[tuple[str, FloatArray]], notes: tuple[Note, ...] = ()) -> Facade:
    """The facade of named polygons (n, 2), m: the largest is the outline, its lower left corner becomes (0, 0).

    Raises InputError when there is none, or one lies beside the largest.
    """
    if not rings:
        raise InputError("holds no closed outline; expected a polygon around the wall, and others in it", name)
    sizes = [float(np.prod(np.ptp(ring, axis=0))) for _, ring in rings]
    outer = int(np.argmax(sizes))
    outline = rings[outer][1]
    low = outline.min(axis=0)
    for number, (id, ring) in enumerate(rings):
        beside = (ring.max(axis=0) <= outline.min(axis=0)) | (ring.min(axis=0) >= outline.max(axis=0))
        if number != outer and beside.any():
            raise InputError(f"lies beside the largest outline, {rings[outer][0]!r}; expected one wall a file", id)
    holes = tuple(ring - low for number, (_, ring) in enumerate(rings) if number != outer)
    return Facade(name, (Wall("wall", outline - low, holes),), notes=notes)


def read_dxf(file: Path, unit: float | None) -> Facade:
    """The facade of a DXF file: closed polylines, circles and splines of its model space.

    Parameters
    ----------
    file : to be read with ezdxf, the extra `dxf`
    unit : metres of one drawing unit; None: as the file says, else metres

    Raises
    ------
    InputError : no such file, no DXF, ezdxf is not installed, or an open outline
    """
    try:
        import ezdxf
        from ezdxf import units
        from ezdxf.path import make_path
    except ImportError:
        raise InputError("cannot be read without ezdxf: pip install optplan[dxf]", str(file)) from None
    if not file.is_file():
        raise InputError("does not exist; expected a DXF file", str(file))
    notes: list[Note] = []
    convert: Any = units.conversion_factor
    try:
        document: Any = ezdxf.readfile(file)  # type: ignore[attr-defined]
        space = document.modelspace()
        stated: Any = document.header.get("$INSUNITS", 0)
        factor = unit if unit is not None else convert(stated, units.M) if stated else 1.0
        rings: list[tuple[str, FloatArray]] = []
        other: dict[str, int] = {}
        for entity in space:
            kind = entity.dxftype()
            if kind not in ("LWPOLYLINE", "POLYLINE", "CIRCLE", "ELLIPSE", "SPLINE"):
                other[kind] = other.get(kind, 0) + 1
                continue
            name = f"{kind} {entity.dxf.handle} on layer {entity.dxf.layer}"
            path = make_path(entity)
            points = np.array([(p.x, p.y) for p in path.flattening(TOLERANCE / factor)]) * factor
            if not (path.is_closed or np.abs(points[0] - points[-1]).max() <= TOLERANCE):
                raise InputError("is open; expected closed outlines of the wall and its no-go areas", name)
            keep = np.append(True, np.abs(np.diff(points, axis=0)).max(axis=1) > 1e-9)
            points = points[keep]
            rings.append((name, points[:-1] if np.abs(points[0] - points[-1]).max() <= TOLERANCE else points))
    except InputError as error:
        raise InputError(error.problem, f"{file}: {error.where}") from None
    except Exception as error:  # a broken file makes the library raise anything
        raise InputError(f"is no DXF file that can be read: {error!r:.200}", str(file)) from None
    notes += [Note("ignored", "", f"{kind}: no closed outline", count) for kind, count in sorted(other.items())]
    if unit is None and not stated:
        notes.append(Note("notice", "", "states no unit: read as metres"))
    return facade_of_rings(file.stem, rings, tuple(notes))
