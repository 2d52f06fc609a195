"""Frames as files: GIF, MP4, a folder of PNGs."""

from __future__ import annotations

import contextlib
import io
import shutil
import subprocess
import tempfile
from collections.abc import Iterable, Iterator
from pathlib import Path
from typing import TYPE_CHECKING

import numpy as np

from optplan.domain.errors import InputError

if TYPE_CHECKING:
    from PIL.Image import Image

HOLD = 1.5
"""The last frame of a GIF stays this long before it begins again, s."""
_BITS = 5
"""Bits of each colour by which the nearest one of the palette is looked up."""


def gif_bytes(frames: Iterable[Image], fps: float, palette: list[tuple[int, int, int]]) -> bytes:
    """A GIF that repeats; frames hold only what changes."""
    table = _nearest(palette)
    flat = [value for colour in palette for value in colour]
    pictures = [_reduced(frame, table, flat) for frame in frames]
    # a GIF counts in hundredths of a second: rounding is made up for, so that the whole takes as long as it should
    moments = np.round(np.arange(len(pictures) + 1) / fps * 100).astype(int)
    waits = (10 * np.diff(moments)).tolist()
    waits[-1] += int(1000 * HOLD)
    made = io.BytesIO()
    pictures[0].save(
        made, "GIF", save_all=True, append_images=pictures[1:], duration=waits, loop=0, disposal=1, optimize=False
    )
    return made.getvalue()


def _nearest(palette: list[tuple[int, int, int]]) -> np.ndarray:
    """Index of the nearest colour of the palette for every colour of few bits."""
    levels = (np.arange(1 << _BITS) * 255 / ((1 << _BITS) - 1)).astype(np.float32)
    grid = np.stack(np.meshgrid(levels, levels, levels, indexing="ij"), axis=-1).reshape(-1, 3)
    colours = np.array(palette, dtype=np.float32)
    away = (grid**2).sum(axis=1)[:, None] - 2 * grid @ colours.T + (colours**2).sum(axis=1)
    return np.asarray(away.argmin(axis=1).astype(np.uint8))


def _reduced(frame: Image, table: np.ndarray, flat: list[int]) -> Image:
    from PIL import Image

    few = np.asarray(frame) >> (8 - _BITS)
    index = (few[..., 0].astype(np.uint16) << (2 * _BITS)) | (few[..., 1].astype(np.uint16) << _BITS) | few[..., 2]
    made = Image.fromarray(table[index])
    made.putpalette(flat)
    return made


def require_ffmpeg(file: Path) -> str:
    """The program that makes MP4 files; InputError where there is none."""
    program = shutil.which("ffmpeg")
    if program is None:
        raise InputError("cannot be made: ffmpeg is not on the PATH; install it, or write a .gif", str(file))
    return program


def mp4_bytes(frames: Iterable[Image], fps: float, size: tuple[int, int], file: Path) -> bytes:
    """An MP4 (H.264) made by ffmpeg; raises InputError with its last words when it fails."""
    program = require_ffmpeg(file)
    with tempfile.TemporaryDirectory() as folder:
        target = Path(folder) / "film.mp4"
        command = [program, "-loglevel", "error", "-y", "-f", "rawvideo", "-pix_fmt", "rgb24"]
        command += ["-s", f"{size[0]}x{size[1]}", "-r", f"{fps:g}", "-i", "-", "-an", "-c:v", "libx264"]
        command += ["-pix_fmt", "yuv420p", "-movflags", "+faststart", str(target)]
        with (Path(folder) / "words").open("w+b") as words:
            child = subprocess.Popen(command, stdin=subprocess.PIPE, stdout=subprocess.DEVNULL, stderr=words)
            assert child.stdin is not None
            try:
                with contextlib.suppress(BrokenPipeError), child.stdin as pipe:
                    for frame in frames:
                        pipe.write(frame.tobytes())
            except BaseException:
                child.kill()
                raise
            finally:
                code = child.wait()
            words.seek(0)
            said = words.read().decode(errors="replace").strip().splitlines()
        if code != 0 or not target.exists():
            raise InputError(f"cannot be made: ffmpeg says {said[-1] if said else f'nothing, code {code}'}", str(file))
        return target.read_bytes()


def write_folder(frames: Iterator[Image], folder: Path, overwrite: bool) -> None:
    """Frames as frame-00000.png and so on; frames of an earlier film that are left over go."""
    from optplan.schema.files import write_atomically

    number = -1
    for number, frame in enumerate(frames):
        image = io.BytesIO()
        frame.save(image, "PNG")
        write_atomically(folder / f"frame-{number:05d}.png", image.getvalue(), overwrite=overwrite)
    for old in folder.glob("frame-[0-9][0-9][0-9][0-9][0-9].png"):
        if int(old.stem[6:]) > number:
            old.unlink()
