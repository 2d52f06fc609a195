"""Displacement along clothoids, closed form and vectorised.

In units of the length a clothoid has the phase phi(t) = theta + b t + a t^2 / 2 with t in 0..1, b = kappa L and
a = sigma L^2, and its displacement is the integral of exp(i phi). With a > 0 and p = phi'(t),

    integral of exp(i phi) from t to infinity = exp(i phi(t)) c w(exp(i pi/4) p / sqrt(2 a)),   p >= 0,

where c = sqrt(pi / (2 a)) exp(i pi/4) and w is the Faddeeva function (complex error function, Abramowitz and Stegun
7.1.3 and 7.4.2). Unlike a difference of Fresnel integrals this never forms the phase of the far-away centre of the
spiral: nearly circular pieces (b^2 / a huge) keep all their digits. A piece that turns little, where the difference of
two tails would cancel, is one Gauss panel.
"""

from __future__ import annotations

import math

import numpy as np
import numpy.typing as npt

from optplan.domain.arrays import FloatArray

_NODES, _WEIGHTS = np.polynomial.legendre.leggauss(16)
_NODES, _WEIGHTS = (_NODES + 1) / 2, _WEIGHTS / 2
_PANEL = 2.0
"""Largest turning that one panel takes, rad: 16 points leave less than 1e-16 of the length."""
_ARC = 1e-17
"""|sigma| L^2 below which a clothoid is an arc to all digits."""


def clothoid_displacement(
    heading: FloatArray, curvature: FloatArray, sharpness: FloatArray, length: FloatArray
) -> tuple[FloatArray, FloatArray]:
    """Where clothoids lead: the integrals of cos and sin of heading + curvature u + sharpness u^2 / 2 over 0..length.

    Parameters
    ----------
    heading, curvature, sharpness, length : rad, 1/m, 1/m^2, m; arrays that broadcast. A negative length drives back.

    Returns
    -------
    dx, dy : m, of the broadcast shape; the error is some 1e-13 of the length, plus rounding of the turning itself
    """
    theta, kappa, sigma, size = np.broadcast_arrays(heading, curvature, sharpness, length)
    b, a = kappa * size, sigma * size * size
    value = np.empty(theta.shape, dtype=np.complex128)
    arc = np.abs(a) <= _ARC
    small = ~arc & (np.abs(b) + np.abs(a) / 2 <= _PANEL)
    rest = ~arc & ~small
    half = (b[arc] + a[arc] / 2) / 2
    value[arc] = np.sinc(half / math.pi) * np.exp(1j * half)
    t = _NODES
    value[small] = np.exp(1j * t * (b[small][:, None] + a[small][:, None] * t / 2)) @ _WEIGHTS
    value[rest] = _tails(b[rest], a[rest])
    value *= size * np.exp(1j * theta)
    return np.ascontiguousarray(value.real), np.ascontiguousarray(value.imag)


def _tails(b: FloatArray, a: FloatArray) -> npt.NDArray[np.complex128]:
    """The integral over 0..1 of exp(i (b t + a t^2 / 2)), a not 0, as the difference of two tails."""
    from scipy.special import wofz

    mirrored = a < 0
    a, b = np.abs(a), np.where(mirrored, -b, b)
    turn, width = np.exp(0.25j * math.pi), np.sqrt(2 * a)
    scale = turn * math.sqrt(math.pi) / width
    last = b + a
    from_start = scale * wofz(turn * np.abs(b) / width)
    from_end = scale * wofz(turn * np.abs(last) / width) * np.exp(1j * (b + a / 2))
    # a tail runs away from the place of least |phi'|; where that lies inside, both halves of the spiral are needed
    inside = (b < 0) & (last > 0)
    value = np.where(b < 0, -1.0, 1.0) * from_start - np.where(last > 0, 1.0, -1.0) * from_end
    centre = np.where(inside, b, 0.0)
    value += np.where(inside, 2 * scale * np.exp(-0.5j * centre * centre / a), 0.0)
    whole: npt.NDArray[np.complex128] = np.where(mirrored, np.conj(value), value)
    return whole
