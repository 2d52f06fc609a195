"""Which strokes enclose which."""

from __future__ import annotations

from collections.abc import Sequence

from optplan.domain.stroke import Stroke
from optplan.geometry.regions import containment as _containment


def containment(strokes: Sequence[Stroke]) -> list[int]:
    """The containment tree of strokes: for each the index of the smallest closed one that wholly contains it, or -1."""
    return _containment([stroke.points[:, :2] for stroke in strokes], [stroke.closed for stroke in strokes])
