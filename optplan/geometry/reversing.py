"""Shortest paths of a car that drives forwards and backwards: Reeds-Shepp paths, and ways of continuous curvature.

A state is x, y, the heading of the body and, for continuous curvature, the curvature that the wheels are turned to. A
path is a chain of pieces, each in a gear: 1 forwards, -1 backwards. Where the gear changes (a cusp) the car stands.
Pieces are described in the direction of travel: backwards, heading and curvature are not those of the body.
`docs/maths/connectors.md` describes the words and how they are found.
"""

from __future__ import annotations

import math
from collections.abc import Callable
from typing import NamedTuple

import numpy as np

from optplan.domain.arrays import FloatArray
from optplan.domain.errors import InputError
from optplan.geometry.cc import EMPTY, END_HEADING, END_POSITION, END_SHARE, SLICE, cc_path, checked
from optplan.geometry.curves import Curve
from optplan.geometry.threads import by_rows

_LETTERS = {1: "L", 0: "S", -1: "R"}


class ReversingPath(NamedTuple):
    """A short path and its pieces, clothoids in driving order; empty ones are left out."""

    word: str
    """where the wheels point, and the gear of each segment: "L+R-L+" """
    length: float
    """m"""
    gears: FloatArray
    """(k,) 1 or -1"""
    curvatures: FloatArray
    """(k,) 1/m, at the beginning of each piece, left of the direction of travel positive"""
    sharpnesses: FloatArray
    """(k,) 1/m^2, of each piece"""
    lengths: FloatArray
    """(k,) m, of each piece"""

    @property
    def cusps(self) -> int:
        """How often the gear changes."""
        return int((np.diff(self.gears) != 0).sum())

    def curves(self, start: FloatArray) -> tuple[Curve, ...]:
        """One for each run in one gear, in the direction of travel, from x, y and heading of the body (3,)."""
        made: list[Curve] = []
        at = np.asarray(start, dtype=np.float64)
        for run in np.split(np.arange(len(self.gears)), np.flatnonzero(np.diff(self.gears)) + 1):
            if len(run):
                turned = np.array([0.0, 0.0, 0.0 if self.gears[run[0]] > 0 else math.pi])
                made.append(Curve(at + turned, self.curvatures[run], self.sharpnesses[run], self.lengths[run]))
                at = made[-1].end - turned
        return tuple(made)


def reeds_shepp_path(start: FloatArray, end: FloatArray, radius: float) -> ReversingPath:
    """The shortest of all 48 words.

    J. A. Reeds and L. A. Shepp, Optimal paths for a car that goes both forwards and backwards, Pacific Journal of
    Mathematics 145 (1990).

    Parameters
    ----------
    start, end : (3,) x, y, heading: m, m, rad
    radius : least turning radius, m, > 0

    Raises
    ------
    InputError : a radius that is not above 0, or a state that is not finite
    """
    from optplan.geometry._kernels import cusps
    from optplan.geometry._kernels.reeds_shepp import shortest

    first, last = _poses(start, end, radius)
    words, segments = np.empty((cusps.WORDS, cusps.COLUMNS)), np.empty((cusps.SEGMENTS, 3))
    row = shortest(first, last, float(radius), cusps.arcs(), words)
    kept = segments[: cusps.segments_of(words[row], segments)]
    kept = kept[kept[:, 2] > EMPTY]
    lengths = kept[:, 2] * radius
    return ReversingPath(
        _word(kept), float(lengths.sum()), kept[:, 0], kept[:, 1] / radius, np.zeros(len(kept)), lengths
    )


def reeds_shepp_lengths(starts: FloatArray, ends: FloatArray, radius: float) -> FloatArray:
    """Lengths (k,) m of shortest paths between rows x, y, heading of (k, 3) arrays. Raises like `reeds_shepp_path`."""
    from optplan.geometry._kernels import reeds_shepp

    lengths: FloatArray = reeds_shepp.lengths(*_poses(starts, ends, radius), float(radius))
    return lengths


