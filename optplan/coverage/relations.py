"""Rules between strokes: what must come before what, and what must follow directly."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np

from optplan.coverage.nesting import containment
from optplan.domain.arrays import FloatArray
from optplan.domain.errors import InputError
from optplan.domain.options import Link
from optplan.domain.stroke import Stroke

NEAR = 1e-6
"""m within which a vertex of a stroke is the drawn one."""


def inner_before_outer(strokes: Sequence[Stroke]) -> list[tuple[int, int]]:
    """Pairs of strokes: whatever a closed stroke encloses comes before it."""
    return [(inner, outer) for inner, outer in enumerate(containment(strokes)) if outer >= 0]


def of_pieces(pairs: Sequence[tuple[int, int]], source: Sequence[int]) -> list[tuple[int, int]]:
    """The same rules between the pieces that strokes were cut into: source[k] is the stroke that piece k is of."""
    pieces: dict[int, list[int]] = {}
    for piece, stroke in enumerate(source):
        pieces.setdefault(stroke, []).append(piece)
    return [(a, b) for before, after in pairs for a in pieces[before] for b in pieces[after]]


def connections(
    links: Sequence[Link], strokes: Sequence[Stroke], drawn: dict[str, FloatArray]
) -> tuple[tuple[int, int, int, int], ...]:
    """Enforced connections as stroke, vertex, stroke, vertex.

    Parameters
    ----------
    links : asked for, by the ids of strokes and the numbers of drawn vertices
    strokes : the strokes, pieces "id~1", "id~2", ... of strokes that were split among them
    drawn : (k, 2) m, the vertices with which a stroke was drawn, by its id; others have the vertices of their points

    Raises
    ------
    InputError : a stroke or vertex that does not exist, or at which the stroke can be neither entered nor left
    """
    return tuple((*_end(a, i, strokes, drawn), *_end(b, j, strokes, drawn)) for a, i, b, j in links)


def _end(id: str, number: int, strokes: Sequence[Stroke], drawn: dict[str, FloatArray]) -> tuple[int, int]:
    """The stroke and its vertex that a drawn vertex is."""
    own = [k for k, stroke in enumerate(strokes) if stroke.id == id or stroke.id.startswith(f"{id}~")]
    if not own:
        names = ", ".join(stroke.id for stroke in strokes[:8]) + (", ..." if len(strokes) > 8 else "")
        raise InputError(f"there is no stroke {id!r}; expected one of {names}", "link")
    vertices = drawn.get(id, strokes[own[0]].points[:, :2])
    if not -len(vertices) <= number < len(vertices):
        raise InputError(
            f"stroke {id!r} has no vertex {number}; expected 0..{len(vertices) - 1}, or -1 for the last", "link"
        )
    for k in own:
        distances = np.linalg.norm(strokes[k].points[:, :2] - vertices[number], axis=1)
        vertex = int(distances.argmin())
        if distances[vertex] <= NEAR and (strokes[k].closed or vertex in (0, len(distances) - 1)):
            return k, vertex
    raise InputError(
        f"stroke {id!r} can be neither entered nor left at vertex {number}; an open one only at its ends", "link"
    )
