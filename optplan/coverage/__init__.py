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
    from optplan.domain.job import Drawing, Facade
    from optplan.domain.options import Options
    from optplan.domain.progress import silent

    if isinstance(job, Drawing):
        return cover_drawing(job, robot, options or Options(), progress or silent)
    if isinstance(job, Facade):
        from optplan.coverage.facade import cover_facade

        return cover_facade(job, robot, options or Options(), progress or silent)
    raise InputError(
        f"{job.name}: a {type(job).__name__.lower()} cannot be covered yet; expected a drawing or a facade"
    )
