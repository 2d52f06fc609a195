"""Other shapes of connections, to compare: Bezier curves, an Euler-spiral spline, a Fermat spiral.

None of them is bounded in curvature by its construction; what each reaches is measured and reported.
"""

from __future__ import annotations

import math
from collections.abc import Callable
from typing import NamedTuple

import numpy as np

from optplan.connectors.spiro import LIMIT_SLACK, spiro_connections
from optplan.domain.arrays import FloatArray, frozen_floats
from optplan.domain.errors import InputError, OptplanError
from optplan.geometry.curves import Curve, cuts, evaluate, positive
from optplan.geometry.dubins import dubins_path
from optplan.geometry.rounding import wrapped

_SAMPLES = 2001


class Shape(NamedTuple):
    """One connection, measured on dense samples."""

    name: str
    points: FloatArray
    """(k, 2) m"""
    heading: FloatArray
    """(k,) rad, continuous"""
    curvature: FloatArray
    """(k,) 1/m"""
    length: float
    """m"""
    max_curvature: float
    """1/m"""
    max_rate: float
    """1/m^2, largest |dkappa/ds| between jumps"""
    order: int
    """continuity between straight strokes: 1 the curvature jumps somewhere, the ends included; 2 nowhere"""
    within: bool
    """max_curvature <= 1 / radius and 2 %"""
    curve: Curve | None = None
    """where it is made of clothoids"""


def bezier3(start: FloatArray, end: FloatArray, radius: float, handle: float | None = None) -> Shape:
    """Cubic Bezier curve with end tangents.

    Parameters
    ----------
    start, end : (3,) x, y, heading: m, m, rad; apart
    radius : least radius, m; only judged by
    handle : m, distance of the inner control points from the ends; None: a quarter of the distance between the ends

    Raises
    ------
    InputError : states that are none or at one place, a radius or handle that is not above 0
    """
    p0, t0, p1, t1, distance = _ends(start, end, radius)
    reach = distance / 4 if handle is None else handle
    positive(reach, "the handle of a Bezier curve")
    return _bezier("bezier3", np.array([p0, p0 + reach * t0, p1 - reach * t1, p1]), radius)


def bezier5(start: FloatArray, end: FloatArray, radius: float, handle: float | None = None) -> Shape:
    """Quintic Bezier curve with end tangents and curvature 0 at both ends: three control points on each end tangent.

    Parameters and errors are those of `bezier3`; the handle (None: a fifth of the distance) is used twice at each end.
    """
    p0, t0, p1, t1, distance = _ends(start, end, radius)
    reach = distance / 5 if handle is None else handle
    positive(reach, "the handle of a Bezier curve")
    control = [p0, p0 + reach * t0, p0 + 2 * reach * t0, p1 - 2 * reach * t1, p1 - reach * t1, p1]
    return _bezier("bezier5", np.array(control), radius)


def spiro(start: FloatArray, end: FloatArray, radius: float) -> Shape:
    """Euler-spiral spline through control points beside the ends; see `spiro_connections`. Raises like `bezier3`."""
    _ends(start, end, radius)
    made = spiro_connections(np.asarray(start)[None], np.asarray(end)[None], radius)
    if made.curves[0] is None:
        raise InputError("no Euler-spiral spline found between these states")
    return _of_curve("spiro", made.curves[0], radius)


def dubins(start: FloatArray, end: FloatArray, radius: float) -> Shape:
    """Shortest path of arcs and lines, to compare with. Raises like `bezier3`."""
    _ends(start, end, radius)
    path = dubins_path(start, end, radius)
    kappa = np.array(path.curvatures)
    return _of_curve("dubins", Curve(start, kappa, np.zeros(len(kappa)), np.array(path.lengths)), radius)


def fermat(start: FloatArray, end: FloatArray, radius: float) -> Shape:
    """Two mirrored Fermat spirals r = a sqrt(theta) with lines, where the headings meet ahead of start and before end.

    Lekkas, Dahl, Breivik and Fossen, Continuous-curvature path generation using Fermat's spiral, 2013. The spirals are
    as large as the nearer end allows; curvature is 0 at their outer ends, and continuous.

    Raises
    ------
    InputError : like `bezier3`, or the lines through both states do not meet between them: no such connection
    """
    p0, t0, p1, t1, _ = _ends(start, end, radius)
    bend = float(wrapped(np.array([end[2] - start[2]]))[0])
    cross = t0[0] * t1[1] - t0[1] * t1[0]
    chord = p1 - p0
    if abs(cross) < 1e-9:
        raise InputError("the headings are parallel: no Fermat spiral turns from one to the other")
    ahead = (chord[0] * t1[1] - chord[1] * t1[0]) / cross
    behind = (t0[0] * chord[1] - t0[1] * chord[0]) / cross
    if ahead <= 0 or behind <= 0:
        raise InputError("the headings do not meet ahead of the start and before the end: no Fermat spiral fits")
    half, side = abs(bend) / 2, math.copysign(1.0, bend)
    from scipy.optimize import brentq

    last = brentq(lambda th: th + math.atan(2 * th) - half, 0.0, half, xtol=1e-15)
    theta = last * np.linspace(0, 1, _SAMPLES) ** 2  # even in sqrt(theta), where the spiral has its derivatives
    root = np.sqrt(theta)
    x, y = root * np.cos(theta), root * np.sin(theta)
    reach = x[-1] + y[-1] * math.tan(half)  # tangent of a spiral pair with a = 1
    a = min(ahead, behind) / reach
    kappa = side * (2 * root * (3 + 4 * theta**2) / (1 + 4 * theta**2) ** 1.5) / a
    turned = start[2] + side * (theta + np.arctan(2 * theta))
    normal = side * np.array([-t0[1], t0[0]])
    first = p0 + (ahead - a * reach) * t0 + a * (x[:, None] * t0 + y[:, None] * normal)
    back = side * np.array([t1[1], -t1[0]]) * -1.0
    second = p1 - (behind - a * reach) * t1 + a * (-x[:, None] * t1 + y[:, None] * back)
    heading = np.concatenate([turned, (2 * start[2] + bend - turned)[::-1][1:]])
    points = np.concatenate([p0[None], first, second[::-1][1:], p1[None]])
    heading = np.concatenate([heading[:1], heading, heading[-1:]])
    kappa = np.concatenate([[0.0], kappa, kappa[::-1][1:], [0.0]])
    keep = np.concatenate([[True], np.hypot(*np.diff(points, axis=0).T) > 1e-12])
    return _measured("fermat", points[keep], heading[keep], kappa[keep], radius)


