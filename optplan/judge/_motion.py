"""The speed profile: whether its times add up, and whether the robot can do it."""

from __future__ import annotations

import math

import numpy as np

from optplan.domain.arrays import FloatArray
from optplan.domain.options import Options
from optplan.domain.path import RAISED, Path, Trajectory
from optplan.domain.report import Check
from optplan.domain.robot import DiffDrive, Robot
from optplan.judge import _tool
from optplan.judge._continuity import steepest
from optplan.judge._findings import (
    GAP,
    RELATIVE,
    SAME_PLACE,
    Place,
    held,
    noted,
    place_of,
)
from optplan.judge._speeds import Speeds

NAMES = ("time", "rest", "speed", "acceleration", "wheel speed", "wheel acceleration", "jerk", "power")
_OF_CHANGES = ("rest", "acceleration", "wheel acceleration")
_INSTANT = 1e-9
"""s below which an interval of time is nothing."""
_COLUMNS = (
    "start", "heading", "elevation", "curvature", "sharpness", "length", "turn", "dwell", "tool", "stroke", "gear",
)  # fmt: skip


def motion(path: Path, trajectory: Trajectory, profile: Speeds, robot: Robot, options: Options) -> list[Check]:
    """All checks of a speed profile."""
    checks = [
        _time(path, trajectory, profile, robot),
        _rest(trajectory),
        _tool.speed(path, profile, robot, options),
        _acceleration(path, trajectory, profile, robot),
        _wheels(path, profile, robot),
        _wheel_acceleration(path, profile, robot),
        _jerk(path, profile, options),
        _power(path, profile, options),
    ]
    if options.time.constant_speed is None:
        return checks
    # one speed from the first metre to the last is a way to compare plans, not to drive them
    asked = "One constant speed was asked for; no robot reaches it in no time."
    return [
        noted(check.name, check.value, check.unit, asked, check.place) if check.name in _OF_CHANGES else check
        for check in checks
    ]


def durations(path: Path, trajectory: Trajectory, profile: Speeds) -> list[tuple[str, float, str]]:
    """The figures `duration`, `work time`, `transit time` and `turn time`, s. Working while standing is work."""
    step, gone = np.diff(trajectory.t), np.diff(profile.knots)
    standing = gone <= SAME_PLACE
    middle = (profile.knots[:-1] + profile.knots[1:]) / 2
    row = np.clip(np.searchsorted(path.offsets, middle, side="right") - 1, 0, max(len(path) - 1, 0))
    work = ~standing & (path.tool[row] > RAISED) if len(path) else standing
    still = float(step[standing].sum())
    dwelt = min(float(path.dwell.sum()), still)
    return [
        ("duration", trajectory.duration, "s"),
        ("work time", float(step[work].sum()) + dwelt, "s"),
        ("transit time", float(step[~work & ~standing].sum()), "s"),
        ("turn time", still - dwelt, "s"),
    ]


def _time(path: Path, trajectory: Trajectory, profile: Speeds, robot: Robot) -> Check:
    """Largest disagreement of the knots, s: with constant acceleration between them, with the path, with its stops."""
    found = [_foreign(path, trajectory), _reach(path, profile), _uneven(trajectory, profile)]
    found.append(_short_stop(path, trajectory, profile, robot))
    error, detail, s = max(found, key=lambda entry: entry[0])
    if error <= 0:
        return held("time", 0.0, 0.0, "s", detail="The knots agree with each other, with the path and with its stops.")
    return held("time", error, 0.0, "s", _place_at(path, s), detail)


_Fault = tuple[float, str, float]  # s, what is wrong, arc length m
_FINE: _Fault = (0.0, "", 0.0)


def _foreign(path: Path, trajectory: Trajectory) -> _Fault:
    same = trajectory.path is path or (
        len(trajectory.path) == len(path)
        and all(np.array_equal(getattr(trajectory.path, name), getattr(path, name)) for name in _COLUMNS)
    )
    return _FINE if same else (1e9, "The speeds were made for another path.", 0.0)


