"""What kind of file a command was given, and what is said when it is the wrong one."""

from __future__ import annotations

from contextlib import AbstractContextManager, nullcontext
from pathlib import Path
from typing import TYPE_CHECKING

from optplan.domain.errors import InputError, located

if TYPE_CHECKING:
    from optplan.domain.job import Job


def is_job(file: Path) -> bool:
    """Whether a file is a job, to begin with, and no plan."""
    if file.suffix.lower() != ".json":
        return file.suffix.lower() in (".svg", ".svgz", ".dxf", ".csv")
    if not file.is_file():
        return False
    from optplan.schema.base import parse_json
    from optplan.schema.files import read_bytes

    data = parse_json(read_bytes(file), str(file))
    return isinstance(data, dict) and ("kind" in data or "circles" in data) and "job" not in data


def refuse_job(stage: str, file: Path) -> None:
    """Raises InputError for a job, where a stage goes on from a plan."""
    if is_job(file):
        raise InputError(
            f"is a job, of which there is no plan yet; expected a plan to {stage}: optplan plan makes all of it, "
            "optplan cover a first one, and optplan compare orders the stops of washing cases",
            str(file),
        )


def facade_file(job: Job, file: Path) -> AbstractContextManager[None]:
    """Puts the file in front of what is wrong with a facade, which is found out while it is covered."""
    from optplan.domain.facade import Facade

    return located(str(file)) if isinstance(job, Facade) else nullcontext()
