"""The end of a clothoid piece, a curve whose curvature changes at a constant rate, in compiled code.

Along u the heading is theta + kappa u + sigma u^2 / 2. The displacement is found by one of three ways, each where it
neither cancels nor divides by zero: Gauss quadrature while the heading changes little; closed forms of arcs; and the
auxiliary functions f and g of the Fresnel integrals (Abramowitz and Stegun, 7.3.5 to 7.3.10) where it changes much.
"""

from __future__ import annotations

import math

import numpy as np

from optplan.compiled import njit
from optplan.domain.arrays import FloatArray

CALM = 6.0
"""rad; up to this change of heading Gauss quadrature with 16 nodes is exact to rounding"""
FAR = 2.4
"""The auxiliary functions are used from this distance of the inflection on: from t = FAR, heading pi t^2 / 2."""

_NODES, _WEIGHTS = (tuple(map(float, row[8:])) for row in np.polynomial.legendre.leggauss(16))
_NODES_8, _WEIGHTS_8 = (tuple(map(float, row[4:])) for row in np.polynomial.legendre.leggauss(8))
# pi t f and pi^2 t^3 g as ratios of polynomials in y = 1 / (pi t^2), interpolated at Chebyshev nodes in 50 digits:
# errors below 4e-17 for t >= FAR.
_F_TOP = (
    1.0,
    57.0117809877943896,
    1891.62169841158877,
    33847.3498562675414,
    360758.16950797979,
    1787911.53974833027,
    1550458.60346883109,
    -18148229.4939363492,
    -6996108.82367446128,
)
_F_BOTTOM = (
    1.0,
    57.0117809877947917,
    1894.62169841086418,
    34018.3851997627683,
    366337.034391864876,
    1883980.51075688072,
    2460920.61388501098,
    -15474522.3937185901,
    -20504811.649041728,
)
_G_TOP = (
    1.0,
    99.2662598872525669,
    5124.24130979873377,
    158976.197176416045,
    3146271.97625915502,
    38881312.5847407772,
    273912334.470568361,
    797855014.387773467,
    -727406066.809316983,
    125873722.116962595,
)
_G_BOTTOM = (
    1.0,
    99.2662598872522278,
    5139.24130979950296,
    160465.191074009124,
    3222415.59626973413,
    41194483.7188348385,
    317527145.963131251,
    1277542934.48957939,
    1650838160.2027923,
    -1420777315.95575306,
)


@njit("UniTuple(float64, 2)(float64)", cache=True, nogil=True, error_model="numpy")
def _ratios(y: float) -> tuple[float, float]:
    """pi t f(t) and pi^2 t^3 g(t) for y = 1 / (pi t^2)."""
    f_top = f_bottom = g_top = g_bottom = 0.0
    for i in range(9):
        f_top = f_top * y + _F_TOP[8 - i]
        f_bottom = f_bottom * y + _F_BOTTOM[8 - i]
    for i in range(10):
        g_top = g_top * y + _G_TOP[9 - i]
        g_bottom = g_bottom * y + _G_BOTTOM[9 - i]
    return f_top / f_bottom, g_top / g_bottom


@njit("UniTuple(float64, 2)(float64, float64, float64, float64)", cache=True, nogil=True, error_model="numpy")
def _gauss(theta: float, kappa: float, sigma: float, length: float) -> tuple[float, float]:
    """Displacement of a piece whose heading changes by a few rad: the middle's frame, symmetric pairs of nodes."""
    h = 0.5 * length
    a = (kappa + sigma * h) * h
    b = 0.5 * sigma * h * h
    along = across = 0.0
    # b counts more: its phase is of the second order in z
    if abs(a) + 4.0 * abs(b) < 0.7:
        for i in range(4):
            z = _NODES_8[i]
            weight = _WEIGHTS_8[i] * math.cos(a * z)
            along += weight * math.cos(b * z * z)
            across += weight * math.sin(b * z * z)
    else:
        for i in range(8):
            z = _NODES[i]
            weight = _WEIGHTS[i] * math.cos(a * z)
            along += weight * math.cos(b * z * z)
            across += weight * math.sin(b * z * z)
    middle = theta + h * (kappa + 0.5 * sigma * h)
    c = math.cos(middle)
    s = math.sin(middle)
    return length * (c * along - s * across), length * (s * along + c * across)


