"""Small plans written by hand, and ways to spoil them."""

from __future__ import annotations

import math
from dataclasses import dataclass, field, replace
from typing import Any

import numpy as np

from optplan.domain.arrays import FloatArray
from optplan.domain.job import Drawing
from optplan.domain.options import Options, PageOptions
from optplan.domain.ordering import Ordering, Status
from optplan.domain.path import Path, Trajectory
from optplan.domain.report import Report, Verdict
from optplan.domain.result import Cover, Plan
from optplan.domain.robot import Canvas, DiffDrive, Gantry, Mobility, Robot, Tool, ToolSetting
from optplan.domain.stop import StopReason
from optplan.domain.stroke import Stroke, Traversals

TOOL = Tool((ToolSetting("raised", 0.0), ToolSetting("narrow", 0.1), ToolSetting("wide", 0.3)))
WHEELS = DiffDrive(0.5, 0.1, 20.0, 40.0, 0.4, 0.6, turns_on_spot=True, turn_rate=1.0, radius=0.5)
RAKE = Robot("rake", "turns on the spot", TOOL, WHEELS)
CAR = Robot("car", "does not", TOOL, replace(WHEELS, turns_on_spot=False))
PLOTTER = Robot("plotter", "has no heading", TOOL, Gantry(0.4, 0.6, 1.0))
OPTIONS = Options(page=PageOptions(tolerance=0.005))


@dataclass
class Pen:
    """Writes a path piece by piece, from where it stands."""

    at: FloatArray
    heading: float = 0.0
    rows: list[tuple[Any, ...]] = field(default_factory=list)

    def curve(self, length: float, kappa: float = 0.0, tool: int = 0, stroke: int = -1) -> None:
        """A line or an arc."""
        self.rows.append((*self.at, self.heading, kappa, length, 0.0, 0.0, tool, stroke))
        half = kappa * length / 2
        chord = length * (math.sin(half) / half if half else 1.0)
        middle = self.heading + half
        self.at = self.at + chord * np.array([math.cos(middle), math.sin(middle)])
        self.heading += kappa * length

    def turn(self, angle: float, dwell: float = 0.0, tool: int = 0, stroke: int = -1) -> None:
        """A stop."""
        self.rows.append((*self.at, self.heading, 0.0, 0.0, angle, dwell, tool, stroke))
        self.heading += angle

    def face(self, point: Any, stroke: int = -1) -> None:
        """Turn on the spot towards a point."""
        dx, dy = np.asarray(point) - self.at
        angle = math.remainder(math.atan2(dy, dx) - self.heading, math.tau)
        if abs(angle) > 1e-9:
            self.turn(angle, stroke=stroke)

    def go(self, point: Any, tool: int = 0, stroke: int = -1) -> None:
        """Turn to a point and drive there in a straight line."""
        self.face(point, stroke)
        self.curve(float(np.linalg.norm(np.asarray(point) - self.at)), tool=tool, stroke=stroke)
        self.at = np.asarray(point, dtype=float)

    def draw(self, stroke: Stroke, index: int, reverse: bool = False, entry: int = 0) -> None:
        """Go to a stroke and drive it."""
        points = np.roll(stroke.points, -entry, axis=0) if stroke.closed else stroke.points
        points = np.concatenate([points, points[:1]]) if stroke.closed else points
        points = points[::-1] if reverse else points
        if np.linalg.norm(points[0] - self.at) > 1e-12:
            self.go(points[0])
        self.face(points[1])
        for point in points[1:]:
            self.go(point, stroke.tool, index)

    @property
    def path(self) -> Path:
        """What was written."""
        table = np.array(self.rows, dtype=float).reshape(-1, 9)
        x, y, heading, kappa, length, turn, dwell, tool, stroke = table.T
        zero = np.zeros(len(table))
        start = np.stack([x, y, zero], axis=1)
        return Path(
            start, heading, zero, kappa, zero, length, turn, dwell, tool.astype(int), stroke.astype(int)
        )  # fmt: skip


def turn_time(angle: float, mobility: Mobility) -> float:
    """Seconds for a turn from rest to rest: a triangle or a trapezoid of angular speed."""
    if angle == 0 or math.isinf(mobility.turn_rate):
        return 0.0
    ramp = mobility.turn_rate / mobility.turn_acceleration
    if angle < mobility.turn_rate * ramp:
        return 2 * math.sqrt(angle / mobility.turn_acceleration)
    return angle / mobility.turn_rate + ramp


