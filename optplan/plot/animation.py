"""A film of the robot driving a plan."""

from __future__ import annotations

import json
import math
from collections.abc import Iterator
from pathlib import Path
from typing import TYPE_CHECKING

import numpy as np

from optplan.domain.arrays import FloatArray, IntArray
from optplan.domain.drive import Drive, Motion
from optplan.domain.errors import InputError, LimitError
from optplan.domain.facade import Facade
from optplan.domain.job import Field
from optplan.domain.progress import Progress, ProgressCallback, silent
from optplan.domain.result import Plan
from optplan.geometry.paths import sampled
from optplan.plot.films import gif_bytes, mp4_bytes, require_ffmpeg, write_folder
from optplan.plot.scene import GRASS, Ground, ground_of
from optplan.plot.stage import Stage

if TYPE_CHECKING:
    from PIL.Image import Image

FILMS = (".gif", ".mp4", ".json", "")
"""File endings of animations; without one it is a folder of PNG frames."""
USUAL_SECONDS = 12.0
"""Length of a film unless something else is asked for; a shorter plan is shown at its own speed."""
MOST_FRAMES = 5000
MOST_PIXELS = 4000
"""Limits of a film's frames, and of their longer side."""
FINEST = 1.5
"""Pixels between moments at which the tool's mark is drawn."""


def make_film(
    plan: Plan,
    target: Path,
    drive: Drive | None,
    seconds: float | None,
    speed_up: float | None,
    fps: float,
    size: float,
    dpi: float,
    overwrite: bool,
    progress: ProgressCallback | None,
) -> None:
    """Write a film; see `optplan.plot.animate`."""
    _check(target, fps, size, dpi, overwrite, seconds=seconds, speed_up=speed_up)
    duration = _duration(plan, drive)
    lasting = _lasting(duration, seconds, speed_up)
    count = round(lasting * fps) + 1
    if count > MOST_FRAMES:
        raise LimitError(f"{lasting:g} s at {fps:g} frames a second are {count} frames; at most {MOST_FRAMES} are made")
    shown = np.linspace(0.0, duration, count)
    factor = duration / lasting
    title = f"{plan.job.name} · {plan.robot.name}" + ("" if factor < 1.05 else f" · {factor:.3g}x")
    if isinstance(plan.job, Facade):
        from optplan.plot.facade_film import facade_stage

        if drive is not None:
            raise InputError("a simulated drive is not shown before a facade; expected the planned motion")
        stage: Stage = facade_stage(plan, plan.job, shown, round(size * dpi), title)
        motion: Motion = stage.motion
    else:
        ground = _ground(plan, drive, round(size * dpi))
        motion = drive if drive is not None else _planned(plan, shown, ground)
        stage = Stage(motion, plan.robot, ground, title, GRASS if isinstance(plan.job, Field) else None)
    moments = np.clip(np.searchsorted(motion.time, shown - 1e-9), 0, len(motion) - 1)
    if target.suffix.lower() == ".json":
        from optplan.schema.files import write_atomically

        write_atomically(target, _json(plan, motion, moments, fps, factor), overwrite=overwrite)
        return
    _write(stage, moments, target, fps, overwrite, progress or silent)


def _write(
    stage: Stage, moments: IntArray, target: Path, fps: float, overwrite: bool, progress: ProgressCallback
) -> None:
    from optplan.schema.files import write_atomically

    def frames() -> Iterator[Image]:
        for k, moment in enumerate(moments.tolist()):
            yield stage.frame(moment)
            progress(Progress("animate", (k + 1) / len(moments)))

    suffix = target.suffix.lower()
    if suffix == ".gif":
        write_atomically(target, gif_bytes(frames(), fps, stage.palette()), overwrite=overwrite)
    elif suffix == ".mp4":
        write_atomically(target, mp4_bytes(frames(), fps, stage.size, target), overwrite=overwrite)
    else:
        write_folder(frames(), target, overwrite)


