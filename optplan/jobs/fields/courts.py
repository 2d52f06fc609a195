"""Courts: tennis, basketball, volleyball, handball."""

from __future__ import annotations

import math

from optplan.domain.job import Field
from optplan.jobs.fields.pen import FOOT, INCH, MOST, Pen, ends, fits


def tennis(doubles: bool = True, line_width: float = 2 * INCH) -> Field:
    """Tennis, ITF Rules of Tennis, rule 1: 78 ft long, 27 ft wide for singles and 36 ft for doubles."""
    x, single, double = 39 * FOOT, 13.5 * FOOT, 18 * FOOT
    y = double if doubles else single
    pen = Pen((x, y))
    pen.rectangle("boundary", (-x, -y), (x, y))
    if doubles:
        for side, sign in (("south", -1), ("north", 1)):
            pen.line(f"singles line {side}", (-x, sign * single), (x, sign * single))
    pen.line("centre service line", (-21 * FOOT, 0), (21 * FOOT, 0))
    for end in ends(pen):
        end.line("service line", (-21 * FOOT, -single), (-21 * FOOT, single))
        end.line("centre mark", (-x, 0), (-x + 4 * INCH, 0))
    return Field(f"tennis, {'doubles' if doubles else 'singles'}", tuple(pen.segments), line_width=line_width)


def basketball(length: float = 28.0, width: float = 15.0, line_width: float = 0.05) -> Field:
    """Basketball, FIBA Official Basketball Rules, article 2."""
    pen = Pen((length / 2, width / 2))
    x, y = length / 2, width / 2
    basket, three, side_gap = 1.575, 6.75, 0.90
    # the restricted areas and the centre circle fit between the lines, and the three-point line is an arc in the middle
    fits("length", length, 2 * (8.325 + 1.80), MOST)
    fits("width", width, 2 * (2.45 + side_gap), 2 * (three + side_gap))
    pen.rectangle("boundary", (-x, -y), (x, y))
    pen.line("centre line", (0, -y - 0.15), (0, y + 0.15))
    pen.circle("centre circle", (0, 0), 1.80)
    for end in ends(pen):
        hoop = (-x + basket, 0.0)
        straight = y - side_gap
        reach = math.sqrt(three**2 - straight**2)
        angle = math.degrees(math.asin(straight / three))
        for side, sign in (("south", -1), ("north", 1)):
            end.line(f"three-point line {side}", (-x, sign * straight), (-x + basket + reach, sign * straight))
            end.line(f"no-charge line {side}", (-x + 1.2, sign * 1.25), (-x + basket, sign * 1.25))
        end.arc("three-point arc", hoop, three, -angle, angle)
        end.arc("no-charge arc", hoop, 1.25, -90, 90)
        end.lines("restricted area", (-x, -2.45), (-x + 5.80, -2.45), (-x + 5.80, 2.45), (-x, 2.45))
        end.arc("free-throw arc", (-x + 5.80, 0), 1.80, -90, 90)
        end.line("throw-in line", (-x + 8.325, -y), (-x + 8.325, -y - 0.15))
    return Field(f"basketball {length:g} x {width:g} m", tuple(pen.segments), line_width=line_width)


def volleyball(beach: bool = False, line_width: float = 0.05) -> Field:
    """Volleyball, FIVB rules: 18 x 9 m, attack lines 3 m from the centre; on the beach 16 x 8 m, no lines inside."""
    x, y = (8.0, 4.0) if beach else (9.0, 4.5)
    pen = Pen((x, y))
    pen.rectangle("boundary", (-x, -y), (x, y))
    if not beach:
        pen.line("centre line", (0, -y), (0, y))
        for end in ends(pen):
            end.line("attack line", (-3, -y), (-3, y))
    return Field(
        f"{'beach ' if beach else ''}volleyball {2 * x:g} x {2 * y:g} m", tuple(pen.segments), line_width=line_width
    )


def handball(length: float = 40.0, width: float = 20.0, circle: float = 2.0, line_width: float = 0.05) -> Field:
    """Handball, IHF Rules of the Game, rule 1."""
    pen = Pen((length / 2, width / 2))
    x, y, post = length / 2, width / 2, 1.5
    # the goal areas end at the goal line, the free-throw lines run out over the side lines
    fits("width", width, 2 * (post + 6.0), 2 * (post + 9.0))
    fits("length", length, 18.5, MOST)
    fits("circle", circle, 0.0, min(x - 9.0, y))
    pen.rectangle("boundary", (-x, -y), (x, y))
    pen.line("centre line", (0, -y), (0, y))
    if circle > 0:
        pen.circle("throw-off circle", (0, 0), circle)
    for end in ends(pen):
        end.arc("goal area south", (-x, -post), 6.0, -90, 0)
        end.line("goal area", (-x + 6, -post), (-x + 6, post))
        end.arc("goal area north", (-x, post), 6.0, 0, 90)
        # the free-throw line runs out over the side lines
        out = math.degrees(math.asin((y - post) / 9.0))
        end.dashed_arc("free-throw line south", (-x, -post), 9.0, -out, 0, 0.15, 0.15)
        end.dashes("free-throw line", (-x + 9, -post), (-x + 9, post), 0.15, 0.15)
        end.dashed_arc("free-throw line north", (-x, post), 9.0, 0, out, 0.15, 0.15)
        end.line("7 m line", (-x + 7, -0.5), (-x + 7, 0.5))
        end.line("goalkeeper's line", (-x + 4, -0.075), (-x + 4, 0.075))
    return Field(f"handball {length:g} x {width:g} m", tuple(pen.segments), line_width=line_width)
