"""The well-known family of words between curvatures 0, made of whole turns, in compiled code.

T. Fraichard and A. Scheuer, From Reeds and Shepp's to continuous-curvature paths, IEEE Transactions on Robotics 20
(2004). A regular turn climbs to the curvature limit at full sharpness, holds it, and comes back: its ends lie on a
circle about the centre of its arc and cross it at a constant angle mu. A small turn keeps to the ends of the regular
one by two clothoids of less sharpness. So the words are those of Dubins on such circles, and a turn's length is a
function of its deflection alone, which is read from a table: no Fresnel integral per query.

A turn may also begin, or end, at the curvature limit: its arc then has one clothoid, and its outer end lies on the
circle of least radius.

Lengths are in least radii (see `spiral`).
"""

from __future__ import annotations

import math

import numpy as np

from optplan.compiled import njit
from optplan.domain.arrays import FloatArray
from optplan.geometry._kernels.cc_turns import limits_of, side_of
from optplan.geometry._kernels.spiral import spiral

S, T, TT, TST, TTT = range(5)
TWO_PI = 2.0 * math.pi
SMALL = 4.5948
"""rad; beyond this deflection two symmetric clothoids end behind their start (A. Scheuer and T. Fraichard, 1997)"""
SNAP = 1e-9
"""rad; deflections this little below 0 are turns the other way, not full turns"""
EXACT = 1e-12
"""What is this near to touching, or to one circle, is so."""
STRAIGHT = 1e-10
"""An end this near to straight on is reached by a line."""
CELLS = 256
HEAD = 6
"""numbers ahead of the cells"""


@njit("float64(float64, float64, float64[:, ::1])", cache=True, nogil=True, error_model="numpy")
def _chord_share(delta: float, s: float, table: FloatArray) -> float:
    """Chord over length of two symmetric clothoids that turn by `delta` > 0, of any sharpness."""
    k = math.sqrt(s * delta)
    ex, ey = spiral(table, k)
    return s * (math.cos(0.5 * delta) * ex + math.sin(0.5 * delta) * ey) / k


@njit("float64(float64, float64, float64, float64, float64[:, ::1])", cache=True, nogil=True, error_model="numpy")
def _small_length(delta: float, s: float, radius: float, mu: float, table: FloatArray) -> float:
    """Length of two clothoids that keep to the ends of the regular turn; inf where there are none."""
    if delta < 1e-18:
        return 2.0 * radius * math.sin(mu)
    if delta >= SMALL or delta >= 1.0 / s or math.sin(0.5 * delta + mu) <= 0.0:
        return math.inf
    length = 2.0 * radius * math.sin(0.5 * delta + mu) / _chord_share(delta, s, table)
    # a shorter pair of clothoids would be sharper than the limit
    if length < 2.0 * math.sqrt(delta / s) * (1.0 - 1e-12):
        return math.inf
    return length


@njit("float64[::1](float64, float64[:, ::1])", cache=True, nogil=True, error_model="numpy")
def turn_table(s: float, table: FloatArray) -> FloatArray:
    """What the reference family asks of its limits: x, y of the circle's centre, its radius, mu, the deflection of two
    whole clothoids, the deflection up to which lengths are in the table; then 6 coefficients a cell of
    chord / length of two clothoids.
    """
    out = np.empty(HEAD + 6 * CELLS)
    side = side_of(1.0, 0.0, limits_of(s, table), table)
    cx, cy = side[7], side[8]
    radius = math.hypot(cx, cy)
    mu = math.atan2(cx, cy)
    out[0], out[1], out[2], out[3], out[4] = cx, cy, radius, mu, 1.0 / s
    most = 0.0
    for i in range(1, 4096):
        delta = min(SMALL, 1.0 / s) * i / 4096
        if math.isinf(_small_length(delta, s, radius, mu, table)):
            break
        most = delta
    if most > 0.0 and _small_length(min(SMALL, 1.0 / s) * (1.0 - 1e-9), s, radius, mu, table) < math.inf:
        most = min(SMALL, 1.0 / s)
    out[5] = most
    h = most / CELLS
    for i in range(CELLS):
        # interpolation at six Chebyshev nodes of the cell, in Newton's form turned into powers
        nodes = np.empty(6)
        values = np.empty(6)
        for j in range(6):
            nodes[j] = 0.5 - 0.5 * math.cos((2 * j + 1) * math.pi / 12.0)
            values[j] = _chord_share((i + nodes[j]) * h, s, table)
        for order in range(1, 6):
            for j in range(5, order - 1, -1):
                values[j] = (values[j] - values[j - 1]) / (nodes[j] - nodes[j - order])
        powers = np.zeros(6)
        for j in range(5, -1, -1):
            for p in range(5, 0, -1):
                powers[p] = powers[p - 1] - nodes[j] * powers[p]
            powers[0] = values[j] - nodes[j] * powers[0]
        for j in range(6):
            out[HEAD + 6 * i + j] = powers[j]
    return out


