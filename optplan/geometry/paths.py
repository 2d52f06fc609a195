"""Evaluating paths of clothoid pieces."""

from __future__ import annotations

from typing import NamedTuple

import numpy as np

from optplan.domain.arrays import FloatArray, IntArray
from optplan.domain.path import Path
from optplan.geometry.clothoids import clothoid_displacement


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


def along(path: Path, piece: IntArray, distance: FloatArray) -> States:
    """States at a distance (k,) m from the beginning of pieces (k,)."""
    heading, curvature, sharpness = path.heading[piece], path.curvature[piece], path.sharpness[piece]
    flat = np.cos(path.elevation[piece])
    dx, dy = clothoid_displacement(heading, curvature, sharpness, distance)
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
