"""Robots as TOML or JSON."""

from __future__ import annotations

import math
from dataclasses import asdict, fields
from typing import Annotated, Literal

from pydantic import Field

from optplan.domain.errors import InputError, located
from optplan.domain.robot import Arm, Boom, Canvas, DiffDrive, Gantry, Mobility, Robot, Supplies, Tool, ToolSetting
from optplan.schema.base import (
    VERSION,
    Acceleration,
    Duration,
    Energy,
    Flow,
    Length,
    Model,
    PerArea,
    Power,
    Rate,
    RateChange,
    Sharpness,
    Speed,
    Volume,
)


class ToolSettingModel(Model):
    """One way of holding the tool."""

    name: str = Field(min_length=1)
    width: Length = Field(description="width of the mark; 0 for the raised tool, which comes first")
    code: int = Field(0, ge=0, le=127, description="the number a controller knows it by")
    up_to: float | None = Field(None, gt=0, description="widest stroke, in drawing units, that it draws")


class ToolModel(Model):
    """What touches the surface."""

    settings: tuple[ToolSettingModel, ...] = Field(min_length=2)
    right: Length = 0.0
    ahead: Length = 0.0
    red_is_travel: bool = False
    green_is_start: bool = False
    fill: str | None = Field(None, description="name of the setting that fills areas; without it, the widest")
    on_delay: Duration = Field(0.0, description="from the command until the tool marks")
    off_delay: Duration = Field(0.0, description="from the command until it no longer does")


class DiffDriveModel(Model):
    """Two driven wheels."""

    kind: Literal["diff-drive"] = "diff-drive"
    track: Length
    wheel_radius: Length
    wheel_speed: Rate
    wheel_acceleration: RateChange
    work_speed: Speed
    transit_speed: Speed
    turns_on_spot: bool = False
    turn_rate: Rate = 1.0
    radius: Length = Field(0.0, description="chosen least turning radius; 0 leaves what the wheels allow")
    sharpness: Sharpness | None = Field(None, description="chosen limit of dkappa/ds")
    lateral_acceleration: Acceleration | None = Field(None, description="limit of v^2 |kappa|; none without it")
    reverses: bool = Field(False, description="whether it may drive backwards")


class GantryModel(Model):
    """Two axes moving at once."""

    kind: Literal["gantry"] = "gantry"
    work_speed: Speed
    transit_speed: Speed
    acceleration: Acceleration


class BoomModel(Model):
    """A boom lift."""

    kind: Literal["boom"] = "boom"
    speeds: tuple[Speed, Speed, Speed] = Field(description="across the wall, up the wall, away from it")
    acceleration: Acceleration
    reach: Length = Field(description="of the arm, from its foot")
    dwell: Duration
    standoff: Length = Field(0.0, description="of the arm's foot from the wall")
    flow: float | None = Field(None, ge=0, description="older place of the flow of `supplies`: water, l/s")


class ArmModel(Model):
    """An industrial arm."""

    kind: Literal["arm"] = "arm"
    work_speed: Speed
    transit_speed: Speed
    acceleration: Acceleration
    orientation_rate: Rate


class CanvasModel(Model):
    """Where drawings go."""

    width: Length
    height: Length
    margin: Length = 0.0


class SuppliesModel(Model):
    """What a robot uses up."""

    name: str = Field("", description="of what the tool gives: paint, water")
    per_area: PerArea = Field(0.0, description="of it for the marks, e.g. '0.13 L/m^2'")
    flow: Flow = Field(0.0, description="of it while the tool works, e.g. '6 L/min'")
    tank: Volume | None = Field(None, gt=0, description="of it on board")
    power: Power = Field(0.0, description="from the battery, on average")
    battery: Energy | None = Field(None, gt=0, description="of a full charge")


MobilityModel = Annotated[DiffDriveModel | GantryModel | BoomModel | ArmModel, Field(discriminator="kind")]


class RobotModel(Model):
    """A robot: a tool on a mobility."""

    version: str = VERSION
    name: str = Field(min_length=1)
    summary: str = ""
    tool: ToolModel
    mobility: MobilityModel
    canvas: CanvasModel | None = None
    supplies: SuppliesModel | None = None
    sources: dict[str, str] = Field(default_factory=dict, description="where each number comes from")


