"""Jobs as JSON: drawing, field, facade, surface."""

from __future__ import annotations

from pathlib import Path as FilePath
from typing import Annotated, Literal

import numpy as np
from pydantic import Field as Entry

from optplan.domain.arrays import FloatArray
from optplan.domain.errors import InputError
from optplan.domain.job import (
    MOST_NORTH,
    Anchor,
    Curve,
    Drawing,
    Element,
    Facade,
    Field,
    FieldSegment,
    FillRule,
    FillSettings,
    Job,
    Surface,
    turned,
)
from optplan.schema.base import VERSION, Angle, Length, Model, Point, Point3, Whole
from optplan.schema.facades import FacadeModel, facade_from, facade_model
from optplan.schema.files import write_atomically
from optplan.schema.notes import NoteModel, note_models, notes_from
from optplan.schema.options import FillModel

Colour = Annotated[str, Entry(pattern="^#[0-9a-f]{6}$")]


class CurveModel(Model):
    """A chain of straight lines or cubic Beziers, in metres."""

    points: list[Point] = Entry(min_length=2)
    handles: list[tuple[Point, Point]] | None = Entry(None, description="inner control points of each segment")
    closed: bool = False


class ElementModel(Model):
    """One element of a drawing."""

    id: str = Entry(min_length=1)
    curves: list[CurveModel]
    stroke: Colour | None = None
    fill: Colour | None = None
    stroke_width: float = Entry(1.0, ge=0, description="drawing units")
    fill_rule: Literal["nonzero", "evenodd"] = "nonzero"
    fill_settings: FillModel = Entry(default_factory=FillModel)
    entry: Whole | None = None
    layer: str = ""


class DrawingModel(Model):
    """A drawing, in metres as printed on paper, y up."""

    version: str = VERSION
    kind: Literal["drawing"] = "drawing"
    name: str
    unit: float = Entry(0.0254 / 96, gt=0, description="metres of one drawing unit")
    page: Point | None = None
    elements: list[ElementModel]
    notes: list[NoteModel] = Entry(default_factory=list)


class SegmentModel(Model):
    """A line (start, end), an arc (start, center, sweep) or a spot (start, spot)."""

    id: str = Entry(min_length=1)
    start: tuple[Length, Length]
    end: tuple[Length, Length] | None = Entry(None, description="of a line; that of an arc follows from its sweep")
    center: tuple[Length, Length] | None = None
    sweep: Angle = Entry(0.0, description="of an arc, left positive; a bare number is degrees")
    spot: Length = Entry(0.0, ge=0, description="diameter of a spot, which has its middle at start")
    actuation: Literal["NONE", "PUMP", "VALVE", "SPRAY", "DISC", "ALL"] = "ALL"
    width: Length | None = Entry(None, gt=0, description="of the mark; default: the field's line width")
    passes: Whole = Entry(1, ge=1)
    directed: bool = Entry(False, description="mark it from start to end only")
    label: str = ""


class AnchorModel(Model):
    """Where on earth the origin lies (WGS 84), and where the y axis points."""

    latitude: float = Entry(ge=-MOST_NORTH, le=MOST_NORTH)
    longitude: float = Entry(ge=-180, le=180)
    bearing: float = Entry(0.0, ge=-360, le=360, description="degrees clockwise from north")


class FieldModel(Model):
    """A sports field, in metres, or in units that are given with the numbers."""

    version: str = VERSION
    kind: Literal["field"] = "field"
    name: str
    segments: list[SegmentModel] = Entry(min_length=1)
    keep_in: list[tuple[Length, Length]] | None = None
    keep_out: list[list[tuple[Length, Length]]] = Entry(default_factory=list)
    start: tuple[Length, Length] | None = Entry(None, description="where the robot stands")
    line_width: Length | None = Entry(None, gt=0, description="default: as wide as the tool")
    anchor: AnchorModel | None = None
    notes: list[NoteModel] = Entry(default_factory=list)


class SurfaceModel(Model):
    """A recorded surface, in metres."""

    version: str = VERSION
    kind: Literal["surface"] = "surface"
    name: str
    points: list[Point3] = Entry(min_length=3)
    tool_axes: list[Point3] | None = None
    disc_radius: Length = Entry(0.02, gt=0)
    notes: list[NoteModel] = Entry(default_factory=list)


JobModel = Annotated[DrawingModel | FieldModel | FacadeModel | SurfaceModel, Entry(discriminator="kind")]


