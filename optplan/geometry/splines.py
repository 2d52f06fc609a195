"""Curves through points with continuous curvature: splines of clothoids (Euler spirals).

Between its points the spline is one clothoid a span; headings at inner points are chosen so that curvature is the same
on both sides (Bertolazzi and Frego, Interpolating clothoid splines with curvature continuity, 2018; the smooth points
of Levien's Euler-spiral splines). Here one Newton iteration does headings and spans together, for many splines at once.
"""

from __future__ import annotations

from itertools import pairwise
from typing import NamedTuple

import numpy as np

from optplan.domain.arrays import BoolArray, FloatArray, frozen_floats
from optplan.domain.errors import InputError, SolverError
from optplan.geometry.curves import Curve, evaluate, joined, sampled_curve
from optplan.geometry.hermite import guess, moments
from optplan.geometry.rounding import wrapped

KINDS = "vc[]"
"""Kinds of control points: v corner, c smooth (G2), [ a line before and a curve after, tangent, ] the reverse."""
OVERLAP = 24
"""Points by which a ring overlaps itself when a spline is put through it: an end is felt 0.27 as much a point on."""
_ROUNDS = 40


class Splines(NamedTuple):
    """m splines through n points each; arrays (m, n - 1)."""

    heading: FloatArray
    """(m, n) rad at the points"""
    curvature: FloatArray
    """1/m at the beginning of each span"""
    sharpness: FloatArray
    length: FloatArray
    converged: BoolArray
    """(m,) False: the numbers are no solution"""


class Fitted(NamedTuple):
    """A drawn curve made drivable."""

    curve: Curve
    deviation: float
    """m, largest distance of the curve from the polyline"""
    max_curvature: float
    """1/m"""
    max_sharpness: float
    """1/m^2"""


def euler_splines(points: FloatArray, th0: FloatArray, th1: FloatArray, *, round_ends: bool = False) -> Splines:
    """Splines through points (m, n, 2) m, n >= 2, consecutive ones apart; headings th0, th1 (m,) rad at the ends.

    A heading of NaN leaves that end free: its curvature is then 0 (a natural end), or, with `round_ends`, the span
    there is an arc.
    """
    chord = np.diff(points, axis=1)
    r, angle = np.hypot(chord[..., 0], chord[..., 1]), np.arctan2(chord[..., 1], chord[..., 0])
    heading = _first_headings(r, angle)
    free0, free1 = np.isnan(th0), np.isnan(th1)
    heading[:, 0] = np.where(free0, heading[:, 0], th0)
    heading[:, -1] = np.where(free1, heading[:, -1], th1)
    # the winding of phi is settled here once, and then moves continuously with the headings
    phi0, phi1 = wrapped(heading[:, :-1] - angle), wrapped(heading[:, 1:] - angle)
    a = guess(phi0.ravel(), phi1.ravel()).reshape(phi0.shape)
    settled = np.zeros(len(points), dtype=bool)
    for _ in range(_ROUNDS):
        state, da, dth, settled = _newton(r, a, phi0, phi1, free0, free1, round_ends)
        if settled.all():
            break
        scale = np.minimum(1.0, 0.5 / np.maximum(np.abs(dth).max(axis=1), 1e-300))[:, None]
        scale = np.minimum(scale, 2.0 / np.maximum(np.abs(da).max(axis=1), 1e-300)[:, None])
        scale[settled] = 0
        a, heading = a + scale * da, heading + scale * dth
        phi0, phi1 = phi0 + scale * dth[:, :-1], phi1 + scale * dth[:, 1:]
    x = np.where(state[0] > 1e-9, state[0], np.nan)
    length = r / x
    good = settled & np.isfinite(length).all(axis=1)
    length = np.where(good[:, None], length, r)
    return Splines(heading, (phi1 - phi0 - a) / length, 2 * a / length**2, length, good)


