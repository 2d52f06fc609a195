"""Gaps, heading jumps, curvature and its steps."""

from __future__ import annotations

import math

import numpy as np

from optplan.domain.arrays import FloatArray, IntArray
from optplan.domain.options import Options
from optplan.domain.path import Path
from optplan.domain.report import Check
from optplan.domain.robot import CurvatureLimits, DiffDrive, Robot
from optplan.judge._findings import (
    ANGLE,
    GAP,
    RELATIVE,
    count_of,
    held,
    noted,
    place_of,
    work_and_transit_speed,
)
from optplan.judge._integrate import Samples, largest_curvature
from optplan.judge._speeds import Speeds

_STILL = 1e-6  # m/s that count as standing
_SAME_CURVATURE = 1e-9  # 1/m


def gaps(path: Path, samples: Samples) -> Check:
    """Largest distance between the end of a piece and the start of the next, m."""
    if len(path) < 2:
        return held("gaps", 0.0, GAP, "m", detail="There are no joints.")
    distance = np.linalg.norm(path.start[1:] - samples.ends[:-1], axis=1)
    worst = int(np.argmax(distance))
    count = int((distance > GAP).sum())
    detail = (
        f"Piece {worst + 1} begins where piece {worst} ends."
        if count == 0
        else (f"{count_of(count, 'gap')}; the largest is between pieces {worst} and {worst + 1}.")
    )
    return held("gaps", float(distance[worst]), GAP, "m", place_of(samples.ends[worst]), detail)


def headings(path: Path, samples: Samples, robot: Robot, profile: Speeds | None) -> Check:
    """Largest change of direction, rad, that no stop accounts for.

    A robot that turns on the spot at a finite rate must state each turn at a stop; one that cannot may not turn at all
    while it stands. A robot without a heading (infinite rate) may set off in any direction, but only from rest.
    """
    jump = _jumps(path, samples)
    mobility = robot.mobility
    if not mobility.turns_on_spot:
        # a turn at a stop, even a full one, is impossible for it
        jump = np.maximum(jump, np.abs(path.turn[1:])) if len(path) > 1 else jump
    elif math.isinf(mobility.turn_rate):
        standing = path.is_stop[:-1] | path.is_stop[1:]
        if profile is None:
            return noted("headings", 0.0, "rad", "Any jump is allowed where the robot stands; there are no speeds yet.")
        jump = np.where(standing | (profile.joints[1:-1] <= _STILL), 0.0, jump)
    if len(jump) == 0:
        return held("headings", 0.0, ANGLE, "rad", detail="There are no joints.")
    worst = int(np.argmax(jump))
    count = int((jump > ANGLE).sum())
    detail = (
        "Every change of direction happens at a stop that states it."
        if count == 0
        else (f"{count_of(count, 'jump')} without a stop; the largest is between pieces {worst} and {worst + 1}.")
    )
    return held("headings", float(jump[worst]), ANGLE, "rad", place_of(path.start[worst + 1]), detail)


def curvature(path: Path, robot: Robot, options: Options, profile: Speeds | None) -> Check:
    """Largest |kappa|, 1/m, against what the robot can steer at the speed it has there.

    The worst spot is the one with the largest share of its limit. On a stretch of constant acceleration the limits of
    a wheeled robot are tightest at an end or where v (1 + |kappa| track / 2) peaks, which is known in closed form.
    """
    bend = largest_curvature(path)
    if profile is None:
        work, transit = work_and_transit_speed(robot, options)
        row = np.arange(len(path))
        value, speed = bend, np.where(path.tool > 0, work, transit)
    else:
        half = robot.mobility.track / 2 if isinstance(robot.mobility, DiffDrive) else 0.0
        row, value, speed = steepest(path, profile, half)
    curved = (value > 0) & (path.length[row] > 0)
    if math.isinf(_limit(robot, 1.0)):
        most = float(bend.max(initial=0.0))
        place = place_of(path.start[int(np.argmax(bend))]) if most > 0 else None
        return noted("curvature", most, "1/m", "The robot follows any curve.", place)
    if not curved.any():
        straight = _limit(robot, work_and_transit_speed(robot, options)[0])
        return held("curvature", 0.0, straight, "1/m", detail="Every piece is straight.")
    row, value, speed = row[curved], value[curved], speed[curved]
    distinct, back = np.unique(speed, return_inverse=True)
    limit = np.array([_limit(robot, v) for v in distinct.tolist()])[back]
    share = value / np.maximum(limit, 1e-12)
    worst = int(np.argmax(share))
    count = len(np.unique(row[value > limit * (1 + RELATIVE) + _SAME_CURVATURE]))
    piece = int(row[worst])
    detail = f"Piece {piece} is the tightest for its speed of {speed[worst]:.4g} m/s"
    detail += "." if count == 0 else f"; {count_of(count, 'piece')} too tight."
    slack = float(limit[worst]) * RELATIVE + _SAME_CURVATURE
    place = place_of(path.start[piece])
    return held("curvature", float(value[worst]), float(limit[worst]), "1/m", place, detail, slack=slack)


