"""Pictures of plans."""

from __future__ import annotations

from pathlib import Path
from typing import TYPE_CHECKING

from optplan.domain.errors import InputError

if TYPE_CHECKING:
    from optplan.domain.result import Plan

PICTURES = (".png", ".svg", ".pdf")
"""File endings of pictures."""


def draw(plan: Plan, file: str | Path, *, overwrite: bool = False, dpi: int = 150) -> None:
    """Write a picture of a plan: work in true widths, travel, directions, start and end.

    Parameters
    ----------
    plan : complete, or of an earlier stage: what there is, is drawn
    file : its ending chooses PNG, SVG or PDF
    overwrite : whether an existing file may be replaced
    dpi : pixels per inch of a PNG

    Raises
    ------
    InputError : an unknown ending, nothing to draw yet, a file that exists or cannot be written
    """
    import io

    from optplan.plot.picture import figure
    from optplan.schema.files import write_atomically

    target = Path(file)
    if target.suffix.lower() not in PICTURES:
        raise InputError(f"has the ending {target.suffix!r}; expected one of {', '.join(PICTURES)}", str(target))
    image = io.BytesIO()
    figure(plan).savefig(image, format=target.suffix.lower()[1:], dpi=dpi)
    write_atomically(target, image.getvalue(), overwrite=overwrite)
