"""Field hockey, lacrosse, baseball and softball."""

from __future__ import annotations

import math

from optplan.domain.job import Field
from optplan.jobs.fields.pen import FOOT, INCH, MOST, YARD, Pen, ends, fits


def field_hockey(length: float = 91.40, width: float = 55.00, line_width: float = 0.075) -> Field:
    """Field hockey, FIH Rules of Hockey, field and equipment specifications."""
    pen = Pen((length / 2, width / 2))
    x, y = length / 2, width / 2
    post, radius, mark = 3.66 / 2, 14.63, 0.30
    fits("length", length, 2 * (22.90 + mark), MOST)
    fits("width", width, 2 * (post + radius + 5.0), MOST)  # the broken circle ends at the back line
    pen.rectangle("boundary", (-x, -y), (x, y))
    pen.line("centre line", (0, -y), (0, y))
    for end in ends(pen):
        end.line("23 m line", (-x + 22.90, -y), (-x + 22.90, y))
        # the circle: a quarter around each post and a line between them
        end.arc("circle south", (-x, -post), radius, -90, 0)
        end.line("circle", (-x + radius, -post), (-x + radius, post))
        end.arc("circle north", (-x, post), radius, 0, 90)
        broken = radius + 5.0
        end.dashed_arc("broken circle south", (-x, -post), broken, -90, 0, mark, 3.0)
        end.line("broken circle", (-x + broken, -mark / 2), (-x + broken, mark / 2))
        end.dashed_arc("broken circle north", (-x, post), broken, 0, 90, mark, 3.0)
        end.spot("penalty spot", (-x + 6.40, 0), 0.15)
        for side, sign in (("south", -1), ("north", 1)):
            for off in (5.0, 10.0):
                at = sign * (post + off)
                end.line(f"{off:g} m mark {side}", (-x, at), (-x - mark, at))
            end.line(f"corner mark {side}", (-x, sign * (y - 5)), (-x - mark, sign * (y - 5)))
            for off in (5.0, radius):
                end.line(f"side mark {off:g} {side}", (-x + off, sign * y), (-x + off, sign * (y + mark)))
    return Field(f"field hockey {length:g} x {width:g} m", tuple(pen.segments), line_width=line_width)


def lacrosse(line_width: float = 4 * INCH) -> Field:
    """Men's field lacrosse: 110 x 60 yd, creases of 9 ft, goals 15 yd from the end lines."""
    x, y = 55 * YARD, 30 * YARD
    pen = Pen((x, y))
    pen.rectangle("boundary", (-x, -y), (x, y))
    pen.line("centre line", (0, -y), (0, y))
    pen.spot("centre mark", (0, 0), 0.1)
    for side, sign in (("south", -1), ("north", 1)):
        pen.line(f"wing line {side}", (-10 * YARD, sign * 20 * YARD), (10 * YARD, sign * 20 * YARD))
        pen.line(f"gate {side}", (-10 * YARD, sign * (y + 0.3)), (10 * YARD, sign * (y + 0.3)))
    for end in ends(pen):
        goal = -x + 15 * YARD
        end.circle("crease", (goal, 0), 9 * FOOT)
        end.line("goal line", (goal, -3 * FOOT), (goal, 3 * FOOT))
        end.line("restraining line", (-20 * YARD, -y), (-20 * YARD, y))
        inner = -x + 35 * YARD
        end.lines("goal area", (-x, -20 * YARD), (inner, -20 * YARD), (inner, 20 * YARD), (-x, 20 * YARD))
    return Field("lacrosse 110 x 60 yd", tuple(pen.segments), line_width=line_width)


def baseball(
    base: float = 90 * FOOT,
    pitch: float = 60.5 * FOOT,
    foul: float = 330 * FOOT,
    grass: float = 95 * FOOT,
    line_width: float = 4 * INCH,
) -> Field:
    """Baseball: foul lines, batter's, catcher's and coach's boxes, running lane, grass line around the pitcher's plate.

    Home plate's corner is the origin; second base lies to the north.
    """
    return _diamond("baseball", base, pitch, foul, grass, (4 * FOOT, 6 * FOOT), 0.0, line_width)


def softball(
    base: float = 60 * FOOT,
    pitch: float = 43 * FOOT,
    foul: float = 200 * FOOT,
    grass: float = 60 * FOOT,
    line_width: float = 4 * INCH,
) -> Field:
    """Fast-pitch softball: as baseball, with its own boxes and the pitcher's circle of 8 ft."""
    return _diamond("softball", base, pitch, foul, grass, (3 * FOOT, 7 * FOOT), 8 * FOOT, line_width)


def _diamond(
    name: str,
    base: float,
    pitch: float,
    foul: float,
    grass: float,
    box: tuple[float, float],
    circle: float,
    line_width: float,
) -> Field:
    c = math.sqrt(0.5)
    fits("base", base, 30 * FOOT, MOST)
    fits("pitch", pitch, base / 4, base)
    fits("foul", foul, base, MOST)
    # the grass line begins and ends on the foul lines
    fits("grass", grass or foul / 2, pitch * c, math.hypot(foul - pitch * c, pitch * c))
    pen = Pen()
    plate = 17 * INCH
    for side in (pen.side("first base", 1.0), pen.side("third base", -1.0)):
        # from beyond the batter's box to the fence
        begin = 8 * FOOT
        side.line("foul line", (begin * c, begin * c), (foul * c, foul * c))
        near, far = plate / 2 + 6 * INCH, plate / 2 + 6 * INCH + box[0]
        middle = plate / 2
        side.rectangle("batter's box", (near, middle - box[1] / 2), (far, middle + box[1] / 2))
        # the coach stands 15 ft off the line, in a box of 20 x 10 ft
        a, b = base - 20 * FOOT, base
        off = 15 * FOOT
        corner = [
            (u * c + v * c, u * c - v * c) for u, v in ((a, off + 10 * FOOT), (a, off), (b, off), (b, off + 10 * FOOT))
        ]
        side.lines("coach's box", *corner)
        if grass > 0:
            # the grass line meets the foul line at this distance from home
            along = pitch * c + math.sqrt(max(grass**2 - (pitch * c) ** 2, 0.0))
            angle = math.degrees(math.atan2(along * c - pitch, along * c))
            side.arc("grass line", (0, pitch), grass, angle, 90)
    first = pen.side("first base")
    lane = 3 * FOOT
    half, whole = base / 2, base
    corner = [(u * c + v * c, u * c - v * c) for u, v in ((half, 0.0), (half, lane), (whole, lane))]
    first.lines("running lane", *corner[0:3])
    width = 43 * INCH / 2
    low = plate / 2 - box[1] / 2
    pen.lines("catcher's box", (-width, low), (-width, -8 * FOOT), (width, -8 * FOOT), (width, low))
    if circle > 0:
        pen.circle("pitcher's circle", (0, pitch), circle)
    return Field(f"{name}, bases {base / FOOT:g} ft", tuple(pen.segments), line_width=line_width)
