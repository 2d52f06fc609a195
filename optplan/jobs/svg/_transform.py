"""Affine transforms: (a, b, c, d, e, f) takes (x, y) to (a x + c y + e, b x + d y + f)."""

from __future__ import annotations

import math
import re

from optplan.domain.errors import InputError, LimitError
from optplan.jobs.svg._number import NUMBER, PIXELS, finite, refuse_not_finite
from optplan.jobs.svg.limits import MAX_TRANSFORM_CHARS

Matrix = tuple[float, float, float, float, float, float]
IDENTITY: Matrix = (1.0, 0.0, 0.0, 1.0, 0.0, 0.0)

_CALL = re.compile(r"[\s,]*+([A-Za-z]++)\s*+\(([^()]*+)\)")
_ARGUMENT = re.compile(rf"\s*+({NUMBER})([A-Za-z]*+|%)\s*+,?")
_TURNS = {"": 1.0, "deg": 1.0, "rad": 180 / math.pi, "grad": 0.9, "turn": 360.0}


def multiply(m: Matrix, n: Matrix) -> Matrix:
    """The transform that does `n` first, then `m`."""
    return (
        m[0] * n[0] + m[2] * n[1],
        m[1] * n[0] + m[3] * n[1],
        m[0] * n[2] + m[2] * n[3],
        m[1] * n[2] + m[3] * n[3],
        m[0] * n[4] + m[2] * n[5] + m[4],
        m[1] * n[4] + m[3] * n[5] + m[5],
    )


def translation(x: float, y: float) -> Matrix:
    """A shift."""
    return (1.0, 0.0, 0.0, 1.0, x, y)


def scale_of(m: Matrix) -> float:
    """The factor by which lengths grow in the mean: the root of the area's factor."""
    return math.sqrt(abs(m[0] * m[3] - m[1] * m[2]))


def parse_transform(text: str) -> Matrix | None:
    """The product of a list such as "translate(3) rotate(30 1 2)", as attribute or style; None when it is malformed.

    Raises
    ------
    InputError : NaN or infinity among the numbers
    LimitError : the text is longer than a transform may be
    """
    if len(text) > MAX_TRANSFORM_CHARS:
        raise LimitError(f"the transform has {len(text)} characters; the limit is {MAX_TRANSFORM_CHARS}")
    if text.strip() in ("", "none"):
        return IDENTITY
    result, at = IDENTITY, 0
    while text[at:].strip(" \t\r\n,"):
        match = _CALL.match(text, at)
        if match is None:
            return None
        step = _call(match[1].lower(), match[2])
        if step is None:
            return None
        result, at = multiply(result, step), match.end()
    if not all(map(math.isfinite, result)):
        raise InputError("the transform's numbers multiply beyond what is finite")
    return result


def _call(name: str, text: str) -> Matrix | None:
    arguments, at = [], 0
    while at < len(text) and text[at:].strip():
        match = _ARGUMENT.match(text, at)
        if match is None:
            refuse_not_finite(text, at)
            return None
        arguments.append((finite(match[1]), match[2].lower()))
        at = match.end()
    if text.rstrip().endswith(","):
        return None
    values: list[float] = []
    for position, (value, unit) in enumerate(arguments):
        angle = name in ("skewx", "skewy", "skew") or (name == "rotate" and position == 0)
        plain = name == "matrix" or name.startswith("scale")
        units = _TURNS if angle else {"": 1.0} if plain else PIXELS
        if unit not in units:
            return None
        values.append(value * units[unit])
    return _matrix(name, values)


def _matrix(name: str, v: list[float]) -> Matrix | None:
    match name, len(v):
        case "matrix", 6:
            return (v[0], v[1], v[2], v[3], v[4], v[5])
        case "translate", 1 | 2:
            return translation(v[0], v[1] if len(v) == 2 else 0.0)
        case "translatex", 1:
            return translation(v[0], 0.0)
        case "translatey", 1:
            return translation(0.0, v[0])
        case "scale", 1 | 2:
            return (v[0], 0.0, 0.0, v[-1], 0.0, 0.0)
        case "scalex", 1:
            return (v[0], 0.0, 0.0, 1.0, 0.0, 0.0)
        case "scaley", 1:
            return (1.0, 0.0, 0.0, v[0], 0.0, 0.0)
        case "rotate", 1 | 3:
            angle = math.radians(v[0])
            turn = (math.cos(angle), math.sin(angle), -math.sin(angle), math.cos(angle), 0.0, 0.0)
            if len(v) == 1:
                return turn
            return multiply(multiply(translation(v[1], v[2]), turn), translation(-v[1], -v[2]))
        case "skewx", 1:
            return (1.0, 0.0, math.tan(math.radians(v[0])), 1.0, 0.0, 0.0)
        case "skewy", 1:
            return (1.0, math.tan(math.radians(v[0])), 0.0, 1.0, 0.0, 0.0)
        case "skew", 1 | 2:
            other = v[1] if len(v) == 2 else 0.0
            return (1.0, math.tan(math.radians(other)), math.tan(math.radians(v[0])), 1.0, 0.0, 0.0)
    return None
