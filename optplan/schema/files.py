"""Reading and writing files safely."""

from __future__ import annotations

import contextlib
import os
import stat
import tempfile
from pathlib import Path

from optplan.domain.errors import InputError, LimitError

MAX_JSON_BYTES = 100 * 2**20
"""Largest plan or job file that is read."""


def read_bytes(file: Path, limit: int = MAX_JSON_BYTES) -> bytes:
    """Contents of a file.

    Raises
    ------
    InputError : it is missing, no ordinary file, or may not be read
    LimitError : it is larger than `limit` bytes
    """
    try:
        if file.is_dir():
            raise InputError("is a folder; expected a file", str(file))
        state = file.stat()
        if not stat.S_ISREG(state.st_mode):  # a pipe could keep us waiting for ever
            raise InputError("is not an ordinary file; expected one", str(file))
        size = state.st_size
        if size > limit:
            raise LimitError(f"has {size / 2**20:.0f} MB; at most {limit / 2**20:.0f} MB are read", str(file))
        with file.open("rb") as stream:
            data = stream.read(limit + 1)
    except FileNotFoundError:
        raise InputError("does not exist", str(file)) from None
    except (OSError, ValueError) as error:
        raise InputError(f"cannot be read: {error}", str(file)) from None
    if len(data) > limit:  # a device or a growing file says nothing true about its size
        raise LimitError(f"has more than {limit / 2**20:.0f} MB, which is the most that is read", str(file))
    return data


def read_text(file: Path, limit: int = MAX_JSON_BYTES) -> str:
    """UTF-8 text of a file; raises like `read_bytes`."""
    try:
        return read_bytes(file, limit).decode("utf-8-sig")
    except UnicodeDecodeError as error:
        raise InputError(f"is not UTF-8 text: {error}", str(file)) from None


def refuse_existing(file: Path, overwrite: bool) -> None:
    """InputError, before any work, where a file is not to be replaced or cannot be."""
    if file.is_dir():
        raise InputError("is a folder; expected the name of a file", str(file))
    if file.exists() and not overwrite:
        raise InputError("exists already; say --force to replace it, or --output for another place", str(file))


def write_atomically(file: Path, data: bytes | str, *, overwrite: bool) -> None:
    """Write a file as a whole or not at all.

    Parameters
    ----------
    overwrite : whether a file of that name may be replaced

    Raises
    ------
    InputError : the file exists and may not be replaced, or the folder cannot be written to
    """
    content = data.encode() if isinstance(data, str) else data
    try:
        refuse_existing(file, overwrite)
        if file.parent.exists() and not file.parent.is_dir():
            raise InputError(f"cannot be written: {file.parent} is not a folder", str(file))
        file.parent.mkdir(parents=True, exist_ok=True)
        handle, temporary = tempfile.mkstemp(dir=file.parent, prefix=f".{file.name}.", suffix=".part")
        try:
            with os.fdopen(handle, "wb") as stream:
                stream.write(content)
                stream.flush()
                os.fsync(stream.fileno())
            Path(temporary).chmod(0o666 & ~_umask())
            if overwrite:
                Path(temporary).replace(file)
            else:
                os.link(temporary, file)  # fails when somebody else wrote it meanwhile
                Path(temporary).unlink()
        except BaseException:
            with contextlib.suppress(OSError):
                Path(temporary).unlink()
            raise
    except FileExistsError:
        raise InputError("exists already; say --force to replace it, or choose another place", str(file)) from None
    except (OSError, ValueError) as error:
        reason = error.strerror if isinstance(error, OSError) else None
        raise InputError(f"cannot be written: {reason or error}", str(file)) from None


def _umask() -> int:
    mask = os.umask(0)
    os.umask(mask)
    return mask
