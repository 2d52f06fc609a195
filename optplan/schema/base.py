"""What all models share: strictness, units, error messages, versions."""

from __future__ import annotations

import json
import re
from dataclasses import dataclass
from typing import Annotated, Any

from pydantic import BaseModel, ConfigDict, Field, GetCoreSchemaHandler, GetJsonSchemaHandler, ValidationError
from pydantic_core import CoreSchema, core_schema

from optplan.domain import units
from optplan.domain.errors import InputError

VERSION = "1.5"
"""Version of the file formats. A newer minor version adds what an older program may not leave out."""


class Model(BaseModel):
    """A public record: unknown keys, NaN and infinity are errors."""

    model_config = ConfigDict(extra="forbid", allow_inf_nan=False, frozen=True)


@dataclass(frozen=True, eq=False)
class _Unit:
    """Annotation of a float field: a number, or text with a unit, converted to SI at the door.

    Where a bare number would not mean the SI unit (degrees), JSON is written with the unit.
    """

    table: dict[str, float]
    default: str
    example: str
    written: str = ""

    def __get_pydantic_core_schema__(self, source: Any, handler: GetCoreSchemaHandler) -> CoreSchema:
        def convert(value: Any) -> float:
            try:
                return units.quantity(value, self.table, self.default)
            except InputError as error:
                raise ValueError(error.problem) from None

        def write(value: float) -> str:
            pretty = f"{round(value / self.table[self.default], 9):.12g} {self.default}"
            # what people read, where it says the same number
            return pretty if convert(pretty) == value else f"{value!r} {self.written}"

        writer = core_schema.plain_serializer_function_ser_schema(write, when_used="json-unless-none")
        return core_schema.no_info_before_validator_function(
            convert, handler(source), serialization=writer if self.written else None
        )

    def __get_pydantic_json_schema__(self, core: CoreSchema, handler: GetJsonSchemaHandler) -> dict[str, Any]:
        return {"anyOf": [{"type": "number"}, {"type": "string"}], "examples": [self.example]}


Length = Annotated[float, _Unit(units.LENGTH, "m", "25 mm")]
Speed = Annotated[float, _Unit(units.SPEED, "m/s", "40 cm/s")]
Acceleration = Annotated[float, _Unit(units.ACCELERATION, "m/s^2", "1 m/s^2")]
Rate = Annotated[float, _Unit(units.RATE, "rad/s", "90 deg/s")]
RateChange = Annotated[float, _Unit(units.RATE_CHANGE, "rad/s^2", "40 rad/s^2")]
Jerk = Annotated[float, _Unit(units.JERK, "m/s^3", "2 m/s^3")]
SpecificPower = Annotated[float, _Unit(units.SPECIFIC_POWER, "W/kg", "1 W/kg")]
Sharpness = Annotated[float, _Unit(units.SHARPNESS, "1/m^2", "4 1/m^2")]
Angle = Annotated[float, _Unit(units.ANGLE, "deg", "30 deg", written="rad")]
Duration = Annotated[float, _Unit(units.TIME, "s", "2 min")]

Whole = Annotated[int, Field(ge=-(2**31), lt=2**31)]
"""A whole number that any computer can count to."""
Point = tuple[float, float]
Point3 = tuple[float, float, float]


def fault(error: ValidationError, where: str) -> InputError:
    """All of pydantic's findings as one InputError."""
    lines = []
    for item in error.errors(include_url=False)[:12]:
        place = "".join(f"[{key}]" if isinstance(key, int) else f".{key}" for key in item["loc"]).lstrip(".")
        given = "" if isinstance(item["input"], dict | list) else f" (given: {str(item['input'])[:60]!r})"
        message = item["msg"].removeprefix("Value error, ")
        if item["type"] == "extra_forbidden":
            message = "is not known"
        elif item["type"] in ("model_type", "dict_type"):
            message = "is no table of named values"
        lines.append(f"{place}: {message}{given}" if place else f"{message}{given}")
    more = error.error_count() - len(lines)
    if more > 0:
        lines.append(f"and {more} more")
    return InputError("; ".join(lines), where)


def check_version(data: Any, where: str) -> None:
    """Raise InputError unless this program can read a file of the version that `data` states."""
    if not isinstance(data, dict):
        raise InputError(f"holds a {type(data).__name__}; expected an object with named parts", where)
    version = data.get("version")
    parts = str(version).split(".")
    if len(parts) != 2 or not all(re.fullmatch("[0-9]{1,9}", part) for part in parts):
        shown = f"version is {repr(version)[:60]}" if "version" in data else "has no version"
        raise InputError(f"{shown}; expected {VERSION!r} or an older minor version of it", where)
    major, minor = map(int, parts)
    own_major, own_minor = map(int, VERSION.split("."))
    if major != own_major or minor > own_minor:
        raise InputError(
            f"was written for format version {version}; this optplan reads {own_major}.0 to {VERSION}. "
            f"{'Update optplan to read it.' if (major, minor) > (own_major, own_minor) else 'Write it again.'}",
            where,
        )


def parse_json(text: str | bytes, where: str) -> Any:
    """JSON with NaN and infinity refused. Raises InputError with line and column."""

    def refuse(name: str) -> Any:
        raise InputError(f"holds {name}; expected finite numbers", where)

    try:
        return json.loads(text, parse_constant=refuse)
    except json.JSONDecodeError as error:
        raise InputError(f"is not JSON: {error.msg} at line {error.lineno}, column {error.colno}", where) from None
    except (ValueError, RecursionError) as error:  # not UTF-8, numbers without end, nested too deeply
        raise InputError(f"is not JSON: {error}", where) from None
