"""Which options mean something for which kind of job."""

from __future__ import annotations

from pathlib import Path
from typing import TYPE_CHECKING, Any

from optplan.domain.errors import InputError

if TYPE_CHECKING:
    from collections.abc import Sequence

    from optplan.domain.job import Job

MEANT: dict[str, tuple[str, ...]] = {
    **dict.fromkeys(
        ("canvas", "margin", "direction", "spacing", "inset", "boundary", "fill", "entry", "inner_first", "link",
         "on_canvas"),
        ("drawing",),
    ),
    "close_gap": ("drawing", "facade"),
    **dict.fromkeys(("cut", "headings"), ("field",)),
    **dict.fromkeys(
        ("tolerance", "keep", "refill", "padding", "curved_padding", "corner", "areas", "clearance", "reversing",
         "drying", "avoid", "entries", "work_speed", "jerk", "power", "constant_speed"),
        ("drawing", "field"),
    ),
    **dict.fromkeys(
        ("unit", "pattern", "fewest", "turned", "placement", "rule", "water", "horizontal", "travel", "lift"),
        ("facade",),
    ),
}  # fmt: skip
"""Kinds of job that an option says something about; what is not listed is for all of them."""

FILES: dict[str, tuple[str, ...]] = {"close_gap": (".svg", ".svgz"), "unit": (".svg", ".svgz", ".dxf")}
"""Endings of the files that an option says something about, where it is about reading."""

_NAMES = {"avoid": "--avoid-finished"}


def flag_of(name: str) -> str:
    """What an option is called on the command line."""
    return _NAMES.get(name, f"--{name.replace('_', '-')}")


def refuse_meaningless(flags: dict[str, Any], job: Job, file: Path | None = None) -> None:
    """InputError for an option that was given and means nothing for this job, or for the file that it came from."""
    kind = type(job).__name__.lower()
    for name, value in flags.items():
        if value is None or value == [] or name not in MEANT:
            continue
        kinds = MEANT[name]
        if kind not in kinds:
            raise InputError(f"means nothing for a {kind}; it is for {_or([f'{k}s' for k in kinds])}", flag_of(name))
        if file is not None and name in FILES and file.suffix.lower() not in FILES[name]:
            raise InputError(f"means nothing for {file.name}; it is for {_or(FILES[name])}", flag_of(name))


def refuse_exports(names: Sequence[str], job: Job) -> None:
    """InputError for a format that a plan of this job cannot be written in."""
    from optplan.exports import FORMATS, unfit

    for name in names:
        if name not in FORMATS:
            raise InputError(f"there is no format {name!r}; expected one of {', '.join(FORMATS)}", "--export")
        reason = unfit(name, job)
        if reason:
            raise InputError(reason, f"--export {name}")


def _or(words: Sequence[str]) -> str:
    return f"{', '.join(words[:-1])} or {words[-1]}" if len(words) > 1 else words[0]
