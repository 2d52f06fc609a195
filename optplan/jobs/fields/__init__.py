"""Sports fields by their published rules, with their measures as parameters."""

from __future__ import annotations

import inspect
import math
from collections.abc import Callable
from dataclasses import dataclass
from typing import TYPE_CHECKING

from optplan.domain.errors import InputError, located

if TYPE_CHECKING:
    from optplan.domain.job import Field


@dataclass(frozen=True)
class Template:
    """A kind of field.

    Parameters
    ----------
    name, summary : for people
    home : module of this folder, and the function in it
    fixed : parameters that this template sets
    """

    name: str
    summary: str
    home: tuple[str, str]
    fixed: tuple[tuple[str, float], ...] = ()

    @property
    def parameters(self) -> dict[str, float | str | bool]:
        """Name and usual value of each: metres, unless it is text or yes and no."""
        made = {name: value.default for name, value in inspect.signature(self._function()).parameters.items()}
        return made | dict(self.fixed)

    def _function(self) -> Callable[..., Field]:
        import importlib

        module = importlib.import_module(f"optplan.jobs.fields.{self.home[0]}")
        found: Callable[..., Field] = getattr(module, self.home[1])
        return found


WIDEST = 1.0
"""Widest line of a template, m."""
_YARD = 0.9144
_FOOT = 0.3048
TEMPLATES = {
    template.name: template
    for template in (
        Template("football", "association football, 105 x 68 m", ("kicked", "football")),
        Template(
            "football-9v9",
            "nine-a-side football, 80 x 50 yd",
            ("kicked", "football"),
            (
                ("length", 80 * _YARD),
                ("width", 50 * _YARD),
                ("goal", 16 * _FOOT),
                ("penalty_depth", 13 * _YARD),
                ("goal_depth", 4 * _YARD),
                ("penalty_mark", 9 * _YARD),
                ("circle", 7 * _YARD),
            ),
        ),
        Template(
            "football-7v7",
            "seven-a-side football, 60 x 40 yd",
            ("kicked", "football"),
            (
                ("length", 60 * _YARD),
                ("width", 40 * _YARD),
                ("goal", 12 * _FOOT),
                ("penalty_depth", 9 * _YARD),
                ("goal_depth", 0.0),
                ("penalty_mark", 8 * _YARD),
                ("circle", 6 * _YARD),
            ),
        ),
        Template(
            "football-5v5",
            "five-a-side football, 40 x 30 yd",
            ("kicked", "football"),
            (
                ("length", 40 * _YARD),
                ("width", 30 * _YARD),
                ("goal", 12 * _FOOT),
                ("penalty_depth", 8 * _YARD),
                ("goal_depth", 0.0),
                ("penalty_mark", 6 * _YARD),
                ("circle", 5 * _YARD),
                ("corner", 0.0),
            ),
        ),
        Template("american-football", "120 x 53 1/3 yd, with hash marks and numbers", ("kicked", "american_football")),
        Template("rugby-union", "100 x 70 m and in-goals", ("kicked", "rugby_union")),
        Template("rugby-league", "100 x 68 m and in-goals", ("kicked", "rugby_league")),
        Template("baseball", "bases 90 ft apart", ("sticks", "baseball")),
        Template("softball", "bases 60 ft apart", ("sticks", "softball")),
        Template("lacrosse", "110 x 60 yd", ("sticks", "lacrosse")),
        Template("field-hockey", "91.4 x 55 m", ("sticks", "field_hockey")),
        Template("tennis", "78 x 36 ft", ("courts", "tennis")),
        Template("basketball", "28 x 15 m", ("courts", "basketball")),
        Template("volleyball", "18 x 9 m", ("courts", "volleyball")),
        Template("handball", "40 x 20 m", ("courts", "handball")),
        Template("athletics", "400 m track of eight lanes", ("track", "athletics")),
    )
}
"""All templates by name."""


def template(name: str, **measures: float | str | bool) -> Field:
    """A field of a kind.

    Parameters
    ----------
    name : one of `TEMPLATES`
    measures : its parameters that are not as usual; lengths as m, or as text with a unit ("110 yd")

    Raises
    ------
    InputError : no such template or parameter, or a measure that is none or does not fit
    """
    from optplan.domain.units import length
    from optplan.jobs.fields.pen import MOST

    if name not in TEMPLATES:
        raise InputError(f"there is no field {name!r}; expected one of {', '.join(TEMPLATES)}")
    found = TEMPLATES[name]
    known = found.parameters
    given: dict[str, float | str | bool] = dict(found.fixed)
    for key, value in measures.items():
        if key not in known:
            raise InputError(f"has no measure {key!r}; expected one of {', '.join(known)}", name)
        with located(f"{name}: {key}"):
            usual = known[key]
            if isinstance(usual, bool):
                given[key] = _truth(value)
            elif isinstance(usual, str):
                given[key] = str(value)
            else:
                given[key] = _whole(value) if isinstance(usual, int) else length(value)
                most = WIDEST if key == "line_width" else MOST
                if not 0 <= float(given[key]) <= most:
                    raise InputError(f"is {value!r}, which does not fit; expected 0..{most:g} m")
    with located(name):
        return found._function()(**given)


def _whole(value: float | str) -> int:
    try:
        number = float(value)
    except ValueError:
        number = math.nan
    if not number.is_integer():
        raise InputError(f"is {value!r}; expected a whole number")
    return int(number)


def _truth(value: float | str | bool) -> bool:
    words = {"yes": True, "true": True, "1": True, "no": False, "false": False, "0": False}
    if isinstance(value, bool):
        return value
    if str(value).lower() not in words:
        raise InputError(f"is {value!r}; expected yes or no")
    return words[str(value).lower()]