def robot_from(model: RobotModel) -> Robot:
    """The robot that a record describes. Raises InputError with the part that is wrong."""
    with located("tool"):
        tool = _tool_from(model.tool)
    with located("mobility"):
        parts = model.mobility.model_dump(exclude={"kind", "flow"}, exclude_none=True)
        kinds = {"diff-drive": DiffDrive, "gantry": Gantry, "boom": Boom, "arm": Arm}
        mobility = kinds[model.mobility.kind](**parts)
    with located("canvas"):
        canvas = None if model.canvas is None else Canvas(**model.canvas.model_dump())
    with located("supplies"):
        supplies = None if model.supplies is None else Supplies(**model.supplies.model_dump(exclude_none=True))
        older = model.mobility.flow if isinstance(model.mobility, BoomModel) else None
        if older and supplies is not None:
            raise InputError("the flow is here and in mobility; expected it here alone")
        if older:
            supplies = Supplies("water", flow=older / 1000)
    return Robot(model.name, model.summary, tool, mobility, canvas, tuple(model.sources.items()), supplies)


def _tool_from(model: ToolModel) -> Tool:
    settings = tuple(ToolSetting(item.name, item.width, item.code) for item in model.settings)
    names = [item.name for item in model.settings]
    limits = [item.up_to for item in model.settings[1:]]
    widths: tuple[float, ...] = ()
    if any(limit is not None for limit in limits):
        if limits[-1] is not None or any(limit is None for limit in limits[:-1]):
            raise InputError("settings: every marking setting but the last needs an up_to, or none of them")
        widths = tuple(limit for limit in limits if limit is not None)
    if model.fill is None:
        fill = max(range(1, len(settings)), key=lambda k: settings[k].width)
    elif model.fill in names[1:]:
        fill = names.index(model.fill)
    else:
        raise InputError(f"fill names {model.fill!r}; expected one of {', '.join(names[1:])}")
    return Tool(
        settings,
        model.right,
        model.ahead,
        widths,
        model.red_is_travel,
        model.green_is_start,
        fill,
        model.on_delay,
        model.off_delay,
    )


def robot_model(robot: Robot) -> RobotModel:
    """The record that describes a robot."""
    tool = robot.tool
    limits = [None, *tool.stroke_widths, *[None] * (len(tool.settings) - 1 - len(tool.stroke_widths))]
    settings = tuple(
        ToolSettingModel(name=item.name, width=item.width, code=item.code, up_to=limit)
        for item, limit in zip(tool.settings, limits, strict=True)
    )
    canvas = robot.canvas
    return RobotModel(
        name=robot.name,
        summary=robot.summary,
        tool=ToolModel(
            settings=settings,
            right=tool.right,
            ahead=tool.ahead,
            red_is_travel=tool.red_is_travel,
            green_is_start=tool.green_is_start,
            fill=tool.settings[tool.fill].name,
            on_delay=tool.on_delay,
            off_delay=tool.off_delay,
        ),
        mobility=_mobility_model(robot.mobility),
        canvas=None if canvas is None else CanvasModel(width=canvas.width, height=canvas.height, margin=canvas.margin),
        supplies=None if robot.supplies is None else _supplies_model(robot.supplies),
        sources=dict(robot.sources),
    )


def _supplies_model(supplies: Supplies) -> SuppliesModel:
    limits = {name: value for name, value in asdict(supplies).items() if value != math.inf}
    return SuppliesModel.model_validate(limits)


def _mobility_model(mobility: Mobility) -> DiffDriveModel | GantryModel | BoomModel | ArmModel:
    parts = {field.name: getattr(mobility, field.name) for field in fields(mobility)}
    match mobility:
        case DiffDrive():
            limits = {name: value for name, value in parts.items() if value != math.inf}
            return DiffDriveModel.model_validate(limits)
        case Gantry():
            return GantryModel.model_validate(parts)
        case Boom():
            return BoomModel.model_validate(parts)
        case Arm():
            return ArmModel.model_validate(parts)
