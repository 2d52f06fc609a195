"""Path data: the text of `d` becomes lines and cubic Beziers in the element's own coordinates.

Points are complex numbers x + iy: affine steps of relative commands are then plain sums.
"""

from __future__ import annotations

import cmath
import math
import re
from collections.abc import Iterator
from dataclasses import dataclass, field

from optplan.domain.errors import LimitError
from optplan.jobs.svg._number import NUMBER, finite, number_run, numbers, refuse_not_finite
from optplan.jobs.svg.limits import MAX_SEGMENTS

Handles = tuple[complex, complex] | None
ARC_PIECE = math.pi / 4
"""an arc is cut into pieces of at most this angle, rad: a cubic is then within 5e-6 of its radius"""

_COMMAND = re.compile(r"[\s]*+([MmLlHhVvCcSsQqTtAaZz])")
_ARC = re.compile(rf"\s*+({NUMBER})" + rf"[\s,]*+({NUMBER})" * 2 + r"[\s,]*+([01])" * 2 + rf"[\s,]*+({NUMBER})" * 2)
_COMMA = re.compile(r"\s*+,?")
_ARITY = {"M": 2, "L": 2, "H": 1, "V": 1, "C": 6, "S": 4, "Q": 4, "T": 2}


@dataclass
class Subpath:
    """A chain of segments while it is being read.

    Parameters
    ----------
    points : the start, then the end of each segment; a closed one may or may not repeat the start
    handles : inner control points of each segment, None for a line
    closed : by a closing command
    """

    points: list[complex]
    handles: list[Handles] = field(default_factory=list)
    closed: bool = False

    def line(self, end: complex) -> None:
        """Append a line."""
        self.points.append(end)
        self.handles.append(None)

    def cubic(self, first: complex, second: complex, end: complex) -> None:
        """Append a cubic Bezier."""
        self.points.append(end)
        self.handles.append((first, second))


def polyline(points: list[complex], *, closed: bool) -> Subpath:
    """Straight lines through `points`."""
    return Subpath(points, [None] * (len(points) - 1), closed)


def arc_pieces(
    center: complex, rx: float, ry: float, turn: float, start: float, sweep: float
) -> Iterator[list[complex]]:
    """Cubics along an elliptical arc, each as [handle, handle, end].

    Parameters
    ----------
    center, rx, ry : of the ellipse
    turn : of its x axis, rad
    start, sweep : angles on the ellipse, rad; a positive sweep turns from x to y
    """
    count = max(1, math.ceil(abs(sweep) / ARC_PIECE - 1e-9))
    step = sweep / count
    reach = 4 / 3 * math.tan(step / 4)
    axis_x, axis_y = rx * cmath.rect(1, turn), ry * 1j * cmath.rect(1, turn)
    for piece in range(count):
        a, b = start + piece * step, start + (piece + 1) * step
        p = axis_x * math.cos(a) + axis_y * math.sin(a)
        q = axis_x * math.cos(b) + axis_y * math.sin(b)
        out = axis_y * math.cos(a) - axis_x * math.sin(a)
        into = axis_y * math.cos(b) - axis_x * math.sin(b)
        yield [center + p + reach * out, center + q - reach * into, center + q]


LARGEST_RADIUS = 1e60
"""Radius from which an arc, grown to reach its end, is a line."""


def add_arc(path: Subpath, rx: float, ry: float, turn: float, large: bool, positive: bool, end: complex) -> None:
    """Append the arc of an A command: radii, turn of the x axis (degrees), the two flags, end point."""
    begin = path.points[-1]
    rx, ry = abs(rx), abs(ry)
    if begin == end:
        return
    if rx == 0 or ry == 0:
        path.line(end)
        return
    angle = math.radians(turn % 360)
    # scaled to the unit circle the arc is a chord of it; too small radii grow until the chord is a diameter
    half = (begin - end) / 2 * cmath.rect(1, -angle)
    u = complex(half.real / rx, half.imag / ry)
    size = math.hypot(u.real, u.imag)
    if size == 0 or not max(rx, ry) * max(size, 1.0) < LARGEST_RADIUS:
        path.line(end)
        return
    if size > 1:
        rx, ry, u, size = rx * size, ry * size, u / size, 1.0
    offset = math.sqrt(max(0.0, 1 - size**2)) / size * u * 1j
    middle = offset if large == positive else -offset
    first, last = u - middle, -u - middle
    sweep = cmath.phase(last) - cmath.phase(first)
    if positive and sweep < 0:
        sweep += 2 * math.pi
    elif not positive and sweep > 0:
        sweep -= 2 * math.pi
    if sweep == 0:
        path.line(end)
        return
    center = (begin + end) / 2 + complex(middle.real * rx, middle.imag * ry) * cmath.rect(1, angle)
    pieces = list(arc_pieces(center, rx, ry, angle, cmath.phase(first), sweep))
    pieces[-1][2] = end
    for one, two, stop in pieces:
        path.cubic(one, two, stop)


