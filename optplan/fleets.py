"""Several robots on one job: who does what, and when each sets off so that none comes too near another."""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass, replace
from pathlib import Path as FilePath

import numpy as np

from optplan.avoiding import twins
from optplan.connectors.families import family_of
from optplan.coverage import cover
from optplan.coverage.field import with_areas, with_metric
from optplan.domain.arrays import FloatArray
from optplan.domain.errors import InputError
from optplan.domain.job import Field, Job
from optplan.domain.options import Options
from optplan.domain.ordering import Ordering, Status
from optplan.domain.progress import Progress, ProgressCallback, silent
from optplan.domain.result import Cover, Plan
from optplan.domain.robot import DiffDrive, Robot
from optplan.domain.stop import StopReason, StopRule
from optplan.judge.fleet import nearest_approach
from optplan.ordering.makespan import shared
from optplan.pipeline import plan_from
from optplan.problem import ordering_problem, traversals
from optplan.robots import load_robot
from optplan.timing.motion import motion

MOST = 8
"""Robots of a fleet."""
STEP = 0.25
"""s between the moments at which distances are looked at when starting times are chosen."""
DELAYS = 240
"""Starting times tried for each robot, evenly over half of the longest plan."""
ROOM = 3.0
"""Distance that robots keep, middle to middle, in their tracks, unless another is asked for."""


@dataclass(frozen=True, eq=False)
class Fleet:
    """Plans of several robots.

    Parameters
    ----------
    plans : one a robot; each has the strokes that are its own
    starts : s after the first, when each sets off
    makespan : until the last has finished, s
    bound : no division of the strokes finishes earlier, starting times and distances apart; s
    apart : least distance between two robots at one time, middle to middle, m; infinite for one robot
    room : distance that was to be kept, m
    """

    plans: tuple[Plan, ...]
    starts: tuple[float, ...]
    makespan: float
    bound: float
    apart: float
    room: float

    @property
    def ok(self) -> bool:
        """Whether every plan is verified and no two robots come too near each other."""
        good = all(plan.report is not None and plan.report.ok for plan in self.plans)
        return good and self.apart >= self.room - 1e-6


def plan_fleet(
    job: Job,
    robot: str | FilePath | Robot = "line-marker",
    count: int = 2,
    options: Options | None = None,
    progress: ProgressCallback | None = None,
    stop: StopRule | None = None,
    room: float | None = None,
) -> Fleet:
    """Divide a job among equal robots so that the last finishes early.

    Parameters
    ----------
    job, robot, options, progress, stop : as `optplan.plan` takes them
    count : of the robots, 1..`MOST`
    room : least distance between two robots, middle to middle, m; None: three times the track

    Raises
    ------
    InputError : as `optplan.plan`; a number of robots or a room out of range; a start point, rules of order or enforced
        connections, which do not go together with several robots
    """
    if isinstance(count, bool) or not 1 <= count <= MOST:
        raise InputError(f"a fleet of {count} robots; expected 1..{MOST}")
    machine, tell, chosen = load_robot(robot), progress or silent, options or Options()
    if isinstance(job, Field):
        chosen = with_areas(job, machine, chosen)
    width = machine.mobility.track if isinstance(machine.mobility, DiffDrive) else 0.0
    kept_apart = ROOM * width if room is None else room
    if not (math.isfinite(kept_apart) and kept_apart >= 0):
        raise InputError(f"the room between robots is {room} m; expected a finite number, 0 or more")
    _refuse_one_start(chosen.order.start or getattr(job, "start", None), count, kept_apart)
    made = cover(job, machine, chosen, tell)
    _refuse_one_start(made.start, count, kept_apart)
    if isinstance(job, Field):
        chosen = with_metric(made, machine, chosen)
    if made.precedence or made.links:
        raise InputError("rules of order and enforced connections do not go together with several robots", job.name)
    ways = traversals(made.strokes, machine, chosen, made.links)
    problem = ordering_problem(ways, made, machine, chosen, tell)
    speed = 1.0 if family_of(machine, chosen).unit == "s" else chosen.time.speeds(machine.mobility)[1]
    order = chosen.order
    rule = stop or StopRule(seconds=order.seconds or math.inf, iterations=order.iterations)

    def told(share: float) -> None:
        tell(Progress("order", share, message=f"{count} robots"))

    # seconds of work in the unit of the costs: metres at transit speed, where these are metres
    shares = shared(problem, ways.duration * speed, twins(ways), count, rule, order.seed, told)
    plans = []
    for nodes in shares.paths:
        kept = sorted({int(ways.stroke[node]) for node in nodes})
        others = tuple(stroke for k, stroke in enumerate(made.strokes) if k not in kept)
        part = replace(made, strokes=tuple(made.strokes[k] for k in kept), elsewhere=others)
        visits = ways.take(nodes)
        own = replace(visits, stroke=np.array([kept.index(k) for k in visits.stroke.tolist()], dtype=np.int64))
        plans.append(plan_from(_ordered(job, machine, chosen, part, own, problem.cost_of(nodes)), "connect", tell))
    starts = _starts(plans, kept_apart)
    durations = [0.0 if plan.trajectory is None else plan.trajectory.duration for plan in plans]
    makespan = max((s + d for s, d in zip(starts, durations, strict=True)), default=0.0)
    return Fleet(
        tuple(plans),
        tuple(starts),
        makespan,
        min(shares.bound / speed, makespan),
        nearest_approach(plans, starts)[0],
        kept_apart,
    )


