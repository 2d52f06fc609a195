"""Planes through measured points, some of which are wrong."""

from __future__ import annotations

from itertools import combinations
from typing import NamedTuple

import numpy as np

from optplan.domain.arrays import BoolArray, FloatArray

TRIPLES = 2000
"""Most triples of points through which planes are tried."""
SPREADS = 4.0
"""Points further from the plane than so many standard deviations are outliers, ..."""
LEAST = 0.01
"""... but none nearer than this, m."""


class Plane(NamedTuple):
    """A plane, and how well points lie in it."""

    centre: FloatArray
    """(3,) m, the middle of the points that count"""
    normal: FloatArray
    """(3,) unit vector"""
    away: FloatArray
    """(n,) m, of every point from it, on the side of the normal positive"""
    outlier: BoolArray
    """(n,)"""


def fit_plane(points: FloatArray, seed: int = 0) -> Plane:
    """The plane through points (n, 3), n >= 3, that at least half of them lie in.

    Least median of squares over triples finds the outliers (P. J. Rousseeuw, Least median of squares regression,
    Journal of the American Statistical Association 79 (1984)); least squares through the others is the plane.
    """
    count = len(points)
    triples = np.array(list(combinations(range(count), 3))) if count <= 20 else None
    if triples is None:
        random = np.random.default_rng(seed)
        triples = np.array([random.choice(count, 3, replace=False) for _ in range(TRIPLES)])
    a, b, c = (points[triples[:, k]] for k in range(3))
    normal = np.cross(b - a, c - a)
    size = np.linalg.norm(normal, axis=1)
    good = size > 1e-9 * max(float(np.ptp(points, axis=0).max()) ** 2, 1e-12)
    if not good.any():
        centre = points.mean(axis=0)
        return Plane(centre, np.zeros(3), np.zeros(count), np.zeros(count, dtype=np.bool_))
    a, normal = a[good], normal[good] / size[good, None]
    apart = np.abs(np.einsum("tk,ntk->tn", normal, points[:, None] - a[None]))
    # half of the points, and the three that the plane goes through anyway
    ranked = np.sort(apart, axis=1)[:, min((count + 4) // 2, count - 1)]
    best = int(np.argmin(ranked))
    spread = 1.4826 * (1 + 5 / max(count - 3, 1)) * float(np.median(apart[best]))
    outlier: BoolArray = apart[best] > max(SPREADS * spread, LEAST)
    for _ in range(3):
        centre, direction = _least_squares(points[~outlier])
        away = (points - centre) @ direction
        spread = float(np.sqrt((away[~outlier] ** 2).sum() / max(int((~outlier).sum()) - 3, 1)))
        outlier = np.abs(away) > max(SPREADS * spread, LEAST)
        if (~outlier).sum() < 3:
            break
    return Plane(centre, direction, away, outlier)


def _least_squares(points: FloatArray) -> tuple[FloatArray, FloatArray]:
    centre = points.mean(axis=0)
    _, _, axes = np.linalg.svd(points - centre)
    return centre, axes[-1]
