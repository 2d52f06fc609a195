"""The shortest path of continuous curvature that may change gear, one or many, in compiled code.

Words of `cusps` between the places where the curvature has come to 0, forwards or backwards, and where it leaves 0,
beside the paths of `cc` driven forwards only and backwards only. Curvature is 0 at cusps.
"""

from __future__ import annotations

import math

import numpy as np

from optplan.compiled import njit
from optplan.domain.arrays import FloatArray
from optplan.geometry._kernels.cc import COLUMNS, ROWS, SAME
from optplan.geometry._kernels.cc import solve as solve_forwards
from optplan.geometry._kernels.cc_reference import turn_pieces
from optplan.geometry._kernels.cc_sharp import sharp_pieces, sharp_words
from optplan.geometry._kernels.clothoid import clothoid_end
from optplan.geometry._kernels.cusps import COLUMNS as COLUMNS_WITH_CUSPS
from optplan.geometry._kernels.cusps import NONE, SEGMENTS, WORDS, cusp_words, segments_of
from optplan.geometry._kernels.dubins import dubins_length

FORWARDS, BACKWARDS, CUSPS = range(3)
CHOICE = SEGMENTS + 2
"""rows of a word with cusps: number of segments, 1 for full sharpness, 1 for from the end to the start; the gears in
which the curvature comes to 0 and leaves it; the segments"""
PIECES = 3 * SEGMENTS + 2
SAVED = 1e-9
"""A word with cusps is taken when it saves more than this share of a path without."""


@njit("void(float64[::1], float64[::1])", cache=True, nogil=True, error_model="numpy")
def _turned_round(state: FloatArray, out: FloatArray) -> None:
    """The state in the direction of travel when driven backwards."""
    out[0], out[1], out[2], out[3] = state[0], state[1], state[2] + math.pi, -state[3]


@njit(
    "UniTuple(float64, 3)(float64, float64, float64, float64, float64, float64)",
    cache=True,
    nogil=True,
    error_model="numpy",
)
def _straightened(
    x: float, y: float, theta: float, curvature: float, gear: float, s: float
) -> tuple[float, float, float]:
    """Where a robot is whose wheels have become straight as fast as they can, in a gear."""
    if curvature == 0.0:
        return x, y, theta
    turned = 0.0 if gear > 0.0 else math.pi
    bend = gear * curvature
    x, y, theta, _ = clothoid_end(x, y, theta + turned, bend, -math.copysign(s, bend), abs(bend) / s)
    return x, y, theta - turned


@njit(
    "float64(float64[::1], float64[::1], float64, float64, float64[:, ::1], float64[::1], float64[:, ::1],"
    "float64[:, ::1], float64[:, ::1], float64[:, ::1])",
    cache=True,
    nogil=True,
    error_model="numpy",
)
def _with_cusps(
    start: FloatArray,
    end: FloatArray,
    kappa: float,
    s: float,
    table: FloatArray,
    turns: FloatArray,
    words: FloatArray,
    segments: FloatArray,
    work: FloatArray,
    choice: FloatArray,
) -> float:
    """Length, in least radii, of the shortest word with cusps. Fills its choice (CHOICE, 3)."""
    dx = (end[0] - start[0]) * kappa
    dy = (end[1] - start[1]) * kappa
    a = min(max(start[3] / kappa, -1.0), 1.0)
    b = min(max(end[3] / kappa, -1.0), 1.0)
    ramps = (abs(a) + abs(b)) / s
    best = math.inf
    for leave in range(1 if a == 0.0 else 2):
        gear1 = 1.0 - 2.0 * leave
        x0, y0, t0 = _straightened(0.0, 0.0, start[2], a, gear1, s)
        c = math.cos(t0)
        sn = math.sin(t0)
        for enter in range(1 if b == 0.0 else 2):
            gear2 = 1.0 - 2.0 * enter
            # the end's clothoid is driven back to where it begins: in the other gear
            x1, y1, t1 = _straightened(dx, dy, end[2], b, -gear2, s)
            gx = x1 - x0
            gy = y1 - y0
            row = cusp_words(c * gx + sn * gy, c * gy - sn * gx, t1 - t0, best - ramps, turns, words)
            if words[row, 1] != NONE and words[row, 0] + ramps < best:
                best = words[row, 0] + ramps
                choice[0, 0], choice[0, 1] = segments_of(words[row], segments), 0.0
                choice[1, 0], choice[1, 1] = gear1, gear2
                choice[2:] = segments
    c = math.cos(start[2])
    sn = math.sin(start[2])
    x = c * dx + sn * dy
    y = c * dy - sn * dx
    length: float = sharp_words(x, y, end[2] - start[2], a, b, s, best, table, words, segments, work, choice)
    return length


@njit("float64(float64[::1], float64[::1])", cache=True, nogil=True, error_model="numpy")
def _ahead(start: FloatArray, end: FloatArray) -> float:
    """How far ahead of or behind one state another is."""
    return float(abs(math.cos(start[2]) * (end[0] - start[0]) + math.sin(start[2]) * (end[1] - start[1])))


