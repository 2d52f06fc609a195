"""What a drive amounts to."""

from __future__ import annotations

import numpy as np

from optplan.domain.arrays import BoolArray, FloatArray, IntArray
from optplan.domain.path import RAISED

GRAVITY = 9.80665
"""m/s^2"""
Figures = tuple[tuple[str, float, str], ...]


def figures_of(
    time: FloatArray,
    tool: IntArray,
    wheel_speed: FloatArray,
    wheel_acceleration: FloatArray,
    cross_track: FloatArray,
    lag: FloatArray,
    planned: float,
    energy: float | None,
    missed: float | None = None,
) -> Figures:
    """Figures of a drive: its columns, the duration planned (s), and, where they are known, the energy (J) and by how
    much marks begin or end elsewhere than planned (m)."""
    down = tool != RAISED
    everywhere = np.ones(len(time), dtype=np.bool_)
    made = [
        ("duration", float(time[-1] - time[0]), "s"),
        ("planned duration", planned, "s"),
        ("cross-track, greatest", _greatest(cross_track, everywhere), "m"),
        ("cross-track, rms", _rms(cross_track, everywhere), "m"),
        ("cross-track with the tool down, greatest", _greatest(cross_track, down), "m"),
        ("cross-track with the tool down, rms", _rms(cross_track, down), "m"),
        ("lag, greatest", _greatest(lag, everywhere), "m"),
        ("wheel speed, greatest", float(np.abs(wheel_speed).max()), "rad/s"),
        ("wheel acceleration, greatest", float(np.abs(wheel_acceleration).max()), "rad/s^2"),
        ("wheel acceleration, rms", float(np.sqrt(np.mean(wheel_acceleration**2))), "rad/s^2"),
    ]
    if energy is not None:
        made.append(("energy", energy, "J"))
    if missed is not None:
        made.append(("ends of marks, greatest error", missed, "m"))
    return tuple(made)


def energy_used(wheel_speed: FloatArray, step: float, radius: float, mass: float, rolling: float) -> float:
    """Energy that the motors give, J: an estimate.

    Each wheel (n, 2) carries half the mass (kg) and half of its rolling resistance (a share of the weight). What
    braking would give back is not counted.
    """
    rim = np.abs(wheel_speed) * radius
    mean = (rim[1:] + rim[:-1]) / 2
    faster = (rim[1:] ** 2 - rim[:-1] ** 2) * mass / 4
    rolled = rolling * mass / 2 * GRAVITY * mean * step
    return float(np.maximum(faster + rolled, 0.0).sum())


def _greatest(values: FloatArray, where: BoolArray) -> float:
    return float(np.abs(values[where]).max(initial=0.0))


def _rms(values: FloatArray, where: BoolArray) -> float:
    return float(np.sqrt(np.mean(values[where] ** 2))) if where.any() else 0.0