def steepest(path: Path, profile: Speeds, half: float) -> tuple[IntArray, FloatArray, FloatArray]:
    """Spots that may be the worst of each stretch for v (1 + |kappa| half).

    Parameters
    ----------
    half : half the track, m; 0 leaves the ends of the stretches

    Returns
    -------
    row, |kappa| (1/m), v (m/s) : (4k,) each. With v^2 = a + b s and kappa = k + c s the square of the product has the
    derivative (1 + h kappa)(b (1 + h kappa) + 2 h c (a + b s)), zero at one s for either sign of kappa.
    """
    row = profile.row
    length = profile.end - profile.begin
    start = path.curvature[row] + path.sharpness[row] * profile.begin
    rate = path.sharpness[row]
    square = profile.before**2
    growth = np.divide(profile.after**2 - square, length, out=np.zeros_like(length), where=length > 0)
    places = [np.zeros_like(length), length]
    for sign in (half, -half):
        below = 3 * growth * sign * rate
        above = -(growth * (1 + sign * start) + 2 * sign * rate * square)
        spot = np.divide(above, below, out=np.zeros_like(length), where=below != 0)
        places.append(np.clip(spot, 0, length))
    s = np.stack(places)
    kappa = np.abs(start + rate * s)
    v = np.sqrt(np.maximum(square + growth * s, 0))
    return np.tile(row, len(places)), kappa.ravel(), v.ravel()


def sharpness(path: Path, robot: Robot, options: Options, profile: Speeds | None) -> Check:
    """Largest |dkappa/ds|, 1/m^2, against what the robot can steer at the speed it has there.

    The worst spot is the one with the largest share of its limit; what jumps is a curvature step.
    """
    if profile is None:
        work, transit = work_and_transit_speed(robot, options)
        row, speed = np.arange(len(path)), np.where(path.tool > 0, work, transit)
    else:
        row, speed = profile.row, np.maximum(profile.before, profile.after)
    value = np.abs(path.sharpness[row])
    limit = np.array([_limits(robot, v).sharpness for v in speed.tolist()])
    if np.isinf(limit).all():
        return noted("sharpness", float(value.max(initial=0.0)), "1/m^2", "Nothing limits it.")
    share = np.where(path.length[row] > 0, value, 0.0) / limit
    worst = int(np.argmax(share))
    piece, most = int(row[worst]), float(limit[worst])
    count = len(np.unique(row[share > 1 + RELATIVE]))
    detail = f"Piece {piece} changes its curvature fastest for its speed of {speed[worst]:.4g} m/s"
    detail += "." if count == 0 else f"; {count_of(count, 'piece')} too fast."
    place = place_of(path.start[piece])
    return held("sharpness", float(value[worst]), most, "1/m^2", place, detail, slack=most * RELATIVE)


def curvature_steps(path: Path, samples: Samples, profile: Speeds | None) -> tuple[Check, list[tuple[str, float, str]]]:
    """Curvature jumps (1/m) that are driven over, and the continuity order of the path where it moves.

    The order is 2 when curvature is continuous, 1 when only headings are, 0 when only places are, -1 with gaps.
    """
    if len(path) < 2:
        return noted("curvature steps", 0.0, "1/m", "There are no joints."), _orders(2, 0)
    moving = ~path.is_stop[:-1] & ~path.is_stop[1:] & (path.gear[:-1] == path.gear[1:])
    if profile is not None:
        moving &= profile.joints[1:-1] > _STILL
    step = np.where(moving, np.abs(path.curvature[1:] - samples.end_curvature[:-1]), 0.0)
    bent = moving & (_jumps(path, samples) > ANGLE)
    apart = np.linalg.norm(path.start[1:] - samples.ends[:-1], axis=1) > GAP
    count = int((step > _SAME_CURVATURE).sum())
    order = -1 if apart.any() else 0 if bent.any() else 1 if count else 2
    worst = int(np.argmax(step))
    detail = (
        "Curvature is continuous wherever the robot moves."
        if count == 0
        else (f"Curvature jumps at {count_of(count, 'joint')} that the robot does not stop at.")
    )
    place = place_of(path.start[worst + 1]) if count else None
    return noted("curvature steps", float(step[worst]), "1/m", detail, place), _orders(order, count)


def _orders(order: int, count: int) -> list[tuple[str, float, str]]:
    return [("continuity order", float(order), ""), ("curvature steps", float(count), "")]


def _limits(robot: Robot, speed: float) -> CurvatureLimits:
    return robot.mobility.curvature_limits(max(speed, 1e-9))


def _limit(robot: Robot, speed: float) -> float:
    return _limits(robot, speed).curvature


def _jumps(path: Path, samples: Samples) -> FloatArray:
    """(n - 1,) angle between where the robot points at the end of a piece and at the start of the next, rad."""
    if len(path) < 2:
        return np.zeros(0)
    # the body's: driven backwards it points against the direction of travel
    back = np.where(path.gear > 0, 0.0, math.pi)
    before = _directions(samples.end_heading[:-1] + back[:-1], path.elevation[:-1])
    after = _directions(path.heading[1:] + back[1:], path.elevation[1:])
    # atan2 stays exact for small angles, where arccos of the product loses half the digits
    crossed = np.linalg.norm(np.cross(before, after), axis=1)
    angles: FloatArray = np.arctan2(crossed, np.einsum("ij,ij->i", before, after))
    return angles


def _directions(heading: FloatArray, elevation: FloatArray) -> FloatArray:
    level = np.cos(elevation)
    return np.stack([level * np.cos(heading), level * np.sin(heading), np.sin(elevation)], axis=1)
