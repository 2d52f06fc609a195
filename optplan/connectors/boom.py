"""Times of a boom lift: every move from rest to rest, each axis within its own limits."""

from __future__ import annotations

import numpy as np

from optplan.connectors.wall_travel import Travel
from optplan.domain.errors import InputError
from optplan.domain.facade import Facade
from optplan.domain.options import Options
from optplan.domain.path import Path, Trajectory
from optplan.domain.result import Cover
from optplan.domain.robot import Robot
from optplan.geometry.paths import ends


def profile_stops(path: Path, job: Facade, cover: Cover, robot: Robot, options: Options) -> Trajectory:
    """The fastest speeds along a path of straight moves and stops. A move's axes are those of the wall it leaves; of
    the first one, where there is a start, those of the wall it comes to.

    Raises InputError for limits that a boom lift has not.
    """
    asked = options.time
    if asked.jerk is not None or asked.power is not None or asked.constant_speed is not None:
        raise InputError(
            "a boom lift has limits of speed and acceleration only; expected no jerk, power, constant_speed"
        )
    if len(path) == 0:
        return Trajectory(path, np.zeros(1), np.zeros(1), np.zeros(1))
    travel = Travel(job, cover, robot, options)
    stops = np.flatnonzero(path.stroke >= 0)
    before = np.searchsorted(stops, np.arange(len(path)), side="right") - 1
    first = int(path.stroke[stops[0]])
    origin = np.where(before >= 0, path.stroke[stops[before]], first)
    moving = np.flatnonzero(path.length > 0)
    steps = ends(path).position - path.start
    limits = travel.limits(steps[moving], origin[moving])
    s, t, v = [0.0], [0.0], [0.0]
    number = {row: k for k, row in enumerate(moving.tolist())}
    for row, (length, until) in enumerate(zip(path.length.tolist(), path.offsets[1:].tolist(), strict=True)):
        if row not in number:
            s.append(s[-1])
            t.append(t[-1] + float(path.dwell[row]))
            v.append(0.0)
            continue
        most, rate = (float(limit[number[row]]) for limit in limits)
        peak = min(most, float(np.sqrt(rate * length)))
        ramp, level = peak**2 / (2 * rate), length - peak**2 / rate
        begin = s[-1]
        if level > 1e-9 * length:
            s += [begin + ramp, begin + ramp + level, until]
            t += [t[-1] + peak / rate, t[-1] + peak / rate + level / peak, t[-1] + 2 * peak / rate + level / peak]
            v += [peak, peak, 0.0]
        else:
            s += [begin + length / 2, until]
            t += [t[-1] + peak / rate, t[-1] + 2 * peak / rate]
            v += [peak, 0.0]
    return Trajectory(path, np.array(s), np.array(t), np.array(v))
