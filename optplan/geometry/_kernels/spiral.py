"""Displacements of full-sharpness clothoids, read from a table, in compiled code.

All lengths are in least radii: the curvature limit is 1, the sharpness limit s = sigma_max / kappa_max^2. One Euler
spiral, E(k) = integral of exp(i w^2 / 2s) dw / s from 0 to k, then holds every clothoid of sharpness s or -s: from a to
b it moves by exp(i (heading - a^2 / 2s)) (E(b) - E(a)), downwards by exp(i (heading + a^2 / 2s)) conj(E(a) - E(b)).
"""

from __future__ import annotations

import math

import numpy as np

from optplan.compiled import njit
from optplan.domain.arrays import FloatArray
from optplan.geometry._kernels.clothoid import clothoid_displacement

LARGEST = 20_000
"""cells of a table; blunter limits than about s = 0.001 get coarser ones, and paths are polished anyway"""


@njit("float64[:, ::1](float64)", cache=True, nogil=True, error_model="numpy")
def spiral_table(s: float) -> FloatArray:
    """Rows of coefficients (n, 12) of E on [0, 1]: quintics that agree to second derivatives at the cells' ends.

    The heading changes by 1/24 rad a cell at most: the error is below 1e-13 / s.
    """
    n = int(min(max(16.0, 24.0 / s), float(LARGEST)))
    h = 1.0 / n
    table = np.empty((n, 12))
    x0 = y0 = 0.0
    for i in range(n):
        k0 = i * h
        k1 = k0 + h
        dx, dy = clothoid_displacement(0.5 * k0 * k0 / s, k0, s, h / s)
        for axis in range(2):
            p0 = x0 if axis == 0 else y0
            p1 = p0 + (dx if axis == 0 else dy)
            shift = 0.0 if axis == 0 else 0.5 * math.pi
            # E' = exp(i k^2 / 2s) / s, E'' = i k / s E'
            a0 = 0.5 * k0 * k0 / s - shift
            a1 = 0.5 * k1 * k1 / s - shift
            v0 = math.cos(a0) * h / s
            v1 = math.cos(a1) * h / s
            w0 = -math.sin(a0) * h * h * k0 / (s * s)
            w1 = -math.sin(a1) * h * h * k1 / (s * s)
            gap = p1 - p0
            row = 6 * axis
            table[i, row] = p0
            table[i, row + 1] = v0
            table[i, row + 2] = 0.5 * w0
            table[i, row + 3] = 10.0 * gap - 6.0 * v0 - 4.0 * v1 - 1.5 * w0 + 0.5 * w1
            table[i, row + 4] = -15.0 * gap + 8.0 * v0 + 7.0 * v1 + 1.5 * w0 - w1
            table[i, row + 5] = 6.0 * gap - 3.0 * v0 - 3.0 * v1 - 0.5 * w0 + 0.5 * w1
        x0 += dx
        y0 += dy
    return table


@njit("UniTuple(float64, 2)(float64[:, ::1], float64)", cache=True, nogil=True, error_model="numpy", inline="always")
def spiral(table: FloatArray, k: float) -> tuple[float, float]:
    """E(k) for -1 <= k <= 1."""
    n = len(table)
    at = abs(k) * n
    i = min(int(at), n - 1)
    u = at - i
    x = table[i, 0] + u * (table[i, 1] + u * (table[i, 2] + u * (table[i, 3] + u * (table[i, 4] + u * table[i, 5]))))
    y = table[i, 6] + u * (table[i, 7] + u * (table[i, 8] + u * (table[i, 9] + u * (table[i, 10] + u * table[i, 11]))))
    if k < 0.0:
        return -x, -y
    return x, y
