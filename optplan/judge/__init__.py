"""The independent judge: measures what a plan does, with none of the code that made it."""

from __future__ import annotations

import math

import numpy as np

from optplan.domain.errors import InputError
from optplan.domain.facade import Facade
from optplan.domain.job import Field
from optplan.domain.path import RAISED, Path
from optplan.domain.report import Check, Report
from optplan.domain.result import Plan
from optplan.judge import (
    _areas,
    _continuity,
    _coverage,
    _facade,
    _field,
    _finished,
    _gears,
    _motion,
    _ordering,
    _padding,
    _strokes,
    _supplies,
    _tool,
    _wheels,
)
from optplan.judge._findings import deviation_limit, page_tolerance, unchecked
from optplan.judge._integrate import integrate
from optplan.judge._speeds import speeds

__all__ = ["verify"]

_COVER_CHECKS = ("strokes", "deviation", "precedence", "connections")


def verify(plan: Plan) -> Report:
    """Measure a plan and hold it against its robot's limits.

    The path is that of the robot's reference point; marks are where it carries its tool. Sections that a plan does not
    have yet are not judged; the checks that need them are in the report all the same, with a note.

    Raises
    ------
    InputError : the plan has no path (a `LimitError` when the path curls beyond all measure)
    """
    if plan.path is None:
        raise InputError("the plan has no path yet; run connect first")
    if isinstance(plan.job, Facade):
        return _facade.verify_facade(plan, plan.job)
    path, robot, options, cover = plan.path, plan.robot, plan.options, plan.cover
    limit = deviation_limit(robot, options)
    samples = integrate(path, limit / 100)
    carried, marks = _tool.of_tool(path, samples, robot)
    profile = None if plan.trajectory is None else speeds(path, plan.trajectory)

    steps, orders = _continuity.curvature_steps(path, samples, profile)
    checks: list[Check] = [
        _continuity.gaps(path, samples),
        _continuity.headings(path, samples, robot, profile),
        _continuity.curvature(path, robot, options, profile),
        _continuity.sharpness(path, robot, options, profile),
        steps,
        _gears.backwards(path, robot),
        _gears.changes(path, profile),
    ]
    figures = [*_lengths(path), *_gears.figures(path), *orders]
    areas: list[tuple[str, float, str]] = []
    exact = np.zeros(0, dtype=bool)
    if cover is None:
        checks += unchecked(_COVER_CHECKS, "the plan has no strokes")
    else:
        done, deviation, exact, aside = _strokes.strokes(carried, marks, cover, limit)
        figures += aside
        links = _strokes.connections(carried, marks, cover, limit)
        checks += [done, deviation, _strokes.precedence(path, cover), links]
    if plan.visits is None:
        checks += unchecked(["visits"], "the plan does not say which ways of driving were chosen")
    else:
        checks.append(_strokes.visits(path, samples, plan.visits))
    padding, padded = _padding.padding(path, samples, cover, options.connect)
    checks += [_strokes.tool(path, robot), *_tool.swirls(path, robot), padding]
    figures += padded
    if cover is None:
        names = ["canvas", "margin", _areas.NAME, *_coverage.NAMES, _finished.NAME, _wheels.NAME]
        checks += unchecked(names, "the plan has no strokes")
    else:
        checks += [
            *_strokes.canvas(path, samples, marks, cover, page_tolerance(robot, options)),
            _areas.areas(path, samples, cover, options, plan.job, robot),
        ]
        widths = None
        if isinstance(plan.job, Field):
            widths = _field.requested_widths(plan.job, cover, robot)
            checks.append(_field.field(plan.job, carried, marks, cover, robot, limit))
        covered, areas = _coverage.coverage(carried, marks, cover, robot, limit, exact, widths)
        wheels = _wheels.wheels_over_finished(path, samples, cover, robot, options, plan.trajectory)
        checks += [*covered, _finished.over_finished(path, samples, cover, robot), wheels]
    if plan.trajectory is None or profile is None:
        checks += unchecked([*_motion.NAMES, _supplies.NAME], "the plan has no speeds")
    else:
        checks += _motion.motion(path, plan.trajectory, profile, robot, options)
        taken = _motion.durations(path, plan.trajectory, profile)
        figures += taken
        area = {name: value for name, value, _ in areas}
        marked = area.get("done area", 0.0) + area.get("overlap area", 0.0)
        times = {name: value for name, value, _ in taken}
        used, amounts = _supplies.supplies(robot, marked, times["work time"], times["duration"])
        checks.append(used)
        figures += amounts
    figures += areas
    if plan.ordering is None:
        checks += unchecked(["bound", "cost"], "the plan does not say how it was ordered")
    else:
        checks += [_ordering.bound(plan.ordering), _ordering.cost(plan.ordering, path, plan.trajectory, robot, options)]
        claims = [("bound", plan.ordering.bound, plan.ordering.unit), ("gap", plan.ordering.gap, "")]
        figures += [claim for claim in claims if math.isfinite(claim[1])]
    return Report(tuple(checks), tuple(figures))


def _lengths(path: Path) -> list[tuple[str, float, str]]:
    """What is driven, in metres and pieces."""
    down, between = path.tool > RAISED, path.stroke < 0
    turning = path.is_stop & (path.turn != 0)
    return [
        ("strokes", float(len(_strokes.runs(path))), ""),
        ("pieces", float(len(path)), ""),
        ("tool-down", float(path.length[down].sum()), "m"),
        ("tool-up", float(path.length[~down & between].sum()), "m"),
        ("travel strokes", float(path.length[~down & ~between].sum()), "m"),
        ("turns", float(turning.sum()), ""),
        ("turned", float(np.abs(path.turn).sum()), "rad"),
    ]
