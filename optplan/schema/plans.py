"""Plans as JSON: one versioned file from the job to the report, later sections absent in earlier stages."""

from __future__ import annotations

import math
from pathlib import Path as FilePath
from typing import Any, Literal

import numpy as np
from pydantic import Field as Entry
from pydantic import ValidationError

from optplan.domain.arrays import FloatArray
from optplan.domain.errors import InputError, located
from optplan.domain.ordering import Ordering, Status, TracePoint
from optplan.domain.path import Path, Trajectory
from optplan.domain.report import Check, Report, Verdict
from optplan.domain.result import Area, Cover, Plan
from optplan.domain.robot import Canvas
from optplan.domain.stop import StopReason
from optplan.domain.stroke import Stroke, Traversals
from optplan.schema.base import VERSION, Model, Point, Point3, Whole, check_version, fault, parse_json
from optplan.schema.files import read_bytes, write_atomically
from optplan.schema.jobs import JobModel, job_from, job_model
from optplan.schema.notes import NoteModel, note_models, notes_from
from optplan.schema.options import OptionsModel, options_from, options_model
from optplan.schema.robots import CanvasModel, RobotModel, robot_from, robot_model

State = tuple[float, float, float, float, float]
Quaternion = tuple[float, float, float, float]


class StrokeModel(Model):
    """A stroke, in metres."""

    id: str
    points: list[Point] | list[Point3]
    tool: Whole = 1
    closed: bool = False
    normals: list[Point3] | None = None
    dwell: float = 0.0
    directed: bool = False
    entry: Whole | None = None
    element: str = ""
    layer: str = ""
    bends: list[float] | None = Entry(None, description="curvature from each point to the next, 1/m, left positive")
    headings: Whole = Entry(1, ge=1, description="of a spot: how many directions it may be driven in")


class AreaModel(Model):
    """An area to fill: rings by the even-odd rule."""

    element: str
    rings: list[list[Point]]
    tool: Whole


KINDS = ("drawing", "field", "facade", "surface")
"""Of jobs."""


class CoverModel(Model):
    """Strokes and what they have to look like."""

    strokes: list[StrokeModel]
    areas: list[AreaModel] = Entry(default_factory=list)
    precedence: list[tuple[Whole, Whole]] = Entry(default_factory=list)
    links: list[tuple[Whole, Whole, Whole, Whole]] = Entry(default_factory=list)
    radii: list[float] = Entry(default_factory=list, description="of the circle that each stop washes")
    start: Point | None = None
    canvas: CanvasModel | None = None
    notes: list[NoteModel] = Entry(default_factory=list)
    elsewhere: list[StrokeModel] = Entry(default_factory=list, description="strokes of the job that other plans do")


class OrderingModel(Model):
    """The solver's answer. `cost` is absent when none was found, `bound` when nothing was proved."""

    nodes: list[Whole]
    cost: float | None = None
    bound: float | None = None
    status: Status
    stopped: StopReason
    solver: str
    seed: Whole = 0
    seconds: float = 0.0
    iterations: int = 0
    message: str = ""
    trace: list[tuple[float, float | None, float | None]] = Entry(default_factory=list)
    unit: Literal["m", "s"] = Entry("m", description="of cost and bound")


class VisitsModel(Model):
    """The chosen traversals in driving order, a column a property."""

    stroke: list[Whole]
    entry_vertex: list[Whole]
    reverse: list[bool]
    entry: list[State] = Entry(description="x, y, z, heading, curvature")
    exit: list[State]
    length: list[float]
    duration: list[float]


class PathModel(Model):
    """Pieces in driving order, a column a property; absent columns are zero."""

    start: list[Point3]
    heading: list[float]
    elevation: list[float] | None = None
    curvature: list[float] | None = None
    sharpness: list[float] | None = None
    length: list[float]
    turn: list[float] | None = None
    dwell: list[float] | None = None
    tool: list[Whole]
    stroke: list[Whole]
    orientation: list[tuple[Quaternion, Quaternion]] | None = None
    gear: list[Literal[1, -1]] | None = Entry(
        None, min_length=1, description="1 forwards, -1 backwards; absent: all forwards"
    )


