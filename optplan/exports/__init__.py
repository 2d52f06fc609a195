"""Plans as files that other systems read."""

from __future__ import annotations

import math
from collections.abc import Callable
from dataclasses import dataclass
from importlib.util import find_spec
from pathlib import Path
from typing import TYPE_CHECKING

from optplan.domain.errors import InputError
from optplan.domain.units import check_unit

if TYPE_CHECKING:
    from optplan.domain.job import Job
    from optplan.domain.result import Plan


@dataclass(frozen=True)
class Format:
    """A file format.

    Parameters
    ----------
    name, summary : for people
    suffix : of its files
    write : plan, point spacing (m) and unit of lengths -> text
    jobs : kinds of job that it is for; None: all
    """

    name: str
    summary: str
    suffix: str
    write: Callable[[Plan, float, str], str | bytes]
    jobs: tuple[str, ...] | None = None


def _csv(plan: Plan, spacing: float, _: str) -> str:
    from optplan.exports.points import csv_text

    return csv_text(plan, spacing)


def _txt(plan: Plan, spacing: float, _: str) -> str:
    from optplan.exports.points import points_text

    return points_text(plan, spacing)


def _tool(plan: Plan, _: float, __: str) -> str:
    from optplan.exports.tool import tool_text

    return tool_text(plan)


def _tsplib(plan: Plan, _: float, __: str) -> str:
    from optplan.exports.tsplib import tsplib_text

    return tsplib_text(plan)


def _messages(style: str) -> Callable[[Plan, float, str], str]:
    def write(plan: Plan, _: float, __: str) -> str:
        from optplan.exports.messages import message_text

        return message_text(plan, style)

    return write


def _geojson(plan: Plan, _: float, __: str) -> str:
    from optplan.exports.geojson import geojson_text

    return geojson_text(plan)


def _schedule(plan: Plan, _: float, unit: str) -> str:
    from optplan.exports.schedule import schedule_text

    return schedule_text(plan, unit)


def _pdf(plan: Plan, _: float, unit: str) -> bytes:
    from io import BytesIO

    from optplan.plot.sheet import sheet

    page = BytesIO()
    sheet(plan, unit).savefig(page, format="pdf", metadata={"CreationDate": None})
    return page.getvalue()


def _stops(plan: Plan, _: float, __: str) -> str:
    from optplan.exports.stops import stops_text

    return stops_text(plan)


def _stops_json(plan: Plan, _: float, __: str) -> str:
    from optplan.exports.stops import stops_json

    return stops_json(plan)


_PLANE, _WALLS = ("drawing", "field"), ("facade",)
FORMATS = {
    form.name: form
    for form in (
        Format("csv", "equally spaced points with time, speed, heading, curvature and tool state", ".csv", _csv),
        Format("txt", "lines 'x y tool', y down, a blank line at every turn on the spot", ".txt", _txt),
        Format("tool", "commands to the tool, ahead of each change by its delay", ".tool.csv", _tool),
        Format("schedule", "time table: what is marked when, and what lies between", ".schedule.csv", _schedule),
        Format(
            "messages",
            "trajectory message of marking robots (JSON): lines and arcs",
            ".messages.json",
            _messages("arcs"),
            _PLANE,
        ),
        Format(
            "messages-lines",
            "the same with lines for whatever changes its curvature",
            ".lines.json",
            _messages("lines"),
            _PLANE,
        ),
        Format(
            "messages-clothoids",
            "the same with clothoids as they are",
            ".clothoids.json",
            _messages("clothoids"),
            _PLANE,
        ),
        Format("geojson", "marks and ways on the map, for fields with an anchor", ".geojson", _geojson, ("field",)),
        Format("pdf", "a job sheet of one page", ".pdf", _pdf),
        Format("tsplib", "the ordering problem of its strokes, for other solvers (GTSP or PCGTSP)", ".gtsp", _tsplib),
        Format(
            "stops",
            "stops of a facade: place, normal, stand-off, arrival, dwell and water",
            ".stops.csv",
            _stops,
            _WALLS,
        ),
        Format("stops-json", "the same as JSON", ".stops.json", _stops_json, _WALLS),
    )
}
"""What `export_plan` writes, by name."""


def unfit(name: str, job: Job) -> str:
    """Why a plan of this job cannot be written in a format; empty where it can."""
    kind = type(job).__name__.lower()
    kinds = FORMATS[name].jobs
    if kinds is not None and kind not in kinds:
        return f"is not written for a {kind}; it is for {' and '.join(f'{k}s' for k in kinds)}"
    if name == "geojson" and getattr(job, "anchor", None) is None:
        return f"{job.name} lies nowhere on earth; expected a field with an anchor (optplan field --anchor)"
    if name == "geojson" and find_spec("pyproj") is None:
        return "places on earth need pyproj: install optplan[geo]"
    return ""


def export_plan(
    plan: Plan,
    to: str,
    file: str | Path,
    *,
    spacing: float | None = None,
    overwrite: bool = False,
    unit: str = "m",
) -> None:
    """Write a plan for another system.

    Parameters
    ----------
    plan : with a path
    to : name of a format in `FORMATS`
    file : where to
    spacing : greatest distance between points, m; default 5 cm, or a hundredth of a smaller canvas
    overwrite : whether an existing file may be replaced
    unit : of lengths in files for people (schedule, pdf): "m", "ft" or "yd"; files for machines are in metres

    Raises
    ------
    InputError : an unknown format, a plan without a path, a file that exists or cannot be written
    """
    from optplan.schema.files import write_atomically

    if to not in FORMATS:
        raise InputError(f"there is no format {to!r}; expected one of {', '.join(FORMATS)}")
    if spacing is not None and not (math.isfinite(spacing) and spacing > 0):
        raise InputError(f"the spacing is {spacing} m; expected a finite number above 0")
    check_unit(unit)
    text = FORMATS[to].write(plan, usual_spacing(plan) if spacing is None else spacing, unit)
    write_atomically(Path(file), text, overwrite=overwrite)


def usual_spacing(plan: Plan) -> float:
    """Point spacing for a plan of its size, m."""
    from optplan.exports.points import SPACING

    canvas = None if plan.cover is None else plan.cover.canvas
    return SPACING if canvas is None else min(SPACING, min(canvas.width, canvas.height) / 100)
