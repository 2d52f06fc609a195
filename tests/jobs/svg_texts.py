"""Short ways to write drawings in tests."""

from __future__ import annotations

import numpy as np

from optplan.domain.arrays import FloatArray
from optplan.domain.job import Drawing, Element
from optplan.jobs.svg import read_svg

PX = 0.0254 / 96
HEAD = '<svg xmlns="http://www.w3.org/2000/svg" xmlns:xlink="http://www.w3.org/1999/xlink" '
LINE = '<path id="p" d="M1 2L3 5" stroke="#000"/>'


def svg(body: str, attributes: str = 'viewBox="0 0 100 100"') -> str:
    """A whole file."""
    return f"{HEAD}{attributes}>{body}</svg>"


def drawing(body: str, attributes: str = 'viewBox="0 0 100 100"') -> Drawing:
    """The drawing that `body` is read as."""
    return read_svg(svg(body, attributes))


def user_points(element: Element, height: float = 100.0, unit: float = PX) -> FloatArray:
    """All vertices, turned back into user units with y down."""
    points = np.concatenate([curve.points for curve in element.curves]) / unit
    result: FloatArray = np.column_stack([points[:, 0], height - points[:, 1]])
    return result


def texts(read: Drawing) -> list[str]:
    """What the load report says."""
    return [note.text for note in read.notes]