def parse_path(text: str, limit: int = MAX_SEGMENTS) -> tuple[list[Subpath], str | None]:
    """Subpaths of path data, up to where it breaks.

    Parameters
    ----------
    text : value of the attribute `d`
    limit : segments that may be read

    Returns
    -------
    the subpaths (one without segments is a bare move), and what is wrong at the break, or None

    Raises
    ------
    InputError : NaN or infinity among the numbers
    LimitError : more than `limit` segments
    """
    return _Reader(text, limit).read()


class _Reader:
    def __init__(self, text: str, limit: int) -> None:
        self.text, self.limit = text, limit
        self.done: list[Subpath] = []
        self.path: Subpath | None = None
        self.here = 0j
        self.count = 0
        self.mirrored = ""
        """the kind of curve whose handle the next S or T may mirror"""
        self.handle = 0j

    def read(self) -> tuple[list[Subpath], str | None]:
        if not self.text.strip():
            return [], None
        at = 0
        while at < len(self.text):
            match = _COMMAND.match(self.text, at)
            if match is None:
                if not self.text[at : at + 1000].strip() and not self.text[at:].strip():
                    break
                return self._broken(at, "expected a command letter")
            letter = match[1]
            if self.path is None and not self.done and letter not in "Mm":
                return self._broken(match.start(1), "path data starts with a move")
            if letter in "Zz":
                self._close()
                at = match.end()
                continue
            run, end = number_run(self.text, match.end())
            problem = self._arcs(run, letter == "a") if letter in "Aa" else self._command(letter, run)
            if problem is None and self.text[end : end + 1] == ",":
                problem = "expected a number after the comma"
            if problem:
                return self._broken(end, problem)
            at = end
        return self.done, None

    def _broken(self, at: int, problem: str) -> tuple[list[Subpath], str]:
        refuse_not_finite(self.text, at)
        return self.done, problem

    def _take(self, count: int) -> None:
        self.count += count
        if self.count > self.limit:
            raise LimitError(f"more segments than the {MAX_SEGMENTS} that a drawing may have")

    def _open(self) -> Subpath:
        """The subpath to append to; after a closing command the next one starts where the last did."""
        if self.path is None:
            self.path = Subpath([self.here])
            self.done.append(self.path)
        return self.path

    def _close(self) -> None:
        self._take(1)
        path = self._open()
        path.closed = True
        self.here = path.points[0]
        self.path, self.mirrored = None, ""

    def _command(self, letter: str, run: str) -> str | None:
        """Append every full group of arguments; returns what is wrong with the rest."""
        kind, relative = letter.upper(), letter.islower()
        arity = _ARITY[kind]
        values = numbers(run, arity * (self.limit - self.count) + arity)
        groups = len(values) // arity
        self._take(groups)
        for k in range(0, groups * arity, arity):
            self._group(kind, relative, values[k : k + arity])
            if kind == "M":
                kind = "L"
        if not values:
            return f"{letter} has no numbers"
        if len(values) % arity:
            return f"{letter} takes {arity} numbers at a time; {len(values) % arity} are left over"
        return None

    def _group(self, kind: str, relative: bool, v: list[float]) -> None:
        origin = self.here if relative else 0j
        if kind == "M":
            self.here = origin + complex(v[0], v[1])
            self.path, self.mirrored = Subpath([self.here]), ""
            self.done.append(self.path)
            return
        path = self._open()
        if kind in "LHV":
            if kind == "L":
                self.here = origin + complex(v[0], v[1])
            elif kind == "H":
                self.here = complex(origin.real + v[0], self.here.imag)
            else:
                self.here = complex(self.here.real, origin.imag + v[0])
            path.line(self.here)
            self.mirrored = ""
            return
        points = [origin + complex(v[k], v[k + 1]) for k in range(0, len(v), 2)]
        family = "C" if kind in "CS" else "Q"
        if kind in "ST":
            points.insert(0, 2 * self.here - self.handle if self.mirrored == family else self.here)
        self.handle = points[-2]
        if family == "C":
            path.cubic(points[0], points[1], points[2])
        else:
            middle, end = points
            path.cubic(self.here + 2 / 3 * (middle - self.here), end + 2 / 3 * (middle - end), end)
        self.here, self.mirrored = points[-1], family

    def _arcs(self, run: str, relative: bool) -> str | None:
        at = 0
        while match := _ARC.match(run, at):
            self._take(math.ceil(2 * math.pi / ARC_PIECE))
            rx, ry, turn, x, y = (finite(match[k]) for k in (1, 2, 3, 6, 7))
            end = complex(x, y) + (self.here if relative else 0j)
            add_arc(self._open(), rx, ry, turn, match[4] == "1", match[5] == "1", end)
            self.here, self.mirrored = end, ""
            comma = _COMMA.match(run, match.end())
            assert comma is not None, "the pattern matches the empty text"
            at = comma.end()
        if run[at:].strip():
            return "A takes two radii, an angle, two flags of 0 or 1 and a point at a time"
        return "A has no numbers" if at == 0 else None