def _refuse_one_start(start: tuple[float, float] | None, count: int, room: float) -> None:
    """InputError where several robots would stand on one spot."""
    if start is not None and count > 1 and room > 0:
        raise InputError(
            f"{count} robots would all start at ({start[0]:g}, {start[1]:g}), {room:.3g} m are to lie between them; "
            "expected no start point: each begins where its part of the work does"
        )


def _ordered(job: Job, robot: Robot, options: Options, part: Cover, visits: object, cost: float) -> Plan:
    from optplan.domain.stroke import Traversals

    assert isinstance(visits, Traversals)
    unit = family_of(robot, options).unit
    ordering = Ordering(
        np.arange(len(visits)), cost, -math.inf, Status.FEASIBLE, StopReason.FINISHED, "fleet", unit=unit,
        message="one of several robots: the bound is the fleet's",
    )  # fmt: skip
    return Plan(job, robot, options, part, ordering, visits)


def _starts(plans: Sequence[Plan], room: float) -> list[float]:
    """When each sets off: one after the other as early as leaves room to those before it."""
    places: list[FloatArray] = [_places(plan) for plan in plans]
    longest = max((len(place) for place in places), default=0)
    shifts = np.unique(np.linspace(0, longest / 2, DELAYS).astype(np.int64)).tolist()
    starts: list[int] = []
    for k, place in enumerate(places):
        best, widest = 0, -1.0
        for shift in shifts if k else [0]:
            gap = min((_gap(place, shift, places[j], starts[j]) for j in range(k)), default=math.inf)
            if gap > widest:
                best, widest = shift, gap
            if gap >= room * 1.02:  # between the moments they may come a little nearer
                best = shift
                break
        starts.append(best)
    return [STEP * start for start in starts]


def _places(plan: Plan) -> FloatArray:
    if plan.trajectory is None or len(plan.trajectory.path) == 0:
        return np.zeros((0, 2))
    times = np.arange(0.0, plan.trajectory.duration + STEP, STEP)
    moved = motion(plan.trajectory, plan.robot, np.minimum(times, plan.trajectory.duration))
    return np.column_stack([moved.x, moved.y])


def _gap(one: FloatArray, first: int, other: FloatArray, second: int) -> float:
    """Least distance of two robots that set off at these moments; before and after, each stands at its end."""
    if len(one) == 0 or len(other) == 0:
        return math.inf
    moments = np.arange(max(first + len(one), second + len(other)))
    a = one[np.clip(moments - first, 0, len(one) - 1)]
    b = other[np.clip(moments - second, 0, len(other) - 1)]
    return float(np.hypot(*(a - b).T).min())
