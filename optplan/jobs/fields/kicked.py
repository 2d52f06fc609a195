"""Football, rugby union and league, American football."""

from __future__ import annotations

import math

from optplan.domain.errors import InputError
from optplan.domain.job import Field
from optplan.jobs.fields.numerals import numeral
from optplan.jobs.fields.pen import FOOT, INCH, YARD, Pen, corners, ends, fits


def football(
    length: float = 105.0,
    width: float = 68.0,
    goal: float = 7.32,
    penalty_depth: float = 16.5,
    goal_depth: float = 5.5,
    penalty_mark: float = 11.0,
    circle: float = 9.15,
    corner: float = 1.0,
    spot: float = 0.22,
    corner_marks: bool = False,
    line_width: float = 0.12,
) -> Field:
    """Association football, IFAB Laws of the Game, law 1; smaller pitches by their measures.

    The areas reach as far beyond the goal posts as they are deep; a depth of 0 leaves one out.
    """
    pen = Pen((length / 2, width / 2))
    x, y = length / 2, width / 2
    for name, depth in (("penalty area", penalty_depth), ("goal area", goal_depth)):
        if goal / 2 + depth > y or depth > x:
            raise InputError(f"a {name} of {depth:g} m does not fit a pitch of {length:g} x {width:g} m")
    if circle >= min(x, y):
        raise InputError(f"a circle of {circle:g} m does not fit a pitch of {length:g} x {width:g} m")
    fits("corner", corner, 0.0, min(x, y) / 2)
    fits("penalty_mark", penalty_mark, 0.0, x)
    fits("spot", spot, 0.0, min(x, y) / 2)
    if corner_marks and corner + circle >= y:
        raise InputError(f"corner_marks {corner + circle:g} m from the corners do not fit a width of {width:g} m")
    pen.rectangle("boundary", (-x, -y), (x, y))
    pen.line("halfway", (0, -y), (0, y))
    if circle > 0:
        pen.circle("centre circle", (0, 0), circle)
    pen.spot("centre mark", (0, 0), spot)
    for end in ends(pen):
        for name, depth in (("penalty area", penalty_depth), ("goal area", goal_depth)):
            half = goal / 2 + depth
            if depth > 0:
                end.lines(name, (-x, -half), (-x + depth, -half), (-x + depth, half), (-x, half))
        if penalty_mark > 0:
            end.spot("penalty mark", (-x + penalty_mark, 0), spot)
            reach = penalty_depth - penalty_mark
            if 0 <= reach < circle and penalty_depth > 0:
                angle = math.degrees(math.acos(reach / circle))
                end.arc("penalty arc", (-x + penalty_mark, 0), circle, -angle, angle)
        if corner_marks:
            for side in (-1, 1):
                at = side * (y - corner - circle)
                end.line(f"corner mark {'north' if side > 0 else 'south'}", (-x - 0.05, at), (-x - 0.3, at))
    if corner > 0:
        for edge in corners(pen):
            edge.arc("corner arc", (-x, -y), corner, 0, 90)
    return Field(f"football {length:g} x {width:g} m", tuple(pen.segments), line_width=line_width)


def rugby_union(
    length: float = 100.0,
    width: float = 70.0,
    in_goal: float = 10.0,
    dash: float = 5.0,
    line_width: float = 0.10,
) -> Field:
    """Rugby union, World Rugby laws, law 1. `length` is that of the field of play, without the in-goals."""
    x, y = length / 2, width / 2
    if x <= 22 or y <= 15:
        raise InputError(f"a field of play of {length:g} x {width:g} m has no room for its lines")
    fits("in_goal", in_goal, 0.0, x)
    fits("dash", dash, 0.05, x - 6)
    pen = Pen((x + in_goal, y))
    pen.rectangle("boundary", (-x - in_goal, -y), (x + in_goal, y))
    pen.line("halfway", (0, -y), (0, y))
    pen.line("halfway mark", (-0.25, 0), (0.25, 0))
    for end in ends(pen):
        end.line("goal line", (-x, -y), (-x, y))
        end.line("22 m", (-x + 22, -y), (-x + 22, y))
        end.dashes("10 m", (-10, -y), (-10, y), dash, dash)
        for side, sign in (("south", -1), ("north", 1)):
            end.dashes(f"5 m {side}", (-x + 5, sign * (y - 5)), (-1, sign * (y - 5)), dash, dash)
            end.dashes(f"15 m {side}", (-x + 5, sign * (y - 15)), (-1, sign * (y - 15)), dash, dash)
            end.line(f"goal dash {side}", (-x + 5, sign * (2.8 + 1)), (-x + 5, sign * 2.8))
    return Field(f"rugby union {length:g} x {width:g} m", tuple(pen.segments), line_width=line_width)


