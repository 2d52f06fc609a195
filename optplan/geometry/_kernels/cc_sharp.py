"""Words with cusps at full sharpness: Newton's method from arcs of several radii, in compiled code.

A turn climbs to a peak and falls to 0, as sharply as the limit allows; its extended peak t (above 1 an arc is held) is
its only unknown, and its length is (2 t - a) / s between curvatures a and 0. The first turn begins with the start's
curvature, the last ends with the end's. Guesses are the words of Reeds and Shepp: a small turn is like an arc of
a larger radius, so several are tried.

Lengths are in least radii (see `spiral`).
"""

from __future__ import annotations

import math

from optplan.compiled import njit
from optplan.domain.arrays import FloatArray
from optplan.geometry._kernels.cusps import KINDS, NONE, PLAIN, WORDS, arcs, cusp_words, segments_of
from optplan.geometry._kernels.spiral import spiral

TWO_PI = 2.0 * math.pi
STEPS = 14
"""of Newton's method"""
CLOSE = 3e-12
"""of a place, by its distance, and of a heading, rad"""
KEPT = 0.2
"""share of an unknown that a step leaves at least: none may become negative"""
DELTAS = (0.1, 0.4, 1.5)
"""rad; turns by these angles are as long as arcs of the radii that are tried"""
PROMISING, LOST = 1.15, 1.5
"""shares of the shortest length known: a guess above the first, or a step above the second, is given up"""


@njit("UniTuple(float64, 6)(float64, float64, float64, float64[:, ::1])", cache=True, nogil=True, error_model="numpy")
def _turn(t: float, a: float, s: float, table: FloatArray) -> tuple[float, float, float, float, float, float]:
    """A left turn from heading 0 and curvature a to 0: displacement, how it changes with t, angle, how that changes."""
    k = min(t, 1.0)
    ex, ey = spiral(table, k)
    ax, ay = spiral(table, a)
    c = math.cos(0.5 * a * a / s)
    sn = -math.sin(0.5 * a * a / s)
    x = c * (ex - ax) - sn * (ey - ay)
    y = c * (ey - ay) + sn * (ex - ax)
    h = 0.5 * (k * k - a * a) / s
    if t > 1.0:
        w = 2.0 * (t - 1.0) / s
        x += math.sin(h + w) - math.sin(h)
        y += math.cos(h) - math.cos(h + w)
        h += w
    c = math.cos(h + 0.5 * k * k / s)
    sn = math.sin(h + 0.5 * k * k / s)
    # the rest is conj(E(k)) turned; it swings about the centre at the peak
    rx = c * ex + sn * ey
    ry = sn * ex - c * ey
    rate = 2.0 / s
    dx = rate * (math.cos(h) - k * ry)
    dy = rate * (math.sin(h) + k * rx)
    return x + rx, y + ry, dx, dy, h + 0.5 * k * k / s, rate * k


@njit("float64(float64, float64, float64)", cache=True, nogil=True, error_model="numpy")
def _peak(delta: float, a: float, s: float) -> float:
    """Extended peak of a turn by `delta` between curvatures a and 0, of the least one if that is more."""
    square = max(s * delta + 0.5 * a * a, max(a, 0.0) ** 2)
    return math.sqrt(square) if square < 1.0 else 0.5 * (square + 1.0)


