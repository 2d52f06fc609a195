"""How long continuous-curvature connectors take, in compiled code."""

from __future__ import annotations

import math

import numpy as np

from optplan.compiled import njit
from optplan.domain.arrays import FloatArray
from optplan.geometry._kernels.cc import COLUMNS, ROWS, pieces_of, solve
from optplan.timing._kernels.sweep import sweep

STEP = 0.1
"""Longest interval where the curvature changes, m."""
MOST_INTERVALS = 4000
PIECES = 12
HALF, ACCELERATION, TRANSIT, RIM, LATERAL = 0, 1, 2, 3, 4
"""Of a pace: half the track (m), acceleration (m/s^2), transit speed, speed of the wheels' rims (m/s), lateral
acceleration (m/s^2)."""


@njit("float64(float64, float64, float64[::1])", cache=True, nogil=True, error_model="numpy")
def _cap(kappa: float, sigma: float, pace: FloatArray) -> float:
    """Greatest v^2 at a curvature and its change."""
    bend = abs(kappa)
    cap = min(pace[TRANSIT], pace[RIM] / (1.0 + bend * pace[HALF])) ** 2
    if bend > 0.0:
        cap = min(cap, pace[LATERAL] / bend)
    if sigma != 0.0:
        cap = min(cap, pace[ACCELERATION] / (pace[HALF] * abs(sigma)))
    return float(cap)


@njit("float64(float64[:, ::1], int64, float64, float64, float64[::1])", cache=True, nogil=True, error_model="numpy")
def time_of(pieces: FloatArray, count: int, before: float, after: float, pace: FloatArray) -> float:
    """Seconds along pieces (rows curvature, sharpness, length) between strokes driven at two speeds (m/s).

    What the strokes lose by slowing down for the connector and gaining speed behind it counts too.
    """
    half, most = pace[HALF], pace[ACCELERATION]
    n = 0
    steps = np.ones(count, dtype=np.int64)
    for i in range(count):
        if pieces[i, 1] != 0.0:
            low = 1.0 - half * max(abs(pieces[i, 0]), abs(pieces[i, 0] + pieces[i, 1] * pieces[i, 2]))
            step = min(STEP, max(abs(low), 0.02) / (2.2 * half * abs(pieces[i, 1])))
            steps[i] = min(max(1, math.ceil(pieces[i, 2] / step)), MOST_INTERVALS // count)
        n += steps[i]
    if n == 0:
        return 0.0
    length, first, last = np.empty(n), np.empty(n), np.empty(n)
    sharpness, limit, cap = np.empty(n), np.full(n, most), np.full(n + 1, np.inf)
    k = 0
    for i in range(count):
        h = pieces[i, 2] / steps[i]
        for j in range(steps[i]):
            length[k], sharpness[k] = h, pieces[i, 1]
            first[k] = pieces[i, 0] + pieces[i, 1] * h * j
            last[k] = first[k] + pieces[i, 1] * h
            cap[k] = min(cap[k], _cap(first[k], sharpness[k], pace))
            cap[k + 1] = min(cap[k + 1], _cap(last[k], sharpness[k], pace))
            k += 1
    cap[0] = min(cap[0], before * before)
    cap[n] = min(cap[n], after * after)
    best = sweep(length, first, last, sharpness, half, limit, cap)
    total = 0.0
    for k in range(n):
        v0, v1 = math.sqrt(best[k]), math.sqrt(best[k + 1])
        if sharpness[k] != 0.0:
            total += 2.0 * length[k] / max(v0 + v1, 1e-9)
            continue
        rate = most / (1.0 + half * abs(first[k]))
        top = min(_cap(first[k], 0.0, pace), (best[k] + best[k + 1]) / 2.0 + rate * length[k])
        top = math.sqrt(max(top, best[k], best[k + 1]))
        ramps = (2.0 * top * top - best[k] - best[k + 1]) / (2.0 * rate)
        total += (2.0 * top - v0 - v1) / rate + max(length[k] - ramps, 0.0) / max(top, 1e-9)
    for wanted, got in ((before, math.sqrt(best[0])), (after, math.sqrt(best[n]))):
        if wanted > got:
            total += (wanted - got) ** 2 / (2.0 * most * wanted)
    return float(total)


@njit(
    "void(float64[:, ::1], float64[:, ::1], float64[::1], float64[::1], boolean, float64, float64, float64[:, ::1],"
    "float64[:, ::1], float64[::1], float64[::1], float64[:, ::1])",
    cache=True,
    nogil=True,
    error_model="numpy",
)
def times(
    exits: FloatArray,
    entries: FloatArray,
    before: FloatArray,
    after: FloatArray,
    paired: bool,
    kappa: float,
    s: float,
    table: FloatArray,
    middles: FloatArray,
    turns: FloatArray,
    pace: FloatArray,
    out: FloatArray,
) -> None:
    """Seconds (n, m) from every exit to every entry, or, paired, (n, 1) row by row, where that is less than in `out`.

    States bent more than the limit have no connector of this kind.
    """
    words, query, pieces = np.empty((ROWS, COLUMNS)), np.empty(5), np.zeros((PIECES, 3))
    for i in range(len(exits)):
        if abs(exits[i, 3]) > kappa * (1.0 + 1e-9):
            continue
        for j in range(1 if paired else len(entries)):
            there = i if paired else j
            if abs(entries[there, 3]) > kappa * (1.0 + 1e-9):
                continue
            total = 0.0
            found = solve(exits[i], entries[there], kappa, s, True, table, middles, turns, words, query)
            # no connector is faster than at transit speed all the way
            if found / pace[TRANSIT] >= out[i, j]:
                continue
            if found > 0.0:
                row = int(np.argmin(words[:, 0]))
                count = pieces_of(words[row], query, row, s, table, turns, pieces)
                kept = 0
                for k in range(count):
                    if pieces[k, 2] > 1e-15 * words[row, 0]:
                        pieces[kept, 0] = pieces[k, 0] * kappa
                        pieces[kept, 1] = pieces[k, 1] * kappa * kappa
                        pieces[kept, 2] = pieces[k, 2] / kappa
                        kept += 1
                total = time_of(pieces, kept, before[i], after[there], pace)
            out[i, j] = min(out[i, j], total)
