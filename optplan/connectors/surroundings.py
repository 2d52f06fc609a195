"""Where a robot may drive: areas to keep in, areas to keep out of, and the clearance from both."""

from __future__ import annotations

import math
from dataclasses import dataclass
from functools import cached_property
from typing import TYPE_CHECKING

import numpy as np

from optplan.domain.arrays import FloatArray, frozen_floats
from optplan.domain.errors import InputError
from optplan.domain.options import Options
from optplan.domain.result import Cover
from optplan.geometry.curves import Curve, evaluate, sampled_curve

if TYPE_CHECKING:
    from shapely.geometry.base import BaseGeometry

ROUND = 16
"""Segments of a quarter circle in borders."""


@dataclass(frozen=True, eq=False)
class Surroundings:
    """Where a robot may drive.

    Parameters
    ----------
    keep_out : polygons (m, 2) m, m >= 3, not to be entered
    keep_in : a polygon (m, 2) m not to be left, or None
    clearance : distance kept from the borders of both, m

    Raises
    ------
    InputError : polygons that are none or cross themselves, a negative clearance
    """

    keep_out: tuple[FloatArray, ...] = ()
    keep_in: FloatArray | None = None
    clearance: float = 0.0

    def __post_init__(self) -> None:
        import shapely

        if not (math.isfinite(self.clearance) and self.clearance >= 0):
            raise InputError(f"the clearance is {self.clearance} m; expected a finite number, 0 or more")
        names = [f"keep-out polygon {k}" for k in range(len(self.keep_out))]
        polygons = [frozen_floats(ring, name, (None, 2)) for ring, name in zip(self.keep_out, names, strict=True)]
        object.__setattr__(self, "keep_out", tuple(polygons))
        if self.keep_in is not None:
            object.__setattr__(self, "keep_in", frozen_floats(self.keep_in, "keep-in polygon", (None, 2)))
            polygons, names = [*polygons, self.keep_in], [*names, "the keep-in polygon"]
        for ring, name in zip(polygons, names, strict=True):
            if len(ring) < 3:
                raise InputError(f"{name} has {len(ring)} vertices; expected 3 or more")
            polygon = shapely.Polygon(ring)
            if not polygon.is_valid or polygon.area == 0:
                raise InputError(f"{name} is no polygon: {shapely.is_valid_reason(polygon)}; expected no crossing")

    @cached_property
    def forbidden(self) -> BaseGeometry:
        """What the middle of the robot may not touch: everything nearer than the clearance to what is forbidden.

        Grown a little more than asked, as borders are polygons. A keep-in polygon leaves a frame around it.
        """
        import shapely

        # a polygon around a circle instead of in it
        reach = self.clearance / math.cos(math.pi / (4 * ROUND))
        parts = [shapely.Polygon(ring).buffer(reach, quad_segs=ROUND) for ring in self.keep_out]
        if self.keep_in is not None:
            inside = shapely.Polygon(self.keep_in)
            frame = inside.buffer(2 * reach + 1.0, join_style="mitre").envelope
            parts.append(frame.difference(inside.buffer(-reach, quad_segs=ROUND)))
        whole: BaseGeometry = shapely.union_all(parts)
        shapely.prepare(whole)
        return whole

    @cached_property
    def _room(self) -> BaseGeometry | None:
        """The inside of the keep-in polygon: outside its frame nothing is allowed either."""
        import shapely

        if self.keep_in is None:
            return None
        room = shapely.Polygon(self.keep_in)
        shapely.prepare(room)
        return room

    def clear(self, points: FloatArray) -> bool:
        """Whether a chain of chords (n, 2) keeps out of what is forbidden. Touching the border is keeping out."""
        import shapely

        line = shapely.LineString(points) if len(points) > 1 else shapely.Point(points[0])
        if self._room is not None and not shapely.covers(self._room, line):
            return False
        return not shapely.intersects(self.forbidden, line) or bool(shapely.touches(self.forbidden, line))

    def allows(self, curve: Curve, sag: float) -> bool:
        """Whether a curve keeps out, with chords that leave it by at most `sag`, m."""
        return self.clear(evaluate(curve, sampled_curve(curve, sag)).points)

    def connected(self, start: FloatArray, end: FloatArray) -> bool:
        """Whether a point could go from one place (2,) to the other at all."""
        import shapely

        places = np.array([start, end])
        if self.keep_in is not None:
            ground = shapely.Polygon(self.keep_in)
        else:
            low, high = np.array(self.forbidden.bounds).reshape(2, 2)
            low, high = np.minimum(low, places.min(axis=0)), np.maximum(high, places.max(axis=0))
            ground = shapely.box(*low, *high).buffer(1.0 + self.clearance, join_style="mitre")
        points = shapely.points(places)
        free = shapely.get_parts(ground.difference(self.forbidden))
        return any(bool((shapely.distance(part, points) <= 1e-9).all()) for part in free)


def surroundings_of(cover: Cover, options: Options) -> Surroundings | None:
    """What the options forbid; None when that is nothing.

    Raises
    ------
    InputError : areas that are none
    """
    asked = options.connect
    keep_in = None if asked.keep_in is None else np.array(asked.keep_in)
    if asked.on_canvas:
        if cover.canvas is None:
            raise InputError("connectors are to stay on the canvas, but there is none; expected a canvas or a polygon")
        if keep_in is not None:
            raise InputError("connectors are to stay on the canvas and in a polygon; expected one of them")
        width, height = cover.canvas.width, cover.canvas.height
        keep_in = np.array([[0, 0], [width, 0], [width, height], [0, height]], dtype=np.float64)
    if keep_in is None and not asked.keep_out:
        return None
    return Surroundings(tuple(np.array(ring) for ring in asked.keep_out), keep_in, asked.clearance)