class TrajectoryModel(Model):
    """Knots of the speed profile along the path."""

    s: list[float]
    t: list[float]
    v: list[float]


class CheckModel(Model):
    """One finding of the judge."""

    name: str
    verdict: Verdict
    value: float | None = None
    limit: float | None = None
    unit: str = ""
    place: Point | None = None
    detail: str = ""


class ReportModel(Model):
    """The judge's findings; figures are name, value, unit."""

    checks: list[CheckModel]
    figures: list[tuple[str, float | None, str]]


class PlanModel(Model):
    """A plan."""

    format: Literal["optplan plan"] = "optplan plan"
    version: str = VERSION
    made_by: str = ""
    job: JobModel
    robot: RobotModel
    options: OptionsModel
    cover: CoverModel | None = None
    ordering: OrderingModel | None = None
    visits: VisitsModel | None = None
    path: PathModel | None = None
    trajectory: TrajectoryModel | None = None
    report: ReportModel | None = None


def save_plan(plan: Plan, file: str | FilePath, *, overwrite: bool = False) -> None:
    """Write a plan as JSON, as a whole or not at all.

    Raises
    ------
    InputError : the file exists and `overwrite` was not asked, or it cannot be written
    """
    write_atomically(FilePath(file), plan_json(plan), overwrite=overwrite)


def plan_json(plan: Plan) -> str:
    """A plan as JSON text."""
    return plan_model(plan).model_dump_json(exclude_none=True) + "\n"


def load_plan(file: str | FilePath) -> Plan:
    """Read a plan.

    Raises
    ------
    InputError : not a plan of a version that this program reads, or one that contradicts itself
    """
    where = str(file)
    return plan_from_json(read_bytes(FilePath(file)), where)


def plan_from_json(text: str | bytes, where: str = "plan") -> Plan:
    """A plan from JSON text; raises like `load_plan`."""
    data = parse_json(text, where)
    if isinstance(data, dict) and "job" not in data and data.get("kind") in KINDS:
        raise InputError(f"is a {data['kind']}, expected a plan; say optplan plan to make one", where)
    check_version(data, where)
    try:
        model = PlanModel.model_validate(data)
    except ValidationError as error:
        raise fault(error, where) from None
    with located(where):
        return plan_from(model)


def plan_model(plan: Plan) -> PlanModel:
    """The record that describes a plan."""
    from optplan import __version__

    return PlanModel(
        made_by=f"optplan {__version__}",
        job=job_model(plan.job),
        robot=robot_model(plan.robot),
        options=options_model(plan.options),
        cover=None if plan.cover is None else _cover_model(plan.cover),
        ordering=None if plan.ordering is None else _ordering_model(plan.ordering),
        visits=None if plan.visits is None else _visits_model(plan.visits),
        path=None if plan.path is None else _path_model(plan.path),
        trajectory=None if plan.trajectory is None else _trajectory_model(plan.trajectory),
        report=None if plan.report is None else _report_model(plan.report),
    )


def plan_from(model: PlanModel) -> Plan:
    """The plan that a record describes. Raises InputError when its sections do not fit together."""
    job, robot, options = job_from(model.job), robot_from(model.robot), options_from(model.options)
    with located("cover"):
        cover = None if model.cover is None else _cover_from(model.cover)
    with located("ordering"):
        ordering = None if model.ordering is None else _ordering_from(model.ordering)
    with located("visits"):
        visits = None if model.visits is None else _visits_from(model.visits)
    with located("path"):
        path = None if model.path is None else _path_from(model.path)
    with located("trajectory"):
        if model.trajectory is not None and path is None:
            raise InputError("there is a speed profile without a path")
        trajectory = (
            None
            if model.trajectory is None or path is None
            else Trajectory(path, *(_array(column) for _, column in model.trajectory))
        )
    report = None if model.report is None else _report_from(model.report)
    plan = Plan(job, robot, options, cover, ordering, visits, path, trajectory, report)
    _check_references(plan)
    return plan