def _reach(path: Path, profile: Speeds) -> _Fault:
    """Knots must begin at 0, end at the path's end and lie at every joint; what is missed counts as 1 s/m."""
    offsets, knots = path.offsets, profile.knots
    if len(knots) == 0:
        return (1e9, "There are no knots.", 0.0) if len(path) else _FINE
    ends = np.array([abs(knots[0]), abs(knots[-1] - offsets[-1])])
    if ends.max() > GAP:
        return float(ends.max()), f"The knots cover {knots[0]:.9g} to {knots[-1]:.9g} m of {offsets[-1]:.9g} m.", 0.0
    right = np.clip(np.searchsorted(knots, offsets), 0, len(knots) - 1)
    left = np.maximum(right - 1, 0)
    miss = np.minimum(np.abs(knots[right] - offsets), np.abs(knots[left] - offsets))
    worst = int(np.argmax(miss))
    if miss[worst] <= GAP:
        return _FINE
    return float(miss[worst]), f"There is no knot where piece {worst} begins.", float(offsets[worst])


def _uneven(trajectory: Trajectory, profile: Speeds) -> _Fault:
    """Intervals whose length, time and speeds do not fit one constant acceleration."""
    if len(trajectory.s) < 2:
        return _FINE
    gone, step, mean = np.diff(profile.knots), np.diff(trajectory.t), (trajectory.v[:-1] + trajectory.v[1:]) / 2
    moving = (gone > 0) & ((mean > 0) | (gone > SAME_PLACE))
    due = np.where(moving, np.where(mean > 0, gone / np.where(mean > 0, mean, 1.0), 1e9), 0.0)
    # standing still takes as long as it takes, but only at speed 0
    late = np.abs(np.where(moving | (mean > 0), step - due, 0.0))
    allowed = RELATIVE * due + _INSTANT
    # rounding of t itself, and of a first or last bit of path driven at nearly no speed
    allowed = (
        allowed + 1e-12 * abs(float(trajectory.t[-1])) + np.where(mean > 0, SAME_PLACE / np.maximum(mean, 1e-5), 0)
    )
    excess = np.where(late > allowed, late, 0.0)
    worst = int(np.argmax(excess))
    if excess[worst] == 0:
        return _FINE
    detail = f"From {profile.knots[worst]:.6g} m the next {gone[worst]:.6g} m take {step[worst]:.9g} s"
    detail += f"; these speeds need {due[worst]:.9g} s."
    return float(excess[worst]), detail, float(profile.knots[worst])


def _turn_time(angle: FloatArray, robot: Robot) -> FloatArray:
    """Least time (k,) s for turning on the spot by angles (k,) rad from rest to rest, within rate and acceleration."""
    rate, rise = robot.mobility.turn_rate, robot.mobility.turn_acceleration
    if math.isinf(rate):
        return np.zeros(len(angle))
    full = angle / rate + rate / rise  # reaches the rate; a smaller turn only speeds up and slows down
    least: FloatArray = np.where(angle * rise < rate**2, 2 * np.sqrt(angle / rise), np.where(angle > 0, full, 0.0))
    return least


def _short_stop(path: Path, trajectory: Trajectory, profile: Speeds, robot: Robot) -> _Fault:
    """Stops that end before the turn and the work are done."""
    stops = np.flatnonzero(path.is_stop)
    if len(stops) == 0 or len(trajectory.s) < 2:
        return _FINE
    needed = _turn_time(np.abs(path.turn[stops]), robot) + path.dwell[stops]
    places, group = np.unique(path.offsets[stops], return_inverse=True)
    due = np.bincount(group, weights=needed)
    step, gone = np.diff(trajectory.t), np.diff(profile.knots)
    still = np.concatenate([[0.0], np.cumsum(np.where(gone <= SAME_PLACE, step, 0.0))])
    # the time spent at a place is the standing time between the first and the last knot there
    first = np.searchsorted(profile.knots, places - SAME_PLACE, side="left")
    last = np.searchsorted(profile.knots, places + SAME_PLACE, side="right") - 1
    had = np.where(last >= first, still[np.maximum(last, 0)] - still[np.minimum(first, len(still) - 1)], 0.0)
    short = due - had
    short = np.where(short > RELATIVE * due + _INSTANT, short, 0.0)
    worst = int(np.argmax(short))
    if short[worst] == 0:
        return _FINE
    detail = f"The stop at {places[worst]:.6g} m takes {had[worst]:.6g} s; its turn and work need {due[worst]:.6g} s."
    return float(short[worst]), detail, float(places[worst])


