"""One door for all job files."""

from __future__ import annotations

import math
import os
from pathlib import Path

from optplan.domain.errors import InputError, located
from optplan.domain.job import Job


def read(
    source: str | bytes | os.PathLike[str],
    *,
    close_gap: float | None = None,
    kind: str | None = None,
    unit: float | None = None,
) -> Job:
    """Read a job.

    Parameters
    ----------
    source : path of an SVG drawing (.svg, .svgz), of a JSON job, of a facade as DXF (.dxf) or measured points (.csv);
        or the text of an SVG itself, as str or bytes
    kind : "facade" reads an SVG as a facade: its largest closed path is the wall, those in it are not washed. What is
        of another kind than this is refused
    unit : metres of one unit of a facade's drawing; default: 1, or what a DXF file says
    close_gap : SVG lines whose ends are nearer than this (drawing units) are closed; default: half their own width

    Raises
    ------
    InputError : the file is missing or is no job, with the place that is wrong
    """
    from optplan.jobs.svg import read_svg

    if kind not in (None, "drawing", "facade"):
        raise InputError(f"the kind of job is {kind!r}; expected drawing or facade")
    if unit is not None and not (math.isfinite(unit) and unit > 0):
        raise InputError(f"the drawing unit is {unit} m; expected a finite number above 0")
    if kind == "facade":
        return _as_asked(_facade(source, close_gap, unit), kind, source)
    if kind == "drawing":
        return _as_asked(read(source, close_gap=close_gap, unit=unit), kind, source)
    if not isinstance(source, str | bytes | os.PathLike):
        raise InputError(f"{source!r} is no job; expected the path of a file, or the text of an SVG")

    if isinstance(source, bytes) or (isinstance(source, str) and source.lstrip().startswith("<")):
        return read_svg(source, close_gap=close_gap)
    file = Path(source)
    match file.suffix.lower():
        case ".svg" | ".svgz":
            return read_svg(file, close_gap=close_gap)
        case ".json":
            return _read_json(file)
        case ".dxf" | ".csv":
            return _facade(file, close_gap, unit)
    if not file.exists():
        raise InputError(
            "does not exist; expected a drawing (.svg), a JSON job, or the name of a shipped one", str(file)
        )
    raise InputError(f"has the ending {file.suffix!r}; expected .svg, .svgz, .json, .dxf or .csv", str(file))


def _as_asked(job: Job, kind: str, source: object) -> Job:
    """The job, if it is of the kind that was asked for."""
    found = type(job).__name__.lower()
    if found != kind:
        raise InputError(f"is a {found}; expected a {kind}", source if isinstance(source, str) else str(source))
    return job


def _facade(source: str | bytes | os.PathLike[str], close_gap: float | None, unit: float | None) -> Job:
    """A facade from a drawing or from measured points."""
    from optplan.jobs.dxf import read_dxf
    from optplan.jobs.facades import facade_of_drawing
    from optplan.jobs.measured import read_measured
    from optplan.jobs.svg import read_svg

    text = isinstance(source, bytes) or (isinstance(source, str) and source.lstrip().startswith("<"))
    suffix = ".svg" if text else Path(source).suffix.lower()  # type: ignore[arg-type]
    match suffix:
        case ".svg" | ".svgz":
            drawing = read_svg(source if text else Path(source), close_gap=close_gap)  # type: ignore[arg-type]
            with located("the drawing" if text else str(source)):
                return facade_of_drawing(drawing, unit)
        case ".dxf":
            return read_dxf(Path(source), unit)  # type: ignore[arg-type]
        case ".csv":
            return read_measured(Path(source))  # type: ignore[arg-type]
    return read(source)


def _read_json(file: Path) -> Job:
    from pydantic import TypeAdapter, ValidationError

    from optplan.schema.base import check_version, fault, parse_json
    from optplan.schema.files import read_bytes
    from optplan.schema.jobs import JobModel, job_from

    data = parse_json(read_bytes(file), str(file))
    if isinstance(data, dict) and "circles" in data and "kind" not in data:
        from optplan.jobs.washing import facade_of_case

        return facade_of_case(data, file)
    if isinstance(data, dict) and data.get("format") == "optplan plan":
        raise InputError("is a plan, expected a job; a plan is looked at by optplan check, show, export", str(file))
    check_version(data, str(file))
    try:
        model = TypeAdapter(JobModel).validate_python(data)
    except ValidationError as error:
        raise fault(error, str(file)) from None
    with located(str(file)):
        return job_from(model)
