"""The shortest path of continuous curvature, one or many, in compiled code.

Everything is scaled by the curvature limit (see `spiral`), seen from the start's frame, solved by `cc_full` and
`cc_reference`, and scaled back.
"""

from __future__ import annotations

import math

import numpy as np

from optplan.compiled import njit
from optplan.domain.arrays import FloatArray
from optplan.geometry._kernels.cc_full import full_words, middle_table
from optplan.geometry._kernels.cc_reference import TTT, S, T, reference_word, turn_pieces, turn_table
from optplan.geometry._kernels.cc_words import word_pieces
from optplan.geometry._kernels.clothoid import clothoid_end
from optplan.geometry._kernels.spiral import spiral_table

REFERENCE = 6
"""row of the reference family among the words, after the six of `full_words`"""
ROWS, COLUMNS = 7, 7
SAME = 1e-12
"""States that differ by less, in least radii and rad, are the same."""


@njit("Tuple((float64[:, ::1], float64[:, ::1], float64[::1]))(float64)", cache=True, nogil=True, error_model="numpy")
def tables(s: float) -> tuple[FloatArray, FloatArray, FloatArray]:
    """What all queries of the same limits share."""
    table = spiral_table(s)
    return table, middle_table(s, table), turn_table(s, table)


@njit(
    "UniTuple(float64, 7)(float64, float64, float64, float64, float64, float64, float64[::1])",
    cache=True,
    nogil=True,
    error_model="numpy",
)
def _reference(
    x: float, y: float, theta: float, a: float, b: float, s: float, turns: FloatArray
) -> tuple[float, float, float, float, float, float, float]:
    """The reference word between the places where the curvature has come to 0 and where it leaves 0."""
    if a == 0.0 and b == 0.0:
        return reference_word(x, y, theta, turns)
    x0, y0, t0, _ = clothoid_end(0.0, 0.0, 0.0, a, -math.copysign(s, a), abs(a) / s)
    # back along the end's clothoid the curvature falls to 0 as well
    x1, y1, t1, _ = clothoid_end(x, y, theta + math.pi, -b, math.copysign(s, b), abs(b) / s)
    t1 -= math.pi
    c = math.cos(t0)
    sn = math.sin(t0)
    dx = x1 - x0
    dy = y1 - y0
    length, word, d1, d2, first, middle, last = reference_word(c * dx + sn * dy, c * dy - sn * dx, t1 - t0, turns)
    return length + (abs(a) + abs(b)) / s, word, d1, d2, first, middle, last


@njit(
    "float64(float64[::1], float64[::1], float64, float64, boolean, float64[:, ::1], float64[:, ::1], float64[::1],"
    "float64[:, ::1], float64[::1])",
    cache=True,
    nogil=True,
    error_model="numpy",
)
def solve(
    start: FloatArray,
    end: FloatArray,
    kappa: float,
    s: float,
    full: bool,
    table: FloatArray,
    middles: FloatArray,
    turns: FloatArray,
    words: FloatArray,
    query: FloatArray,
) -> float:
    """Length (m) of the shortest word. Fills the scaled query (5,) and the words (ROWS, COLUMNS), length first."""
    c = math.cos(start[2])
    sn = math.sin(start[2])
    dx = (end[0] - start[0]) * kappa
    dy = (end[1] - start[1]) * kappa
    x = c * dx + sn * dy
    y = c * dy - sn * dx
    theta = end[2] - start[2]
    theta -= 2.0 * math.pi * math.floor(theta / (2.0 * math.pi) + 0.5)
    a = min(max(start[3] / kappa, -1.0), 1.0)
    b = min(max(end[3] / kappa, -1.0), 1.0)
    query[0], query[1], query[2], query[3], query[4] = x, y, theta, a, b
    words[:, 0] = math.inf
    if max(abs(x), abs(y), abs(theta), abs(a - b)) < SAME:
        return 0.0
    best = math.inf
    found = _reference(x, y, theta, a, b, s, turns)
    for i in range(7):
        words[REFERENCE, i] = found[i]
    best = found[0]
    if full and not (found[1] == S and a == 0.0 and b == 0.0):
        full_words(x, y, theta, a, b, s, table, middles, words)
        for row in range(ROWS):
            best = min(best, words[row, 0])
    return best / kappa


@njit(
    "int64(float64[::1], float64[::1], int64, float64, float64[:, ::1], float64[::1], float64[:, ::1])",
    cache=True,
    nogil=True,
    error_model="numpy",
)
def pieces_of(
    word: FloatArray, query: FloatArray, row: int, s: float, table: FloatArray, turns: FloatArray, pieces: FloatArray
) -> int:
    """Writes rows curvature, sharpness, length of a found word, in least radii; returns their number."""
    a, b = query[3], query[4]
    if row < REFERENCE:
        return word_pieces(int(word[1]), word[2], word[3], word[4], word[5], word[6], a, b, s, pieces)
    n = 0
    if a != 0.0:
        pieces[n, 0], pieces[n, 1], pieces[n, 2] = a, -math.copysign(s, a), abs(a) / s
        n += 1
    kind, d1, d2 = int(word[1]), word[2], word[3]
    if kind != S:
        n = turn_pieces(d1, word[4], s, turns, table, pieces, n)
    if kind == TTT:
        n = turn_pieces(-d1, word[5], s, turns, table, pieces, n)
    else:
        pieces[n, 0], pieces[n, 1], pieces[n, 2] = 0.0, 0.0, word[5]
        n += 1
    if kind != S and kind != T:
        n = turn_pieces(d2, word[6], s, turns, table, pieces, n)
    if b != 0.0:
        pieces[n, 0], pieces[n, 1], pieces[n, 2] = 0.0, math.copysign(s, b), abs(b) / s
        n += 1
    return n


@njit(
    "void(float64[:, ::1], float64[:, ::1], float64, float64, boolean, float64[:, ::1], float64[:, ::1], float64[::1],"
    "float64[::1])",
    cache=True,
    nogil=True,
    error_model="numpy",
)
def lengths(
    starts: FloatArray,
    ends: FloatArray,
    kappa: float,
    s: float,
    full: bool,
    table: FloatArray,
    middles: FloatArray,
    turns: FloatArray,
    out: FloatArray,
) -> None:
    """Lengths (k,) between rows (k, 4)."""
    words = np.empty((ROWS, COLUMNS))
    query = np.empty(5)
    for i in range(len(starts)):
        out[i] = solve(starts[i], ends[i], kappa, s, full, table, middles, turns, words, query)


@njit(
    "void(float64[:, ::1], float64[:, ::1], float64, float64, boolean, float64[:, ::1], float64[:, ::1], float64[::1],"
    "float64[:, ::1])",
    cache=True,
    nogil=True,
    error_model="numpy",
)
def matrix(
    exits: FloatArray,
    entries: FloatArray,
    kappa: float,
    s: float,
    full: bool,
    table: FloatArray,
    middles: FloatArray,
    turns: FloatArray,
    out: FloatArray,
) -> None:
    """Lengths (n, m) from every exit (n, 4) to every entry (m, 4)."""
    words = np.empty((ROWS, COLUMNS))
    query = np.empty(5)
    for i in range(len(exits)):
        for j in range(len(entries)):
            out[i, j] = solve(exits[i], entries[j], kappa, s, full, table, middles, turns, words, query)