def _rest(trajectory: Trajectory) -> Check:
    ends = trajectory.v[[0, -1]] if len(trajectory.v) else np.zeros(2)
    detail = (
        "The robot begins and ends at rest."
        if ends.max() <= GAP
        else (f"The robot begins at {ends[0]:.4g} m/s and ends at {ends[1]:.4g} m/s.")
    )
    return held("rest", float(ends.max()), 0.0, "m/s", detail=detail, slack=GAP)


def _acceleration(path: Path, trajectory: Trajectory, profile: Speeds, robot: Robot) -> Check:
    """Largest acceleration along the path, m/s^2. A jump of speed at one place counts as over `SAME_PLACE`."""
    limit = robot.mobility.acceleration
    if len(trajectory.v) < 2:
        return held("acceleration", 0.0, limit, "m/s^2", detail="Nothing moves.")
    gone = np.diff(profile.knots)
    change = np.abs(np.diff(trajectory.v**2)) / 2
    value = change / np.maximum(gone, SAME_PLACE)
    # over next to no path, a speed known to some nine digits says nothing about acceleration
    fuzz = 1e-9 * (np.maximum(trajectory.v[:-1], trajectory.v[1:]) ** 2 + limit)
    fine = change <= limit * gone * (1 + RELATIVE) + fuzz
    value = np.where(fine, np.minimum(value, limit), value)
    worst = int(np.argmax(value))
    place = _place_at(path, float(profile.knots[worst]))
    detail = "The speed changes no faster than the robot can."
    if not fine.all():
        detail = f"The speed changes too fast from {profile.knots[worst]:.6g} m of the path on."
    return held("acceleration", float(value[worst]), limit, "m/s^2", place, detail, slack=limit * RELATIVE)


def _wheels(path: Path, profile: Speeds, robot: Robot) -> Check:
    """Fastest turning of a wheel, rad/s, between samples too."""
    mobility = robot.mobility
    if not isinstance(mobility, DiffDrive):
        return noted("wheel speed", 0.0, "rad/s", "The robot has no wheels.")
    row, kappa, v = steepest(path, profile, mobility.track / 2)
    if len(row) == 0:
        return held("wheel speed", 0.0, mobility.wheel_speed, "rad/s", detail="Nothing moves.")
    rate = v * (1 + kappa * mobility.track / 2) / mobility.wheel_radius
    worst = int(np.argmax(rate))
    place = place_of(path.start[int(row[worst])])
    detail = f"A wheel turns fastest on piece {int(row[worst])}."
    limit = mobility.wheel_speed
    return held("wheel speed", float(rate[worst]), limit, "rad/s", place, detail, slack=RELATIVE * limit)


