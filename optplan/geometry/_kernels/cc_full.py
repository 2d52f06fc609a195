"""All words at full sharpness, in compiled code. Lengths are in least radii (see `spiral`).

Lines are found first. Then the guesses of words with three extrema are gathered and tried, the shortest first.
"""

from __future__ import annotations

import math

import numpy as np

from optplan.compiled import njit
from optplan.domain.arrays import FloatArray
from optplan.geometry._kernels.cc_scan import FACTOR, LINES, LONG, lines
from optplan.geometry._kernels.cc_turns import Side, from_least, limits_of, side_of
from optplan.geometry._kernels.cc_words import CCC, CSC, three_extrema
from optplan.geometry._kernels.spiral import spiral

TWO_PI = 2.0 * math.pi
GUESSES = 96
"""room for guesses: length, word, first peak, valley, last peak, by how much it may miss"""
WIDE = 24
"""rows of valleys down to the limit, and as many of arcs there"""
LATE = 1.5
"""A guess this many times as long as the shortest path by then comes too late: guesses are too long by less."""
NEAR = 0.7
"""share of its length by which the guess of small outer turns may miss"""
SLIGHT = 0.12
"""guess of the valley of a slight counter-turn"""
WINDING = 1.5
"""rad; wiggles whose chord is off the mean curvature by more do not pay"""
HARD = 0.6
"""sharpness limit from which on words are so long that slight counter-turns, and more guesses of peaks, pay"""


@njit("float64[:, ::1](float64, float64[:, ::1])", cache=True, nogil=True, error_model="numpy")
def middle_table(s: float, table: FloatArray) -> FloatArray:
    """Rows w, reach, turned of the half of a CCC's middle, from the circle at the limit to its extremum (n, 3).

    w is the extended valley, from -1 (curvature stays at the limit) past 1 (arc against the turn). Seen from the
    middle, where the heading is 0, `reach` is how far ahead the middle is of the first circle's centre, and `turned` by
    how much the heading grows from the limit's end to the middle.
    """
    n = WIDE
    rows = np.empty((2 * n, 3))
    ex1, ey1 = spiral(table, 1.0)
    for i in range(2 * n):
        w = -1.0 + 2.0 * i / (n - 1) if i < n else 1.0 + 0.5 * s * TWO_PI * (i - n + 1) / n
        k = -min(w, 1.0)
        arc = max(w - 1.0, 0.0) / s
        turned = 0.5 * (1.0 - k * k) / s
        # start at the limit, heading 0, centre (0, 1); down to k, half the arc
        exk, eyk = spiral(table, k)
        c = math.cos(0.5 / s)
        sn = math.sin(0.5 / s)
        dx = ex1 - exk
        dy = -(ey1 - eyk)
        x = c * dx - sn * dy
        y = sn * dx + c * dy - 1.0
        if arc > 0.0:
            x -= math.sin(turned - arc) - math.sin(turned)
            y += math.cos(turned - arc) - math.cos(turned)
            turned -= arc
        rows[i, 0] = w
        rows[i, 1] = x * math.cos(turned) + y * math.sin(turned)
        rows[i, 2] = turned
    return rows


@njit(
    "void(float64[:, ::1], int64, int64, float64, float64, float64, float64, float64, float64)",
    cache=True,
    nogil=True,
    error_model="numpy",
)
def _keep(
    best: FloatArray, row: int, kind: int, d1: float, d2: float, t1: float, m: float, t2: float, length: float
) -> None:
    if length < best[row, 0]:
        best[row, 0] = length
        best[row, 1] = kind
        best[row, 2] = d1
        best[row, 3] = d2
        best[row, 4] = t1
        best[row, 5] = m
        best[row, 6] = t2


@njit("float64(float64)", cache=True, nogil=True, error_model="numpy", inline="always")
def _wrapped(angle: float) -> float:
    """In [-pi, pi)."""
    return angle - TWO_PI * math.floor(angle / TWO_PI + 0.5)


@njit("float64(float64, float64)", cache=True, nogil=True, error_model="numpy")
def _extended(t: float, s: float) -> float:
    """Angle turned between curvatures 0 around an extended extremum."""
    return (t * t if t < 1.0 else 2.0 * t - 1.0) / s


