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
from optplan.geometry._kernels.cc_reference import TTT, S, T, held_pieces, reference_word, turn_pieces, turn_table
from optplan.geometry._kernels.cc_words import word_pieces
from optplan.geometry._kernels.clothoid import clothoid_end
from optplan.geometry._kernels.spiral import spiral_table

REFERENCE = 6
"""row of the reference family among the words, after the six of `full_words`"""
ROWS, COLUMNS = 7, 9
"""columns of `full_words`, or of `reference_word` and the curvatures between which it is driven"""
SAME = 1e-12
"""States that differ by less, in least radii and rad, are the same."""


@njit("Tuple((float64[:, ::1], float64[:, ::1], float64[::1]))(float64)", cache=True, nogil=True, error_model="numpy")
def tables(s: float) -> tuple[FloatArray, FloatArray, FloatArray]:
    """What all queries of the same limits share."""
    table = spiral_table(s)
    return table, middle_table(s, table), turn_table(s, table)


@njit(
    "UniTuple(float64, 3)(float64, float64, float64, float64, float64, float64)",
    cache=True,
    nogil=True,
    error_model="numpy",
)
def _steered(x: float, y: float, theta: float, before: float, after: float, s: float) -> tuple[float, float, float]:
    """Place and heading once the curvature has come from one value to another at full sharpness."""
    if before == after:
        return x, y, theta
    x, y, theta, _ = clothoid_end(x, y, theta, before, math.copysign(s, after - before), abs(after - before) / s)
    return x, y, theta


@njit(
    "void(float64, float64, float64, float64, float64, float64, float64[::1], float64[::1])",
    cache=True,
    nogil=True,
    error_model="numpy",
)
def _reference(
    x: float, y: float, theta: float, a: float, b: float, s: float, turns: FloatArray, word: FloatArray
) -> None:
    """The shortest reference word, with the curvatures at its ends (COLUMNS,).

    A curvature that is neither 0 nor at the limit is first brought to one of these.
    """
    word[0] = math.inf
    for i in range(1 if a == 0.0 else 2):
        held1 = 0.0 if i == 0 else math.copysign(1.0, a)
        x0, y0, t0 = _steered(0.0, 0.0, 0.0, a, held1, s)
        c = math.cos(t0)
        sn = math.sin(t0)
        for j in range(1 if b == 0.0 else 2):
            held2 = 0.0 if j == 0 else math.copysign(1.0, b)
            # back along the end's clothoid
            x1, y1, t1 = _steered(x, y, theta + math.pi, -b, -held2, s)
            dx = x1 - x0
            dy = y1 - y0
            ramps = (abs(a - held1) + abs(b - held2)) / s
            found = reference_word(c * dx + sn * dy, c * dy - sn * dx, t1 - math.pi - t0, held1, held2, turns)
            if found[0] + ramps < word[0]:
                for k in range(7):
                    word[k] = found[k]
                word[0] += ramps
                word[7], word[8] = held1, held2


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
    found = words[REFERENCE]
    _reference(x, y, theta, a, b, s, turns, found)
    best: float = found[0]
    if full and not (found[1] == S and a == 0.0 and b == 0.0):
        full_words(x, y, theta, a, b, s, table, middles, words)
        for row in range(ROWS):
            best = min(best, words[row, 0])
    return best / kappa


@njit(
    "int64(float64, float64, float64, float64, float64, float64[::1], float64[:, ::1], float64[:, ::1], int64)",
    cache=True,
    nogil=True,
    error_model="numpy",
)
def _end_pieces(
    d: float,
    delta: float,
    held1: float,
    held2: float,
    s: float,
    turns: FloatArray,
    table: FloatArray,
    pieces: FloatArray,
    n: int,
) -> int:
    """Writes rows of a first or last turn; returns their number then."""
    if held1 == 0.0 and held2 == 0.0:
        count: int = turn_pieces(d, delta, s, turns, table, pieces, n)
    else:
        count = held_pieces(d, delta, held1, held2, s, turns, pieces, n)
    return count


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
    held1, held2 = word[7], word[8]
    if a != held1:
        pieces[n, 0], pieces[n, 1], pieces[n, 2] = a, math.copysign(s, held1 - a), abs(held1 - a) / s
        n += 1
    kind, d1, d2 = int(word[1]), word[2], word[3]
    if kind == T and (held1 != 0.0 or held2 != 0.0):
        n = held_pieces(d1, word[4], held1, held2, s, turns, pieces, n)
    elif kind != S:
        n = _end_pieces(d1, word[4], held1, 0.0, s, turns, table, pieces, n)
    if kind == TTT:
        n = turn_pieces(-d1, word[5], s, turns, table, pieces, n)
    elif word[5] > 0.0:
        pieces[n, 0], pieces[n, 1], pieces[n, 2] = 0.0, 0.0, word[5]
        n += 1
    if kind != S and kind != T:
        n = _end_pieces(d2, word[6], 0.0, held2, s, turns, table, pieces, n)
    if b != held2:
        pieces[n, 0], pieces[n, 1], pieces[n, 2] = held2, math.copysign(s, b - held2), abs(b - held2) / s
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
