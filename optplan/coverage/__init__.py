"""Job to strokes: what has to be driven so that the surface looks as asked."""

from __future__ import annotations

from typing import TYPE_CHECKING

from optplan.domain.errors import InputError

if TYPE_CHECKING:
    from optplan.domain.job import Job
    from optplan.domain.options import Options
    from optplan.domain.progress import ProgressCallback
    from optplan.domain.result import Cover
    from optplan.domain.robot import Robot
    from optplan.domain.stroke import Stroke


def cover(job: Job, robot: Robot, options: Options | None = None, progress: ProgressCallback | None = None) -> Cover:
    """Strokes for a job.

    Parameters
    ----------
    job, robot : what is to be done and by whom
    options : settings of the plan; their groups `page`, `cover`, `connect` and `wash` matter here

    Raises
    ------
    InputError : nothing to draw, a canvas without room, settings for an element that does not exist, or a kind of job
        that this robot or this version does not cover
    """
    from optplan.coverage.drawing import cover_drawing
    from optplan.coverage.field import cover_field
    from optplan.domain.job import Drawing, Facade, Field
    from optplan.domain.options import Options
    from optplan.domain.progress import silent
    from optplan.domain.robot import Boom

    options, progress = options or Options(), progress or silent
    if isinstance(robot.mobility, Boom) and isinstance(job, Drawing | Field):
        kind, usual = type(job).__name__.lower(), "line-marker" if isinstance(job, Field) else "beach-rake"
        raise InputError(
            f"a boom lift such as {robot.name} washes facades, this is a {kind}; expected {usual}", job.name
        )
    if isinstance(job, Drawing):
        return _kept(cover_drawing(job, robot, options, progress), robot, options)
    if isinstance(job, Field):
        return _kept(cover_field(job, robot, options, progress), robot, options)
    if isinstance(job, Facade):
        from optplan.coverage.facade import cover_facade

        return cover_facade(job, robot, options, progress)
    kind = type(job).__name__.lower()
    raise InputError(f"{job.name}: a {kind} cannot be covered yet; expected a drawing, a field or a facade")


def _kept(made: Cover, robot: Robot, options: Options) -> Cover:
    """With the order of the job, and its directions, where these are kept; what can only be driven the other way is."""
    from dataclasses import replace

    from optplan.coverage.beside import refusals

    keep = options.order.keep
    if keep == "nothing":
        return made
    strokes = made.strokes
    if keep == "all":
        strokes = tuple(
            replace(stroke, directed=_forwards(stroke) and not refusals(stroke, robot, options)[0], headings=1)
            for stroke in strokes
        )
    return replace(made, strokes=strokes, precedence=tuple((k, k + 1) for k in range(len(strokes) - 1)))


def _forwards(stroke: Stroke) -> bool:
    """Whether a stroke may be driven in the order of its points, as far as where it is entered goes."""
    return not stroke.is_stop and (stroke.closed or stroke.entry in (None, 0))
