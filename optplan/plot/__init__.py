"""Pictures and films of plans, and pictures of how solvers got there."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from pathlib import Path
from typing import TYPE_CHECKING

from optplan.domain.errors import InputError

if TYPE_CHECKING:
    from matplotlib.figure import Figure

    from optplan.domain.drive import Drive
    from optplan.domain.ordering import Ordering
    from optplan.domain.progress import ProgressCallback
    from optplan.domain.result import Plan

PICTURES = (".png", ".svg", ".pdf")
"""File endings of pictures."""


def draw(plan: Plan, file: str | Path, *, overwrite: bool = False, dpi: int = 150, in_space: bool = False) -> None:
    """Write a picture of a plan: work in true widths, travel, directions, start and end.

    Parameters
    ----------
    plan : complete, or of an earlier stage: what there is, is drawn
    file : its ending chooses PNG, SVG or PDF
    overwrite : whether an existing file may be replaced
    dpi : pixels per inch of a PNG
    in_space : a facade's building in three dimensions, instead of its walls unrolled

    Raises
    ------
    InputError : an unknown ending, nothing to draw yet, a file that exists or cannot be written, or `in_space` for
        something else than a facade
    """
    from optplan.domain.facade import Facade
    from optplan.plot.picture import figure

    job = plan.job
    if isinstance(job, Facade):
        from optplan.plot.building import building_figure
        from optplan.plot.facade import facade_figure

        made = building_figure if in_space else facade_figure
        _save(lambda: made(plan, job), Path(file), overwrite, dpi)
        return
    if in_space:
        raise InputError("a picture in space is made of facades only")
    _save(lambda: figure(plan), Path(file), overwrite, dpi)


def draw_convergence(
    runs: Ordering | Sequence[Ordering],
    file: str | Path,
    *,
    title: str = "",
    overwrite: bool = False,
    dpi: int = 150,
) -> None:
    """Write a picture of what solvers found and proved over time: incumbents solid, lower bounds dashed.

    Parameters
    ----------
    runs : one answer, or several to the same problem
    file, overwrite, dpi : as `draw` takes them
    title : of the picture

    Raises
    ------
    InputError : as `draw`, or answers without a trace
    """
    from optplan.domain.ordering import Ordering
    from optplan.plot.convergence import convergence_figure

    several = [runs] if isinstance(runs, Ordering) else list(runs)
    _save(lambda: convergence_figure(several, title), Path(file), overwrite, dpi)


def animate(
    plan: Plan,
    file: str | Path,
    *,
    drive: Drive | None = None,
    seconds: float | None = None,
    speed_up: float | None = None,
    fps: float = 15.0,
    size: float = 8.0,
    dpi: float = 80.0,
    overwrite: bool = False,
    progress: ProgressCallback | None = None,
) -> None:
    """Write a film of the robot driving a plan: marks that grow in their true widths, travel, time and speed.

    Parameters
    ----------
    plan : with a trajectory
    file : .gif; .mp4 where ffmpeg is installed; .json for editors: a pose a frame; no ending: a folder of PNG frames
    drive : what a simulated robot did (`optplan.simulate`); None shows the planned motion
    seconds, speed_up : how long the film is, or how much faster than the robot; with neither 12 s at most
    fps : frames a second
    size, dpi : longer side of the ground, inches, and pixels per inch
    overwrite : whether existing files may be replaced
    progress : called with the share of frames that are drawn

    A robot that would be smaller than 20 pixels is drawn that large.

    Raises
    ------
    InputError : a plan without speeds, an unknown ending, no ffmpeg, a file that exists, a number out of its range
    LimitError : too many frames, or too large ones
    """
    from optplan.plot.animation import make_film

    make_film(plan, Path(file), drive, seconds, speed_up, fps, size, dpi, overwrite, progress)


def _save(make: Callable[[], Figure], target: Path, overwrite: bool, dpi: int) -> None:
    import io

    from optplan.schema.files import write_atomically

    if target.suffix.lower() not in PICTURES:
        raise InputError(f"has the ending {target.suffix!r}; expected one of {', '.join(PICTURES)}", str(target))
    image = io.BytesIO()
    make().savefig(image, format=target.suffix.lower()[1:], dpi=dpi)
    write_atomically(target, image.getvalue(), overwrite=overwrite)