@njit(
    "int64(float64[:, ::1], int64, int64, float64, float64, float64, float64, float64, float64, float64, float64,"
    "float64)",
    cache=True,
    nogil=True,
    error_model="numpy",
)
def _note(
    guesses: FloatArray,
    count: int,
    row: int,
    t1: float,
    m: float,
    t2: float,
    a: float,
    b: float,
    s: float,
    distance: float,
    most: float,
    near: float,
) -> int:
    """Adds a guess unless it is too long, or too short to come this far; returns their number."""
    length = (2.0 * (t1 + m + t2) - a - b) / s
    if length > most or 1.2 * length < distance or count == GUESSES:
        return count
    guess = guesses[count]
    guess[0], guess[1], guess[2], guess[3], guess[4], guess[5] = length, row, t1, m, t2, near
    return count + 1


@njit(
    "int64(float64[:, ::1], int64, int64, float64, float64, float64, UniTuple(float64, 9), UniTuple(float64, 9),"
    "float64, float64[:, ::1], float64)",
    cache=True,
    nogil=True,
    error_model="numpy",
)
def _three_turns(
    guesses: FloatArray,
    count: int,
    row: int,
    x: float,
    y: float,
    theta: float,
    side1: Side,
    side2: Side,
    s: float,
    middles: FloatArray,
    most: float,
) -> int:
    """Guesses of CCC words: wiggles, small outer turns, and circles at the limit whose centres the middle spans.

    Mirrored for RLR. Returns the number of guesses.
    """
    a = side1[1]
    b = side2[1]
    distance = math.hypot(x, y)
    # wiggles about the mean of the ends' curvatures, as long as the chord: the ways of short moves along a curve
    wiggle = 0.25 * s * distance
    mean = 0.5 * (a + b)
    off = _wrapped(theta - mean * distance)
    off_chord = _wrapped(math.atan2(y, x) - 0.5 * mean * distance)
    loose = 0.01 + 0.3 * s * distance * distance
    # how far the chord may be off at either end; where words are long they wind
    loose_chord = min(loose, WINDING) if s >= HARD else math.inf
    if wiggle < 2.0 and abs(off) < loose and abs(off_chord) < loose_chord and abs(off - off_chord) < loose_chord:
        k = max(mean - wiggle, -1.0)
        t1 = max(a + 0.5 * wiggle, k)
        t2 = max(b + 0.5 * wiggle, k)
        count = _note(guesses, count, row, t1, -k, t2, a, b, s, distance, most, math.inf)
    t1 = max(0.15, a + 0.05)
    t2 = max(0.15, b + 0.05)
    turning = from_least(_extended(t1, s) + _extended(t2, s) - 0.5 * (a * a + b * b) / s - theta, 0.0)
    for j in range(3 if s < LONG else 2):
        turned = turning + j * TWO_PI
        m = math.sqrt(s * turned) if s * turned < 1.0 else 0.5 * (s * turned + 1.0)
        count = _note(guesses, count, row, t1, m, t2, a, b, s, distance, most, NEAR)
    c = math.cos(theta)
    sn = math.sin(theta)
    gx = x - c * side2[7] - sn * side2[8] - side1[7]
    gy = y - sn * side2[7] + c * side2[8] - side1[8]
    half = 0.5 * math.hypot(gx, gy)
    across = math.atan2(gy, gx)
    ta = 0.5 * (1.0 - a * a) / s
    tb = 0.5 * (1.0 - b * b) / s
    for i in range(len(middles) - 1):
        for way in range(2):
            sign = 1.0 - 2.0 * way
            f0 = sign * middles[i, 1] - half
            f1 = sign * middles[i + 1, 1] - half
            if f0 * f1 > 0.0:
                continue
            u = f0 / (f0 - f1) if f0 != f1 else 0.5
            w = middles[i, 0] + u * (middles[i + 1, 0] - middles[i, 0])
            turned = middles[i, 2] + u * (middles[i + 1, 2] - middles[i, 2])
            chi = across + math.pi * way
            arc1 = from_least(chi - turned - ta, 0.0)
            arc2 = from_least(theta - chi - turned - tb, 0.0)
            for j in range(4):
                t1 = 1.0 + 0.5 * s * (arc1 - TWO_PI * (j & 1))
                t2 = 1.0 + 0.5 * s * (arc2 - TWO_PI * (j >> 1))
                if t1 >= -w and t2 >= -w:
                    # the linear extended peak, which serves turns near the circle, and where words are long also the
                    # peak below the limit that turns as far
                    count = _note(guesses, count, row, max(t1, 0.1), w, max(t2, 0.1), a, b, s, distance, most, math.inf)
                    if s < HARD and min(t1, t2) < 0.85:
                        t1 = t1 if t1 > 1.0 else math.sqrt(max(2.0 * t1 - 1.0, 0.01))
                        t2 = t2 if t2 > 1.0 else math.sqrt(max(2.0 * t2 - 1.0, 0.01))
                        count = _note(guesses, count, row, t1, w, t2, a, b, s, distance, most, math.inf)
    return count


