"""The 48 words of a car that also drives backwards, on circles that turns of continuous curvature keep to, compiled.

J. A. Reeds and L. A. Shepp, Optimal paths for a car that goes both forwards and backwards, Pacific Journal of
Mathematics 145 (1990), name the words; T. Fraichard and A. Scheuer, From Reeds and Shepp's to continuous-curvature
paths, IEEE Transactions on Robotics 20 (2004), put circles of radius R in the place of arcs, which they cross at an
angle mu (see `cc_reference`); mu = 0 and R = 1 are the words of Reeds and Shepp.

A segment has a gear g, and turns the body's heading theta to the side e (1: left); its wheels point to d = e g. It
turns about p + i d R exp(i (theta - e mu)), seen from its beginning, p + i d R exp(i (theta + e mu)) from its end, so
two segments that meet at the heading phi set their centres apart by exp(i phi) w, where w is, with K = 2 R cos(mu),

    -i d K              at a cusp, after which d has changed and e has not
    -2 i d R exp(i e mu)    where e and d change
    g (l + 2 R sin mu)      along a line of length l, and -i d K more where e and d change behind it.

Each word is solved from the sum of these, which is known, and from what Reeds and Shepp have proved of its segments:
two turns in the middle are alike, turns between a cusp and a line are right angles.
"""

from __future__ import annotations

import math

import numpy as np

from optplan.compiled import njit
from optplan.domain.arrays import FloatArray
from optplan.geometry._kernels.cc_reference import turn_length

TWO_PI = 2.0 * math.pi
RIGHT = 0.5 * math.pi
SNAP = 1e-9
"""rad; deflections this little below 0 are turns the other way, not full turns"""
TOUCHING = 1e-12
"""Circles this near to touching do."""
SEGMENTS = 5
COLUMNS = 5 + SEGMENTS
"""of a word: length, number in `SIDES`, 1 or -1: gears as there, sides as there, order as there; then the segments'
angles (rad) or lengths"""
NONE = -1.0
"""number of a word that is not there"""
KINDS, PLAIN = 9, 2
"""kinds of words, the first of them without cusps"""
WORDS = 2 * KINDS
"""Rows of the shortest words: of each kind that begin forwards, then backwards. Of C|C|C both are often as long."""
SIDES = np.array(
    [
        # gear and side of each segment; side 0: a line, gear 0: none
        [[1, 1], [1, 0], [1, 1], [0, 0], [0, 0]],  # CSC
        [[1, 1], [1, 0], [1, -1], [0, 0], [0, 0]],
        [[1, 1], [-1, 1], [1, 1], [0, 0], [0, 0]],  # C|C|C
        [[1, 1], [1, -1], [-1, -1], [0, 0], [0, 0]],  # CC|C
        [[1, 1], [1, -1], [-1, -1], [-1, 1], [0, 0]],  # CCu|CuC
        [[1, 1], [-1, 1], [-1, -1], [1, -1], [0, 0]],  # C|CuCu|C
        [[1, 1], [-1, 1], [-1, 0], [-1, -1], [0, 0]],  # C|C(pi/2)SC
        [[1, 1], [-1, 1], [-1, 0], [-1, 1], [0, 0]],
        [[1, 1], [-1, 1], [-1, 0], [-1, -1], [1, -1]],  # C|C(pi/2)SC(pi/2)|C
    ],
    dtype=np.int64,
)


@njit("float64[::1]()", cache=True, nogil=True, error_model="numpy")
def arcs() -> FloatArray:
    """What `cusp_words` asks of turns that are arcs of radius 1: its circles are theirs, and curvature jumps."""
    circles = np.zeros(6)
    circles[1] = circles[2] = 1.0
    return circles


@njit("float64(float64)", cache=True, nogil=True, error_model="numpy", inline="always")
def _wrapped(angle: float) -> float:
    """In [-SNAP, 2 pi - SNAP)."""
    return angle - TWO_PI * math.floor((angle + SNAP) / TWO_PI)


@njit("float64(float64, float64[::1])", cache=True, nogil=True, error_model="numpy", inline="always")
def _length(delta: float, turns: FloatArray) -> float:
    """Of a turn; where curvature may jump, it is an arc."""
    if turns[4] == 0.0:
        return max(delta, 0.0)
    return turn_length(delta, turns)


