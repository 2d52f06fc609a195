"""Athletics: the lanes of a running track."""

from __future__ import annotations

import math

from optplan.domain.errors import InputError
from optplan.domain.job import Field
from optplan.jobs.fields.pen import MOST, Pen, fits

KERB, LINE = 0.30, 0.20
"""A lane is measured so far outside the kerb of the first one, or outside the line of the one before, m."""


def lane_length(lane: int, radius: float, straight: float, lane_width: float) -> float:
    """Once around a lane (1 is the innermost), m, where it is measured."""
    off = KERB if lane == 1 else (lane - 1) * lane_width + LINE
    return 2 * straight + 2 * math.pi * (radius + off)


def athletics(
    lanes: int = 8,
    radius: float = 36.50,
    straight: float = 84.39,
    lane_width: float = 1.22,
    starts: bool = True,
    line_width: float = 0.05,
) -> Field:
    """A 400 m track, World Athletics Track and Field Facilities Manual: lane lines, finish, staggered 400 m starts.

    The middle of the infield is in the middle; the finish is where the home straight, in the south, ends in the east.
    """
    if not 1 <= lanes <= 12:
        raise InputError(f"{lanes} lanes; expected 1..12")
    fits("lane_width", lane_width, 0.3, 5.0)
    fits("straight", straight, 1.0, MOST)
    # the starts of the outer lanes lie on the first bend
    fits("radius", radius, max((lanes - 1) * lane_width if starts else 0.0, 5.0), MOST)
    outer = radius + lanes * lane_width
    pen = Pen((straight / 2 + outer, outer))
    half = straight / 2
    for k in range(lanes + 1):
        r = radius + k * lane_width
        name = f"lane line {k}"
        pen.line(f"{name} home", (-half, -r), (half, -r))
        pen.arc(f"{name} east", (half, 0), r, -90, 90)
        pen.line(f"{name} back", (half, r), (-half, r))
        pen.arc(f"{name} west", (-half, 0), r, 90, 270)
    pen.line("finish", (half, -radius), (half, -outer))
    for lane in range(2, lanes + 1) if starts else ():
        # forward of the finish by what its lane is longer, on the bend in the east
        longer = lane_length(lane, radius, straight, lane_width) - lane_length(1, radius, straight, lane_width)
        angle = longer / (radius + (lane - 1) * lane_width + LINE) - math.pi / 2
        ends = [
            (half + r * math.cos(angle), r * math.sin(angle))
            for r in (radius + (lane - 1) * lane_width, radius + lane * lane_width)
        ]
        pen.line(f"400 m start {lane}", ends[0], ends[1])
    return Field(f"athletics, {lanes} lanes", tuple(pen.segments), line_width=line_width)
