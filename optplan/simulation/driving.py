"""A robot with two driven wheels drives a trajectory."""

from __future__ import annotations

import math

import numpy as np

from optplan.domain.arrays import FloatArray, IntArray
from optplan.domain.drive import Drive
from optplan.domain.path import Trajectory
from optplan.domain.progress import Progress, ProgressCallback
from optplan.domain.robot import DiffDrive, Robot
from optplan.domain.stop import StopRule
from optplan.simulation._kernels import loop, record
from optplan.simulation._kernels import machine as m
from optplan.simulation._kernels.machine import STEP, Machine
from optplan.simulation._kernels.route import BODY, FIRST, GEAR, KNOT, KNOT_S, Route, X, Y
from optplan.simulation.figures import energy_used, figures_of
from optplan.simulation.options import DriveOptions
from optplan.simulation.schedule import route_of
from optplan.simulation.switching import switched

SLICE = 5000
"""Control steps between two looks at the stop rule: some 10 ms."""
SLIP_TIME = 0.5
"""Time over which a slip is remembered, s: a choice, about half a wheel's round."""
BLEND = 0.1
"""Share of a noisy measurement that is believed at once; the rest is reckoned from the wheels."""

_REASONS = {
    loop.RUNNING: "stopped on the way",
    loop.FINISHED: "came to rest at the end of the plan",
    loop.LOST: "lost the path",
    loop.LATE: "did not reach the end of a stretch in twice its time and 30 s more",
}


def drive_wheels(
    robot: Robot,
    mobility: DiffDrive,
    trajectory: Trajectory,
    options: DriveOptions,
    progress: ProgressCallback,
    stop: StopRule | None,
) -> Drive:
    """Simulate a drive; see `optplan.simulation.simulate`."""
    route = route_of(trajectory)
    machine = _machine(robot, mobility, options)
    state, whole = _beginning(route, options)
    numbers = [_first_row(machine, route, state)]
    tools = [route.tools[:1]]
    random = np.random.default_rng(options.seed)
    clock = None if stop is None else stop.start()
    duration = trajectory.duration
    reason = None
    while reason is None:
        if clock is not None and (why := clock.reason()) is not None:
            reason = f"{_REASONS[loop.RUNNING]}: {why.value}"
            break
        rows, settings = np.empty((SLICE, 14)), np.empty(SLICE, dtype=np.int64)
        count = loop.drive(route, machine, state, whole, _noise(random, options, machine), rows, settings)
        numbers.append(rows[:count])
        tools.append(settings[:count])
        progress(Progress("drive", min(float(state[m.TIME]) / max(duration, STEP), 1.0)))
        if whole[m.STATUS] != loop.RUNNING:
            reason = _REASONS[int(whole[m.STATUS])]
    if whole[m.STATUS] == loop.LOST:
        x, y, away = state[m.TRUE_X], state[m.TRUE_Y], machine.lost
        reason = f"lost the path: at ({x:.2f}, {y:.2f}) m it was more than {away:g} m beside it"
    finished = whole[m.STATUS] == loop.FINISHED
    return _drive(np.concatenate(numbers), np.concatenate(tools), finished, reason, options, robot, trajectory)


def _machine(robot: Robot, mobility: DiffDrive, options: DriveOptions) -> Machine:
    lag = options.time_constant(mobility.wheel_radius)
    noisy = options.noise > 0 or options.heading_noise > 0
    return Machine(
        track=mobility.track,
        radius=mobility.wheel_radius,
        wheel_speed=mobility.wheel_speed,
        wheel_acceleration=mobility.wheel_acceleration,
        share=1.0 if lag == 0 else -math.expm1(-STEP / lag),
        turn_rate=mobility.turn_rate,
        turn_acceleration=mobility.turn_acceleration,
        right=robot.offset.right,
        ahead=robot.offset.ahead,
        pursuit=options.tracker == "pure-pursuit",
        lookahead=options.lookahead or 0.0,
        reach=mobility.track / 2,
        # a slow wheel must not be steered faster than it answers
        reach_time=max(0.2, 4 * lag),
        lost=4 * mobility.track if options.lost is None else options.lost,
        blend=BLEND if noisy else 1.0,
        slipping=math.exp(-STEP / SLIP_TIME),
    )