def _check_references(plan: Plan) -> None:
    strokes = 0 if plan.cover is None else len(plan.cover.strokes)
    settings = len(plan.robot.tool.settings)
    columns: list[tuple[str, object, int, int]] = []  # name, values, least, how many there are
    if plan.visits is not None:
        columns.append(("visits.stroke", plan.visits.stroke, 0, strokes))
    if plan.path is not None:
        columns += [("path.stroke", plan.path.stroke, -1, strokes), ("path.tool", plan.path.tool, 0, settings)]
    if plan.cover is not None:
        columns.append(("cover.strokes.tool", [stroke.tool for stroke in plan.cover.strokes], 0, settings))
        columns.append(("cover.elsewhere.tool", [stroke.tool for stroke in plan.cover.elsewhere], 0, settings))
        columns.append(("cover.precedence", plan.cover.precedence, 0, strokes))
        columns.append(("cover.links", [(a, b) for a, _, b, _ in plan.cover.links], 0, strokes))
        columns.append(("cover.areas.tool", [area.tool for area in plan.cover.areas], 0, settings))
    for name, values, least, count in columns:
        numbers = np.asarray(values, dtype=np.int64).ravel()
        wrong = numbers[(numbers < least) | (numbers >= count)]
        if len(wrong):
            raise InputError(f"{name} names {wrong[0]}; expected {least}..{count - 1}")
    if plan.visits is not None and plan.cover is not None:
        for stroke, vertex in zip(plan.visits.stroke.tolist(), plan.visits.entry_vertex.tolist(), strict=True):
            if not (stroke >= 0 and 0 <= vertex < _entries(plan.cover.strokes[stroke])):
                raise InputError(f"visits enter stroke {stroke} at vertex {vertex}, which it does not have")


def _stroke_model(stroke: Stroke) -> StrokeModel:
    return StrokeModel(
        id=stroke.id,
        points=stroke.points.tolist(),
        tool=stroke.tool,
        closed=stroke.closed,
        normals=None if stroke.normals is None else stroke.normals.tolist(),
        dwell=stroke.dwell,
        directed=stroke.directed,
        entry=stroke.entry,
        element=stroke.element,
        layer=stroke.layer,
        bends=None if stroke.bends is None else stroke.bends.tolist(),
        headings=stroke.headings,
    )


def _stroke_from(model: StrokeModel) -> Stroke:
    return Stroke(
        model.id,
        _array(model.points),
        model.tool,
        model.closed,
        None if model.normals is None else _array(model.normals),
        model.dwell,
        model.directed,
        model.entry,
        model.element,
        model.layer,
        None if model.bends is None else _array(model.bends),
        model.headings,
    )


def _cover_model(cover: Cover) -> CoverModel:
    areas = [AreaModel(element=a.element, rings=[ring.tolist() for ring in a.rings], tool=a.tool) for a in cover.areas]
    canvas = cover.canvas
    return CoverModel(
        strokes=list(map(_stroke_model, cover.strokes)),
        areas=areas,
        precedence=list(cover.precedence),
        links=list(cover.links),
        radii=list(cover.radii),
        start=cover.start,
        canvas=None if canvas is None else CanvasModel(width=canvas.width, height=canvas.height, margin=canvas.margin),
        notes=note_models(cover.notes),
        elsewhere=list(map(_stroke_model, cover.elsewhere)),
    )


def _cover_from(model: CoverModel) -> Cover:
    areas = tuple(Area(a.element, tuple(map(_array, a.rings)), a.tool) for a in model.areas)
    canvas = None if model.canvas is None else Canvas(**model.canvas.model_dump())
    return Cover(
        tuple(map(_stroke_from, model.strokes)),
        areas,
        tuple(model.precedence),
        model.start,
        canvas,
        notes_from(model.notes),
        tuple(model.links),
        tuple(model.radii),
        tuple(map(_stroke_from, model.elsewhere)),
    )