@njit("float64(float64)", cache=True, nogil=True, error_model="numpy", inline="always")
def _wrapped(angle: float) -> float:
    """In [-SNAP, 2 pi - SNAP): just below no turn is a small turn the other way, not a full one."""
    return angle - TWO_PI * math.floor((angle + SNAP) / TWO_PI)


@njit("float64(float64, float64[::1])", cache=True, nogil=True, error_model="numpy")
def turn_length(delta: float, turns: FloatArray) -> float:
    """Length of the shorter of the small and the regular turn by `delta` in [-SNAP, 2 pi - SNAP)."""
    regular: float = delta - turns[4]
    if regular < 0.0:
        regular += TWO_PI * math.ceil(-regular / TWO_PI)
    regular += 2.0 * turns[4]
    if delta < turns[5]:
        at = delta / turns[5] * CELLS
        i = min(max(int(at), 0), CELLS - 1)
        u = at - i
        c = HEAD + 6 * i
        small = turns[c] + u * (
            turns[c + 1] + u * (turns[c + 2] + u * (turns[c + 3] + u * (turns[c + 4] + u * turns[c + 5])))
        )
        small = 2.0 * turns[2] * math.sin(0.5 * delta + turns[3]) / small
        if small < regular:
            regular = small
    return regular


@njit("float64(float64, float64, float64[::1])", cache=True, nogil=True, error_model="numpy", inline="always")
def _end_length(delta: float, held: float, turns: FloatArray) -> float:
    """Length of a first or last turn, which begins or ends at the limit when it is held."""
    if held != 0.0:
        arc: float = _wrapped(delta - 0.5 * turns[4])
        return float(arc + turns[4])
    whole: float = turn_length(delta, turns)
    return whole


@njit("float64(float64, float64, float64[::1])", cache=True, nogil=True, error_model="numpy", inline="always")
def _least_length(delta: float, held: float, turns: FloatArray) -> float:
    """No such turn is shorter: from straight to straight, two clothoids of the limit's sharpness."""
    if held != 0.0:
        return float(turns[4])
    return 2.0 * (1.0 - 1e-9) * math.sqrt(max(delta, 0.0) * turns[4])


@njit(
    "UniTuple(float64, 7)(float64, float64, float64, float64, float64, float64[::1])",
    cache=True,
    nogil=True,
    error_model="numpy",
)
def reference_word(
    x: float, y: float, theta: float, held1: float, held2: float, turns: FloatArray
) -> tuple[float, float, float, float, float, float, float]:
    """Length, word, sides of the first and last turn (1: left), first deflection, line or middle deflection, last.

    held1, held2 : the curvature at the start and the end: 0, or 1 or -1, the limit of one side, with which the word's
    first or last turn has to agree
    """
    cx, cy, radius, mu = turns[0], turns[1], turns[2], turns[3]
    # the centre of the first and last circle, as far ahead of the start and behind the end
    cx1, cy1 = (cx, cy) if held1 == 0.0 else (0.0, 1.0)
    cx2, cy2 = (cx, cy) if held2 == 0.0 else (0.0, 1.0)
    c = math.cos(theta)
    sn = math.sin(theta)
    size = 1.0 + abs(x) + abs(y)
    straight = held1 == 0.0 and held2 == 0.0
    if straight and abs(y) <= STRAIGHT * size and abs(sn) <= STRAIGHT and c > 0.0 and x >= 0.0:
        return x, float(S), 1.0, 1.0, 0.0, x, 0.0
    best = math.inf
    word = float(S)
    side1 = side2 = first = middle = last = 0.0
    for i in range(4):
        d1 = 1.0 if i == 0 or i == 2 else -1.0
        d2 = 1.0 if i == 0 or i == 3 else -1.0
        if d1 * held1 < 0.0 or d2 * held2 < 0.0:
            continue
        # from centre to centre; the last circle is seen backwards
        gx = x - c * cx2 - d2 * sn * cy2 - cx1
        gy = y - sn * cx2 + d2 * c * cy2 - d1 * cy1
        apart = math.sqrt(gx * gx + gy * gy)
        if i < 2:
            if apart <= 10.0 * EXACT * size:
                delta = _wrapped(d1 * theta)
                if held1 != 0.0 and held2 != 0.0:
                    length = delta
                else:
                    length = _end_length(delta, held1 + held2, turns)
                if length < best:
                    best, word, side1, side2, first, middle, last = length, float(T), d1, d2, delta, 0.0, 0.0
                continue
            line = apart - 2.0 * cx
            if line < 0.0 or line >= best:
                continue
            psi = math.atan2(gy, gx)
        elif apart >= 2.0 * radius * (1.0 - 1e-12):
            # inner tangent; circles that touch are the word TT
            line = math.sqrt(max(apart * apart - 4.0 * cy * cy, 0.0)) - 2.0 * cx
            if line >= best:
                continue
            psi = math.atan2(gy, gx) + d1 * math.asin(min(2.0 * cy / apart, 1.0))
        else:
            continue
        delta1 = _wrapped(d1 * psi)
        delta2 = _wrapped(d2 * (theta - psi))
        if line + _least_length(delta1, held1, turns) + _least_length(delta2, held2, turns) >= best:
            continue
        length = line + _end_length(delta1, held1, turns) + _end_length(delta2, held2, turns)
        if length < best:
            kind = float(TT) if i >= 2 and line <= EXACT * size else float(TST)
            best, word, side1, side2, first, middle, last = length, kind, d1, d2, delta1, line, delta2
    for i in range(2):
        d1 = 1.0 if i == 0 else -1.0
        if d1 * held1 < 0.0 or d1 * held2 < 0.0:
            continue
        gx = x - c * cx2 - d1 * sn * cy2 - cx1
        gy = y - sn * cx2 + d1 * c * cy2 - d1 * cy1
        apart = math.sqrt(gx * gx + gy * gy)
        if apart > 4.0 * radius or apart <= 10.0 * EXACT * size:
            continue
        angle = math.atan2(gy, gx)
        bend = math.acos(apart / (4.0 * radius))
        for way in range(2):
            off = bend if way == 0 else -bend
            # a turn leaves its circle at polar angle phi with heading phi + d (pi / 2 - mu)
            psi1 = angle + off + d1 * (0.5 * math.pi - mu)
            psi2 = angle - off - d1 * (0.5 * math.pi - mu)
            delta1 = _wrapped(d1 * psi1)
            delta2 = _wrapped(d1 * (psi1 - psi2))
            delta3 = _wrapped(d1 * (theta - psi2))
            least = _least_length(delta2, 0.0, turns)
            least += _least_length(delta1, held1, turns) + _least_length(delta3, held2, turns)
            if least >= best:
                continue
            length = turn_length(delta2, turns)
            length += _end_length(delta1, held1, turns) + _end_length(delta3, held2, turns)
            if length < best:
                best, word, side1, side2, first, middle, last = length, float(TTT), d1, d1, delta1, delta2, delta3
    return best, word, side1, side2, first, middle, last


