"""Options as TOML or JSON."""

from __future__ import annotations

import math
from dataclasses import asdict

from pydantic import Field

from optplan.domain.errors import located
from optplan.domain.job import FillSettings
from optplan.domain.options import ConnectOptions, CoverOptions, Options, OrderOptions, PageOptions, TimeOptions
from optplan.domain.washing import WashOptions
from optplan.schema.base import Angle, Duration, Jerk, Length, Model, SpecificPower, Speed


class PageModel(Model):
    """How a drawing is put on its canvas."""

    width: Length | None = Field(None, description="of the canvas; default: the robot's")
    height: Length | None = Field(None, description="of the canvas; default: the robot's")
    margin: Length | None = Field(None, description="nothing is placed closer to the border; default: the robot's")
    tolerance: Length | None = Field(None, description="between a drawn curve and its polyline; default: mark / 20")


class FillModel(Model):
    """How one area is filled."""

    direction: Angle | None = None
    spacing: Length | None = None
    inset: Length | None = None


class CoverModel(Model):
    """How areas are filled."""

    direction: Angle = Field(0.0, description="of the fill lines from the x axis; a bare number is degrees")
    spacing: Length | None = Field(None, description="between fill lines; default: the width of the fill tool")
    inset: Length | None = Field(None, description="of the lines from the outline; default: what fits the boundary")
    boundary: bool = Field(True, description="drive the outline too, half a tool width inside")
    elements: dict[str, FillModel] = Field(default_factory=dict, description="settings of single elements, by id")
    inner_first: bool = Field(False, description="drive whatever a closed line encloses before it")
    links: list[tuple[str, int, str, int]] = Field(
        default_factory=list, description="enforced connections: stroke, drawn vertex (-1: the last), stroke, vertex"
    )
    cut: bool = Field(True, description="lines of a field may be left and entered where others meet them")
    headings: int = Field(8, ge=1, le=360, description="directions in which a spot of a field may be driven")


class OrderModel(Model):
    """How strokes are ordered."""

    solver: str = "auto"
    metric: str = Field("auto", description="euclid, dubins, cc, time or auto")
    seconds: Duration | None = Field(None, description="time limit")
    iterations: int | None = Field(None, ge=0, description="iteration limit: with a seed a repeatable plan")
    seed: int = Field(0, ge=0, lt=2**31)
    start: tuple[Length, Length] | None = Field(None, description="where the robot stands")
    heading: Angle | None = Field(None, description="where it faces there; free without it")
    drying: Duration | None = Field(None, description="after it finished work may be driven over; never without it")
    entries: int | None = Field(None, ge=1, description="most vertices at which a closed stroke may be entered")
    avoid: float = Field(0.0, ge=0, description="metres worth a metre not driven over finished work")
    keep: str = Field("nothing", description="of the job: nothing, its order, or all: order and directions")
    refill: Length | None = Field(None, description="marks that a tank lasts; it is filled again at the start point")
    refill_time: Duration = Field(120.0, ge=0, description="that filling takes")


class ConnectModel(Model):
    """How strokes are driven and joined."""

    corner: Angle = Field(math.radians(30), description="a sharper vertex is a corner; a bare number is degrees")
    keep_out: list[list[tuple[Length, Length]]] = Field(
        default_factory=list, description="polygons that connectors do not enter"
    )
    keep_in: list[tuple[Length, Length]] | None = Field(None, description="a polygon that connectors do not leave")
    on_canvas: bool = Field(False, description="connectors stay on the canvas")
    clearance: Length = Field(0.0, description="between connectors and the borders of these areas")
    reversing: bool = Field(False, description="connectors may be driven backwards, by a robot that can")
    pad_before: Length = Field(0.0, ge=0, description="driven with the tool up before each stroke, to compare with")
    pad_after: Length = Field(0.0, ge=0, description="and after each")
    curved_padding: bool = Field(False, description="padding goes on with the curvature of the stroke's end")


class TimeModel(Model):
    """Speeds."""

    work_speed: Speed | None = None
    transit_speed: Speed | None = None
    jerk: Jerk | None = Field(None, description="limit of the change of the acceleration along the path")
    power: SpecificPower | None = Field(None, description="limit of acceleration times speed")
    constant_speed: Speed | None = Field(None, description="one speed everywhere, to compare with")


class WashModel(Model):
    """How a facade is washed."""

    pattern: str = Field("best", description="hexagon, square, brick, stretched or best")
    fewest: str = Field("exact", description="pattern, minimal or exact: which circles are left out")
    turned: bool = Field(False, description="patterns may be turned: fewer circles, but no level rows")
    effort: Duration = Field(5.0, description="for the exact model of the fewest circles")
    tolerance: Length = Field(0.0, description="the cover stays complete when every stop is off by up to this")
    rule: str = Field("overlap", description="overlap, rows or none: which stops come before which")
    direction: str = Field("up", description="up or down")
    tau: float | None = Field(None, description="of the rule, in radii; default: the job's")
    width: float | None = Field(None, description="of the rule, in radii; default: the job's")
    horizontal: float = Field(1.0, description="weight of horizontal metres in the order")
    travel: str = Field("straight", description="straight, around or lift: how no-go areas are passed")
    lift: Length = Field(1.0, description="beyond the stand-off, where no-go areas are passed by lifting")


class OptionsModel(Model):
    """All settings of a plan, a table for each stage."""

    page: PageModel = Field(default_factory=PageModel)
    cover: CoverModel = Field(default_factory=CoverModel)
    order: OrderModel = Field(default_factory=OrderModel)
    connect: ConnectModel = Field(default_factory=ConnectModel)
    time: TimeModel = Field(default_factory=TimeModel)
    wash: WashModel = Field(default_factory=WashModel)


def options_from(model: OptionsModel) -> Options:
    """The options that a record describes. Raises InputError with the setting that is wrong."""
    cover = model.cover
    elements = tuple((id, FillSettings(**fill.model_dump())) for id, fill in cover.elements.items())
    with located("options"):
        return Options(
            PageOptions(**model.page.model_dump()),
            CoverOptions(
                cover.direction,
                cover.spacing,
                cover.inset,
                cover.boundary,
                elements,
                cover.inner_first,
                tuple(cover.links),
                cover.cut,
                cover.headings,
            ),
            OrderOptions(**model.order.model_dump()),
            ConnectOptions(
                model.connect.corner,
                tuple(tuple(ring) for ring in model.connect.keep_out),
                None if model.connect.keep_in is None else tuple(model.connect.keep_in),
                model.connect.on_canvas,
                model.connect.clearance,
                model.connect.reversing,
                model.connect.pad_before,
                model.connect.pad_after,
                model.connect.curved_padding,
            ),
            TimeOptions(**model.time.model_dump()),
            WashOptions(**model.wash.model_dump()),
        )


def options_model(options: Options) -> OptionsModel:
    """The record that describes options; angles carry their unit, as a bare number would mean degrees."""
    cover, heading = asdict(options.cover), options.order.heading
    cover["direction"] = f"{options.cover.direction!r} rad"
    cover["elements"] = {
        id: {**asdict(fill), "direction": None if fill.direction is None else f"{fill.direction!r} rad"}
        for id, fill in options.cover.elements
    }
    return OptionsModel.model_validate(
        {
            "page": asdict(options.page),
            "cover": cover,
            "order": {**asdict(options.order), "heading": None if heading is None else f"{heading!r} rad"},
            "connect": {**asdict(options.connect), "corner": f"{options.connect.corner!r} rad"},
            "time": asdict(options.time),
            "wash": asdict(options.wash),
        }
    )
