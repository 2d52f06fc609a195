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
LONG = 0.15
"""sharpness limit below which words are so long that unlikely ones are tried as well"""
BRACKETS = 8 * CELLS
"""room for two roots of each word in each cell"""
BACKWARDS = 2.0
"""times 1 / s: a line driven backwards for longer is not the valley of a dip, which would have to pass the limit"""
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
    a_left = start_left[1]
    b_left = end_left[1]
    least_backwards = -BACKWARDS / limits[0] if limits[0] > LONG else -math.inf
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
    # h, g, g_c and peak of each turn at both ends of each cell, and its shift
    values = np.empty((4, CELLS, 9))
    for i in range(4):
        side = start_left if i == 0 else (start_right if i == 1 else (end_left if i == 2 else end_right))
        origin = 0.0 if i < 2 else theta
        d = side[0] if i < 2 else -side[0]
        last = math.nan
        h = g = gc = peak = 0.0
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
                    h, g, gc, peak = turn(delta, c, d * sn, side, limits, table)
                    last = delta
                values[i, k, 4 * e] = side[0] * h
                values[i, k, 4 * e + 1] = g
                values[i, k, 4 * e + 2] = gc
                values[i, k, 4 * e + 3] = peak
            values[i, k, 8] = shift - d * origin
    # f and f' at both ends of every bracket of a root, and about how long the path is there
    s = limits[0]
    rounding = 1e-13 * (1.0 + abs(x) + abs(y))
    # what a length between the ends of a cell is off: a peak near 0 grows like a root
    slack = 0.5 + 0.5 / math.sqrt(s) + 0.1 * (abs(x) + abs(y))
    brackets = np.empty((BRACKETS, 9))
    waiting = 0
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
            f1 = across1 + values[i2, k, 4] - values[i1, k, 4]
            if abs(f0) < rounding:
                f0 = 0.0
            if abs(f1) < rounding:
                f1 = 0.0
            slope0 = values[i1, k, 2] + values[i2, k, 2] - along0
            slope1 = values[i1, k, 6] + values[i2, k, 6] - along1
            # a line at a cut itself is found from one of the cells that meet there
            crosses = f0 * f1 <= 0.0
            if not crosses and (f0 * slope0 >= 0.0 or f1 * slope1 <= 0.0):
                continue
            share = f0 / (f0 - f1) if crosses and f0 != f1 else 0.5
            m = along0 - values[i1, k, 1] - values[i2, k, 1]
            m += share * (along1 - values[i1, k, 5] - values[i2, k, 5] - m)
            peaks = values[i1, k, 3] + values[i2, k, 3]
            peaks += share * (values[i1, k, 7] + values[i2, k, 7] - peaks)
            ends = a_left if i1 == 0 else -a_left
            ends += b_left if i2 == 2 else -b_left
            length = m + (2.0 * peaks - ends) / s
            if crosses and (m + slack < (least_backwards if row < 2 else 0.0) or length - slack > most):
                continue
            side1 = start_left if i1 == 0 else start_right
            side2 = end_left if i2 == 2 else end_right
            middle = right
            f_middle = f1
            slope_middle = slope1
            if not crosses:
                middle, f_middle, slope_middle = crossing(
                    left,
                    right,
                    f0,
                    slope0,
                    slope1,
                    values[i1, k, 8],
                    values[i2, k, 8],
                    x,
                    y,
                    theta,
                    side1,
                    side2,
                    limits,
                    table,
                )
                if middle != middle:
                    continue
            for part in range(1 if crosses else 2):
                b = brackets[waiting]
                b[0], b[1], b[2] = length, row, k
                if part == 0:
                    b[3], b[4], b[5], b[6], b[7], b[8] = left, middle, f0, f_middle, slope0, slope_middle
                else:
                    b[3], b[4], b[5], b[6], b[7], b[8] = middle, right, f_middle, f1, slope_middle, slope1
                waiting += 1
    # the shortest first: what is much longer than a path already known leads nowhere
    count = 0
    while waiting > 0:
        first = 0
        for i in range(1, waiting):
            if brackets[i, 0] < brackets[first, 0]:
                first = i
        length, row, k = brackets[first, 0], int(brackets[first, 1]), int(brackets[first, 2])
        if length - slack > most:
            break
        i1 = row & 1
        i2 = 2 + (i1 if row < 2 else 1 - i1)
        side1 = start_left if i1 == 0 else start_right
        side2 = end_left if i2 == 2 else end_right
        least = least_backwards if row < 2 else -1e-10
        m, t1, t2 = line_root(
            brackets[first],
            values[i1, k, 8],
            values[i2, k, 8],
            x,
            y,
            theta,
            least,
            most + (side1[1] + side2[1]) / s,
            side1,
            side2,
            limits,
            table,
        )
        waiting -= 1
        for i in range(9):
            brackets[first, i] = brackets[waiting, i]
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