SHAPES: dict[str, Callable[[FloatArray, FloatArray, float], Shape]] = {
    "dubins": dubins,
    "bezier3": bezier3,
    "bezier5": bezier5,
    "spiro": spiro,
    "fermat": fermat,
}


def compare_shapes(start: FloatArray, end: FloatArray, radius: float) -> dict[str, Shape | str]:
    """Every shape between two states by name; where there is none, why not. Raises for states that are none."""
    _ends(start, end, radius)
    table: dict[str, Shape | str] = {}
    for name, make in SHAPES.items():
        try:
            table[name] = make(start, end, radius)
        except OptplanError as error:
            table[name] = str(error)
    return table


def shapes_table(start: FloatArray, end: FloatArray, radius: float) -> str:
    """The comparison as text: length, greatest curvature and its rate, continuity. Raises like `compare_shapes`."""
    lines = [f"{'shape':8} {'length m':>10} {'max 1/m':>10} {'rate 1/m^2':>11} {'order':>6}  within limit"]
    for name, made in compare_shapes(start, end, radius).items():
        if isinstance(made, str):
            lines.append(f"{name:8} {made}")
        else:
            numbers = f"{made.length:10.4f} {made.max_curvature:10.4f} {made.max_rate:11.4f}"
            lines.append(f"{name:8} {numbers} {'G' + str(made.order):>6}  {'yes' if made.within else 'no'}")
    return "\n".join(lines)


def _ends(
    start: FloatArray, end: FloatArray, radius: float
) -> tuple[FloatArray, FloatArray, FloatArray, FloatArray, float]:
    begin, finish = frozen_floats(start, "start state", (3,)), frozen_floats(end, "end state", (3,))
    positive(radius, "the radius of a connection")
    distance = math.hypot(*(finish[:2] - begin[:2]))
    if distance == 0:
        raise InputError("a connection starts and ends at one place; expected two places")
    t0, t1 = (np.array([math.cos(state[2]), math.sin(state[2])]) for state in (begin, finish))
    return begin[:2], t0, finish[:2], t1, distance


def _bezier(name: str, control: FloatArray, radius: float) -> Shape:
    t = np.linspace(0, 1, _SAMPLES)
    points, speed, change = _bernstein(control, t), *(_bernstein(d, t) for d in _hodographs(control))
    size = np.hypot(speed[:, 0], speed[:, 1])
    # a curve that stops has a cusp there: its curvature is unbounded, and said to be enormous
    safe = np.maximum(size, 1e-9 * size.max())
    kappa = (speed[:, 0] * change[:, 1] - speed[:, 1] * change[:, 0]) / safe**3
    heading = np.unwrap(np.arctan2(speed[:, 1], speed[:, 0]))
    return _measured(name, points, heading, kappa, radius)


def _hodographs(control: FloatArray) -> tuple[FloatArray, FloatArray]:
    degree = len(control) - 1
    first = degree * np.diff(control, axis=0)
    return first, (degree - 1) * np.diff(first, axis=0)


def _bernstein(control: FloatArray, t: FloatArray) -> FloatArray:
    degree = len(control) - 1
    basis = [math.comb(degree, k) * t**k * (1 - t) ** (degree - k) for k in range(degree + 1)]
    values: FloatArray = np.stack(basis, axis=1) @ control
    return values


def _of_curve(name: str, curve: Curve, radius: float) -> Shape:
    parts = np.maximum(2, np.ceil(_SAMPLES * curve.length / curve.total)).astype(np.int64)
    at = evaluate(curve, cuts(curve, parts))
    shape = _measured(name, at.points, at.heading, at.curvature, radius)
    ends = np.concatenate([[0.0], curve.end_curvature]), np.concatenate([curve.curvature, [0.0]])
    even = bool((np.abs(ends[1] - ends[0]) <= 1e-6 / radius).all())
    largest = curve.max_curvature
    within = largest <= (1 + LIMIT_SLACK) / radius
    return shape._replace(
        length=curve.total,
        max_curvature=largest,
        max_rate=curve.max_sharpness,
        order=1 + even,
        within=within,
        curve=curve,
    )


def _measured(name: str, points: FloatArray, heading: FloatArray, kappa: FloatArray, radius: float) -> Shape:
    chord = np.hypot(*np.diff(points, axis=0).T)
    half = wrapped(np.diff(heading)) / 2
    steps = chord / np.sinc(half / math.pi)  # as arcs: exact where curvature is even
    largest = float(np.abs(kappa).max())
    rate = float((np.abs(np.diff(kappa)) / np.maximum(steps, 1e-300)).max())
    even = max(abs(kappa[0]), abs(kappa[-1])) <= 1e-6 * max(1 / radius, largest)
    within = largest <= (1 + LIMIT_SLACK) / radius
    return Shape(name, points, heading, kappa, float(steps.sum()), largest, rate, 1 + even, within)