@njit("UniTuple(float64, 2)(float64, float64, float64)", cache=True, nogil=True, error_model="numpy")
def _rest(theta: float, kappa: float, sigma: float) -> tuple[float, float]:
    """From a point far from the inflection to the infinite end of the spiral (kappa and sigma of one sign)."""
    f, g = _ratios(abs(sigma) / (kappa * kappa))
    # the integral from t on is (f + i g) i exp(i heading), scaled by 1 / kappa
    f /= kappa
    g *= sigma / (kappa * kappa * kappa)
    c = math.cos(theta)
    s = math.sin(theta)
    return g * c - f * s, f * c + g * s


@njit("UniTuple(float64, 2)(float64, float64, float64, float64)", cache=True, nogil=True, error_model="numpy")
def clothoid_displacement(theta: float, kappa: float, sigma: float, length: float) -> tuple[float, float]:
    """Displacement (m, m) over `length` metres from a heading (rad), a curvature (1/m) and a sharpness (1/m^2)."""
    swing = max(abs(kappa), abs(kappa + sigma * length)) * abs(length)
    if swing <= CALM:
        return _gauss(theta, kappa, sigma, length)
    if sigma == 0.0 or abs(sigma) * length * length < 1e-16:
        # many turns of an arc
        half = 0.5 * kappa * length
        chord = 2.0 * math.sin(half) / kappa
        return chord * math.cos(theta + half), chord * math.sin(theta + half)
    if length < 0.0:
        x, y = clothoid_displacement(theta + math.pi, -kappa, sigma, -length)
        return x, y
    # the inflection, t = 0, and t = -FAR and FAR cut the piece: far outside f and g, between them quadrature
    reach = FAR * math.sqrt(math.pi / abs(sigma))
    inflection = -kappa / sigma
    x = y = done = 0.0
    for i in range(4):
        stop = length if i == 3 else min(length, inflection + (i - 1) * reach)
        if stop <= done:
            continue
        at = theta + done * (kappa + 0.5 * sigma * done)
        bend = kappa + sigma * done
        part = stop - done
        end = kappa + sigma * stop
        if max(abs(bend), abs(end)) * part <= CALM or i == 1 or i == 2:
            dx, dy = _gauss(at, bend, sigma, part)
        else:
            x1, y1 = _rest(at, bend, sigma)
            x2, y2 = _rest(theta + stop * (kappa + 0.5 * sigma * stop), end, sigma)
            dx = x1 - x2
            dy = y1 - y2
        x += dx
        y += dy
        done = stop
    return x, y


@njit(
    "UniTuple(float64, 4)(float64, float64, float64, float64, float64, float64)",
    cache=True,
    nogil=True,
    error_model="numpy",
)
def clothoid_end(
    x: float, y: float, theta: float, kappa: float, sigma: float, length: float
) -> tuple[float, float, float, float]:
    """Position (m, m), heading (rad, not wrapped) and curvature (1/m) after `length` metres at sharpness sigma (1/m^2).

    A negative length goes back along the same curve.
    """
    dx, dy = clothoid_displacement(theta, kappa, sigma, length)
    return x + dx, y + dy, theta + length * (kappa + 0.5 * sigma * length), kappa + sigma * length


@njit("float64[:, ::1](float64[:, ::1], float64[::1], float64[::1])", cache=True, nogil=True, error_model="numpy")
def clothoid_ends(starts: FloatArray, sharpnesses: FloatArray, lengths: FloatArray) -> FloatArray:
    """`clothoid_end` of rows x, y, theta, kappa (k, 4), sharpnesses (k,) and lengths (k,): rows (k, 4)."""
    ends = np.empty((len(starts), 4))
    for i in range(len(starts)):
        x, y, theta, kappa = clothoid_end(
            starts[i, 0], starts[i, 1], starts[i, 2], starts[i, 3], sharpnesses[i], lengths[i]
        )
        ends[i, 0] = x
        ends[i, 1] = y
        ends[i, 2] = theta
        ends[i, 3] = kappa
    return ends
