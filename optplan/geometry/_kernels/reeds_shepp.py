"""Lengths of Reeds-Shepp paths, in compiled code."""

from __future__ import annotations

import math

import numpy as np

from optplan.compiled import njit
from optplan.domain.arrays import FloatArray
from optplan.geometry._kernels.cusps import COLUMNS, WORDS, arcs, cusp_words


@njit(
    "int64(float64[::1], float64[::1], float64, float64[::1], float64[:, ::1])",
    cache=True,
    nogil=True,
    error_model="numpy",
)
def shortest(start: FloatArray, end: FloatArray, radius: float, circles: FloatArray, words: FloatArray) -> int:
    """Fills words (WORDS, COLUMNS) between states x, y, heading, in radii; returns the row of the shortest."""
    c = math.cos(start[2])
    sn = math.sin(start[2])
    dx = (end[0] - start[0]) / radius
    dy = (end[1] - start[1]) / radius
    return cusp_words(c * dx + sn * dy, c * dy - sn * dx, end[2] - start[2], math.inf, circles, words)


@njit("float64[::1](float64[:, ::1], float64[:, ::1], float64)", cache=True, nogil=True, error_model="numpy")
def lengths(starts: FloatArray, ends: FloatArray, radius: float) -> FloatArray:
    """Lengths (k,) m between rows x, y, heading of (k, 3) arrays."""
    words, circles, out = np.empty((WORDS, COLUMNS)), arcs(), np.empty(len(starts))
    for i in range(len(starts)):
        out[i] = radius * words[shortest(starts[i], ends[i], radius, circles, words), 0]
    return out


@njit("void(float64[:, ::1], float64[:, ::1], float64, float64[:, ::1])", cache=True, nogil=True, error_model="numpy")
def matrix(exits: FloatArray, entries: FloatArray, radius: float, out: FloatArray) -> None:
    """Lengths (n, m) m from every exit (n, 3) to every entry (m, 3)."""
    words, circles = np.empty((WORDS, COLUMNS)), arcs()
    for i in range(len(exits)):
        for j in range(len(entries)):
            out[i, j] = radius * words[shortest(exits[i], entries[j], radius, circles, words), 0]
