"""Logos and lettering on a field: outlines of a drawing as lines and arcs."""

from __future__ import annotations

import math
from dataclasses import replace
from pathlib import Path

import numpy as np

from optplan.domain.arrays import FloatArray
from optplan.domain.errors import InputError, LimitError
from optplan.domain.job import Drawing, Field, FieldSegment, Note, turned

TOLERANCE = 0.005
"""Between a drawn curve and the arcs that stand for it, m."""
MAX_SEGMENTS = 3000
"""Of one logo."""
WIDEST = 1000.0
"""Of one logo, m."""


def with_logo(field: Field, file: Path, middle: tuple[float, float], width: float, turn: float = 0.0) -> Field:
    """A field with the outlines of a drawing around a place.

    Parameters
    ----------
    field : what it is put on
    file : the drawing (.svg); colours and fills mean nothing here, and a note says so; its own notes are kept
    middle : of the logo, m
    width : of the logo before it is turned, m
    turn : rad

    Raises
    ------
    InputError : no drawing, nothing in it that can be seen at this width, a width that is not above 0 or beyond
        `WIDEST`, or more than `MAX_SEGMENTS` lines and arcs
    """
    from optplan.jobs.reading import read

    job = read(file)
    if not isinstance(job, Drawing):
        raise InputError("is no drawing; expected an SVG file", str(file))
    if not 0 < width <= WIDEST:
        raise InputError(f"the logo's width is {width} m; expected more than 0, at most {WIDEST:g} m", str(file))
    curves = [(element.id, curve) for element in job.elements for curve in element.curves]
    if not curves:
        raise InputError("holds no lines", str(file))
    places = np.concatenate([curve.points for _, curve in curves])
    low, high = places.min(axis=0), places.max(axis=0)
    size = high - low
    scale = width / float(size[0] if size[0] > 0 else size[1])
    cosine, sine = math.cos(turn), math.sin(turn)
    matrix = scale * np.array([[cosine, sine], [-sine, cosine]])

    name = file.stem
    segments: list[FieldSegment] = []
    for number, (id, curve) in enumerate(curves, start=1):
        placed = replace(
            curve,
            points=(curve.points - (low + high) / 2) @ matrix + np.array(middle),
            handles=None if curve.handles is None else (curve.handles - (low + high) / 2) @ matrix + np.array(middle),
        )
        segments += _segments(f"{name} {number} {id}", _line(placed))
        if len(segments) > MAX_SEGMENTS:
            raise LimitError(f"has more than {MAX_SEGMENTS} lines and arcs; simplify it", str(file))
    if not segments:
        raise InputError(f"nothing of it is longer than {TOLERANCE:g} m when it is {width:g} m wide", str(file))
    taken = {segment.id for segment in field.segments}
    copy = 1
    while any(segment.id in taken for segment in segments):
        copy += 1
        segments = [replace(segment, id=f"{copy}/{segment.id.removeprefix(f'{copy - 1}/')}") for segment in segments]
    note = Note("notice", name, "is marked by its outlines; colours, widths and fills are left out")
    # two logos of one file say the same
    notes = tuple(dict.fromkeys((*field.notes, *job.notes, note)))
    return replace(field, segments=(*field.segments, *segments), notes=notes)


def _line(curve: object) -> FloatArray:
    from optplan.domain.job import Curve
    from optplan.geometry.flatten import flatten

    assert isinstance(curve, Curve)
    points = flatten(curve, TOLERANCE / 5)
    ring = np.concatenate([points, points[:1]]) if curve.closed else points
    keep = np.concatenate([[True], np.linalg.norm(np.diff(ring, axis=0), axis=1) > TOLERANCE / 5])
    kept: FloatArray = ring[keep]
    return kept


def _segments(name: str, line: FloatArray) -> list[FieldSegment]:
    """Lines and arcs along a polyline, each as long as it stays within the tolerance."""
    made: list[FieldSegment] = []
    at = 0
    while at < len(line) - 1:
        end, arc = _longest(line, at)
        id = f"{name}.{len(made) + 1}"
        if arc is None:
            made.append(FieldSegment(id, line[at], line[end]))
        else:
            center, sweep = arc
            made.append(FieldSegment(id, line[at], turned(line[at], center, sweep), center, sweep))
        at = end
    return made


def _longest(line: FloatArray, at: int) -> tuple[int, tuple[FloatArray, float] | None]:
    """The farthest vertex that one line or arc from this one reaches, doubling and halving the step."""
    best = at + 1
    found: tuple[FloatArray, float] | None = None
    step = 2
    while at + step < len(line):
        good, arc = _fits(line[at : at + step + 1])
        if not good:
            break
        best, found = at + step, arc
        step *= 2
    low, high = best, min(at + step, len(line) - 1)
    while high - low > 1:
        middle = (low + high) // 2
        good, arc = _fits(line[at : middle + 1])
        if not good:
            high = middle
        else:
            low, best, found = middle, middle, arc
    return best, found


def _fits(points: FloatArray) -> tuple[bool, tuple[FloatArray, float] | None]:
    """Whether a line (None) or an arc (centre, sweep) stands for these points, and which."""
    a, b = points[0], points[-1]
    chord = b - a
    length = float(np.linalg.norm(chord))
    if length <= TOLERANCE:
        return False, None
    normal = np.array([-chord[1], chord[0]]) / length
    aside = (points - a) @ normal
    if np.abs(aside).max() <= TOLERANCE:
        along = (points - a) @ chord
        return bool((np.diff(along) > 0).all()), None
    middle = points[len(points) // 2]
    # the circle through both ends and a vertex between
    u, v = float((middle - a) @ chord / length), float((middle - a) @ normal)
    if abs(v) < 1e-12:
        return False, None
    height = (u * u + v * v - u * length) / (2 * v)
    center = a + chord / 2 + normal * height
    radius = float(np.linalg.norm(a - center))
    if np.abs(np.linalg.norm(points - center, axis=1) - radius).max() > TOLERANCE:
        return False, None
    angles = np.unwrap(np.arctan2(*(points - center).T[::-1]))
    turns = np.diff(angles)
    if not ((turns > 0).all() or (turns < 0).all()) or abs(angles[-1] - angles[0]) > 1.5 * math.pi:
        return False, None
    # chords between the points must not stray from the arc either
    if (radius * (1 - np.cos(turns / 2))).max() > TOLERANCE:
        return False, None
    return True, (center, float(angles[-1] - angles[0]))
