"""Jobs and small ordering instances that ship with optplan."""

from __future__ import annotations

from pathlib import Path

from optplan.domain.errors import InputError

SUFFIXES = (".svg", ".json", ".atsp", ".sop", ".gtsp", ".pcglns")


def _folder() -> Path:
    """Where they are: in the installed package, or beside it in a checkout."""
    package = Path(__file__).parent
    shipped = package / "_data" / "instances"
    return shipped if shipped.is_dir() else package.parent / "instances"


def instance_names() -> tuple[str, ...]:
    """Names of everything shipped, such as "drawings/lion", sorted."""
    folder = _folder()
    files = [file for file in folder.glob("*/*") if file.suffix in SUFFIXES]
    return tuple(sorted(file.relative_to(folder).with_suffix("").as_posix() for file in files))


def instance(name: str) -> Path:
    """File of a shipped job or instance.

    Parameters
    ----------
    name : such as "drawings/lion", or just "lion"

    Raises
    ------
    InputError : there is none of that name
    """
    matches = [known for known in instance_names() if name in (known, known.split("/", 1)[1])]
    if len(matches) != 1:
        raise InputError(f"there is no instance {name!r}; expected one of {', '.join(instance_names())}")
    file = _folder() / matches[0]
    return next(candidate for suffix in SUFFIXES if (candidate := file.with_suffix(suffix)).exists())


def shipped_or_file(source: str | Path) -> Path:
    """The file itself; where there is none, the shipped one of that name, with or without its folder and its ending."""
    file = Path(source)
    if file.is_file():
        return file
    names = {short for name in instance_names() for short in (name, name.split("/", 1)[1])}
    bare = file.with_suffix("").as_posix() if file.suffix in SUFFIXES else file.as_posix()
    if bare not in names:
        return file
    shipped = instance(bare)
    return shipped if file.suffix in ("", shipped.suffix) else file