@njit(
    "void(int64, float64, float64, float64, float64, float64, float64, float64, float64, float64[::1],float64[:, ::1])",
    cache=True,
    nogil=True,
    error_model="numpy",
)
def _offer(
    word: int,
    gears: float,
    sides: float,
    order: float,
    first: float,
    second: float,
    third: float,
    fourth: float,
    fifth: float,
    turns: FloatArray,
    best: FloatArray,
) -> None:
    """Keeps a word of these angles and lengths when it is the shortest of its kind."""
    parts = (first, second, third, fourth, fifth)
    angles = (_wrapped(first), _wrapped(second), _wrapped(third), _wrapped(fourth), _wrapped(fifth))
    row = word if gears > 0.0 else word + KINDS
    length = 0.0
    for k in range(SEGMENTS):
        if SIDES[word, k, 0] == 0:
            break
        if SIDES[word, k, 1] == 0:
            if parts[k] < 0.0:
                return
            length += parts[k]
        else:
            length += _length(angles[k], turns)
        if length >= best[row, 0]:
            return
    best[row, 0], best[row, 1], best[row, 2], best[row, 3], best[row, 4] = length, word, gears, sides, order
    for k in range(SEGMENTS):
        best[row, 5 + k] = parts[k] if SIDES[word, k, 1] == 0 else angles[k]


@njit("float64(float64)", cache=True, nogil=True, error_model="numpy", inline="always")
def _arccos(share: float) -> float:
    """NaN outside [-1, 1], but for rounding."""
    if abs(share) > 1.0 + TOUCHING:
        return math.nan
    return math.acos(min(max(share, -1.0), 1.0))


@njit(
    "void(float64, float64, float64, float64, float64, float64, float64[::1], float64[:, ::1])",
    cache=True,
    nogil=True,
    error_model="numpy",
)
def _three_and_more(
    x: float, y: float, theta: float, gears: float, sides: float, order: float, turns: FloatArray, best: FloatArray
) -> None:
    """The words that begin with a left turn forwards and are not the same backwards: CC|C and C|C(pi/2)SC."""
    cx, cy, radius, mu = turns[0], turns[1], turns[2], turns[3]
    across = 2.0 * cy
    joint = 2.0 * radius
    c = math.cos(theta)
    sn = math.sin(theta)
    # to the centre of a last turn with the wheels to the left, backwards: CC|C, and C|C(pi/2)SC that ends so
    gx = x + c * cx - sn * cy - cx
    gy = y + sn * cx + c * cy - cy
    apart = math.sqrt(gx * gx + gy * gy)
    angle = math.atan2(gy, gx)
    bend = _arccos((joint * joint + across * across - apart * apart) / (2.0 * joint * across))
    if not math.isnan(bend):
        for way in range(2):
            delta = (bend if way == 0 else -bend) - mu
            # i (K exp(-i delta) - J exp(i mu))
            wx = across * math.sin(delta) + joint * math.sin(mu)
            wy = across * math.cos(delta) - joint * math.cos(mu)
            phi = angle - math.atan2(wy, wx)
            _offer(3, gears, sides, order, phi, delta, phi - delta - theta, 0.0, 0.0, turns, best)
    if apart >= across:
        line = math.sqrt(apart * apart - across * across)
        phi = angle - math.atan2(across, -line)
        line -= across + 2.0 * cx
        _offer(6, gears, sides, order, phi - RIGHT, RIGHT, line, phi - theta, 0.0, turns, best)
    # and with the wheels to the right, backwards
    gx = x + c * cx + sn * cy - cx
    gy = y + sn * cx - c * cy - cy
    apart = math.sqrt(gx * gx + gy * gy)
    phi = math.atan2(-gy, -gx)
    line = apart - across - 2.0 * cx
    _offer(7, gears, sides, order, phi - RIGHT, RIGHT, line, theta - phi, 0.0, turns, best)


