"""Facades from DXF files: closed outlines in the plane of the drawing, or in any other plane."""

from __future__ import annotations

import math
from collections import Counter
from collections.abc import Iterator
from pathlib import Path
from typing import Any

import numpy as np

from optplan.domain.arrays import FloatArray
from optplan.domain.errors import InputError, LimitError, located
from optplan.domain.facade import Facade
from optplan.domain.job import Note
from optplan.jobs.facades import TOLERANCE, Frame, facade_of_rings

KINDS = ("LWPOLYLINE", "POLYLINE", "CIRCLE", "ELLIPSE", "SPLINE")
"""Entities that may be closed outlines."""
DEEPEST = 8
"""Blocks in blocks."""
MOST_ENTITIES = 20_000
FLAT = 2e-3
"""m that corners may be off their wall's plane."""
LEVEL = math.radians(80)
"""A plane that leans back by more is no wall."""

Ring = tuple[str, FloatArray]


def read_dxf(file: Path, unit: float | None) -> Facade:
    """The facade of a DXF file: closed polylines, circles and splines of its model space, and of blocks in it.

    What lies in x-y is a drawing of the wall. What lies in another plane is the wall itself: its corners run against
    the clock, seen from outside.

    Parameters
    ----------
    file : to be read with ezdxf, the extra `dxf`
    unit : metres of one drawing unit; None: as the file says, else metres

    Raises
    ------
    InputError : no such file, no DXF, ezdxf is not installed, an open outline, or outlines in no common plane
    LimitError : more than MOST_ENTITIES
    """
    try:
        import ezdxf
        from ezdxf import units
    except ImportError:
        raise InputError("cannot be read without ezdxf: pip install optplan[dxf]", str(file)) from None
    if not file.is_file():
        raise InputError("does not exist; expected a DXF file", str(file))
    convert: Any = units.conversion_factor
    with located(str(file)):
        try:
            document: Any = ezdxf.readfile(file)  # type: ignore[attr-defined]
            stated: Any = document.header.get("$INSUNITS", 0)
            factor = unit if unit is not None else convert(stated, units.M) if stated else 1.0
            rings, notes = _rings(document, factor)
        except InputError:
            raise
        except Exception as error:  # a broken file makes the library raise anything
            raise InputError(f"is no DXF file that can be read: {error!r:.200}") from None
        if unit is None and not stated:
            notes.append(Note("notice", "", "states no unit: read as metres"))
        known = unit is not None or bool(stated)
        if not rings or max(float(np.ptp(ring[:, 2])) for _, ring in rings) <= FLAT:
            level = [(name, ring[:, :2]) for name, ring in rings]
            return facade_of_rings(file.stem, level, tuple(notes), stated=known)
        frame, flat = _in_plane(rings)
        text = "lies in space: its outside is where its corners run against the clock"
        notes.append(Note("notice", max(rings, key=lambda ring: _doubled(ring[1]))[0], text))
        return facade_of_rings(file.stem, flat, tuple(notes), frame, stated=known)


def _rings(document: Any, factor: float) -> tuple[list[Ring], list[Note]]:
    """Closed outlines (n, 3) m by name, and what was left out."""
    from ezdxf.path import make_path

    rings: list[Ring] = []
    hidden = {layer.dxf.name.lower() for layer in document.layers if layer.is_off() or layer.is_frozen()}
    other: Counter[str] = Counter()
    count = 0
    for entity, layer in _entities(document.modelspace(), 0, ""):
        count += 1
        if count > MOST_ENTITIES:
            raise LimitError(f"has more than {MOST_ENTITIES} entities, those of its blocks included")
        kind = entity.dxftype()
        if layer.lower() in hidden or entity.dxf.get("invisible", 0):
            other[f"{kind}: hidden, on layer {layer}"] += 1
            continue
        if kind not in KINDS:
            other[f"{kind}: no closed outline"] += 1
            continue
        handle = f" {entity.dxf.handle}" if entity.dxf.handle else " of a block"
        name = f"{kind}{handle} on layer {layer}"
        path = make_path(entity)
        points = np.array([tuple(p) for p in path.flattening(TOLERANCE / factor)]).reshape(-1, 3) * factor
        if not np.isfinite(points).all():
            raise InputError("has a coordinate that is no finite number", name)
        if len(points) == 0 or not (path.is_closed or np.abs(points[0] - points[-1]).max() <= TOLERANCE):
            raise InputError("is open; expected closed outlines of the wall and its no-go areas", name)
        keep = np.append(True, np.abs(np.diff(points, axis=0)).max(axis=1) > 1e-9)
        points = points[keep]
        rings.append((name, points[:-1] if np.abs(points[0] - points[-1]).max() <= TOLERANCE else points))
    return rings, [Note("ignored", "", text, times) for text, times in sorted(other.items())]


def _entities(source: Any, depth: int, outer: str) -> Iterator[tuple[Any, str]]:
    """Entities and the layers that they are on, those of blocks where these are inserted."""
    if depth > DEEPEST:
        raise LimitError(f"has blocks in blocks more than {DEEPEST} deep")
    for entity in source:
        # what is on layer 0 of a block is on the layer of its insertion
        layer = outer if outer and entity.dxf.layer == "0" else entity.dxf.layer
        if entity.dxftype() != "INSERT":
            yield entity, layer
            continue
        for one in entity.multi_insert() if entity.mcount > 1 else [entity]:
            yield from _entities(one.virtual_entities(), depth + 1, layer)


def _doubled(ring: FloatArray) -> float:
    """Twice the area of a polygon (n, 3), m2."""
    return float(np.linalg.norm(_newell(ring)))


def _newell(ring: FloatArray) -> FloatArray:
    """(3,) m2, twice the area, along the normal around which the corners run against the clock."""
    apart = ring - ring.mean(axis=0)
    total: FloatArray = np.cross(apart, np.roll(apart, -1, axis=0)).sum(axis=0)
    return total


def _in_plane(rings: list[Ring]) -> tuple[Frame, list[Ring]]:
    """The plane of the largest outline, and all of them (n, 2) in it. Raises InputError with the one that is not."""
    outer, largest = max(rings, key=lambda ring: _doubled(ring[1]))
    area = _newell(largest)
    if not area.any():
        raise InputError("encloses no area; expected an outline of the wall", outer)
    normal, centre = area / np.linalg.norm(area), largest.mean(axis=0)
    for name, ring in rings:
        off = np.abs((ring - centre) @ normal)
        if off.max() > FLAT:
            x, y, z = ring[int(np.argmax(off))].tolist()
            where = "its own plane" if name == outer else f"the plane of {outer}"
            raise InputError(
                f"its corner ({x:g}, {y:g}, {z:g}) m is {off.max():.3g} m off {where}; expected one flat wall a file",
                name,
            )
    if abs(math.asin(float(np.clip(normal[2], -1, 1)))) > LEVEL:
        raise InputError("lies nearly level; expected a wall, or its drawing in x-y", outer)
    up = np.array([0.0, 0.0, 1.0]) - normal[2] * normal
    up /= np.linalg.norm(up)
    frame = Frame(centre, np.cross(up, normal), up)
    return frame, [(name, (ring - centre) @ np.column_stack([frame.across, frame.up])) for name, ring in rings]
