"""Where lines and arcs meet."""

from __future__ import annotations

import math
from typing import NamedTuple

import numpy as np

from optplan.domain.arrays import FloatArray

FEW = 1e-12


class Primitive(NamedTuple):
    """A line or an arc."""

    start: FloatArray
    """(2,) m"""
    heading: float
    """rad, at the start"""
    curvature: float
    """1/m, left positive; 0 for a line"""
    length: float
    """m"""

    def at(self, s: FloatArray | float) -> FloatArray:
        """Points (..., 2) at arc lengths, m."""
        s = np.asarray(s, dtype=np.float64)
        half = self.curvature * s / 2
        chord = s * np.sinc(half / math.pi)
        angle = self.heading + half
        return self.start + np.stack([chord * np.cos(angle), chord * np.sin(angle)], axis=-1)

    def end_heading(self) -> float:
        """rad"""
        return self.heading + self.curvature * self.length

    def nearest(self, point: FloatArray) -> tuple[float, float]:
        """Arc length of the place nearest to a point, and its distance, m."""
        away = point - self.start
        forward, left = _turned(away, -self.heading)
        if self.curvature == 0:
            places = [forward]
        else:
            radius = 1 / self.curvature
            turn = math.atan2(forward / radius, (radius - left) / radius)
            around = 2 * math.pi * abs(radius)
            first = turn * radius % around
            places = [first, first - around]
        places = [min(max(place, 0.0), self.length) for place in places]
        apart = [float(np.linalg.norm(self.at(place) - point)) for place in places]
        best = int(np.argmin(apart))
        return places[best], apart[best]


def junctions(one: Primitive, other: Primitive, tolerance: float) -> list[float]:
    """Arc lengths (m) of one where the other meets it, within `tolerance` (m)."""
    points = [*crossing_points(one, other), other.at(0.0), other.at(other.length)]
    found: list[float] = []
    for point in points:
        place, apart = one.nearest(point)
        if apart <= tolerance and other.nearest(point)[1] <= tolerance:
            found.append(place)
    return found


def crossing_points(one: Primitive, other: Primitive) -> list[FloatArray]:
    """Points in which the whole lines and circles cross."""
    if one.curvature == 0 and other.curvature == 0:
        u, v = _unit(one.heading), _unit(other.heading)
        across = u[0] * v[1] - u[1] * v[0]
        if abs(across) < FEW:
            return []
        away = other.start - one.start
        return [one.start + u * (away[0] * v[1] - away[1] * v[0]) / across]
    if one.curvature == 0 or other.curvature == 0:
        line, circle = (one, other) if one.curvature == 0 else (other, one)
        centre, radius = _circle(circle)
        u = _unit(line.heading)
        foot = line.start + u * float(np.dot(centre - line.start, u))
        rest = radius**2 - float(np.dot(foot - centre, foot - centre))
        if rest < 0:
            return []
        return [foot + u * root for root in (math.sqrt(rest), -math.sqrt(rest))]
    (a, r), (b, q) = _circle(one), _circle(other)
    away = b - a
    distance = math.hypot(*away)
    if distance < FEW:
        return []
    along = (distance**2 + r**2 - q**2) / (2 * distance)
    rest = r**2 - along**2
    if rest < 0:
        return []
    u = away / distance
    side = np.array([-u[1], u[0]]) * math.sqrt(rest)
    return [a + u * along + side, a + u * along - side]


def _circle(arc: Primitive) -> tuple[FloatArray, float]:
    radius = 1 / arc.curvature
    centre = arc.start + radius * np.array([-math.sin(arc.heading), math.cos(arc.heading)])
    return centre, abs(radius)


def _unit(heading: float) -> FloatArray:
    return np.array([math.cos(heading), math.sin(heading)])


def _turned(vector: FloatArray, angle: float) -> tuple[float, float]:
    cosine, sine = math.cos(angle), math.sin(angle)
    return float(cosine * vector[0] - sine * vector[1]), float(sine * vector[0] + cosine * vector[1])