def _entries(stroke: Stroke) -> int:
    """How many vertices, or directions of a spot, there are to enter a stroke."""
    return stroke.headings if stroke.headings > 1 else len(stroke.points)


def _ordering_model(ordering: Ordering) -> OrderingModel:
    return OrderingModel(
        nodes=ordering.nodes.tolist(),
        cost=_finite(ordering.cost),
        bound=_finite(ordering.bound),
        status=ordering.status,
        stopped=ordering.stopped,
        solver=ordering.solver,
        seed=ordering.seed,
        seconds=ordering.seconds,
        iterations=ordering.iterations,
        message=ordering.message,
        trace=[(p.seconds, _finite(p.cost), _finite(p.bound)) for p in ordering.trace],
        unit="s" if ordering.unit == "s" else "m",
    )


def _ordering_from(model: OrderingModel) -> Ordering:
    return Ordering(
        np.array(model.nodes),
        math.inf if model.cost is None else model.cost,
        _bound(model),
        model.status,
        model.stopped,
        model.solver,
        model.seed,
        model.seconds,
        model.iterations,
        model.message,
        tuple(
            TracePoint(s, math.inf if cost is None else cost, -math.inf if bound is None else bound)
            for s, cost, bound in model.trace
        ),
        model.unit,
    )


def _bound(model: OrderingModel) -> float:
    if model.bound is None:  # JSON has no infinity: a proof that there is no order, or no proof of anything
        return math.inf if model.status is Status.INFEASIBLE else -math.inf
    return model.bound


def _visits_model(visits: Traversals) -> VisitsModel:
    return VisitsModel.model_validate({name: getattr(visits, name).tolist() for name in VisitsModel.model_fields})


def _visits_from(model: VisitsModel) -> Traversals:
    columns: dict[str, Any] = {name: np.array(value) for name, value in model}
    for name in ("entry", "exit"):
        columns[name] = columns[name].reshape(-1, 5)
    return Traversals(**columns)


_OFTEN_ZERO = ("elevation", "curvature", "sharpness", "turn", "dwell")


def _path_model(path: Path) -> PathModel:
    columns = {name: getattr(path, name) for name in PathModel.model_fields if name != "orientation"}
    written = {k: None if k in _OFTEN_ZERO and not v.any() else v.tolist() for k, v in columns.items()}
    if (path.gear > 0).all():
        written["gear"] = None
    written["orientation"] = None if path.orientation is None else path.orientation.tolist()
    return PathModel.model_validate(written)


def _path_from(model: PathModel) -> Path:
    columns = {name: value for name, value in model if name not in ("orientation", "gear")}
    zero = np.zeros(len(model.length))
    arrays: dict[str, Any] = {name: zero if value is None else _array(value) for name, value in columns.items()}
    arrays["start"] = arrays["start"].reshape(-1, 3)
    if model.gear is not None:
        arrays["gear"] = np.array(model.gear)
    return Path(**arrays, orientation=None if model.orientation is None else _array(model.orientation))


def _trajectory_model(trajectory: Trajectory) -> TrajectoryModel:
    return TrajectoryModel(s=trajectory.s.tolist(), t=trajectory.t.tolist(), v=trajectory.v.tolist())


def _report_model(report: Report) -> ReportModel:
    checks = [
        CheckModel(
            name=c.name,
            verdict=c.verdict,
            value=_finite(c.value),
            limit=c.limit if c.limit is None else _finite(c.limit),
            unit=c.unit,
            place=c.place,
            detail=c.detail,
        )
        for c in report.checks
    ]
    return ReportModel(checks=checks, figures=[(name, _finite(value), unit) for name, value, unit in report.figures])


def _report_from(model: ReportModel) -> Report:
    checks = tuple(
        Check(c.name, c.verdict, math.inf if c.value is None else c.value, c.limit, c.unit, c.place, c.detail)
        for c in model.checks
    )
    return Report(checks, tuple((name, math.inf if v is None else v, unit) for name, v, unit in model.figures))


def _finite(value: float) -> float | None:
    return value if math.isfinite(value) else None


def _array(values: object) -> FloatArray:
    return np.array(values)
