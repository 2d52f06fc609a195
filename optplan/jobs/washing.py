"""Washing cases as facades: instances of ordering that also say which wall their circles wash."""

from __future__ import annotations

from pathlib import Path
from typing import Any

from optplan.domain.errors import InputError, located
from optplan.domain.facade import Facade
from optplan.schema.base import VERSION, fault
from optplan.schema.facades import FacadeModel, facade_from


def facade_of_case(data: dict[str, Any], file: Path) -> Facade:
    """The facade of a washing case: its keys name, surface, no_go, circles, radius and rule. Raises InputError."""
    from pydantic import ValidationError

    if "surface" not in data:
        raise InputError("has circles but no surface: expected one, or optplan compare instead", str(file))
    rule = data.get("rule")
    tables = rule if isinstance(rule, dict) else {}
    known = {"tau": tables.get("tau"), "width": tables.get("d"), "radius": data.get("radius")}
    given = {
        "version": VERSION,
        "name": data.get("name", file.stem),
        "outline": data["surface"],
        "no_go": data.get("no_go", []),
        "stops": data["circles"],
        **{name: value for name, value in known.items() if value is not None},
    }
    try:
        model = FacadeModel.model_validate(given)
    except ValidationError as error:
        raise fault(error, str(file)) from None
    with located(str(file)):
        return facade_from(model)
