"""Evaluating paths of clothoid pieces."""

from __future__ import annotations

import math
from typing import NamedTuple

import numpy as np

from optplan.domain.arrays import FloatArray, IntArray
from optplan.domain.path import Path

_NODES, _WEIGHTS = np.polynomial.legendre.leggauss(12)
_PANEL = 1.0
"""Largest turning of the integrand within one Gauss panel, rad: 12 points then leave less than 1e-15 of the length."""


class States(NamedTuple):
    """Places along a path; arrays (k, ...)."""

    position: FloatArray
    """(k, 3) m"""
    heading: FloatArray
    """(k,) rad"""
    curvature: FloatArray
    """(k,) 1/m"""
    piece: IntArray
    """(k,) row of the path"""
    distance: FloatArray
    """(k,) m from the beginning of that row"""


def displacement(
    heading: FloatArray, curvature: FloatArray, sharpness: FloatArray, length: FloatArray
) -> tuple[FloatArray, FloatArray]:
    """Integrals of cos and sin of heading + curvature u + sharpness u^2 / 2 over 0..length; all arrays (k,), m.

    Lines and arcs are closed forms; clothoids are integrated by composite Gauss-Legendre.
    """
    half = curvature * length / 2
    chord = length * np.sinc(half / math.pi)
    dx, dy = chord * np.cos(heading + half), chord * np.sin(heading + half)
    for row in np.flatnonzero(sharpness != 0).tolist():
        swing = abs(curvature[row] * length[row]) + abs(sharpness[row]) * length[row] ** 2 / 2
        panels = max(1, math.ceil(swing / _PANEL))
        edges = np.linspace(0, length[row], panels + 1)
        width = length[row] / panels
        u = edges[:-1, None] + width * (_NODES + 1) / 2
        angle = heading[row] + u * (curvature[row] + u * sharpness[row] / 2)
        dx[row] = (np.cos(angle) @ _WEIGHTS).sum() * width / 2
        dy[row] = (np.sin(angle) @ _WEIGHTS).sum() * width / 2
    return dx, dy


def along(path: Path, piece: IntArray, distance: FloatArray) -> States:
    """States at a distance (k,) m from the beginning of pieces (k,)."""
    heading, curvature, sharpness = path.heading[piece], path.curvature[piece], path.sharpness[piece]
    flat = np.cos(path.elevation[piece])
    dx, dy = displacement(heading, curvature, sharpness, distance)
    offset = np.stack([dx * flat, dy * flat, distance * np.sin(path.elevation[piece])], axis=1)
    return States(
        path.start[piece] + offset,
        heading + distance * (curvature + distance * sharpness / 2),
        curvature + distance * sharpness,
        piece,
        distance,
    )


def ends(path: Path) -> States:
    """States at the end of every piece; a stop ends with its turn made."""
    states = along(path, np.arange(len(path)), path.length)
    return states._replace(heading=states.heading + path.turn)


def sampled(path: Path, spacing: float) -> States:
    """Equally spaced states: consecutive ones at most `spacing` (m) of arc length apart, every piece's ends included.

    Each piece is divided evenly; a stop gives one state before its turn. The last state is the end of the path.
    """
    if len(path) == 0:
        return States(np.zeros((0, 3)), np.zeros(0), np.zeros(0), np.zeros(0, dtype=np.int64), np.zeros(0))
    parts = np.maximum(1, np.ceil(path.length / spacing - 1e-9)).astype(np.int64)
    piece = np.repeat(np.arange(len(path)), parts)
    within = np.arange(len(piece)) - np.repeat(np.cumsum(parts) - parts, parts)
    states = along(path, piece, path.length[piece] * within / parts[piece])
    last = ends(path)
    return States(*(np.concatenate([column, final[-1:]]) for column, final in zip(states, last, strict=True)))
