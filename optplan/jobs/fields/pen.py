"""A pen that writes down the segments of a field."""

from __future__ import annotations

import math
from dataclasses import dataclass, field
from itertools import pairwise
from typing import Any

import numpy as np

from optplan.domain.arrays import FloatArray
from optplan.domain.errors import InputError, LimitError
from optplan.domain.job import MOST_SEGMENTS, FieldSegment, turned

FOOT, YARD, INCH = 0.3048, 0.9144, 0.0254
"""m"""
MOST = 1000.0
"""Longest measure of any field, m."""
Place = tuple[float, float]


def fits(name: str, value: float, least: float, most: float) -> None:
    """InputError unless a measure, m, lies between these."""
    if not least <= value <= most:
        raise InputError(f"{name} is {value:g} m, which does not fit; expected {least:.4g}..{most:.4g} m")


@dataclass(frozen=True)
class Pen:
    """Draws around the middle of a field; a view of it may be mirrored and puts a name before its ids.

    Parameters
    ----------
    shift : added to every place, m
    x, y : 1, or -1 where the view is mirrored
    name : put before ids
    segments : what has been drawn, by all views
    """

    shift: Place = (0.0, 0.0)
    x: float = 1.0
    y: float = 1.0
    name: str = ""
    segments: list[FieldSegment] = field(default_factory=list)

    def side(self, name: str, x: float = 1.0, y: float = 1.0) -> Pen:
        """A view of the same field, mirrored where x or y is -1."""
        whole = f"{self.name} {name}".strip()
        return Pen(self.shift, self.x * x, self.y * y, whole, self.segments)

    def line(self, id: str, a: Place, b: Place, **more: Any) -> None:
        """A line from a to b; more: settings of the segment."""
        self._add(FieldSegment(self._id(id), self._at(a), self._at(b), **more))

    def lines(self, id: str, *corners: Place, **more: Any) -> None:
        """Lines from corner to corner."""
        for number, (a, b) in enumerate(pairwise(corners), start=1):
            self.line(id if len(corners) == 2 else f"{id} {number}", a, b, **more)

    def rectangle(self, id: str, low: Place, high: Place, **more: Any) -> None:
        """Four lines."""
        self.lines(id, low, (high[0], low[1]), high, (low[0], high[1]), low, **more)

    def arc(self, id: str, center: Place, radius: float, first: float, last: float, **more: Any) -> None:
        """An arc from one direction to another, degrees, counter-clockwise where the last is the larger one."""
        a = math.radians(first)
        start = self._at((center[0] + radius * math.cos(a), center[1] + radius * math.sin(a)))
        sweep = math.radians(last - first) * self.x * self.y
        middle = self._at(center)
        end = start if abs(last - first) == 360 else turned(start, middle, sweep)
        self._add(FieldSegment(self._id(id), start, end, middle, sweep, **more))

    def circle(self, id: str, center: Place, radius: float, **more: Any) -> None:
        """A full circle."""
        self.arc(id, center, radius, 0, 360, **more)

    def spot(self, id: str, at: Place, diameter: float, **more: Any) -> None:
        """A spot."""
        place = self._at(at)
        self._add(FieldSegment(self._id(id), place, place, spot=diameter, **more))

    def dashes(self, id: str, a: Place, b: Place, dash: float, gap: float, **more: Any) -> None:
        """A broken line that begins and ends with a dash; gaps give way a little so that it does."""
        step = np.array(b) - np.array(a)
        length = float(np.hypot(*step))
        if not (0 < dash <= length and gap >= 0):
            raise InputError(f"dashes of {dash:g} m, {gap:g} m apart, do not fit a line of {length:g} m")
        self._room_for((length + gap) / (dash + gap))
        count = max(1, round((length + gap) / (dash + gap)))
        pitch = (length - dash) / (count - 1) if count > 1 else 0.0
        for k in range(count):
            ends = [tuple((np.array(a) + step * s / length).tolist()) for s in (k * pitch, k * pitch + dash)]
            self.line(f"{id} {k + 1}", ends[0], ends[1], **more)

    def dashed_arc(
        self, id: str, center: Place, radius: float, first: float, last: float, dash: float, gap: float
    ) -> None:
        """A broken arc; dash and gap are measured along it, m."""
        per = math.degrees(1 / radius)
        span = abs(last - first)
        count = max(1, round((span + gap * per) / ((dash + gap) * per)))
        pitch = (span - dash * per) / (count - 1) if count > 1 else 0.0
        sign = math.copysign(1, last - first)
        for k in range(count):
            begin = first + sign * k * pitch
            self.arc(f"{id} {k + 1}", center, radius, begin, begin + sign * dash * per)

    def _id(self, id: str) -> str:
        return f"{self.name} {id}".strip()

    def _at(self, place: Place) -> FloatArray:
        return np.array([self.shift[0] + self.x * place[0], self.shift[1] + self.y * place[1]])

    def _room_for(self, more: float) -> None:
        if len(self.segments) + more > MOST_SEGMENTS:
            raise LimitError(f"these are more than {MOST_SEGMENTS} lines; expected fewer: longer dashes")

    def _add(self, segment: FieldSegment) -> None:
        self.segments.append(segment)


def ends(pen: Pen) -> tuple[Pen, Pen]:
    """Views of the two ends of a field, which mirror each other; both are drawn as the west one, x from -length / 2."""
    return pen.side("west"), pen.side("east", x=-1.0)


def corners(pen: Pen) -> tuple[Pen, ...]:
    """Views of the four corners, all drawn as the one in the south-west."""
    names = ("south-west", 1.0, 1.0), ("south-east", -1.0, 1.0), ("north-east", -1.0, -1.0), ("north-west", 1.0, -1.0)
    return tuple(pen.side(name, x, y) for name, x, y in names)
