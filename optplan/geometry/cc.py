"""Paths of continuous curvature: short ways of a car that steers at a limited rate and only drives forwards.

A state is x, y, heading and curvature. Along a path the curvature stays within +-kappa_max and changes by no more than
sigma_max per metre. `docs/maths/connectors.md` describes the words and how they are found.
"""

from __future__ import annotations

import math
from collections.abc import Callable
from functools import lru_cache
from typing import Literal, NamedTuple

import numpy as np

from optplan.domain.arrays import FloatArray
from optplan.domain.errors import InputError
from optplan.geometry.threads import by_rows

Family = Literal["full", "reference"]
WORDS = ("LSL", "RSR", "LSR", "RSL", "LRL", "RLR")
END_POSITION, END_SHARE, END_HEADING = 1e-9, 1e-11, 1e-9
"""m, of the path's length (the larger of both), rad: a word that misses its end by more is passed over"""
SLICE = 20_000
"""queries between two looks at whether a cancel has come: 0.2 s"""
EMPTY = 1e-15
"""A piece this short, in units of the path's length, is left out."""


class CCPath(NamedTuple):
    """A short path and its pieces, clothoids in driving order; empty ones are left out."""

    word: str
    """turns and lines; `LL`: a left turn whose curvature dips; with 0: turns of the reference family"""
    length: float
    """m"""
    start: FloatArray
    """(4,) x, y, heading, curvature: m, m, rad, 1/m"""
    curvatures: FloatArray
    """(k,) 1/m, at the beginning of each piece, left turns positive"""
    sharpnesses: FloatArray
    """(k,) 1/m^2, of each piece"""
    lengths: FloatArray
    """(k,) m, of each piece"""
    runners_up: tuple[tuple[str, float], ...]
    """other words that were found, and their lengths (m), shortest first"""


def cc_path(start: FloatArray, end: FloatArray, curvature: float, sharpness: float, family: Family = "full") -> CCPath:
    """The shortest word of a family; there is one between any two states.

    Parameters
    ----------
    start, end : (4,) x, y, heading, curvature: m, m, rad, 1/m
    curvature, sharpness : limits kappa_max and sigma_max, 1/m and 1/m^2, > 0
    family : "full": all words at full sharpness and the reference family's; "reference": that family alone (between
        curvatures 0 and the limit; other curvatures are first brought to one of these)

    Raises
    ------
    InputError : a limit that is not above 0 or not finite, a state that is not finite, a curvature beyond its limit
    """
    from optplan.geometry._kernels import cc as kernels
    from optplan.geometry._kernels.clothoid import clothoid_end

    full = checked(start, end, curvature, sharpness, family, 1)
    first, last = (np.array(state, dtype=np.float64) for state in (start, end))
    s = sharpness / curvature / curvature
    table, middles, turns = shared_tables(s)
    words, query, pieces = np.empty((kernels.ROWS, kernels.COLUMNS)), np.empty(5), np.zeros((12, 3))
    length = kernels.solve(first, last, curvature, s, full, table, middles, turns, words, query)
    if length == 0.0:
        none = np.empty(0)
        return CCPath("", 0.0, first, none, none, none, ())
    order = [int(row) for row in np.argsort(words[:, 0], kind="stable") if math.isfinite(words[row, 0])]
    misses = {}
    for row in order:
        count = kernels.pieces_of(words[row], query, row, s, table, turns, pieces)
        x, y, heading = 0.0, 0.0, 0.0
        for kappa, sigma, part in pieces[:count]:
            x, y, heading, _ = clothoid_end(x, y, heading, kappa, sigma, part)
        tolerance = max(END_POSITION * curvature, END_SHARE * words[row, 0])
        turned = math.remainder(heading - query[2], 2 * math.pi)
        misses[row] = max(math.hypot(x - query[0], y - query[1]) / tolerance, abs(turned) / END_HEADING)
        if misses[row] <= 1.0:
            break
    # roots are found to rounding, so the first one does; if none did, the best of them is returned
    row = min(misses, key=lambda row: misses[row])
    count = kernels.pieces_of(words[row], query, row, s, table, turns, pieces)
    kept = pieces[:count][pieces[:count, 2] > EMPTY * words[row, 0]]
    name = _name(row, words[row])
    return CCPath(
        name,
        float(kept[:, 2].sum()) / curvature,
        first,
        kept[:, 0] * curvature,
        kept[:, 1] * curvature**2,
        kept[:, 2] / curvature,
        tuple((_name(other, words[other]), float(words[other, 0]) / curvature) for other in order if other != row),
    )