@njit(
    "float64(float64[:, ::1], int64, float64, float64, float64, float64, float64, float64, float64, float64,"
    "float64[:, ::1], float64[:, ::1])",
    cache=True,
    nogil=True,
    error_model="numpy",
)
def sharpened(
    segments: FloatArray,
    count: int,
    x: float,
    y: float,
    theta: float,
    a: float,
    b: float,
    radius: float,
    s: float,
    most: float,
    table: FloatArray,
    work: FloatArray,
) -> float:
    """Length of a word at full sharpness; inf when none is found that is shorter than `most`.

    Parameters
    ----------
    segments : (SEGMENTS, 3) gear, side, and angle of an arc or length of a line in radii; they become peaks and lengths
    count : number of segments
    x, y, theta : the end, seen from the start
    a, b : the wheels' curvatures at both ends
    radius : of the arcs
    work : (5, SEGMENTS) for numbers on the way
    """
    jacobian = work[:3]
    places = work[3:]
    close = CLOSE * (1.0 + abs(x) + abs(y))
    for j in range(count):
        bend = (a if j == 0 else b if j == count - 1 else 0.0) * segments[j, 0] * segments[j, 1]
        if segments[j, 1] != 0.0:
            segments[j, 2] = _peak(segments[j, 2], bend, s)
        else:
            segments[j, 2] *= radius
    for step_number in range(STEPS):
        px = py = heading = length = 0.0
        for j in range(count):
            gear, side, t = segments[j, 0], segments[j, 1], segments[j, 2]
            c = math.cos(heading)
            sn = math.sin(heading)
            if side == 0.0:
                dx, dy, rx, ry, turned, rate = t, 0.0, 1.0, 0.0, 0.0, 0.0
                length += t
            else:
                bend = (a if j == 0 else b if j == count - 1 else 0.0) * gear * side
                dx, dy, rx, ry, turned, rate = _turn(t, bend, s, table)
                length += (2.0 * t - bend) / s
                if j == count - 1:
                    # the same seen backwards
                    ct = math.cos(turned)
                    st = math.sin(turned)
                    rx, ry = rx - rate * dy, -ry + rate * dx
                    dx, dy = ct * dx + st * dy, st * dx - ct * dy
                    rx, ry = ct * rx - st * ry, st * rx + ct * ry
                dy *= side
                ry *= side
            px += gear * (c * dx - sn * dy)
            py += gear * (sn * dx + c * dy)
            heading += side * turned
            places[0, j], places[1, j] = px, py
            jacobian[0, j] = gear * (c * rx - sn * ry)
            jacobian[1, j] = gear * (sn * rx + c * ry)
            jacobian[2, j] = side * rate
        ox = x - px
        oy = y - py
        off = theta - heading
        off -= TWO_PI * math.floor(off / TWO_PI + 0.5)
        if abs(ox) + abs(oy) < close and abs(off) < CLOSE:
            for j in range(0, count, count - 1):
                # a peak below the end's curvature would be behind it
                if segments[j, 2] < (a if j == 0 else b) * segments[j, 0] * segments[j, 1]:
                    return math.inf
            return length if length < most else math.inf
        if length > (PROMISING if step_number == 0 else LOST) * most:
            return math.inf
        # the shortest step that would close the gap: J' (J J')^-1 r
        m00 = m01 = m02 = m11 = m12 = m22 = 0.0
        for j in range(count):
            jacobian[0, j] -= jacobian[2, j] * (py - places[1, j])
            jacobian[1, j] += jacobian[2, j] * (px - places[0, j])
            u, v, w = jacobian[0, j], jacobian[1, j], jacobian[2, j]
            m00 += u * u
            m01 += u * v
            m02 += u * w
            m11 += v * v
            m12 += v * w
            m22 += w * w
        c00 = m11 * m22 - m12 * m12
        c01 = m02 * m12 - m01 * m22
        c02 = m01 * m12 - m02 * m11
        det = m00 * c00 + m01 * c01 + m02 * c02
        if not abs(det) > 1e-14 * m00 * m11 * m22:
            return math.inf
        c11 = m00 * m22 - m02 * m02
        c12 = m01 * m02 - m00 * m12
        c22 = m00 * m11 - m01 * m01
        u = (c00 * ox + c01 * oy + c02 * off) / det
        v = (c01 * ox + c11 * oy + c12 * off) / det
        w = (c02 * ox + c12 * oy + c22 * off) / det
        share = 1.0
        for j in range(count):
            step = jacobian[0, j] * u + jacobian[1, j] * v + jacobian[2, j] * w
            if step < 0.0 and -share * step > (1.0 - KEPT) * segments[j, 2]:
                share = (1.0 - KEPT) * segments[j, 2] / -step
        for j in range(count):
            segments[j, 2] += share * (jacobian[0, j] * u + jacobian[1, j] * v + jacobian[2, j] * w)
    return math.inf


@njit(
    "float64(float64, float64, float64, float64, float64, float64, float64, float64[:, ::1], float64[:, ::1],"
    "float64[:, ::1], float64[:, ::1], float64[:, ::1])",
    cache=True,
    nogil=True,
    error_model="numpy",
)
def sharp_words(
    x: float,
    y: float,
    theta: float,
    a: float,
    b: float,
    s: float,
    most: float,
    table: FloatArray,
    words: FloatArray,
    segments: FloatArray,
    work: FloatArray,
    choice: FloatArray,
) -> float:
    """Length of the shortest word at full sharpness that is shorter than `most`, else `most`.

    Fills the number of its segments into choice[0, 0], 1 into choice[0, 1], and the segments from choice[2] on.
    """
    circles = arcs()
    for delta in DELTAS:
        radius = 2.0 * _peak(delta, 0.0, s) / (s * delta)
        # the same for all words of a radius, so that a mirrored query tries the same ones
        bound = most
        cusp_words(x / radius, y / radius, theta, PROMISING * bound / radius, circles, words)
        for row in range(WORDS):
            # words without cusps are left to `cc_full`
            if words[row, 1] == NONE or row % KINDS < PLAIN:
                continue
            count = segments_of(words[row], segments)
            length = sharpened(segments, count, x, y, theta, a, b, radius, s, bound, table, work)
            if length < most:
                most = length
                choice[0, 0], choice[0, 1] = count, 1.0
                choice[2:] = segments
    return most


@njit(
    "int64(float64, float64, float64, float64, float64, float64, float64[:, ::1], int64)",
    cache=True,
    nogil=True,
    error_model="numpy",
)
def sharp_pieces(gear: float, side: float, t: float, a: float, b: float, s: float, pieces: FloatArray, n: int) -> int:
    """Writes rows curvature, sharpness, length, gear of a turn after row n; returns the number of rows then.

    a, b : the wheels' curvatures at both ends
    """
    k = min(t, 1.0)
    a *= gear * side
    b *= gear * side
    rows = ((a, s, (k - a) / s), (k, 0.0, 2.0 * (t - k) / s), (k, -s, (k - b) / s))
    for curvature, sharpness, length in rows:
        pieces[n, 0], pieces[n, 1], pieces[n, 2], pieces[n, 3] = side * curvature, side * sharpness, length, gear
        n += 1
    return n