@njit(
    "Tuple((float64, int64))(float64[::1], float64[::1], float64, float64, float64[:, ::1], float64[:, ::1],"
    "float64[::1], float64[:, ::1])",
    cache=True,
    nogil=True,
    error_model="numpy",
)
def solve(
    start: FloatArray,
    end: FloatArray,
    kappa: float,
    s: float,
    table: FloatArray,
    middles: FloatArray,
    turns: FloatArray,
    choice: FloatArray,
) -> tuple[float, int]:
    """Length (m) of the shortest path and whether it is driven FORWARDS, BACKWARDS or with CUSPS (fills its choice).

    The same path is driven from its end to its start in the other gears, so words with cusps are always sought from the
    same one of both: lengths are symmetric. Paths without cusps are left out when they cannot be shorter.
    """
    turn = end[2] - start[2]
    turn -= 2.0 * math.pi * math.floor(turn / (2.0 * math.pi) + 0.5)
    apart = max(abs(end[0] - start[0]), abs(end[1] - start[1])) * kappa
    if max(apart, abs(turn), abs(end[3] - start[3]) / kappa) < SAME:
        return 0.0, FORWARDS
    words, query, turned = np.empty((ROWS, COLUMNS)), np.empty(5), np.empty((2, 4))
    with_cusps, segments, work = np.empty((WORDS, COLUMNS_WITH_CUSPS)), np.zeros((SEGMENTS, 3)), np.empty((5, SEGMENTS))
    if _ahead(start, end) >= _ahead(end, start):
        best = _with_cusps(start, end, kappa, s, table, turns, with_cusps, segments, work, choice)
        choice[0, 2] = 0.0
    else:
        best = _with_cusps(end, start, kappa, s, table, turns, with_cusps, segments, work, choice)
        choice[0, 2] = 1.0
    shortest = best / kappa
    best = shortest * (1.0 + SAVED)
    way = CUSPS
    radius = 1.0 / kappa
    if dubins_length(start[0], start[1], start[2], end[0], end[1], end[2], radius) < best:
        length = solve_forwards(start, end, kappa, s, True, table, middles, turns, words, query)
        if length <= best:
            best, way = length, FORWARDS
    _turned_round(start, turned[0])
    _turned_round(end, turned[1])
    if dubins_length(start[0], start[1], turned[0, 2], end[0], end[1], turned[1, 2], radius) < best:
        length = solve_forwards(turned[0], turned[1], kappa, s, True, table, middles, turns, words, query)
        if length < best:
            best, way = length, BACKWARDS
    return shortest if way == CUSPS else best, way


@njit(
    "int64(float64[:, ::1], float64, float64, float64, float64[:, ::1], float64[::1], float64[:, ::1])",
    cache=True,
    nogil=True,
    error_model="numpy",
)
def pieces_of(
    choice: FloatArray, a: float, b: float, s: float, table: FloatArray, turns: FloatArray, pieces: FloatArray
) -> int:
    """Writes rows curvature, sharpness, length, gear in the direction of travel, in least radii; returns their number.

    a, b : the wheels' curvatures at both ends of the word
    """
    n = 0
    count = int(choice[0, 0])
    sharp = choice[0, 1] > 0.0
    if a != 0.0 and not sharp:
        bend = choice[1, 0] * a
        pieces[n, 0], pieces[n, 1], pieces[n, 2] = bend, -math.copysign(s, bend), abs(bend) / s
        pieces[n, 3] = choice[1, 0]
        n += 1
    for k in range(count):
        gear, side, size = choice[2 + k]
        if side == 0.0:
            pieces[n, 0], pieces[n, 1], pieces[n, 2], pieces[n, 3] = 0.0, 0.0, size, gear
            n += 1
        elif sharp:
            before, after = a if k == 0 else 0.0, b if k == count - 1 else 0.0
            n = sharp_pieces(gear, side, size, before, after, s, pieces, n)
        else:
            before_n = n
            n = turn_pieces(side, size, s, turns, table, pieces, n)
            pieces[before_n:n, 3] = gear
    if b != 0.0 and not sharp:
        bend = choice[1, 1] * b
        pieces[n, 0], pieces[n, 1], pieces[n, 2] = 0.0, math.copysign(s, bend), abs(bend) / s
        pieces[n, 3] = choice[1, 1]
        n += 1
    return n


@njit(
    "void(float64[:, ::1], float64[:, ::1], float64, float64, float64[:, ::1], float64[:, ::1], float64[::1],"
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
    table: FloatArray,
    middles: FloatArray,
    turns: FloatArray,
    out: FloatArray,
) -> None:
    """Lengths (n, m) from every exit (n, 4) to every entry (m, 4)."""
    choice = np.zeros((CHOICE, 3))
    for i in range(len(exits)):
        for j in range(len(entries)):
            out[i, j], _ = solve(exits[i], entries[j], kappa, s, table, middles, turns, choice)


@njit(
    "void(float64[:, ::1], float64[:, ::1], float64, float64, float64[:, ::1], float64[:, ::1], float64[::1],"
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
    table: FloatArray,
    middles: FloatArray,
    turns: FloatArray,
    out: FloatArray,
) -> None:
    """Lengths (k,) between rows (k, 4)."""
    choice = np.zeros((CHOICE, 3))
    for i in range(len(starts)):
        out[i], _ = solve(starts[i], ends[i], kappa, s, table, middles, turns, choice)