@njit(
    "void(float64, float64, float64, float64, float64, float64, float64[:, ::1], float64[:, ::1], float64[:, ::1])",
    cache=True,
    nogil=True,
    error_model="numpy",
)
def full_words(
    x: float,
    y: float,
    theta: float,
    a: float,
    b: float,
    s: float,
    table: FloatArray,
    middles: FloatArray,
    best: FloatArray,
) -> None:
    """Improves rows length, kind, d1, d2, t1, m, t2 of the shortest LSL, RSR, LSR, RSL, LRL, RLR (6, 7).

    From the origin with heading 0 and curvature a to x, y, theta with curvature b. Rows above the sixth are only looked
    at: what is much longer than the shortest of all is not searched for.
    """
    limits = limits_of(s, table)
    sides = (
        side_of(1.0, a, limits, table),
        side_of(-1.0, a, limits, table),
        side_of(1.0, b, limits, table),
        side_of(-1.0, b, limits, table),
    )
    found = np.empty((LINES, 5))
    shortest = best[:, 0].min()
    count = lines(x, y, theta, sides, limits, table, FACTOR * shortest, found)
    for i in range(count):
        if found[i, 2] >= -1e-10 and found[i, 1] > 0.0:
            row = int(found[i, 0])
            d1 = 1.0 if row == 0 or row == 2 else -1.0
            d2 = 1.0 if row == 0 or row == 3 else -1.0
            _keep(best, row, CSC, d1, d2, found[i, 3], max(found[i, 2], 0.0), found[i, 4], found[i, 1])
            shortest = min(shortest, found[i, 1])
    distance = math.hypot(x, y)
    most = FACTOR * shortest
    guesses = np.empty((GUESSES, 6))
    waiting = 0
    for i in range(count):
        row = int(found[i, 0])
        m = found[i, 2]
        if row < 2 and (m < 0.0 or s < HARD):
            # a line that would be driven backwards: a valley above 0 takes its place; and a short one may do better
            # as a slight turn the other way
            m = max(-0.95, 0.5 * s * m) if m < 0.0 else SLIGHT
            d = 1.0 - 2.0 * row
            waiting = _note(
                guesses, waiting, row, found[i, 3], m, found[i, 4], d * a, d * b, s, distance, most, math.inf
            )
    for row in range(2):
        d = 1.0 - 2.0 * row
        side1, side2 = (sides[0], sides[2]) if row == 0 else (sides[1], sides[3])
        waiting = _three_turns(guesses, waiting, row, x, d * y, d * theta, side1, side2, s, middles, most)
    # the shortest first, so that a reversed query takes the same ones
    while waiting > 0:
        first = 0
        for i in range(1, waiting):
            if guesses[i, 0] < guesses[first, 0]:
                first = i
        guess = guesses[first]
        row, t1, m, t2, near = int(guess[1]), guess[2], guess[3], guess[4], guess[5]
        if guess[0] > LATE * shortest and s > LONG:
            break
        waiting -= 1
        for i in range(6):
            guesses[first, i] = guesses[waiting, i]
        d = 1.0 - 2.0 * row
        side1, side2 = (sides[0], sides[2]) if row == 0 else (sides[1], sides[3])
        length, t1, m, t2 = three_extrema(t1, m, t2, x, d * y, d * theta, side1, side2, limits, table, shortest, near)
        _keep(best, 4 + row, CCC, d, d, t1, m, t2, length)
        shortest = min(shortest, length)