def _beginning(route: Route, options: DriveOptions) -> tuple[FloatArray, IntArray]:
    """Numbers of the drive before its first step."""
    state, whole = np.zeros(16), np.zeros(4, dtype=np.int64)
    first = route.phases[0]
    pose = (*route.pieces[first[FIRST], [X, Y]], route.turns[0, BODY])
    if options.start is not None:
        x, y, heading = options.start
        # counted like the path's headings, not whole turns away
        pose = (x, y, pose[2] + math.remainder(heading - pose[2], 2 * math.pi))
    state[m.TRUE_X : m.TRUE_H + 1] = state[m.BELIEF_X : m.BELIEF_H + 1] = pose
    state[m.S] = route.knots[first[KNOT], KNOT_S]
    whole[m.ROW], whole[m.TIMED] = first[FIRST], first[KNOT]
    return state, whole


def _first_row(machine: Machine, route: Route, state: FloatArray) -> FloatArray:
    row = np.zeros((1, 14))
    x, y, heading = state[m.TRUE_X : m.TRUE_H + 1]
    row[0, [record.PX, record.PY, record.H]] = x, y, heading
    tool = _tool(machine, x, y, heading)
    row[0, [record.TX, record.TY]] = tool
    begin = route.pieces[route.phases[0, FIRST], [X, Y]]
    direction = route.turns[0, BODY]
    planned = _tool(machine, begin[0], begin[1], direction)
    # left of the direction of travel, which the front points against where the robot backs
    across = (tool[1] - planned[1]) * math.cos(direction) - (tool[0] - planned[0]) * math.sin(direction)
    row[0, record.CROSS] = route.turns[0, GEAR] * across
    return row


def _tool(machine: Machine, x: float, y: float, heading: float) -> tuple[float, float]:
    c, s = math.cos(heading), math.sin(heading)
    return x + machine.ahead * c + machine.right * s, y + machine.ahead * s - machine.right * c


def _noise(random: np.random.Generator, options: DriveOptions, machine: Machine) -> FloatArray:
    """(SLICE, 5) changes of the slips and errors of the measured pose."""
    fresh = math.sqrt(1 - machine.slipping**2)
    scale = [options.slip * fresh, options.slip * fresh, options.noise, options.noise, options.heading_noise]
    return random.standard_normal((SLICE, 5)) * scale


def _drive(
    numbers: FloatArray,
    tools: IntArray,
    finished: bool,
    reason: str,
    options: DriveOptions,
    robot: Robot,
    trajectory: Trajectory,
) -> Drive:
    wheels, accelerations = numbers[:, record.WL : record.WR + 1], numbers[:, record.AL : record.AR + 1]
    time, cross, lag = numbers[:, record.T], numbers[:, record.CROSS], numbers[:, record.LAG]
    energy = None
    if options.mass is not None and isinstance(robot.mobility, DiffDrive):
        energy = energy_used(wheels, STEP, robot.mobility.wheel_radius, options.mass, options.rolling)
    missed = None
    if robot.tool.on_delay > 0 or robot.tool.off_delay > 0:
        tools, missed = switched(time, lag, trajectory, robot.tool)
    return Drive(
        time=time,
        x=numbers[:, record.PX],
        y=numbers[:, record.PY],
        heading=numbers[:, record.H],
        speed=numbers[:, record.V],
        turn_rate=numbers[:, record.OMEGA],
        tool=tools,
        tool_x=numbers[:, record.TX],
        tool_y=numbers[:, record.TY],
        wheel_speed=wheels,
        wheel_acceleration=accelerations,
        cross_track=cross,
        lag=lag,
        finished=bool(finished),
        reason=reason,
        method=options.tracker,
        figures=figures_of(time, tools, wheels, accelerations, cross, lag, trajectory.duration, energy, missed),
    )
