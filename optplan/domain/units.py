"""Units at the door: text such as "25 mm" or "90 deg" becomes SI once; inside there are only plain floats."""

from __future__ import annotations

import math
import re

from optplan.domain.errors import InputError

LENGTH = {
    "m": 1.0,
    "mm": 1e-3,
    "cm": 1e-2,
    "dm": 1e-1,
    "km": 1e3,
    "um": 1e-6,
    "in": 0.0254,
    "ft": 0.3048,
    "yd": 0.9144,
    "pt": 0.0254 / 72,
    "px": 0.0254 / 96,
}
TIME = {"s": 1.0, "ms": 1e-3, "min": 60.0, "h": 3600.0}
ANGLE = {"rad": 1.0, "deg": math.pi / 180, "°": math.pi / 180}
SPEED = {"m/s": 1.0, "mm/s": 1e-3, "cm/s": 1e-2, "km/h": 1 / 3.6, "ft/s": 0.3048, "mm/min": 1e-3 / 60, "mph": 0.44704}
ACCELERATION = {"m/s^2": 1.0, "m/s2": 1.0, "mm/s^2": 1e-3, "mm/s2": 1e-3}
JERK = {"m/s^3": 1.0, "m/s3": 1.0}
SPECIFIC_POWER = {"W/kg": 1.0}
RATE = {"rad/s": 1.0, "deg/s": math.pi / 180, "rpm": 2 * math.pi / 60}
RATE_CHANGE = {"rad/s^2": 1.0, "rad/s2": 1.0, "deg/s^2": math.pi / 180}
SHARPNESS = {"1/m^2": 1.0, "1/m2": 1.0}
VOLUME = {"m^3": 1.0, "m3": 1.0, "L": 1e-3, "l": 1e-3, "ml": 1e-6}
PER_AREA = {"m": 1.0, "L/m^2": 1e-3, "L/m2": 1e-3, "ml/m^2": 1e-6}
FLOW = {"m^3/s": 1.0, "L/s": 1e-3, "L/min": 1e-3 / 60}
POWER = {"W": 1.0, "kW": 1e3}
ENERGY = {"J": 1.0, "Wh": 3600.0, "kWh": 3.6e6}

_QUANTITY = re.compile(r"\s*([+-]?(?:\d+\.?\d*|\.\d+)(?:[eE][+-]?\d+)?)\s*(\S.*?)?\s*")


def quantity(text: str | float, units: dict[str, float], default: str) -> float:
    """A number in SI units.

    Parameters
    ----------
    text : a number (taken in the unit `default`) or text with an optional unit
    units : accepted units and their factor to SI, e.g. `LENGTH`
    default : the unit of a bare number

    Raises
    ------
    InputError : not a number, not finite, or a unit that is not accepted here
    """
    if isinstance(text, bool) or not isinstance(text, str | int | float):
        raise InputError(f"{text!r} is not a quantity; expected a number or text such as '2.5 {default}'")
    if isinstance(text, str):
        match = _QUANTITY.fullmatch(text)
        if match is None:
            raise InputError(f"{text!r} is not a quantity; expected a number with a unit, such as '2.5 {default}'")
        number, unit = float(match[1]), match[2] or default
    else:
        try:
            number, unit = float(text), default
        except OverflowError:
            raise InputError("a number of more than 300 digits is not finite") from None
    if unit not in units:
        raise InputError(f"{text!r} has the unit {unit!r}; expected one of {', '.join(units)}")
    value = number * units[unit]
    if not math.isfinite(value):
        raise InputError(f"{text!r} is not finite")
    return value


def length(text: str | float) -> float:
    """Metres from "25 mm", "3 ft" or a number of metres. Raises InputError."""
    return quantity(text, LENGTH, "m")


def duration(text: str | float) -> float:
    """Seconds from "2 min" or a number of seconds. Raises InputError."""
    return quantity(text, TIME, "s")


def angle(text: str | float) -> float:
    """Radians from "30 deg", "0.5 rad" or a number of **degrees**, as people type angles. Raises InputError."""
    return quantity(text, ANGLE, "deg")


def speed(text: str | float) -> float:
    """Metres per second from "40 cm/s" or a number of m/s. Raises InputError."""
    return quantity(text, SPEED, "m/s")


UNITS = ("m", "ft", "yd")
"""In which people may want to read lengths."""
_NAMES = {"m": "metres", "ft": "feet", "yd": "yards"}
_POWERS = {"m": 1, "m2": 2, "m/s": 1, "m/s^2": 1, "m/s^3": 1, "1/m": -1, "1/m^2": -2}


def check_unit(unit: str) -> str:
    """The unit; InputError for none of `UNITS`."""
    if unit not in UNITS:
        raise InputError(f"the unit is {unit!r}; expected one of {', '.join(UNITS)}")
    return unit


def unit_name(unit: str) -> str:
    """metres, feet or yards"""
    return _NAMES[check_unit(unit)]


def shown(value: float, unit: str, lengths: str) -> tuple[float, str]:
    """A value in SI for people: with its lengths in m, ft or yd, and the unit that it then has."""
    power = _POWERS.get(unit)
    if power is None or check_unit(lengths) == "m":
        return value, unit
    return value / LENGTH[lengths] ** power, unit.replace("m", lengths, 1)