def profile(path: Path, robot: Robot, factor: float = 1.0, push: float = 1.0) -> Trajectory:
    """Trapezoids from rest to rest on every piece; `factor` and `push` raise speed and acceleration."""
    s, t, v = [0.0], [0.0], [0.0]
    mobility = robot.mobility
    for row, length in enumerate(path.length.tolist()):
        if length == 0:
            s.append(s[-1])
            t.append(t[-1] + turn_time(abs(float(path.turn[row])), mobility) + float(path.dwell[row]))
            v.append(0.0)
            continue
        top = factor * (mobility.work_speed if path.tool[row] else mobility.transit_speed)
        half = mobility.track / 2 if isinstance(mobility, DiffDrive) else 0.0
        rate = push * mobility.acceleration / (1 + half * abs(float(path.curvature[row])))
        top = min(top, math.sqrt(rate * length))
        ramp, begin, now = top**2 / (2 * rate), s[-1], t[-1]
        cruise = (length - 2 * ramp) / top
        s += [begin + ramp, begin + length - ramp, begin + length]
        t += [now + top / rate, now + top / rate + cruise, now + 2 * top / rate + cruise]
        v += [top, top, 0.0]
    return Trajectory(path, np.maximum.accumulate(s), np.maximum.accumulate(t), np.array(v))


def square(name: str, x: float, y: float, **more: Any) -> Stroke:
    """A closed square of 1 m with its first corner at (x, y)."""
    corners = np.array([[x, y], [x + 1, y], [x + 1, y + 1], [x, y + 1]])
    return Stroke(name, corners, closed=True, **more)


def plan_of(robot: Robot, path: Path, cover: Cover, **more: Any) -> Plan:
    """A plan with speeds and an order proved to be the best."""
    cost = float(path.length[path.stroke < 0].sum())
    ordering = Ordering(np.arange(len(cover.strokes)), cost, cost, Status.OPTIMAL, StopReason.FINISHED, "hand")
    sections: dict[str, Any] = {"trajectory": profile(path, robot), "ordering": ordering} | more
    return Plan(Drawing("by hand", ()), robot, OPTIONS, cover=cover, path=path, **sections)


def visits_of(path: Path) -> Traversals:
    """The ways that a path drives, for squares entered at their first corner."""
    rows = [int(np.flatnonzero((path.stroke == k) & (path.length > 0))[0]) for k in range(int(path.stroke.max()) + 1)]
    ends = np.zeros((len(rows), 5))
    ends[:, :3] = path.start[rows]
    count = len(rows)
    flags = np.zeros(count, dtype=bool)
    return Traversals(np.arange(count), np.zeros(count, int), flags, ends, ends, np.full(count, 4.0), np.ones(count))


def two_squares(robot: Robot = RAKE) -> Plan:
    """Two squares, turned at on the spot, on a canvas with a margin."""
    cover = Cover(
        (square("left", 1, 1), square("right", 3, 1)), precedence=((0, 1),), canvas=Canvas(5.0, 3.0, 0.5)
    )  # fmt: skip
    pen = Pen(np.array([1.0, 1.0]))
    for index, stroke in enumerate(cover.strokes):
        pen.draw(stroke, index)
    return plan_of(robot, pen.path, cover, visits=visits_of(pen.path))


def road(robot: Robot = CAR) -> Plan:
    """Two parallel lines joined by a half circle: what a car can drive."""
    cover = Cover((Stroke("out", np.array([[0.0, 0], [3, 0]])), Stroke("back", np.array([[0.0, 2], [3, 2]]))))
    pen = Pen(np.zeros(2))
    pen.curve(3.0, tool=1, stroke=0)
    pen.curve(math.pi, 1.0)
    pen.curve(3.0, tool=1, stroke=1)
    return plan_of(robot, pen.path, cover)


def spoiled(plan: Plan, timed: bool = True, **columns: Any) -> Plan:
    """The plan with other columns of its path, driven at speeds that suit them."""
    assert plan.path is not None
    path = replace(plan.path, **columns)
    return replace(plan, path=path, trajectory=profile(path, plan.robot) if timed else None)


def changed(values: Any, at: Any, value: Any) -> Any:
    """A copy with another value somewhere."""
    copy = np.array(values)
    copy[at] = value
    return copy


def failures(report: Report) -> set[str]:
    """Names of the checks that failed."""
    return {check.name for check in report.checks if check.verdict is Verdict.FAILED}
