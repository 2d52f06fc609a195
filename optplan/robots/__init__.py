"""Robots: presets that ship with optplan, and robots of the user's own."""

from __future__ import annotations

from pathlib import Path

from optplan.domain.errors import InputError, located
from optplan.domain.robot import Robot

_PRESETS = Path(__file__).parent

USUAL_ROBOTS = {"Drawing": "beach-rake", "Field": "line-marker", "Facade": "boom-washer", "Surface": "arm-grinder"}
"""Who does a job unless somebody else is named."""


def robot_names() -> tuple[str, ...]:
    """Names of the presets, sorted."""
    return tuple(sorted(file.stem for file in _PRESETS.glob("*.toml")))


def load_robot(name: str | Path | Robot) -> Robot:
    """A preset by name, or the robot that a TOML or JSON file describes.

    Parameters
    ----------
    name : name of a preset, path of a file, or a robot (returned as it is)

    Raises
    ------
    InputError : neither a preset nor a file, or a file that does not describe a robot
    """
    if isinstance(name, Robot):
        return name
    if not isinstance(name, str | Path):
        raise InputError(f"{name!r} is no robot; expected the name of a preset, a file, or a robot")
    if str(name) in robot_names():
        return _read(_PRESETS / f"{name}.toml")
    file = Path(name)
    if file.suffix not in (".toml", ".json"):
        known = ", ".join(robot_names())
        raise InputError(f"there is no robot {str(name)!r}; expected one of {known}, or a .toml or .json file")
    return _read(file)


def _read(file: Path) -> Robot:
    import tomllib

    from pydantic import ValidationError

    from optplan.schema.base import check_version, fault, parse_json
    from optplan.schema.files import read_text
    from optplan.schema.robots import RobotModel, robot_from

    text = read_text(file)
    if file.suffix == ".json":
        data = parse_json(text, str(file))
    else:
        try:
            data = tomllib.loads(text)
        except (ValueError, RecursionError) as error:  # TOMLDecodeError is a ValueError
            raise InputError(f"is not TOML: {error}", str(file)) from None
    check_version(data, str(file))
    try:
        model = RobotModel.model_validate(data)
    except ValidationError as error:
        raise fault(error, str(file)) from None
    with located(str(file)):
        return robot_from(model)