def reeds_shepp_matrix(
    exits: FloatArray,
    entries: FloatArray,
    radius: float,
    threads: int | None = None,
    told: Callable[[float], None] | None = None,
) -> FloatArray:
    """Lengths (n, m) m from every exit (n, 3) to every entry (m, 3), by threads. Raises like `reeds_shepp_path`.

    `told` is called with the share that is done; what it raises ends the work.
    """
    from optplan.geometry._kernels import reeds_shepp

    first, last = _poses(exits, entries, radius)
    out = np.empty((len(first), len(last)))

    def fill(part: slice) -> None:
        reeds_shepp.matrix(first[part], last, float(radius), out[part])

    by_rows(fill, len(first), max(1, SLICE // max(len(last), 1)), threads, told)
    return out


def reversing_path(start: FloatArray, end: FloatArray, curvature: float, sharpness: float) -> ReversingPath:
    """The shortest path of continuous curvature that is known; there is one between any two states.

    Never longer than `cc_path`, nor than that driven backwards. Curvature is 0 at cusps.

    Parameters
    ----------
    start, end : (4,) x, y, heading of the body, curvature that the wheels are turned to: m, m, rad, 1/m
    curvature, sharpness : limits kappa_max and sigma_max, 1/m and 1/m^2, > 0

    Raises
    ------
    InputError : a limit that is not above 0 or not finite, a state that is not finite, a curvature beyond its limit
    """
    from optplan.geometry._kernels import cc, cc_cusps

    checked(start, end, curvature, sharpness, "full", 1)
    first, last = (np.array(state, dtype=np.float64) for state in (start, end))
    s = sharpness / curvature / curvature
    shared = cc.tables(s)
    choice = np.zeros((cc_cusps.CHOICE, 3))
    length, way = cc_cusps.solve(first, last, curvature, s, *shared, choice)
    if length == 0.0:
        return ReversingPath("", 0.0, *(np.empty(0) for _ in range(4)))
    if way == cc_cusps.CUSPS:
        made = _with_cusps(first, last, curvature, s, choice, shared)
        if _arrives(made, first, last):
            return made
        # for want of digits it would miss its end, so a path without cusps is taken
    ways = [_one_gear(first, last, curvature, sharpness, gear) for gear in (1, -1)]
    if way != cc_cusps.CUSPS:
        return ways[0 if way == cc_cusps.FORWARDS else 1]
    return min(ways, key=lambda path: path.length)


def reversing_lengths(starts: FloatArray, ends: FloatArray, curvature: float, sharpness: float) -> FloatArray:
    """Lengths (k,) m of `reversing_path` between rows x, y, heading, curvature of (k, 4) arrays. Raises like it."""
    from optplan.geometry._kernels import cc, cc_cusps

    checked(starts, ends, curvature, sharpness, "full", 2)
    if np.shape(starts) != np.shape(ends):
        raise InputError(f"{len(starts)} starts and {len(ends)} ends; expected as many of both")
    first, last = (np.ascontiguousarray(states, dtype=np.float64) for states in (starts, ends))
    s = sharpness / curvature / curvature
    shared = cc.tables(s)
    out = np.empty(len(first))
    for i in range(0, len(first), SLICE):
        part = slice(i, i + SLICE)
        cc_cusps.lengths(first[part], last[part], curvature, s, *shared, out[part])
    return out


def reversing_matrix(
    exits: FloatArray,
    entries: FloatArray,
    curvature: float,
    sharpness: float,
    threads: int | None = None,
    told: Callable[[float], None] | None = None,
) -> FloatArray:
    """Lengths (n, m) m from every exit (n, 4) to every entry (m, 4), by threads. Raises like `reversing_path`.

    `told` is called with the share that is done; what it raises ends the work.
    """
    from optplan.geometry._kernels import cc, cc_cusps

    checked(exits, entries, curvature, sharpness, "full", 2)
    first, last = (np.ascontiguousarray(states, dtype=np.float64) for states in (exits, entries))
    s = sharpness / curvature / curvature
    shared = cc.tables(s)
    out = np.empty((len(first), len(last)))

    def fill(part: slice) -> None:
        cc_cusps.matrix(first[part], last, curvature, s, *shared, out[part])

    by_rows(fill, len(first), max(1, SLICE // 4 // max(len(last), 1)), threads, told)
    return out


def _poses(starts: FloatArray, ends: FloatArray, radius: float) -> tuple[FloatArray, FloatArray]:
    """Arrays of x, y, heading for the kernels; InputError for what cannot be solved."""
    if not (math.isfinite(radius) and radius > 0):
        raise InputError(f"the turning radius is {radius} m; expected a finite number above 0")
    first, last = (np.ascontiguousarray(states, dtype=np.float64) for states in (starts, ends))
    if not (np.isfinite(first).all() and np.isfinite(last).all()):
        raise InputError("a state of a Reeds-Shepp path is not finite; expected x, y, heading")
    return first, last


def _word(segments: FloatArray) -> str:
    """Of rows gear, side the body turns to, size."""
    return "".join(f"{_LETTERS[int(gear * side)]}{'+' if gear > 0 else '-'}" for gear, side, _ in segments)


def _one_gear(first: FloatArray, last: FloatArray, curvature: float, sharpness: float, gear: int) -> ReversingPath:
    """The path of `cc_path`, or that driven backwards: a path forwards of a car that is turned round."""
    turned = np.array([0.0, 0.0, 0.0 if gear > 0 else math.pi, 0.0])
    sign = np.array([1.0, 1.0, 1.0, gear])
    made = cc_path(turned + sign * first, turned + sign * last, curvature, sharpness)
    count = len(made.lengths)
    word = made.word if gear > 0 else made.word.translate(str.maketrans("LR", "RL"))
    name = "".join(f"{letter}{'+' if gear > 0 else '-'}" for letter in word if letter in "LSR")
    return ReversingPath(
        name, made.length, np.full(count, float(gear)), made.curvatures, made.sharpnesses, made.lengths
    )


def _with_cusps(
    first: FloatArray,
    last: FloatArray,
    curvature: float,
    s: float,
    choice: FloatArray,
    shared: tuple[FloatArray, FloatArray, FloatArray],
) -> ReversingPath:
    """The path that the kernel has chosen."""
    from optplan.geometry._kernels import cc_cusps

    count, _, swapped = choice[0]
    a, b = first[3] / curvature, last[3] / curvature
    if swapped:
        a, b = b, a
    pieces = np.zeros((cc_cusps.PIECES, 4))
    table, _, turns = shared
    rows = pieces[: cc_cusps.pieces_of(choice, a, b, s, table, turns, pieces)]
    segments = choice[2 : 2 + int(count)]
    if swapped:
        # the same places the other way round, in the other gears
        rows, segments = rows[::-1].copy(), segments[::-1] * np.array([-1.0, -1.0, 1.0])
        rows[:, 0] = -(rows[:, 0] + rows[:, 1] * rows[:, 2])
        rows[:, 3] *= -1
    rows = rows[rows[:, 2] > EMPTY * rows[:, 2].sum()]
    bends, sharpnesses, lengths, gears = rows.T
    return ReversingPath(
        _word(segments),
        float(lengths.sum()) / curvature,
        gears,
        bends * curvature,
        sharpnesses * curvature**2,
        lengths / curvature,
    )


def _arrives(path: ReversingPath, first: FloatArray, last: FloatArray) -> bool:
    """Whether a path that is driven ends in its end."""
    from optplan.geometry._kernels.clothoid import clothoid_end

    x, y, heading = first[:3]
    rows = zip(path.gears, path.curvatures, path.sharpnesses, path.lengths, strict=True)
    for gear, curvature, sharpness, length in rows:
        back = 0.0 if gear > 0 else math.pi
        x, y, heading, _ = clothoid_end(x, y, heading + back, curvature, sharpness, length)
        heading -= back
    close = max(END_POSITION, END_SHARE * path.length)
    return math.hypot(x - last[0], y - last[1]) <= close and (
        abs(math.remainder(heading - last[2], 2 * math.pi)) <= END_HEADING
    )