@njit(
    "int64(float64, float64, float64, float64, float64, float64[::1], float64[:, ::1], int64)",
    cache=True,
    nogil=True,
    error_model="numpy",
)
def held_pieces(
    d: float, delta: float, held1: float, held2: float, s: float, turns: FloatArray, pieces: FloatArray, n: int
) -> int:
    """Writes rows of a turn that begins (held1) or ends (held2) at the limit, or both, as `turn_pieces` does."""
    ramps = 1.0 if held1 == 0.0 or held2 == 0.0 else 0.0
    if held1 == 0.0:
        pieces[n, 0], pieces[n, 1], pieces[n, 2] = 0.0, d * s, 1.0 / s
        n += 1
    pieces[n, 0], pieces[n, 1], pieces[n, 2] = d, 0.0, max(_wrapped(delta - 0.5 * ramps * turns[4]), 0.0)
    n += 1
    if held2 == 0.0:
        pieces[n, 0], pieces[n, 1], pieces[n, 2] = d, -d * s, 1.0 / s
        n += 1
    return n


@njit(
    "int64(float64, float64, float64, float64[::1], float64[:, ::1], float64[:, ::1], int64)",
    cache=True,
    nogil=True,
    error_model="numpy",
)
def turn_pieces(
    d: float, delta: float, s: float, turns: FloatArray, table: FloatArray, pieces: FloatArray, n: int
) -> int:
    """Writes rows curvature, sharpness, length of a turn after row n; returns the number of rows then."""
    radius, mu = turns[2], turns[3]
    length = turn_length(delta, turns)
    small = _small_length(abs(delta), s, radius, mu, table) if delta < turns[5] else math.inf
    if small <= length * (1.0 + 1e-6):
        # the exact chord, not the one of the table; just below 0 it is that of a turn the other way
        if abs(delta) < 1e-18:
            pieces[n, 0], pieces[n, 1], pieces[n, 2] = 0.0, 0.0, 2.0 * radius * math.sin(mu)
            return n + 1
        if delta < 0.0:
            small *= math.sin(0.5 * delta + mu) / math.sin(mu - 0.5 * delta)
        sharpness = min(4.0 * delta / (small * small), s)
        pieces[n, 0], pieces[n, 1], pieces[n, 2] = 0.0, d * sharpness, 0.5 * small
        pieces[n + 1, 0], pieces[n + 1, 1], pieces[n + 1, 2] = 0.5 * d * sharpness * small, -d * sharpness, 0.5 * small
        return n + 2
    regular = delta - turns[4]
    if regular < 0.0:
        regular += TWO_PI * math.ceil(-regular / TWO_PI)
    pieces[n, 0], pieces[n, 1], pieces[n, 2] = 0.0, d * s, 1.0 / s
    pieces[n + 1, 0], pieces[n + 1, 1], pieces[n + 1, 2] = d, 0.0, regular
    pieces[n + 2, 0], pieces[n + 2, 1], pieces[n + 2, 2] = d, -d * s, 1.0 / s
    return n + 3