def _newton(
    r: FloatArray,
    a: FloatArray,
    phi0: FloatArray,
    phi1: FloatArray,
    free0: BoolArray,
    free1: BoolArray,
    round_ends: bool,
) -> tuple[tuple[FloatArray, FloatArray], FloatArray, FloatArray, BoolArray]:
    """X and Y of every span, the full Newton step of a (m, n - 1) and of the headings (m, n), and who has arrived."""
    shape = a.shape
    cosine, sine = (m.reshape(*shape, 3) for m in moments(a.ravel(), phi0.ravel(), phi1.ravel()))
    x, y = cosine[..., 0], sine[..., 0]
    slope = cosine[..., 2] - cosine[..., 1]
    slope = np.where(np.abs(slope) > 1e-9, slope, -1e-9)
    # a follows the headings: da = -(y + y_0 dphi0 + y_1 dphi1) / slope
    fixed, by0, by1 = -y / slope, -(cosine[..., 0] - cosine[..., 1]) / slope, -cosine[..., 1] / slope
    x_a, x_0, x_1 = sine[..., 1] - sine[..., 2], sine[..., 1] - sine[..., 0], -sine[..., 1]
    bend0, bend1 = phi1 - phi0 - a, phi1 - phi0 + a  # kappa at the ends is x bend / r
    k0, k1 = x * bend0 / r, x * bend1 / r

    def linear(bend: FloatArray, sign: float) -> tuple[FloatArray, FloatArray, FloatArray]:
        d_a = (x_a * bend + sign * x) / r
        return d_a * fixed, (x_0 * bend - x) / r + d_a * by0, (x_1 * bend + x) / r + d_a * by1

    c0, l0, r0 = linear(bend0, -1.0)
    c1, l1, r1 = linear(bend1, 1.0)
    m, n = len(r), r.shape[1] + 1
    lower, main, upper, right = (np.zeros((m, n)) for _ in range(4))
    # inner rows: kappa at the end of one span less kappa at the beginning of the next
    lower[:, 1:-1], main[:, 1:-1], upper[:, 1:-1] = l1[:, :-1], r1[:, :-1] - l0[:, 1:], -r0[:, 1:]
    gap = k1[:, :-1] - k0[:, 1:]
    right[:, 1:-1] = -(gap + c1[:, :-1] - c0[:, 1:])
    # a free end: no curvature, or none that changes along its span
    first, last = (k0 - k1, k1 - k0) if round_ends else (k0, k1)
    fl, fr, fc = (l0 - l1, r0 - r1, c0 - c1) if round_ends else (l0, r0, c0)
    ll, lr, lc = (l1 - l0, r1 - r0, c1 - c0) if round_ends else (l1, r1, c1)
    main[:, 0], upper[:, 0] = np.where(free0, fl[:, 0], 1.0), np.where(free0, fr[:, 0], 0.0)
    right[:, 0] = np.where(free0, -(first[:, 0] + fc[:, 0]), 0.0)
    main[:, -1], lower[:, -1] = np.where(free1, lr[:, -1], 1.0), np.where(free1, ll[:, -1], 0.0)
    right[:, -1] = np.where(free1, -(last[:, -1] + lc[:, -1]), 0.0)
    dth = _tridiagonal(lower, main, upper, right)
    da = fixed + by0 * dth[:, :-1] + by1 * dth[:, 1:]
    apart = np.abs(y).max(axis=1)
    uneven = (np.abs(gap) * np.minimum(r[:, :-1], r[:, 1:])).max(axis=1, initial=0.0)
    uneven = np.maximum(uneven, np.abs(np.where(free0, first[:, 0] * r[:, 0], 0.0)))
    uneven = np.maximum(uneven, np.abs(np.where(free1, last[:, -1] * r[:, -1], 0.0)))
    return (x, y), da, dth, (apart < 1e-13) & (uneven < 1e-10)


def _tridiagonal(lower: FloatArray, main: FloatArray, upper: FloatArray, right: FloatArray) -> FloatArray:
    """Solve m tridiagonal systems of n rows, given as (m, n) arrays, as one with nothing between the blocks."""
    from scipy.linalg import LinAlgError, solve_banded

    bands = np.zeros((3, main.size))
    bands[0, 1:], bands[1], bands[2, :-1] = upper.ravel()[:-1], main.ravel(), lower.ravel()[1:]
    try:
        solved: FloatArray = solve_banded((1, 1), bands, right.ravel(), check_finite=False)
    except LinAlgError:
        bands[1] += 1e-6 * np.abs(bands).max()
        solved = solve_banded((1, 1), bands, right.ravel(), check_finite=False)
    return np.nan_to_num(solved, nan=0.0, posinf=1.0, neginf=-1.0).reshape(main.shape)


