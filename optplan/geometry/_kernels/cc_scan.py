"""All lines that join a turn from the start and a turn into the end, in compiled code.

The circle of headings is cut where a turn jumps by 2 pi (each of the four turns once) and at GRID even places, counted
from the direction of the end, so that a mirrored or reversed query is cut alike. Each turn is evaluated once at both
ends of a cell; a word's f then costs a sum.
"""

from __future__ import annotations

import math

import numpy as np

from optplan.compiled import njit
from optplan.domain.arrays import FloatArray
from optplan.geometry._kernels.cc_turns import TWO_PI, Limits, Side, crossing, from_least, line_root, turn

GRID = 8
FACTOR = 1.2
"""What is this many times as long as the shortest path so far is no guess of a shorter one."""
CELLS = GRID + 4
LINES = 48
"""room for lines: row of the word, length of the path, line's length, both peaks"""


@njit(
    "int64(float64, float64, float64, UniTuple(UniTuple(float64, 9), 4), UniTuple(float64, 6), float64[:, ::1],"
    "float64, float64[:, ::1])",
    cache=True,
    nogil=True,
    error_model="numpy",
)
def lines(
    x: float,
    y: float,
    theta: float,
    sides: tuple[Side, Side, Side, Side],
    limits: Limits,
    table: FloatArray,
    most: float,
    out: FloatArray,
) -> int:
    """Writes rows word, length, line, first and last peak (LINES, 5); returns their number.

    Words count as in `cc_full`. A negative line belongs to no path, but where a path with a dip may be found.
    """
    start_left, start_right, end_left, end_right = sides
    towards = math.atan2(y, x) if x != 0.0 or y != 0.0 else 0.5 * theta
    low = towards - math.pi
    psi = np.empty(CELLS + 1)
    for k in range(GRID):
        psi[k] = low + k * (TWO_PI / GRID)
    psi[GRID] = from_least(start_left[2], low)
    psi[GRID + 1] = from_least(-start_right[2], low)
    psi[GRID + 2] = from_least(theta - end_left[2], low)
    psi[GRID + 3] = from_least(theta + end_right[2], low)
    psi[CELLS] = low + TWO_PI
    for i in range(GRID, CELLS):
        cut = psi[i]
        k = i
        while k > 0 and psi[k - 1] > cut:
            psi[k] = psi[k - 1]
            k -= 1
        psi[k] = cut
    ux = np.empty(CELLS + 1)
    uy = np.empty(CELLS + 1)
    for k in range(CELLS + 1):
        ux[k] = math.cos(psi[k])
        uy[k] = math.sin(psi[k])
    c_end = math.cos(theta)
    s_end = math.sin(theta)
    # h, g, g_c and shift of each turn at both ends of each cell
    values = np.empty((4, CELLS, 7))
    for i in range(4):
        side = start_left if i == 0 else (start_right if i == 1 else (end_left if i == 2 else end_right))
        origin = 0.0 if i < 2 else theta
        d = side[0] if i < 2 else -side[0]
        last = math.nan
        h = g = gc = 0.0
        for k in range(CELLS):
            if psi[k + 1] - psi[k] < 1e-12:
                continue
            middle = d * (0.5 * (psi[k] + psi[k + 1]) - origin)
            shift = from_least(middle, side[2]) - middle
            for e in range(2):
                off = d * (psi[k + e] - origin)
                delta = max(off + shift, side[2])
                if e == 1 or not abs(delta - last) < 1e-9:
                    # cosine and sine of psi, or of psi - theta
                    c = ux[k + e] if i < 2 else c_end * ux[k + e] + s_end * uy[k + e]
                    sn = uy[k + e] if i < 2 else c_end * uy[k + e] - s_end * ux[k + e]
                    h, g, gc, _ = turn(delta, c, d * sn, side, limits, table)
                    last = delta
                values[i, k, 3 * e] = side[0] * h
                values[i, k, 3 * e + 1] = g
                values[i, k, 3 * e + 2] = gc
            values[i, k, 6] = shift - d * origin
    s = limits[0]
    rounding = 1e-13 * (1.0 + abs(x) + abs(y))
    count = 0
    for k in range(CELLS):
        left = psi[k]
        right = psi[k + 1]
        if right - left < 1e-12:
            continue
        across0 = ux[k] * y - uy[k] * x
        along0 = ux[k] * x + uy[k] * y
        across1 = ux[k + 1] * y - uy[k + 1] * x
        along1 = ux[k + 1] * x + uy[k + 1] * y
        for row in range(4):
            i1 = row & 1
            i2 = 2 + (i1 if row < 2 else 1 - i1)
            f0 = across0 + values[i2, k, 0] - values[i1, k, 0]
            f1 = across1 + values[i2, k, 3] - values[i1, k, 3]
            if abs(f0) < rounding:
                f0 = 0.0
            if abs(f1) < rounding:
                f1 = 0.0
            middle = left
            f_middle = f0
            # a line at a cut itself is found from one of the cells that meet there
            if f0 == 0.0 or f1 == 0.0 or f0 * f1 < 0.0:
                pieces = 1
            else:
                slope0 = values[i1, k, 2] + values[i2, k, 2] - along0
                slope1 = values[i1, k, 5] + values[i2, k, 5] - along1
                if f0 * slope0 >= 0.0 or f1 * slope1 <= 0.0:
                    continue
                pieces = 2
            side1 = start_left if i1 == 0 else start_right
            side2 = end_left if i2 == 2 else end_right
            shift1 = values[i1, k, 6]
            shift2 = values[i2, k, 6]
            if pieces == 2:
                middle, f_middle = crossing(
                    left, right, f0, slope0, slope1, shift1, shift2, x, y, theta, side1, side2, limits, table
                )
                if middle != middle:
                    continue
            # lines driven backwards lead to dips; what is much longer than a path already known leads nowhere
            least = -math.inf if row < 2 else -1e-10
            worth = most + (side1[1] + side2[1]) / s
            for part in range(pieces):
                if pieces == 1:
                    m, t1, t2 = line_root(
                        left, right, f0, f1, shift1, shift2, x, y, theta, least, worth, side1, side2, limits, table
                    )
                elif part == 0:
                    m, t1, t2 = line_root(
                        left,
                        middle,
                        f0,
                        f_middle,
                        shift1,
                        shift2,
                        x,
                        y,
                        theta,
                        least,
                        worth,
                        side1,
                        side2,
                        limits,
                        table,
                    )
                else:
                    m, t1, t2 = line_root(
                        middle,
                        right,
                        f_middle,
                        f1,
                        shift1,
                        shift2,
                        x,
                        y,
                        theta,
                        least,
                        worth,
                        side1,
                        side2,
                        limits,
                        table,
                    )
                if m >= least and count < LINES:
                    out[count, 0] = row
                    out[count, 1] = m + (2.0 * (t1 + t2) - side1[1] - side2[1]) / s
                    out[count, 2] = m
                    out[count, 3] = t1
                    out[count, 4] = t2
                    if m >= 0.0:
                        most = min(most, FACTOR * out[count, 1])
                    count += 1
    return count