def cc_lengths(
    starts: FloatArray, ends: FloatArray, curvature: float, sharpness: float, family: Family = "full"
) -> FloatArray:
    """Lengths (k,) m of `cc_path` between rows x, y, heading, curvature of (k, 4) arrays. Raises like `cc_path`."""
    from optplan.geometry._kernels import cc as kernels

    full = checked(starts, ends, curvature, sharpness, family, 2)
    if np.shape(starts) != np.shape(ends):
        raise InputError(f"{len(starts)} starts and {len(ends)} ends; expected as many of both")
    first, last = (np.ascontiguousarray(states, dtype=np.float64) for states in (starts, ends))
    s = sharpness / curvature / curvature
    shared = shared_tables(s)
    out = np.empty(len(first))
    for i in range(0, len(first), SLICE):
        part = slice(i, i + SLICE)
        kernels.lengths(first[part], last[part], curvature, s, full, *shared, out[part])
    return out


def cc_matrix(
    exits: FloatArray,
    entries: FloatArray,
    curvature: float,
    sharpness: float,
    family: Family = "full",
    threads: int | None = None,
    told: Callable[[float], None] | None = None,
) -> FloatArray:
    """Lengths (n, m) m from every exit (n, 4) to every entry (m, 4), by threads. Raises like `cc_path`.

    `told` is called with the share that is done; what it raises ends the work.
    """
    from optplan.geometry._kernels import cc as kernels

    full = checked(exits, entries, curvature, sharpness, family, 2)
    first, last = (np.ascontiguousarray(states, dtype=np.float64) for states in (exits, entries))
    s = sharpness / curvature / curvature
    shared = shared_tables(s)
    out = np.empty((len(first), len(last)))
    rows = max(1, SLICE // max(len(last), 1))

    def fill(part: slice) -> None:
        kernels.matrix(first[part], last, curvature, s, full, *shared, out[part])

    by_rows(fill, len(first), rows, threads, told)
    return out


def cc_lower_bounds(starts: FloatArray, ends: FloatArray, curvature: float) -> FloatArray:
    """Lower bounds (k,) m on every path within the curvature limit: Dubins lengths, which let curvature jump.

    Starts and ends are (k, 3) or (k, 4). Raises like `optplan.geometry.dubins.dubins_lengths`.
    """
    from optplan.geometry.dubins import dubins_lengths

    if not (math.isfinite(curvature) and curvature > 0):
        raise InputError(f"the curvature limit is {curvature} 1/m; expected a finite number above 0")
    return dubins_lengths(np.asarray(starts)[:, :3], np.asarray(ends)[:, :3], 1.0 / curvature)


@lru_cache(maxsize=32)
def shared_tables(s: float) -> tuple[FloatArray, FloatArray, FloatArray]:
    """What all queries share whose limits have the ratio s = sigma_max / kappa_max^2."""
    from optplan.geometry._kernels.cc import tables

    made: tuple[FloatArray, FloatArray, FloatArray] = tables(s)
    return made


def _name(row: int, word: FloatArray) -> str:
    """Turns and lines of a row of the kernel's words."""
    if row < 4:
        return WORDS[row]
    first, last = ("L" if side > 0 else "R" for side in word[2:4])
    if row < len(WORDS):
        # a valley that stays above 0 does not turn the other way
        return WORDS[row] if word[5] > 0 else first + last
    middle = "R" if first == "L" else "L"
    return ("S", first, first + last, f"{first}S{last}", first + middle + last)[int(word[1])] + "0"


def checked(
    start: FloatArray, end: FloatArray, curvature: float, sharpness: float, family: str, dimensions: int
) -> bool:
    """Whether the full family is meant; InputError for limits and states, in arrays of `dimensions`, that are none."""
    for name, limit, unit in (("curvature", curvature, "1/m"), ("sharpness", sharpness, "1/m^2")):
        if not (math.isfinite(limit) and limit > 0):
            raise InputError(f"the {name} limit is {limit} {unit}; expected a finite number above 0")
    if family not in ("full", "reference"):
        raise InputError(f"the family is {family!r}; expected 'full' or 'reference'")
    for states in (np.asarray(start), np.asarray(end)):
        if states.ndim != dimensions or states.shape[-1] != 4:
            raise InputError(f"states have shape {states.shape}; expected x, y, heading, curvature")
        if not np.isfinite(states).all():
            raise InputError("a state is not finite; expected x, y, heading, curvature")
        if (np.abs(states[..., 3]) > curvature * (1 + 1e-9)).any():
            worst = np.abs(states[..., 3]).max()
            raise InputError(f"a state has curvature {worst} 1/m; expected at most the limit, {curvature} 1/m")
    return family == "full"