def _check(target: Path, fps: float, size: float, dpi: float, overwrite: bool, **times: float | None) -> None:
    """Find out what is wrong before the work, not after it."""
    suffix = target.suffix.lower()
    if suffix not in FILMS:
        known = ", ".join(FILMS[:-1])
        raise InputError(f"has the ending {target.suffix!r}; expected {known}, or none for a folder", str(target))
    for name, value in {"fps": fps, "size": size, "dpi": dpi, **times}.items():
        if value is not None and not (math.isfinite(value) and value > 0):
            raise InputError(f"the film's {name.replace('_', '-')} is {value}; expected a finite number above 0")
    if times["seconds"] is not None and times["speed_up"] is not None:
        raise InputError("a film has both a duration and a speed-up; expected one of them")
    if fps > 50 and suffix == ".gif":
        raise InputError(f"the film's fps is {fps:g}; viewers show at most 50 frames a second of a GIF")
    if size * dpi > MOST_PIXELS:
        raise LimitError(f"{size:g} inches at {dpi:g} dpi are too large; at most {MOST_PIXELS} pixels")
    if suffix == ".mp4":
        require_ffmpeg(target)
    if target.exists() and not overwrite and not (suffix == "" and target.is_dir() and not any(target.iterdir())):
        raise InputError("exists already; say --force to replace it, or choose another place", str(target))
    if target.exists() and target.is_dir() != (suffix == ""):
        raise InputError("is no folder" if suffix == "" else "is a folder", str(target))


def _duration(plan: Plan, drive: Drive | None) -> float:
    if drive is not None:
        return float(drive.time[-1])
    if plan.trajectory is None or len(plan.trajectory.path) == 0:
        raise InputError("the plan has no speeds to show; run the stage time first")
    return plan.trajectory.duration


def _lasting(duration: float, seconds: float | None, speed_up: float | None) -> float:
    if seconds is not None:
        return seconds
    if speed_up is not None:
        return max(duration / speed_up, 1e-3)
    return min(max(duration, 1.0), USUAL_SECONDS)


def _ground(plan: Plan, drive: Drive | None, longer: int) -> Ground:
    canvas = None if plan.cover is None else plan.cover.canvas
    places = []
    if plan.path is not None and len(plan.path):
        spacing = max(float(plan.path.length.sum()) / 2000, 1e-6)
        places.append(sampled(plan.path, spacing).position[:, :2])
    if plan.cover is not None:
        places += [stroke.points[:, :2] for stroke in plan.cover.strokes]
    if drive is not None:
        places.append(np.column_stack([drive.tool_x, drive.tool_y]))
    room = None if canvas is None else (canvas.width, canvas.height)
    return ground_of(np.concatenate(places), room, longer)


def _planned(plan: Plan, shown: FloatArray, ground: Ground) -> Motion:
    """The planned motion, at the frames' moments and often enough between them to draw its marks."""
    from optplan.timing.motion import motion

    trajectory = plan.trajectory
    assert trajectory is not None  # `_duration` has made sure
    between = float(trajectory.v.max()) * float(shown[-1]) / max(len(shown) - 1, 1) * ground.scale / 2 / FINEST
    parts = min(max(1, math.ceil(between)), 200)
    fine = np.interp(np.arange((len(shown) - 1) * parts + 1) / parts, np.arange(len(shown)), shown)
    knots = trajectory.t - trajectory.t[0]
    return motion(trajectory, plan.robot, np.unique(np.concatenate([fine, shown, knots])))


def _json(plan: Plan, motion: Motion, moments: IntArray, fps: float, factor: float) -> str:
    """Frames as numbers, for editors that draw themselves."""
    frames = [
        {
            "t": round(float(motion.time[k]), 3),
            "x": round(float(motion.x[k]), 5),
            "y": round(float(motion.y[k]), 5),
            "heading": round(float(motion.heading[k]), 5),
            "speed": round(float(motion.speed[k]), 4),
            "tool": int(motion.tool[k]),
            "tool_x": round(float(motion.tool_x[k]), 5),
            "tool_y": round(float(motion.tool_y[k]), 5),
        }
        for k in moments.tolist()
    ]
    settings = [{"name": choice.name, "width": choice.width} for choice in plan.robot.tool.settings]
    head = {"version": "1.0", "job": plan.job.name, "robot": plan.robot.name, "fps": fps, "speed_up": factor}
    return json.dumps({**head, "settings": settings, "frames": frames}, allow_nan=False)