def _first_headings(r: FloatArray, angle: FloatArray) -> FloatArray:
    """(m, n) rad: of the circle through three neighbours; at the ends as if that circle went on."""
    bend = wrapped(np.diff(angle, axis=1))
    share = r[:, :-1] / (r[:, :-1] + r[:, 1:])
    inner = angle[:, :-1] + bend * share
    if inner.shape[1] == 0:
        return np.concatenate([angle, angle], axis=1)
    first, last = angle[:, :1] - bend[:, :1] * share[:, :1], angle[:, -1:] + bend[:, -1:] * (1 - share[:, -1:])
    return np.concatenate([first, inner, last], axis=1)


def through(points: FloatArray, heading: FloatArray, closed: bool) -> Curve | None:
    """The spline through points (n, 2) m with the first and the last of headings (n,) rad; None when none was found.

    The points of a ring (`closed`) repeat the first; it ends as it begins, in curvature too.
    """
    n = len(points) - 1
    lap = min(OVERLAP, n) if closed else 0
    order = np.arange(-lap, n + lap + 1) % n if closed else np.arange(n + 1)
    made = euler_splines(points[order][None], heading[order[:1]], heading[order[-1:]])
    if not made.converged[0]:
        return None
    own = slice(lap, lap + n)
    start = np.array([*points[0], made.heading[0, lap]])
    return Curve(start, made.curvature[0, own], made.sharpness[0, own], made.length[0, own])


def euler_spline(
    points: FloatArray, th0: float | None = None, th1: float | None = None, kinds: str = ""
) -> list[Curve]:
    """Curves through control points; one curve, or one between every two corners.

    Parameters
    ----------
    points : (n, 2) m, n >= 2, consecutive ones apart
    th0, th1 : rad, heading at the first and last point; None: free, with curvature 0 there
    kinds : one of `KINDS` a point (of the ends it counts for nothing); all smooth when empty

    Raises
    ------
    InputError : points or kinds that are none; SolverError when no spline was found
    """
    points = frozen_floats(points, "control points", (None, 2))
    if len(points) < 2 or (np.diff(points, axis=0) == 0).all(axis=1).any():
        raise InputError("control points repeat one another or are fewer than two; expected two or more, apart")
    kinds = kinds or "c" * len(points)
    if len(kinds) != len(points) or set(kinds) - set(KINDS):
        raise InputError(f"kinds of control points {kinds!r} do not fit; expected {len(points)} letters of {KINDS!r}")
    steps = np.diff(points, axis=0)
    angle = np.arctan2(steps[:, 1], steps[:, 0])
    stops = [0, *(k for k in range(1, len(points) - 1) if kinds[k] != "c"), len(points) - 1]
    runs: list[list[Curve]] = [[]]
    for low, high in pairwise(stops):
        # a straight run gives its direction to the curve that it touches
        begin = th0 if low == 0 else (angle[low - 1] if kinds[low] == "[" else None)
        finish = th1 if high == len(points) - 1 else (angle[high] if kinds[high] == "]" else None)
        if (low > 0 and kinds[low] == "]") or (high < len(points) - 1 and kinds[high] == "["):
            if high - low > 1:
                raise InputError(f"points {low} to {high} are to be a straight run; expected no point between them")
            made = Curve([*points[low], angle[low]], [0.0], [0.0], [float(np.hypot(*steps[low]))])  # type: ignore[arg-type]
        else:
            made = _run(points[low : high + 1], begin, finish)
        if low > 0 and kinds[low] == "v":
            runs.append([])
        runs[-1].append(made)
    return [joined(*run) for run in runs]


def _run(points: FloatArray, begin: float | None, finish: float | None) -> Curve:
    ends = np.array([np.nan if begin is None else begin, np.nan if finish is None else finish])
    made = euler_splines(points[None], ends[:1], ends[1:])
    if not made.converged[0]:
        raise SolverError(f"no spline found through {len(points)} points; expected points that turn less sharply")
    start = np.array([*points[0], made.heading[0, 0]])
    return Curve(start, made.curvature[0], made.sharpness[0], made.length[0])


def drivable(points: FloatArray, th0: float | None = None, th1: float | None = None) -> Fitted:
    """A drawn polyline (n, 2) as one G2 curve through its points; parameters and errors of `euler_spline`."""
    import shapely

    curve = euler_spline(points, th0, th1)[0]
    dense = evaluate(curve, sampled_curve(curve, max(1e-9, 1e-6 * curve.total))).points
    away = shapely.distance(shapely.LineString(points), shapely.points(dense))
    return Fitted(curve, float(away.max()), curve.max_curvature, curve.max_sharpness)
