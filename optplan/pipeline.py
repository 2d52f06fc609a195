"""From a job to a verified plan."""

from __future__ import annotations

import math
from collections.abc import Callable
from dataclasses import replace
from pathlib import Path

from optplan.avoiding import avoid_finished
from optplan.connectors.boom import profile_stops
from optplan.connectors.driving import connect
from optplan.connectors.families import family_of
from optplan.connectors.stops import connect_stops
from optplan.coverage import cover
from optplan.coverage.field import with_areas, with_metric
from optplan.detours import with_detours
from optplan.domain.errors import InputError
from optplan.domain.facade import Facade
from optplan.domain.job import Field, Job
from optplan.domain.options import Options
from optplan.domain.progress import Progress, ProgressCallback, silent
from optplan.domain.result import Plan
from optplan.domain.robot import Robot
from optplan.domain.stop import StopRule
from optplan.judge import verify
from optplan.ordering import solve
from optplan.problem import problem_of
from optplan.refilling import check_refills, with_refills, without_refills
from optplan.robots import USUAL_ROBOTS, load_robot
from optplan.timing.fastest import profile

STAGES = ("cover", "order", "connect", "time", "verify")
"""What a plan goes through, in order."""


def plan(
    job: Job,
    robot: str | Path | Robot | None = None,
    options: Options | None = None,
    progress: ProgressCallback | None = None,
    stop: StopRule | None = None,
) -> Plan:
    """Plan a job from beginning to end.

    Parameters
    ----------
    job : what is to be done, from `optplan.read`
    robot : name of a preset, path of a robot file, or a robot; None: the preset that suits the job
    options : settings of every stage
    progress : called with what each stage has reached
    stop : when ordering stops; default: what the options say

    Returns
    -------
    a plan with all its sections; a plan whose ordering found nothing ends there

    Raises
    ------
    InputError : the job, the robot or the options are wrong
    SolverError : the solver that was asked for does not take this problem
    """
    if not isinstance(job, Job):
        raise InputError(f"the job is {job!r:.60}; expected what optplan.read returns")
    machine = load_robot(USUAL_ROBOTS[type(job).__name__] if robot is None else robot)
    return plan_from(Plan(job, machine, options or Options()), "cover", progress, stop)


def plan_from(
    earlier: Plan, stage: str, progress: ProgressCallback | None = None, stop: StopRule | None = None
) -> Plan:
    """Plan again from a stage on, keeping what comes before it.

    Parameters
    ----------
    earlier : a plan that has the sections before `stage`; its options may have been replaced
    stage : one of `STAGES`

    Raises
    ------
    InputError : an unknown stage, or a section before it is missing
    SolverError : the solver that was asked for does not take this problem
    """
    if stage not in STAGES:
        raise InputError(f"there is no stage {stage!r}; expected one of {', '.join(STAGES)}")
    tell = progress or silent
    done = earlier
    for name in STAGES[STAGES.index(stage) :]:
        tell(Progress(name, 0.0))
        done = _STEPS[name](done, tell, stop)
        tell(Progress(name, 1.0))
        if done.ordering is not None and done.visits is None:
            break  # no plan found: a result, not an error
    return done


def run_stage(
    earlier: Plan, stage: str, progress: ProgressCallback | None = None, stop: StopRule | None = None
) -> Plan:
    """One stage alone; what depended on its earlier result is left out. Raises like `plan_from`."""
    if stage not in STAGES:
        raise InputError(f"there is no stage {stage!r}; expected one of {', '.join(STAGES)}")
    return _STEPS[stage](earlier, progress or silent, stop)


def _cover(before: Plan, progress: ProgressCallback, _: StopRule | None) -> Plan:
    options = before.options
    if isinstance(before.job, Field):
        options = with_areas(before.job, before.robot, options)
    made = cover(before.job, before.robot, options, progress)
    if isinstance(before.job, Field):
        options = with_metric(made, before.robot, options)
    return Plan(before.job, before.robot, options, made)


def _order(before: Plan, progress: ProgressCallback, stop: StopRule | None) -> Plan:
    if before.cover is None:
        raise InputError("the plan has no strokes yet; run the stage cover first")
    before = replace(before, cover=without_refills(before.cover))
    assert before.cover is not None
    job, robot, options = before.job, before.robot, before.options
    if not isinstance(job, Facade):
        check_refills(before.cover, options)
    ways, problem = problem_of(job, before.cover, robot, options, progress)
    order = options.order
    rule = stop or StopRule(seconds=order.seconds or math.inf, iterations=order.iterations)
    # what is to be avoided takes the other half of the time
    first = replace(rule, seconds=rule.seconds / 2) if order.avoid > 0 else rule
    clock = rule.start()
    ordering = solve(problem, order.solver, first, order.seed, progress=progress)
    if not isinstance(job, Facade):
        ordering, problem = with_detours(ordering, problem, ways, before.cover, robot, options, clock, progress)
    if order.avoid > 0 and problem.clusters > 1 and math.isfinite(ordering.cost):
        ordering = avoid_finished(ordering, problem, ways, before.cover, robot, options, clock, progress)
    strokes = before.cover
    if isinstance(job, Facade):
        ordering = replace(ordering, unit="s" if order.metric == "time" else "m")
    else:
        ordering = replace(ordering, unit=family_of(robot, options).unit)
        ordering, ways, strokes = with_refills(ordering, problem, ways, strokes, robot, options)
    visits = ways.take(ordering.nodes) if math.isfinite(ordering.cost) else None
    return Plan(job, robot, options, strokes, ordering, visits)


def _connect(before: Plan, *_: object) -> Plan:
    if before.cover is None or before.visits is None:
        raise InputError("the plan has no order yet; run the stage order first")
    if isinstance(before.job, Facade):
        path = connect_stops(before.visits, before.job, before.cover, before.robot, before.options)
    else:
        path = connect(before.visits, before.cover, before.robot, before.options)
    return replace(before, path=path, trajectory=None, report=None)


def _time(before: Plan, *_: object) -> Plan:
    if before.path is None:
        raise InputError("the plan has no path yet; run the stage connect first")
    if isinstance(before.job, Facade) and before.cover is not None:
        timed = profile_stops(before.path, before.job, before.cover, before.robot, before.options)
        return replace(before, trajectory=timed, report=None)
    return replace(before, trajectory=profile(before.path, before.robot, before.options), report=None)


def _verify(before: Plan, *_: object) -> Plan:
    return replace(before, report=verify(before))


_STEPS: dict[str, Callable[[Plan, ProgressCallback, StopRule | None], Plan]] = {
    "cover": _cover,
    "order": _order,
    "connect": _connect,
    "time": _time,
    "verify": _verify,
}
