"""Quantities with units."""

from __future__ import annotations

import math
from contextlib import suppress

import pytest
from hypothesis import given
from hypothesis import strategies as st

from optplan.domain import units
from optplan.domain.errors import InputError


@pytest.mark.parametrize(
    ("text", "table", "default", "expected"),
    [
        ("25 mm", units.LENGTH, "m", 0.025),
        ("25mm", units.LENGTH, "m", 0.025),
        (" +1.5e1 cm ", units.LENGTH, "m", 0.15),
        ("100 yd", units.LENGTH, "m", 91.44),
        ("1 in", units.LENGTH, "m", 0.0254),
        ("72 pt", units.LENGTH, "m", 0.0254),
        ("96 px", units.LENGTH, "m", 0.0254),
        (".5", units.LENGTH, "m", 0.5),
        (3, units.LENGTH, "mm", 0.003),
        ("-3 ft", units.LENGTH, "m", -0.9144),
        ("2 min", units.TIME, "s", 120.0),
        ("180", units.ANGLE, "deg", math.pi),
        ("90°", units.ANGLE, "deg", math.pi / 2),
        ("0.5 rad", units.ANGLE, "deg", 0.5),
        ("36 km/h", units.SPEED, "m/s", 10.0),
        ("600 mm/min", units.SPEED, "m/s", 0.01),
        ("60 rpm", units.RATE, "rad/s", 2 * math.pi),
    ],
)
def test_known_quantities(text: str | float, table: dict[str, float], default: str, expected: float) -> None:
    assert units.quantity(text, table, default) == pytest.approx(expected, rel=1e-14)


@pytest.mark.parametrize(
    "text", ["", "m", "1 2 m", "1 parsec", "nan", "inf", "1e999", "1,5 m", "--1", True, None, [1], math.nan, math.inf]
)
def test_refused_quantities(text: object) -> None:
    with pytest.raises(InputError):
        units.length(text)  # type: ignore[arg-type]


def test_numbers_too_large_for_a_float_are_refused() -> None:
    with pytest.raises(InputError, match="finite"):
        units.length(10**400)


@given(st.floats(allow_nan=False, allow_infinity=False, min_value=-1e300, max_value=1e300))
def test_plain_numbers_survive_text(value: float) -> None:
    assert units.length(repr(value)) == value
    assert units.angle(f"{value!r} rad") == value
    assert units.duration(value) == value
    assert units.speed(f"{value!r} m/s") == value


@given(st.text(max_size=12))
def test_any_text_gives_a_number_or_an_input_error(text: str) -> None:
    with suppress(InputError):
        assert math.isfinite(units.length(text))
