"""The way of a robot whose tool, ahead of it or behind it, follows a curve exactly.

A tool at (ahead, -right) in the robot's frame moves at the angle delta to the robot's heading theta, with

    tan(delta) = kappa ahead / (1 + kappa right),    dtheta/ds = sin(delta) / ahead

along the arc length s of its own curve. With the heading phi of that curve this is

    dtheta/ds = sin(phi - theta) / ahead,

whatever `right` is: the equation of a trailer (a tractrix). Errors of theta die out forwards for a tool ahead, and
backwards for one behind; so it is solved from the end from which it is stable. The robot is then at the place of the
tool less R(theta) (ahead, -right), with kappa = sin(delta) / (ahead cos(delta) - right sin(delta)).
"""

from __future__ import annotations

import math
from typing import NamedTuple

import numpy as np

from optplan.domain.arrays import FloatArray
from optplan.domain.errors import InputError, LimitError
from optplan.geometry.curves import Curve, cuts, evaluate
from optplan.geometry.rounding import wrapped
from optplan.geometry.splines import through

STEP = 0.1
"""Longest step of the tool's way, as a share of its distance ahead or behind."""
LAPS = 3
"""Times that a ring is followed until the robot's heading is that of a lap before."""
_ROUNDS = 8
_MOST = 200_000


class Towed(NamedTuple):
    """A robot's way, and where along it each place of its tool's is."""

    curve: Curve
    error: float
    """m, greatest distance found between the tool and its curve"""
    tool: FloatArray
    """(k,) arc length along the tool's curve, m"""
    robot: FloatArray
    """(k,) arc length along the robot's way there, m"""


def towed(curve: Curve, right: float, ahead: float, tolerance: float, *, closed: bool = False) -> Towed:
    """The way of a robot that keeps its tool on a curve.

    Parameters
    ----------
    curve : of the tool; a `closed` one ends as it begins, and so does the robot's way
    right, ahead : where the tool sits, m; ahead is not 0
    tolerance : greatest distance of the tool from its curve, m

    Raises
    ------
    InputError : the curve turns so tightly that the robot would have to drive backwards to keep its tool there
    LimitError : the tolerance is not reached
    """
    if ahead == 0:
        raise InputError("a towed tool is neither ahead nor behind; expected a distance that is not 0")
    parts = np.maximum(1, np.ceil(curve.length / (STEP * abs(ahead)))).astype(np.int64)
    for _ in range(_ROUNDS):
        if 2 * parts.sum() > _MOST:
            break
        s = cuts(curve, 2 * parts)
        at = evaluate(curve, s)
        theta = _headings(curve, s, ahead, closed)
        delta = at.heading - theta
        forwards = math.copysign(1.0, ahead) * (ahead * np.cos(delta) - right * np.sin(delta))
        if forwards.min() <= 0:
            raise InputError(
                f"a tool {right:g} m right and {ahead:g} m ahead cannot follow a curve of {curve.max_curvature:g} 1/m"
            )
        x = at.x - ahead * np.cos(theta) - right * np.sin(theta)
        y = at.y - ahead * np.sin(theta) + right * np.cos(theta)
        made = through(np.column_stack([x, y])[::2], theta[::2], closed)
        if made is not None:
            middle = evaluate(made, made.offsets[:-1] + made.length / 2)
            away = np.hypot(middle.x - x[1::2], middle.y - y[1::2])
            error = away + math.hypot(right, ahead) * np.abs(wrapped(middle.heading - theta[1::2]))
            if error.max() <= tolerance:
                return Towed(made, float(error.max()), s[::2], made.offsets)
        parts *= 2
    raise LimitError(f"no way was found that keeps a tool {ahead:g} m ahead within {tolerance:g} m of its curve")


def _headings(curve: Curve, s: FloatArray, ahead: float, closed: bool) -> FloatArray:
    """(k,) rad, the robot's heading at arc lengths s of its tool: classical Runge-Kutta from the stable end."""
    low, high = s[:-1], s[1:]
    phi = evaluate(curve, s).heading
    middle = evaluate(curve, (low + high) / 2).heading
    step = np.diff(s)
    kappa = evaluate(curve, s[[0, -1]]).curvature
    lap = phi[-1] - phi[0]
    if ahead < 0:
        phi, middle, step, kappa, lap = phi[::-1], middle[::-1], -step[::-1], kappa[::-1], -lap
    # as if the curve went on as an arc before
    heading = float(phi[0] - math.asin(min(max(ahead * kappa[0], -1.0), 1.0)))
    found = np.empty(len(phi))
    for _ in range(LAPS if closed else 1):
        found[0] = heading
        for k, (begin, half, end, h) in enumerate(
            zip(phi[:-1].tolist(), middle.tolist(), phi[1:].tolist(), (step / ahead).tolist(), strict=True)
        ):
            a = math.sin(begin - heading)
            b = math.sin(half - heading - h * a / 2)
            c = math.sin(half - heading - h * b / 2)
            d = math.sin(end - heading - h * c)
            heading += h * (a + 2 * b + 2 * c + d) / 6
            found[k + 1] = heading
        heading -= lap
    return found[::-1] if ahead < 0 else found
