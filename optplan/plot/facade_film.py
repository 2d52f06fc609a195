"""Films of facades: the walls unrolled, circles as they are washed, and the lift on its way."""

from __future__ import annotations

from dataclasses import replace

import numpy as np

from optplan.domain.arrays import FloatArray
from optplan.domain.drive import Motion
from optplan.domain.facade import Facade
from optplan.domain.path import RAISED, Trajectory
from optplan.domain.result import Plan
from optplan.domain.robot import Robot
from optplan.plot.facade import Shown, moves_of, shown
from optplan.plot.scene import Colours, Ground, ground_of
from optplan.plot.stage import Stage

WASHED = Colours(
    "#ffffff", "#f3ede2", "#9cc9e8", "#c0392b", "#1c2a39", "#f2c14e", "#2b2b2b", "#c0392b", "#2f7fb8"
)  # fmt: skip
LINE = 2
"""Pixels of the sheet."""


class FacadeStage(Stage):
    """Draws the outlines of walls and no-go areas, and the way so far, on top of what is washed."""

    def __init__(self, motion: Motion, robot: Robot, ground: Ground, title: str, rings: list[FloatArray]) -> None:
        self._rings = [[(float(x), float(y)) for x, y in ground.pixels(ring)] for ring in rings]
        super().__init__(motion, robot, ground, title, WASHED)

    def _mark(self, begin: int, end: int, width: float, colour: str) -> None:
        super()._mark(begin, end, width, colour)
        for ring in self._rings:
            self._pen.line([*ring, ring[0]], fill=self.colours.text, width=LINE)
        if colour != self.colours.hint and end > 0:
            way = [(float(x), float(y)) for x, y in self._track[: end + 1]]
            self._pen.line(way, fill=self.colours.travel, width=LINE)


def facade_stage(plan: Plan, job: Facade, times: FloatArray, longer: int, title: str) -> FacadeStage:
    """A stage with the planned motion at these times (n,) s; longer : pixels of the longer side."""
    seen = shown(plan, job)
    flat = seen.flat()
    rings = [
        ring + np.array([offset, 0.0])
        for wall, offset in zip(job.walls, seen.offset, strict=True)
        for ring in (wall.outline, *wall.no_go)
    ]
    reach = seen.radii[:, None]
    ground = ground_of(np.concatenate([flat - reach, flat + reach, *rings]), None, longer)
    tool = plan.robot.tool
    washing = replace(tool.settings[1], width=2 * float(seen.radii.max()))
    robot = replace(plan.robot, tool=replace(tool, settings=(tool.settings[0], washing, *tool.settings[2:])))
    assert plan.trajectory is not None
    return FacadeStage(motion_on_walls(plan, job, seen, times), robot, ground, title, rings)


def motion_on_walls(plan: Plan, job: Facade, seen: Shown, times: FloatArray) -> Motion:
    """Where the lift is in the picture of its unrolled walls, at these times (n,) s and at every knot."""
    trajectory = plan.trajectory
    assert trajectory is not None
    knots = trajectory.t - trajectory.t[0]
    time = np.unique(np.concatenate([times, knots]))
    s, v, standing = _along(trajectory, time)
    flat, path = seen.flat(), trajectory.path
    stops = np.flatnonzero(path.stroke >= 0)
    at = path.offsets[stops]
    number = np.clip(np.searchsorted(at, s + 1e-9, side="right") - 1, 0, len(stops) - 1)
    places = flat[path.stroke[stops[number]]]
    for k, (line, _) in enumerate(moves_of(plan, job, seen)):
        between = np.flatnonzero((number == k) & (s > at[k] + 1e-9))
        gone = np.concatenate([[0.0], np.cumsum(np.hypot(*np.diff(line, axis=0).T))])
        share = (s[between] - at[k]) / max(at[k + 1] - at[k], 1e-9) * gone[-1]
        places[between] = np.column_stack([np.interp(share, gone, line[:, axis]) for axis in (0, 1)])
    tool = np.where(standing, path.tool[stops[number]], RAISED)
    zero = np.zeros(len(time))
    x, y = places.T
    return Motion(time, x, y, zero, v, zero, tool.astype(np.int64), x, y)


def _along(trajectory: Trajectory, time: FloatArray) -> tuple[FloatArray, FloatArray, FloatArray]:
    """Arc length (n,) m, speed (n,) m/s and whether it stands to work (n,), at these times."""
    knots = trajectory.t - trajectory.t[0]
    k = np.clip(np.searchsorted(knots, time, side="right") - 1, 0, len(knots) - 2)
    span = np.maximum(knots[k + 1] - knots[k], 1e-12)
    rate = (trajectory.v[k + 1] - trajectory.v[k]) / span
    gone = np.clip(time - knots[k], 0, span)
    s = np.minimum(trajectory.s[k] + trajectory.v[k] * gone + rate * gone**2 / 2, trajectory.s[k + 1])
    return s, trajectory.v[k] + rate * gone, trajectory.s[k + 1] == trajectory.s[k]