def _wheel_acceleration(path: Path, profile: Speeds, robot: Robot) -> Check:
    """Largest change of a wheel's speed while driving, rad/s^2, between samples too.

    On a stretch of constant acceleration a along a clothoid, the rims of the wheels, r from the middle, have the
    tangential acceleration a (1 +- kappa r) +- r kappa' v^2, which is linear in the arc length: an end has the largest.
    """
    mobility = robot.mobility
    if not isinstance(mobility, DiffDrive):
        return noted("wheel acceleration", 0.0, "rad/s^2", "The robot has no wheels.")
    limit = mobility.wheel_acceleration
    length = profile.end - profile.begin
    if not (length > 0).any():
        return held("wheel acceleration", 0.0, limit, "rad/s^2", detail="Nothing moves.")
    half, row, rate = mobility.track / 2, profile.row, path.sharpness[profile.row]
    change = (profile.after**2 - profile.before**2) / 2
    # a times length: over next to no path, speeds known to some nine digits say nothing about acceleration
    fuzz = 1e-9 * (np.maximum(profile.before, profile.after) ** 2 + mobility.acceleration)
    worst, place, count = 0.0, 0, 0
    for spot, square in ((profile.begin, profile.before**2), (profile.end, profile.after**2)):
        bend = path.curvature[row] + rate * spot
        for side in (half, -half):
            moved = np.abs(change * (1 + bend * side) + side * rate * square * length)
            fine = moved <= mobility.acceleration * length * (1 + RELATIVE) + fuzz
            value = moved / np.maximum(length, SAME_PLACE) / mobility.wheel_radius
            value = np.where(fine, np.minimum(value, limit), value)
            count += int((~fine).sum())
            if value.max() > worst:
                worst, place = float(value.max()), int(np.argmax(value))
    detail = "No wheel changes its speed faster than it can."
    if count:
        detail = f"A wheel changes its speed too fast from {path.offsets[row[place]] + profile.begin[place]:.6g} m on."
    where = place_of(path.start[int(row[place])])
    return held("wheel acceleration", worst, limit, "rad/s^2", where, detail, slack=limit * RELATIVE)


def _jerk(path: Path, profile: Speeds, options: Options) -> Check:
    """Largest change of the acceleration along the path, m/s^3: from the middle of one stretch to that of the next.

    From rest, and to it, the acceleration changes within half of the stretch's time.
    """
    limit = options.time.jerk
    if limit is None:
        return noted("jerk", 0.0, "m/s^3", "Nothing limits it.")
    length = profile.end - profile.begin
    rate = np.divide(profile.after**2 - profile.before**2, 2 * length, out=np.zeros_like(length), where=length > 0)
    speed = profile.after[:-1]
    moving = (length[:-1] > 0) & (length[1:] > 0) & (speed > 0)
    if not (length > 0).any():
        return held("jerk", 0.0, limit, "m/s^3", detail="Nothing moves.")
    between = np.maximum((length[:-1] + length[1:]) / 2, SAME_PLACE)
    value = np.where(moving, np.abs(np.diff(rate)) * speed / between, 0.0)
    resting = (profile.before == 0) != (profile.after == 0)
    alone = np.where(resting, np.abs(rate) * (profile.before + profile.after) / np.maximum(length, SAME_PLACE), 0.0)
    value = np.maximum(alone, np.append(value, 0.0))
    worst = int(np.argmax(value))
    where = place_of(path.start[int(profile.row[worst])])
    detail = f"The acceleration changes fastest on piece {int(profile.row[worst])}."
    return held("jerk", float(value[worst]), limit, "m/s^3", where, detail, slack=limit * 10 * RELATIVE)


def _power(path: Path, profile: Speeds, options: Options) -> Check:
    """Largest product of acceleration and speed, W/kg, while it speeds up."""
    limit = options.time.power
    if limit is None:
        return noted("power", 0.0, "W/kg", "Nothing limits it.")
    length = profile.end - profile.begin
    rate = np.divide(profile.after**2 - profile.before**2, 2 * length, out=np.zeros_like(length), where=length > 0)
    value = rate * profile.after
    if not (value > 0).any():
        return held("power", 0.0, limit, "W/kg", detail="Nothing speeds up.")
    worst = int(np.argmax(value))
    where = place_of(path.start[int(profile.row[worst])])
    detail = f"Speeding up takes most on piece {int(profile.row[worst])}."
    return held("power", float(value[worst]), limit, "W/kg", where, detail, slack=limit * 10 * RELATIVE)


def _place_at(path: Path, s: float) -> Place | None:
    """Start of the piece at this arc length."""
    if len(path) == 0:
        return None
    offsets: FloatArray = path.offsets
    row = int(np.clip(np.searchsorted(offsets, s + SAME_PLACE, side="right") - 1, 0, len(path) - 1))
    return place_of(path.start[row])