def rugby_league(
    length: float = 100.0,
    width: float = 68.0,
    in_goal: float = 8.0,
    dash: float = 2.0,
    numbers: bool = False,
    line_width: float = 0.10,
) -> Field:
    """Rugby league, international laws of the game: lines across every 10 m, broken lines 10 and 20 m from touch."""
    x, y = length / 2, width / 2
    if y <= 20 or x <= 10:
        raise InputError(f"a field of play of {length:g} x {width:g} m has no room for its lines")
    fits("in_goal", in_goal, 0.0, x)
    fits("dash", dash, 0.05, 5.0)
    pen = Pen((x + in_goal, y))
    pen.rectangle("boundary", (-x - in_goal, -y), (x + in_goal, y))
    for end in ends(pen):
        end.line("goal line", (-x, -y), (-x, y))
        for metres in range(10, int(x), 10):
            end.line(f"{metres} m", (-x + metres, -y), (-x + metres, y))
            for side, sign in (("south", -1), ("north", 1)) if numbers else ():
                numeral(end.side(f"number {metres} {side}"), str(metres), (-x + metres, sign * (y - 14)), 2.0, sign)
        for side, sign in (("south", -1), ("north", 1)):
            for touch in (10, 20):
                at = sign * (y - touch)
                end.dashes(f"{touch} m from touch {side}", (-x + 2, at), (-dash / 2, at), dash, 10 - dash)
    pen.line("halfway", (0, -y), (0, y))
    return Field(f"rugby league {length:g} x {width:g} m", tuple(pen.segments), line_width=line_width)


HASHES = {"nfl": 70.75 * FOOT, "ncaa": 60 * FOOT, "high school": 160 / 3 * FOOT}
"""From the side line to the near inbounds line."""


def american_football(
    rules: str = "ncaa",
    numbers: bool = True,
    yard_marks: bool = True,
    line_width: float = 4 * INCH,
) -> Field:
    """American football: 120 x 53 1/3 yd, lines every 5 yd, hash marks every yard, numbers every 10 yd.

    `rules` ("nfl", "ncaa", "high school") says where the hash marks are.
    """
    if rules not in HASHES:
        raise InputError(f"there are no rules {rules!r}; expected one of {', '.join(HASHES)}")
    x, y, mark = 60 * YARD, 80 * FOOT, 2 * FOOT
    pen = Pen((x, y))
    pen.rectangle("boundary", (-x, -y), (x, y))
    # the near ends of hash marks lie on the inbounds lines, 2 ft of line towards the side
    inbounds = y - HASHES[rules]
    try_mark = {"nfl": 2, "ncaa": 3, "high school": 3}[rules] * YARD
    pen.line("50 yd", (0, -y), (0, y))
    for end in ends(pen):
        end.line("goal line", (-x + 10 * YARD, -y), (-x + 10 * YARD, y))
        end.line("try mark", (-x + 10 * YARD + try_mark, -YARD / 2), (-x + 10 * YARD + try_mark, YARD / 2))
        for yard in range(1, 50):
            at = -x + (10 + yard) * YARD
            if yard % 5 == 0:
                end.line(f"{yard} yd", (at, -y), (at, y))
                for side, sign in (("south", -1), ("north", 1)):
                    # across the yard lines, hash marks are short lines lengthwise
                    end.line(f"hash {yard} {side}", (at - mark / 2, sign * inbounds), (at + mark / 2, sign * inbounds))
            elif yard_marks:
                for side, sign in (("south", -1), ("north", 1)):
                    end.line(f"hash {yard} {side}", (at, sign * inbounds), (at, sign * (inbounds + mark)))
                    edge = y - 4 * INCH
                    end.line(f"side mark {yard} {side}", (at, sign * edge), (at, sign * (edge - mark)))
    if numbers:
        for yard in range(10, 100, 10):
            at = -x + (10 + yard) * YARD
            for side, sign in (("south", -1), ("north", 1)):
                text = str(min(yard, 100 - yard))
                # their tops are 9 yd from the side line
                numeral(pen.side(f"number {yard} {side}"), text, (at, sign * (y - 10 * YARD)), 2 * YARD, sign)
    return Field(f"American football, {rules}", tuple(pen.segments), line_width=line_width)
