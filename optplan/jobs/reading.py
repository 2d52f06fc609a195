"""One door for all job files."""

from __future__ import annotations

import os
from pathlib import Path

from optplan.domain.errors import InputError, located
from optplan.domain.job import Job


def read(source: str | bytes | os.PathLike[str], *, close_gap: float | None = None) -> Job:
    """Read a job.

    Parameters
    ----------
    source : path of an SVG drawing (.svg, .svgz) or of a JSON job; or the text of an SVG itself, as str or bytes
    close_gap : SVG lines whose ends are nearer than this (drawing units) are closed; default: half their own width

    Raises
    ------
    InputError : the file is missing or is no job, with the place that is wrong
    """
    from optplan.jobs.svg import read_svg

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
    if not file.exists():
        raise InputError(
            "does not exist; expected a drawing (.svg), a JSON job, or the name of a shipped one", str(file)
        )
    raise InputError(f"has the ending {file.suffix!r}; expected .svg, .svgz or .json", str(file))


def _read_json(file: Path) -> Job:
    from pydantic import TypeAdapter, ValidationError

    from optplan.schema.base import check_version, fault, parse_json
    from optplan.schema.files import read_bytes
    from optplan.schema.jobs import JobModel, job_from

    data = parse_json(read_bytes(file), str(file))
    if isinstance(data, dict) and "circles" in data and "kind" not in data:
        from optplan.jobs.washing import facade_of_case

        return facade_of_case(data, file)
    check_version(data, str(file))
    try:
        model = TypeAdapter(JobModel).validate_python(data)
    except ValidationError as error:
        raise fault(error, str(file)) from None
    with located(str(file)):
        return job_from(model)
