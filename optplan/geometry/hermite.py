"""One clothoid between two places with headings (G1 Hermite), vectorised.

Bertolazzi and Frego, G1 fitting with clothoids, 2015: with the chord as the x axis, phi0 and phi1 the headings against
it and phi(t) = A t^2 + (phi1 - phi0 - A) t + phi0, A is the root of Y = integral of sin(phi) over 0..1; the length is
r / X with X the integral of cos(phi). Newton from their polynomial guess takes a few steps.
"""

from __future__ import annotations

import math
from typing import NamedTuple

import numpy as np

from optplan.domain.arrays import BoolArray, FloatArray, frozen_floats
from optplan.domain.errors import InputError
from optplan.geometry.curves import Curve
from optplan.geometry.rounding import wrapped

_T, _W = np.polynomial.legendre.leggauss(40)
_T, _W = (_T + 1) / 2, _W / 2
_MOMENTS = np.column_stack([_W, _W * _T, _W * _T * _T])
_GUESS = (2.989696028701907, 0.716228953608281, -0.458969738821509, -0.502821153340377, 0.261062141752652)
_GUESS_LAST = -0.045854475238709


class Hermite(NamedTuple):
    """Clothoids between pairs of states; arrays (k,)."""

    curvature: FloatArray
    """1/m at the start"""
    sharpness: FloatArray
    """1/m^2"""
    length: FloatArray
    """m"""
    converged: BoolArray
    """False: the numbers are no solution"""


def moments(a: FloatArray, phi0: FloatArray, phi1: FloatArray) -> tuple[FloatArray, FloatArray]:
    """(k, 3) integrals of t^j cos(phi) and of t^j sin(phi) over 0..1, j = 0, 1, 2."""
    phase = phi0[:, None] + _T * ((phi1 - phi0 - a)[:, None] + a[:, None] * _T)
    return np.cos(phase) @ _MOMENTS, np.sin(phase) @ _MOMENTS


def guess(phi0: FloatArray, phi1: FloatArray) -> FloatArray:
    """A before Newton, for phi0 and phi1 in -pi..pi."""
    x, y = phi0 / math.pi, phi1 / math.pi
    xy, squares = x * y, x * x + y * y
    c0, c1, c2, c3, c4 = _GUESS
    factor = c0 + xy * (c1 + xy * c2) + (c3 + xy * c4) * squares + _GUESS_LAST * (x**4 + y**4)
    return (phi0 + phi1) * factor


def hermite_clothoids(p0: FloatArray, th0: FloatArray, p1: FloatArray, th1: FloatArray) -> Hermite:
    """Clothoids from p0 (k, 2) with heading th0 (k,) to p1 with heading th1; m and rad, p0 and p1 apart."""
    chord = p1 - p0
    r, angle = np.hypot(chord[:, 0], chord[:, 1]), np.arctan2(chord[:, 1], chord[:, 0])
    phi0, phi1 = wrapped(th0 - angle), wrapped(th1 - angle)
    a = guess(phi0, phi1)
    for _ in range(25):
        cosine, sine = moments(a, phi0, phi1)
        slope = cosine[:, 2] - cosine[:, 1]
        step = sine[:, 0] / np.where(np.abs(slope) > 1e-12, slope, 1e-12)
        a = a - np.clip(step, -1.0, 1.0)
        if np.abs(step).max(initial=0.0) < 1e-13:
            break
    cosine, sine = moments(a, phi0, phi1)
    good = (np.abs(sine[:, 0]) < 1e-11) & (cosine[:, 0] > 1e-9)
    x = np.where(good, cosine[:, 0], 1.0)
    length = r / x
    return Hermite((phi1 - phi0 - a) / length, 2 * a / length**2, length, good)


def clothoid_fit(p0: FloatArray, th0: float, p1: FloatArray, th1: float) -> Curve:
    """The clothoid from p0 (2,) with heading th0 to p1 (2,) with heading th1; m and rad.

    Raises
    ------
    InputError : a number that is not finite, the same place twice, or a pair without a solution: a chord driven
        backwards at both ends (both headings a half turn off it) leads along no clothoid
    """
    begin, finish = frozen_floats(p0, "start of a clothoid", (2,)), frozen_floats(p1, "end of a clothoid", (2,))
    ends = frozen_floats([th0, th1], "headings of a clothoid", (2,))
    if (begin == finish).all():
        raise InputError(f"a clothoid starts and ends at {tuple(begin.tolist())}; expected two places")
    fit = hermite_clothoids(begin[None], ends[:1], finish[None], ends[1:])
    if not fit.converged[0]:
        raise InputError(f"no clothoid found with headings {th0:g} and {th1:g} rad; both point away from the other end")
    return Curve(np.array([*begin, ends[0]]), fit.curvature, fit.sharpness, fit.length)
