"""Fields moved, turned, mirrored and scaled; put between two measured points; tied to a place on earth."""

from __future__ import annotations

import math
from dataclasses import replace

import numpy as np

from optplan.domain.arrays import FloatArray
from optplan.domain.errors import InputError
from optplan.domain.job import Anchor, Field, FieldSegment, Note

Place = tuple[float, float]


def placed(
    field: Field, at: Place = (0.0, 0.0), turn: float = 0.0, scale: float = 1.0, mirrored: bool = False
) -> Field:
    """A field mirrored at its y axis, scaled, turned about its origin (rad), and moved so that this lies at `at` (m).

    Line widths stay as they are; an anchor is dropped, as it holds for the field as it was.

    Raises
    ------
    InputError : a scale that is not above 0, or numbers that are not finite
    """
    if not (math.isfinite(scale) and scale > 0):
        raise InputError(f"the scale is {scale}; expected a finite number above 0")
    if not all(math.isfinite(value) for value in (*at, turn)):
        raise InputError(f"a field cannot be moved by {at} m and turned by {turn} rad; expected finite numbers")
    cosine, sine = math.cos(turn), math.sin(turn)
    side = -1.0 if mirrored else 1.0
    matrix = scale * np.array([[cosine, -sine], [sine, cosine]]) @ np.diag([side, 1.0])
    shift = np.array(at)

    def moved(points: FloatArray) -> FloatArray:
        made: FloatArray = points @ matrix.T + shift
        return made

    def segment(old: FieldSegment) -> FieldSegment:
        center = None if old.center is None else moved(old.center)
        start, end = moved(old.start), moved(old.end)
        return replace(old, start=start, end=end, center=center, sweep=side * old.sweep, spot=old.spot)

    start = None if field.start is None else tuple(moved(np.array(field.start)).tolist())
    return replace(
        field,
        segments=tuple(map(segment, field.segments)),
        keep_in=None if field.keep_in is None else moved(field.keep_in),
        keep_out=tuple(map(moved, field.keep_out)),
        start=start,
        anchor=None,
    )


def aligned(field: Field, own: tuple[Place, Place], measured: tuple[Place, Place], *, scaled: bool = False) -> Field:
    """A field moved and turned so that two of its own points come to lie where they were measured.

    Where the two pairs are not equally far apart, the middles and directions agree, and a note says by how much the
    points miss; `scaled` stretches the field instead.

    Raises
    ------
    InputError : two points in one place
    """
    a, b = (np.array(point, dtype=np.float64) for point in own)
    p, q = (np.array(point, dtype=np.float64) for point in measured)
    before, after = float(np.linalg.norm(b - a)), float(np.linalg.norm(q - p))
    if not (before > 0 and after > 0):
        raise InputError("the two points of an alignment coincide; expected points apart")
    turn = math.atan2(q[1] - p[1], q[0] - p[0]) - math.atan2(b[1] - a[1], b[0] - a[0])
    scale = after / before if scaled else 1.0
    cosine, sine = math.cos(turn), math.sin(turn)
    middle = scale * np.array([[cosine, -sine], [sine, cosine]]) @ (a + b) / 2
    shift = (p + q) / 2 - middle
    made = placed(field, (float(shift[0]), float(shift[1])), turn, scale)
    missed = abs(after - scale * before) / 2
    if missed > 1e-3:
        text = f"the measured points are {after:.3f} m apart, the field's {before:.3f} m: each misses by {missed:.3f} m"
        made = replace(made, notes=(*made.notes, Note("notice", field.name, text)))
    return made


def anchored(field: Field, latitude: float, longitude: float, bearing: float = 0.0) -> Field:
    """A field whose origin lies at a place on earth (WGS 84, degrees), its y axis pointing `bearing` degrees clockwise
    from north. Raises InputError for a place that is none."""
    return replace(field, anchor=Anchor(latitude, longitude, bearing))


def joined(name: str, *fields: Field) -> Field:
    """Several fields as one job; each segment's id begins with the number of its field. Raises InputError for none."""
    if not fields:
        raise InputError("no fields to join; expected at least one")
    widths = {field.line_width for field in fields}
    segments = [
        replace(s, id=f"{k} {s.id}", width=s.width if len(widths) == 1 else s.width or field.line_width)
        for k, field in enumerate(fields, start=1)
        for s in field.segments
    ]
    return replace(
        fields[0],
        name=name,
        segments=tuple(segments),
        keep_out=tuple(ring for field in fields for ring in field.keep_out),
        notes=tuple(note for field in fields for note in field.notes),
        line_width=fields[0].line_width if len(widths) == 1 else None,
    )
