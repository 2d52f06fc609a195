"""A polyline made drivable: gentle vertices become tangent arcs, the others stay corners.

A drawn curve reaches us as a polyline with many gentle vertices. Taken literally it asks a robot to stop and turn at
each of them. The arc that touches both neighbouring segments restores the curve: with equal chords the arcs follow one
another without a gap, with the curve's own radius.
"""

from __future__ import annotations

import math
from typing import NamedTuple

import numpy as np

from optplan.domain.arrays import BoolArray, FloatArray

STRAIGHT = 1e-9
"""Deflection below which a vertex lies on a straight line, rad."""


class Vertices(NamedTuple):
    """What becomes of the inner vertices of a polyline; all arrays (k,)."""

    deflection: FloatArray
    """rad, left positive"""
    tangent: FloatArray
    """m that the arc takes from both neighbouring segments; 0 where there is none"""
    corner: BoolArray
    """whether it stays a corner"""


class Pieces(NamedTuple):
    """Lines, arcs, clothoids and turns in driving order; all arrays have one row a piece."""

    start: FloatArray
    """(n, 2) m"""
    heading: FloatArray
    """rad"""
    curvature: FloatArray
    """1/m, at the beginning"""
    length: FloatArray
    """m; 0 where the robot turns on the spot"""
    turn: FloatArray
    """rad turned on the spot"""
    sharpness: FloatArray
    """1/m^2, how the curvature grows along the piece"""

    @property
    def total(self) -> float:
        """m"""
        return float(self.length.sum())


def wrapped(angle: FloatArray) -> FloatArray:
    """Angles in (-pi, pi]."""
    inside: FloatArray = -((-angle + math.pi) % (2 * math.pi) - math.pi)
    return inside


def inner_vertices(points: FloatArray, closed: bool, tolerance: float, radius: float, corner: float) -> Vertices:
    """Decide which vertices are rounded.

    Parameters
    ----------
    points : (n, 2) m, consecutive ones apart
    closed : the last joins the first; then every vertex is an inner one (k = n), else all but the ends (k = n - 2)
    tolerance : greatest distance between the polyline and the rounded path, m
    radius : least radius of an arc, m
    corner : deflection above which a vertex stays a corner, rad
    """
    ring = np.concatenate([points[-1:], points, points[:1]]) if closed else points
    steps = np.diff(ring, axis=0)
    lengths = np.hypot(steps[:, 0], steps[:, 1])
    headings = np.arctan2(steps[:, 1], steps[:, 0])
    deflection = wrapped(np.diff(headings))
    size = np.abs(deflection)
    bent = size > STRAIGHT
    quarter = np.tan(np.where(bent, size, 1.0) / 4)
    # the arc of a vertex leaves it by tangent * tan(deflection / 4)
    tangent = np.minimum(np.minimum(lengths[:-1], lengths[1:]) / 2, tolerance / quarter)
    arc = tangent / np.tan(np.where(bent, size, 1.0) / 2)
    sharp = bent & ((size > corner) | (arc < radius * (1 - 1e-12)))
    return Vertices(deflection, np.where(bent & ~sharp, tangent, 0.0), sharp)


def rounded(points: FloatArray, tolerance: float, radius: float, corner: float) -> Pieces:
    """Lines, arcs and turns along an open polyline (a closed one repeats its first point at the end).

    Parameters are those of `inner_vertices`; points (n, 2), n >= 2.
    """
    vertices = inner_vertices(points, False, tolerance, radius, corner)
    steps = np.diff(points, axis=0)
    lengths = np.hypot(steps[:, 0], steps[:, 1])
    headings = np.arctan2(steps[:, 1], steps[:, 0])
    directions = steps / lengths[:, None]
    before = np.concatenate([[0.0], vertices.tangent])  # taken from the beginning of each segment
    after = np.concatenate([vertices.tangent, [0.0]])  # and from its end
    straight = lengths - before - after
    straight[straight < 1e-12 * lengths] = 0.0

    # every segment gives a line, every inner vertex an arc or a turn: interleave them
    count = 2 * len(steps) - 1
    start = np.empty((count, 2))
    heading = np.empty(count)
    curvature, length, turn = np.zeros(count), np.empty(count), np.zeros(count)
    start[0::2] = points[:-1] + before[:, None] * directions
    heading[0::2] = headings
    length[0::2] = straight
    start[1::2] = points[1:-1] - vertices.tangent[:, None] * directions[:-1]
    heading[1::2] = headings[:-1]
    is_arc = vertices.tangent > 0
    safe = np.where(is_arc, vertices.tangent, 1.0)
    bend = np.where(is_arc, np.tan(vertices.deflection / 2) / safe, 0.0)
    curvature[1::2] = bend
    length[1::2] = np.where(is_arc, np.abs(vertices.deflection) / np.where(is_arc, np.abs(bend), 1.0), 0.0)
    turn[1::2] = np.where(vertices.corner, vertices.deflection, 0.0)
    keep = (length > 0) | (turn != 0)
    return Pieces(start[keep], heading[keep], curvature[keep], length[keep], turn[keep], np.zeros(int(keep.sum())))
