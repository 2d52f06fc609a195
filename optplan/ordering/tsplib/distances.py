"""The distance functions of TSPLIB, rounded as it says (Reinelt, "TSPLIB 95", 1995, section 2)."""

from __future__ import annotations

import numpy as np

from optplan.domain.arrays import FloatArray

EARTH_RADIUS = 6378.388
"""km, as the format fixes it."""


def nearest_integer(values: FloatArray) -> FloatArray:
    """The format's nint: half up."""
    rounded: FloatArray = np.floor(values + 0.5)
    return rounded


def _steps(points: FloatArray) -> FloatArray:
    return points[:, None, :] - points[None, :, :]


def euclid(points: FloatArray) -> FloatArray:
    """EUC_2D and EUC_3D."""
    return nearest_integer(np.sqrt((_steps(points) ** 2).sum(axis=-1)))


def ceiling(points: FloatArray) -> FloatArray:
    """CEIL_2D."""
    rounded: FloatArray = np.ceil(np.sqrt((_steps(points) ** 2).sum(axis=-1)))
    return rounded


def manhattan(points: FloatArray) -> FloatArray:
    """MAN_2D and MAN_3D."""
    return nearest_integer(np.abs(_steps(points)).sum(axis=-1))


def maximum(points: FloatArray) -> FloatArray:
    """MAX_2D and MAX_3D."""
    largest: FloatArray = np.abs(_steps(points)).max(axis=-1)
    return nearest_integer(largest)


def pseudo_euclid(points: FloatArray) -> FloatArray:
    """ATT: rounded up where rounding would shorten."""
    exact = np.sqrt((_steps(points) ** 2).sum(axis=-1) / 10.0)
    rounded = nearest_integer(exact)
    return np.where(rounded < exact, rounded + 1.0, rounded)


def geographical(points: FloatArray) -> FloatArray:
    """GEO: degrees and minutes of latitude and longitude as DDD.MM, on a sphere, km."""
    degrees = np.trunc(points)
    # pi as the format writes it: the known optima belong to it
    radians = 3.141592 * (degrees + 5.0 * (points - degrees) / 3.0) / 180.0
    latitude, longitude = radians[:, 0], radians[:, 1]
    q1 = np.cos(longitude[:, None] - longitude)
    q2 = np.cos(latitude[:, None] - latitude)
    q3 = np.cos(latitude[:, None] + latitude)
    angle = np.arccos(np.clip(0.5 * ((1.0 + q1) * q2 - (1.0 - q1) * q3), -1.0, 1.0))
    return np.trunc(EARTH_RADIUS * angle + 1.0)


DISTANCES = {
    "EUC_2D": (2, euclid),
    "EUC_3D": (3, euclid),
    "CEIL_2D": (2, ceiling),
    "MAN_2D": (2, manhattan),
    "MAN_3D": (3, manhattan),
    "MAX_2D": (2, maximum),
    "MAX_3D": (3, maximum),
    "ATT": (2, pseudo_euclid),
    "GEO": (2, geographical),
}
"""Coordinates of a point, and the function from points (n, d) to distances (n, n), by name."""
