"""Numbers and lengths as SVG writes them."""

from __future__ import annotations

import math
import re
from itertools import islice
from typing import Literal, NamedTuple

from optplan.domain.errors import InputError, LimitError
from optplan.jobs.svg.limits import MAX_SEGMENTS

NUMBER = r"[-+]?(?:[0-9]++(?:\.[0-9]*+)?|\.[0-9]++)(?:[eE][-+]?[0-9]++)?"
NUMBERS = re.compile(NUMBER)
_LIST = re.compile(rf"\s*+((?:{NUMBER}\s*+(?:,\s*+(?={NUMBER}))?)*+)")
_LENGTH = re.compile(rf"\s*+({NUMBER})\s*+([A-Za-z]*+|%)\s*+")
_NOT_FINITE = re.compile(r"[\s,]*+[-+]?(?:nan|inf(?:inity)?)(?![a-z])", re.IGNORECASE)

LARGEST = 1e30
"""no number of a drawing is larger: products of two of them stay finite"""
PX = 0.0254 / 96
"""metres of a CSS pixel"""
PIXELS = {
    "": 1.0,
    "px": 1.0,
    "in": 96.0,
    "cm": 96 / 2.54,
    "mm": 96 / 25.4,
    "q": 96 / 101.6,
    "pt": 96 / 72,
    "pc": 16.0,
    "em": 16.0,
    "rem": 16.0,
    "ex": 8.0,
    "ch": 8.0,
}
FONT_UNITS = frozenset({"em", "rem", "ex", "ch"})
"""depend on fonts; taken for a font of 16 px"""

Axis = Literal["x", "y", "r"]


class Length(NamedTuple):
    """A number with its unit in lower case; "%" is a unit."""

    value: float
    unit: str

    def pixels(self, viewport: tuple[float, float] | None = None, axis: Axis = "r") -> float | None:
        """User units (a pixel is one), or None when the unit is unknown or refers to a size that is."""
        if self.unit == "%":
            if viewport is None:
                return None
            width, height = viewport
            whole = {"x": width, "y": height, "r": math.sqrt((width**2 + height**2) / 2)}[axis]
            return self.value / 100 * whole
        factor = PIXELS.get(self.unit)
        return None if factor is None else self.value * factor


def refuse_not_finite(text: str, start: int = 0) -> None:
    """Raises InputError when `text` has "nan" or "infinity" at `start`."""
    match = _NOT_FINITE.match(text, start)
    if match:
        raise InputError(f"{match[0].strip(' ,')!r} is not a finite number; expected one")


def finite(text: str) -> float:
    """The number that `text` writes. Raises InputError beyond `LARGEST`, such as 1e999, which is no finite float."""
    value = float(text)
    if abs(value) > LARGEST:
        shown = text if len(text) <= 20 else text[:20] + "..."
        raise InputError(f"the number {shown} is not finite or absurdly large; expected at most {LARGEST:g}")
    return value


def parse_length(text: str) -> Length | None:
    """A length such as "2.5mm", or None when `text` is none. Raises InputError for NaN and infinity."""
    match = _LENGTH.fullmatch(text)
    if match is None:
        refuse_not_finite(text)
        return None
    return Length(finite(match[1]), match[2].lower())


def number_run(text: str, start: int = 0) -> tuple[str, int]:
    """The longest run of numbers, separated as SVG allows, from `start`; and where it ends."""
    match = _LIST.match(text, start)
    assert match is not None, "the pattern matches the empty run"
    return match[1], match.end()


def numbers(run: str, limit: int) -> list[float]:
    """The numbers of a run.

    Raises
    ------
    LimitError : more than `limit` of them
    InputError : one is not finite
    """
    if len(run) > limit and next(islice(NUMBERS.finditer(run), limit, None), None) is not None:
        raise LimitError(f"more than {limit} numbers in one attribute: beyond the limit of {MAX_SEGMENTS} segments")
    values = list(map(float, NUMBERS.findall(run)))
    if values and max(map(abs, values)) > LARGEST:
        for match in NUMBERS.finditer(run):
            finite(match[0])
    return values