@njit(
    "void(float64, float64, float64, float64, float64, float64[::1], float64[:, ::1])",
    cache=True,
    nogil=True,
    error_model="numpy",
)
def _symmetric(
    x: float, y: float, theta: float, gears: float, sides: float, turns: FloatArray, best: FloatArray
) -> None:
    """The words that begin with a left turn forwards and are of the same kind backwards."""
    cx, cy, radius, mu = turns[0], turns[1], turns[2], turns[3]
    across = 2.0 * cy
    joint = 2.0 * radius
    c = math.cos(theta)
    sn = math.sin(theta)
    # a last turn to the left, forwards
    gx = x - c * cx - sn * cy - cx
    gy = y - sn * cx + c * cy - cy
    apart = math.sqrt(gx * gx + gy * gy)
    angle = math.atan2(gy, gx)
    _offer(0, gears, sides, 1.0, angle, apart - 2.0 * cx, theta - angle, 0.0, 0.0, turns, best)
    share = 0.5 * apart / across
    if share <= 1.0 + TOUCHING:
        half = math.asin(min(share, 1.0))
        for _ in range(2):
            phi = angle + math.pi - half
            _offer(2, gears, sides, 1.0, phi, 2.0 * half, theta - phi - 2.0 * half, 0.0, 0.0, turns, best)
            half = math.pi - half
    # a last turn with the wheels to the right, forwards
    gx = x - c * cx + sn * cy - cx
    gy = y - sn * cx - c * cy - cy
    apart = math.sqrt(gx * gx + gy * gy)
    angle = math.atan2(gy, gx)
    if apart >= across * (1.0 - TOUCHING):
        line = math.sqrt(max(apart * apart - across * across, 0.0))
        phi = angle + math.atan2(across, line)
        _offer(1, gears, sides, 1.0, phi, line - 2.0 * cx, phi - theta, 0.0, 0.0, turns, best)
        phi = angle - math.atan2(across, -line)
        line -= 2.0 * across + 2.0 * cx
        _offer(8, gears, sides, 1.0, phi - RIGHT, RIGHT, line, RIGHT, phi - RIGHT - theta, turns, best)
    bend = _arccos((joint * joint + 4.0 * across * across - apart * apart) / (4.0 * joint * across))
    if not math.isnan(bend):
        for way in range(2):
            u = (bend if way == 0 else -bend) - mu
            # i (J exp(i (u + mu)) - 2 K)
            phi = angle - math.atan2(joint * math.cos(u + mu) - 2.0 * across, -joint * math.sin(u + mu))
            _offer(5, gears, sides, 1.0, phi, u, u, phi - theta, 0.0, turns, best)
    # and backwards
    gx = x + c * cx + sn * cy - cx
    gy = y + sn * cx - c * cy - cy
    apart = math.sqrt(gx * gx + gy * gy)
    angle = math.atan2(gy, gx)
    for way in range(2):
        sign = 1.0 if way == 0 else -1.0
        bend = _arccos((across - sign * apart) / (2.0 * joint))
        if not math.isnan(bend):
            u = bend - mu
            phi = angle - sign * RIGHT + u
            _offer(4, gears, sides, 1.0, phi, u, u, theta - phi + 2.0 * u, 0.0, turns, best)


@njit(
    "int64(float64, float64, float64, float64, float64[::1], float64[:, ::1])",
    cache=True,
    nogil=True,
    error_model="numpy",
)
def cusp_words(x: float, y: float, theta: float, most: float, turns: FloatArray, best: FloatArray) -> int:
    """Fills the shortest words (WORDS, COLUMNS) between curvatures 0; returns the row of the shortest.

    From the origin with heading 0 to x, y, theta. Words no shorter than `most` are left out: their length stays `most`
    and their number `NONE`, as lengths that come back through other units may have lost a digit.
    `turns` are the circles as `cc_reference.turn_table` gives them.
    """
    best[:, 0], best[:, 1] = most, NONE
    back_x = x * math.cos(theta) + y * math.sin(theta)
    back_y = x * math.sin(theta) - y * math.cos(theta)
    for variant in range(4):
        gears = 1.0 - 2.0 * (variant & 1)
        sides = 1.0 - 2.0 * (variant >> 1)
        turned = gears * sides * theta
        _symmetric(gears * x, sides * y, turned, gears, sides, turns, best)
        _three_and_more(gears * x, sides * y, turned, gears, sides, 1.0, turns, best)
        _three_and_more(gears * back_x, sides * back_y, turned, gears, sides, -1.0, turns, best)
    return int(np.argmin(best[:, 0]))


@njit("int64(float64[::1], float64[:, ::1])", cache=True, nogil=True, error_model="numpy")
def segments_of(word: FloatArray, segments: FloatArray) -> int:
    """Writes rows gear, side the body turns to (0: a line), angle or length, in driving order; returns their number."""
    kind = int(word[1])
    count = SEGMENTS
    while SIDES[kind, count - 1, 0] == 0:
        count -= 1
    for k in range(count):
        at = k if word[4] > 0.0 else count - 1 - k
        segments[k, 0] = SIDES[kind, at, 0] * word[2]
        segments[k, 1] = SIDES[kind, at, 1] * word[2] * word[3]
        segments[k, 2] = word[5 + at]
    return count