def job_from(model: DrawingModel | FieldModel | FacadeModel | SurfaceModel) -> Job:
    """The job that a record describes. Raises InputError with the part that is wrong."""
    notes = notes_from(model.notes)
    match model:
        case DrawingModel():
            return Drawing(model.name, tuple(map(_element_from, model.elements)), model.unit, model.page, notes)
        case FieldModel():
            return Field(
                model.name,
                tuple(map(_segment, model.segments)),
                _maybe(model.keep_in),
                tuple(map(_array, model.keep_out)),
                notes,
                model.start,
                model.line_width,
                None if model.anchor is None else Anchor(**model.anchor.model_dump()),
            )
        case FacadeModel():
            return facade_from(model)
        case SurfaceModel():
            return Surface(model.name, _array(model.points), _maybe(model.tool_axes), model.disc_radius, notes)


def _element_from(model: ElementModel) -> Element:
    curves = tuple(Curve(_array(c.points), _maybe(c.handles), c.closed) for c in model.curves)
    fill = FillSettings(**model.fill_settings.model_dump())
    rule = FillRule(model.fill_rule)
    return Element(model.id, curves, model.stroke, model.fill, model.stroke_width, rule, fill, model.entry, model.layer)


def job_model(job: Job) -> DrawingModel | FieldModel | FacadeModel | SurfaceModel:
    """The record that describes a job."""
    match job:
        case Drawing():
            elements = [_element_model(element) for element in job.elements]
            return DrawingModel(
                name=job.name, unit=job.unit, page=job.page, elements=elements, notes=note_models(job.notes)
            )
        case Field():
            return _field_model(job)
        case Facade():
            return facade_model(job)
        case Surface():
            return SurfaceModel.model_validate(
                {
                    "name": job.name,
                    "points": job.points.tolist(),
                    "tool_axes": None if job.tool_axes is None else job.tool_axes.tolist(),
                    "disc_radius": job.disc_radius,
                    "notes": note_models(job.notes),
                }
            )


def save_job(job: Job, file: str | FilePath, *, overwrite: bool = False) -> None:
    """Write a job as JSON, as a whole or not at all. Raises InputError: it exists, or it cannot be written."""
    text = job_model(job).model_dump_json(exclude_none=True, indent=1) + "\n"
    write_atomically(FilePath(file), text, overwrite=overwrite)


def _field_model(job: Field) -> FieldModel:
    segments = [
        {
            "id": s.id,
            "start": s.start.tolist(),
            "end": s.end.tolist() if s.spot == 0 else None,
            "center": None if s.center is None else s.center.tolist(),
            "sweep": f"{s.sweep!r} rad",
            "spot": s.spot,
            "actuation": s.actuation,
            "width": s.width,
            "passes": s.passes,
            "directed": s.directed,
            "label": s.label,
        }
        for s in job.segments
    ]
    return FieldModel.model_validate(
        {
            "name": job.name,
            "segments": segments,
            "keep_in": None if job.keep_in is None else job.keep_in.tolist(),
            "keep_out": [ring.tolist() for ring in job.keep_out],
            "start": job.start,
            "line_width": job.line_width,
            "anchor": None if job.anchor is None else job.anchor._asdict(),
            "notes": note_models(job.notes),
        }
    )


def _segment(model: SegmentModel) -> FieldSegment:
    start = _array(model.start)
    if model.end is not None:
        end = _array(model.end)
    elif model.center is not None:
        end = turned(start, _array(model.center), model.sweep)
    elif model.spot > 0:
        end = start
    else:
        raise InputError(f"segment {model.id!r} has no end; expected that of a line, a centre, or the size of a spot")
    rest = model.model_dump(include={"sweep", "spot", "actuation", "width", "passes", "directed", "label"})
    return FieldSegment(model.id, start, end, _maybe(model.center), **rest)


def _element_model(element: Element) -> ElementModel:
    fill = element.fill_settings
    curves = [
        CurveModel(
            points=curve.points.tolist(),
            handles=None if curve.handles is None else curve.handles.tolist(),
            closed=curve.closed,
        )
        for curve in element.curves
    ]
    direction = None if fill.direction is None else f"{fill.direction!r} rad"
    return ElementModel(
        id=element.id,
        curves=curves,
        stroke=element.stroke,
        fill=element.fill,
        stroke_width=element.stroke_width,
        fill_rule=element.fill_rule.value,
        fill_settings=FillModel.model_validate({"direction": direction, "spacing": fill.spacing, "inset": fill.inset}),
        entry=element.entry,
        layer=element.layer,
    )


def _array(values: object) -> FloatArray:
    return np.array(values, dtype=np.float64)


def _maybe(values: object | None) -> FloatArray | None:
    return None if values is None else _array(values)
