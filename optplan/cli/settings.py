"""Settings: defaults, then a configuration file, then flags; the later ones win."""

from __future__ import annotations

import re
from pathlib import Path
from typing import TYPE_CHECKING, Annotated, Any

import typer

from optplan.domain.errors import InputError, located

if TYPE_CHECKING:
    from optplan.domain.job import Job
    from optplan.domain.options import Options

CONFIG = Path("optplan.toml")
"""Configuration file that is read from the current folder when there is one."""

PlanFile = Annotated[Path, typer.Argument(help="A plan file (plan.json).", show_default=False)]
Json = Annotated[bool, typer.Option("--json", help="Print JSON for machines.")]
Force = Annotated[bool, typer.Option("--force", "-f", help="Replace files that exist.")]
Quiet = Annotated[bool, typer.Option("--quiet", "-q", help="No progress bar.")]
OutFile = Annotated[Path | None, typer.Option("--output", "-o", help="File to write.", show_default=False)]

RobotName = Annotated[str | None, typer.Option("--robot", "-r", help="Preset or robot file (.toml, .json).")]
ConfigFile = Annotated[Path | None, typer.Option("--config", "-c", help="Settings file; default: ./optplan.toml.")]
CloseGap = Annotated[
    float | None,
    typer.Option(help="Close lines whose ends are nearer than this, drawing units."),
]
CanvasSize = Annotated[str | None, typer.Option("--canvas", help="Canvas, e.g. 20x15 or '5 m x 400 cm'.")]
Margin = Annotated[str | None, typer.Option(help="Kept free along the border, e.g. 50cm.")]
Tolerance = Annotated[str | None, typer.Option(help="Greatest distance from a drawn curve, e.g. 2mm.")]
Direction = Annotated[str | None, typer.Option(help="Direction of fill lines, degrees.")]
Spacing = Annotated[str | None, typer.Option(help="Between fill lines, e.g. 40cm.")]
Inset = Annotated[str | None, typer.Option(help="Of fill lines from the outline.")]
Boundary = Annotated[
    bool | None,
    typer.Option("--boundary/--no-boundary", help="Drive the inset outline of areas too."),
]
ElementFill = Annotated[
    list[str] | None,
    typer.Option("--fill", help="Fill of one element: 'ID:direction=45,spacing=30cm,inset=10cm'. Repeatable."),
]
InnerFirst = Annotated[
    bool | None, typer.Option("--inner-first/--any-order", help="Drive what a closed line encloses before it.")
]
Links = Annotated[
    list[str] | None,
    typer.Option("--link", help="Join two strokes at drawn vertices: 'ID:0,ID:-1' (-1: the last). Repeatable."),
]
Cut = Annotated[
    bool | None, typer.Option("--cut/--whole", help="Lines of a field may be left where others meet them, or not.")
]
SpotHeadings = Annotated[int | None, typer.Option("--headings", help="Directions in which a spot may be driven.")]
Keep = Annotated[str | None, typer.Option(help="Of the job: nothing, order, or all (order and directions).")]
Refill = Annotated[
    str | None, typer.Option(help="Marks that a tank lasts, e.g. 1500m: stops at the start point to fill it again.")
]
EntryVertex = Annotated[
    list[str] | None, typer.Option("--entry", help="Enter an element at a drawn vertex: 'ID:3'. Repeatable.")
]
SolverName = Annotated[str | None, typer.Option("--solver", "-s", help="See: optplan solvers.")]
Metric = Annotated[str | None, typer.Option(help="euclid, dubins, cc, time or auto.")]
TimeLimit = Annotated[str | None, typer.Option(help="For ordering, e.g. 10s or 2min.")]
Iterations = Annotated[int | None, typer.Option(help="Limit of ordering; with a seed repeatable.")]
Seed = Annotated[int | None, typer.Option(help="Of everything random.")]
Start = Annotated[str | None, typer.Option(help="Where the robot stands: X,Y or X,Y,HEADING (m, degrees).")]
Entries = Annotated[int | None, typer.Option(help="Most entry vertices of a closed stroke.")]
Avoid = Annotated[
    float | None, typer.Option("--avoid-finished", help="Metres worth a metre not driven over finished work.")
]
Drying = Annotated[str | None, typer.Option(help="Time after which finished work may be driven over, e.g. 10min.")]
Corner = Annotated[str | None, typer.Option(help="Sharper vertices are corners, degrees.")]
Areas = Annotated[
    Path | None,
    typer.Option("--areas", help="JSON file with polygons for connectors: keep_out, keep_in, clearance."),
]
OnCanvas = Annotated[
    bool | None, typer.Option("--on-canvas/--off-canvas", help="Connectors stay on the canvas, or may leave it.")
]
Clearance = Annotated[str | None, typer.Option(help="Of connectors from areas and border, e.g. 30cm.")]
Reversing = Annotated[
    bool | None,
    typer.Option("--reversing/--forwards", help="Connectors may be driven backwards, by a robot that can."),
]
Padding = Annotated[
    str | None,
    typer.Option(help="Driven before and after strokes with the tool up, to compare: 50cm or 50cm,10cm."),
]
CurvedPadding = Annotated[
    bool | None,
    typer.Option("--curved-padding/--straight-padding", help="Padding is bent like the stroke's end."),
]
WorkSpeed = Annotated[str | None, typer.Option(help="With the tool down, m/s.")]
TransitSpeed = Annotated[str | None, typer.Option(help="With the tool up, m/s.")]
JerkLimit = Annotated[str | None, typer.Option("--jerk", help="Limit of the acceleration's change, m/s^3.")]
PowerLimit = Annotated[str | None, typer.Option("--power", help="Limit of acceleration times speed, W/kg.")]
ConstantSpeed = Annotated[
    str | None, typer.Option("--constant-speed", help="One speed everywhere, m/s: to compare with older planners.")
]

LengthUnit = Annotated[
    str, typer.Option("--units", help="Of lengths in what people read (report, schedule, pdf): m, ft or yd.")
]

Kind = Annotated[str | None, typer.Option("--as", help="What the file is: drawing or facade (an SVG may be both).")]
Unit = Annotated[str | None, typer.Option("--unit", help="One unit of a facade's drawing, e.g. 1cm; default: 1m.")]
Pattern = Annotated[str | None, typer.Option(help="Of washing circles: hexagon, square, brick, stretched or best.")]
Fewest = Annotated[str | None, typer.Option(help="Circles left out: pattern (useless ones), minimal or exact.")]
Turned = Annotated[bool | None, typer.Option("--turned/--level", help="Patterns may be turned, or rows are level.")]
Placement = Annotated[
    str | None, typer.Option("--placement", help="The cover stays complete though stops are off by this, e.g. 10cm.")
]
Rule = Annotated[str | None, typer.Option(help="Of the order of stops: overlap, rows or none.")]
Water = Annotated[str | None, typer.Option("--water", help="Facades are washed up or down: bottom to top or not.")]
Horizontal = Annotated[float | None, typer.Option(help="Weight of horizontal metres between stops.")]
Travel = Annotated[str | None, typer.Option(help="Past no-go areas: straight, around or lift.")]
Lift = Annotated[str | None, typer.Option(help="How far from the wall it passes them, beyond the stand-off.")]

Tracker = Annotated[str, typer.Option(help="path-frame or pure-pursuit.")]
Ideal = Annotated[bool, typer.Option("--ideal", help="No lag, no slip, no noise.")]
Lag = Annotated[str | None, typer.Option(help="Time constant of a wheel's speed, e.g. 50ms.")]
Mass = Annotated[float | None, typer.Option(help="Of the robot, kg; gives an estimate of the energy.")]
Motor = Annotated[float | None, typer.Option(help="Torque per lacking wheel speed, N m s/rad; gives the lag.")]
Slip = Annotated[float | None, typer.Option(help="Standard deviation of each wheel's slip, e.g. 0.02.")]
Noise = Annotated[str | None, typer.Option(help="Standard deviation of the measured place, e.g. 1cm.")]
HeadingNoise = Annotated[str | None, typer.Option(help="Standard deviation of the measured heading, degrees.")]
Lookahead = Annotated[str | None, typer.Option(help="Of pure pursuit, e.g. 50cm.")]

Animate = Annotated[bool, typer.Option("--animate", help="A film of the robot driving the plan.")]
Frames = Annotated[bool, typer.Option("--frames", help="The film as a folder of PNG files, or with -o x.json as JSON.")]
Simulated = Annotated[bool, typer.Option("--simulated", help="The film of a simulated drive, not of the planned one.")]
FilmDuration = Annotated[str | None, typer.Option("--duration", help="Of the film, e.g. 20s; default: 12s at most.")]
SpeedUp = Annotated[float | None, typer.Option(help="How much faster than the robot the film is.")]
Fps = Annotated[float | None, typer.Option(help="Frames a second of the film; default: 15.")]
FilmSize = Annotated[float | None, typer.Option("--size", help="Longer side of the film, inches; default: 8.")]

_PLACES = {
    "margin": ("page", "margin"),
    "tolerance": ("page", "tolerance"),
    "direction": ("cover", "direction"),
    "spacing": ("cover", "spacing"),
    "inset": ("cover", "inset"),
    "boundary": ("cover", "boundary"),
    "inner_first": ("cover", "inner_first"),
    "cut": ("cover", "cut"),
    "headings": ("cover", "headings"),
    "keep": ("order", "keep"),
    "refill": ("order", "refill"),
    "solver": ("order", "solver"),
    "metric": ("order", "metric"),
    "time_limit": ("order", "seconds"),
    "iterations": ("order", "iterations"),
    "seed": ("order", "seed"),
    "entries": ("order", "entries"),
    "avoid": ("order", "avoid"),
    "drying": ("order", "drying"),
    "corner": ("connect", "corner"),
    "on_canvas": ("connect", "on_canvas"),
    "clearance": ("connect", "clearance"),
    "reversing": ("connect", "reversing"),
    "curved_padding": ("connect", "curved_padding"),
    "work_speed": ("time", "work_speed"),
    "transit_speed": ("time", "transit_speed"),
    "jerk": ("time", "jerk"),
    "power": ("time", "power"),
    "constant_speed": ("time", "constant_speed"),
    "pattern": ("wash", "pattern"),
    "fewest": ("wash", "fewest"),
    "turned": ("wash", "turned"),
    "placement": ("wash", "tolerance"),
    "rule": ("wash", "rule"),
    "water": ("wash", "direction"),
    "horizontal": ("wash", "horizontal"),
    "travel": ("wash", "travel"),
    "lift": ("wash", "lift"),
}
"""Flags that are one setting: their group and name."""


def read_config(file: Path | None) -> dict[str, Any]:
    """Settings of a file as plain tables: {"robot": ..., "page": {...}, ...}. Raises InputError."""
    import tomllib

    from optplan.schema.files import read_text

    if file is None:
        if not CONFIG.is_file():
            return {}
        file = CONFIG
    try:
        settings = tomllib.loads(read_text(file))
    except (ValueError, RecursionError) as error:  # TOMLDecodeError is a ValueError
        raise InputError(f"is not TOML: {error}", str(file)) from None
    robot = settings.get("robot")
    if robot is not None and not isinstance(robot, str):
        raise InputError(f"robot is {robot!r}; expected the name of a preset or a file", str(file))
    _validated({key: value for key, value in settings.items() if key != "robot"}, str(file))
    return settings


def settings_of(base: dict[str, Any], flags: dict[str, Any]) -> Options:
    """Options from plain tables and the flags that were given. Raises InputError."""
    tables: dict[str, Any] = {key: dict(value) for key, value in base.items() if key != "robot"}
    for flag, (group, name) in _PLACES.items():
        if flags.get(flag) is not None:
            tables.setdefault(group, {})[name] = flags[flag]
    if flags.get("canvas") is not None:
        width, height = _canvas(flags["canvas"])
        tables.setdefault("page", {}).update(width=width, height=height)
    if flags.get("start") is not None:
        tables.setdefault("order", {}).update(pose(flags["start"], "--start"))
    if flags.get("padding") is not None:
        parts = [part.strip() for part in flags["padding"].split(",")]
        if len(parts) > 2:
            raise InputError(f"{flags['padding']!r} is no padding; expected BEFORE or BEFORE,AFTER", "--padding")
        tables.setdefault("connect", {}).update(pad_before=parts[0], pad_after=parts[-1])
    if flags.get("areas") is not None:
        tables.setdefault("connect", {}).update(_areas(flags["areas"]))
        if flags.get("clearance") is not None:
            tables["connect"]["clearance"] = flags["clearance"]
    for text in flags.get("fill") or ():
        id, fill = _element_fill(text)
        tables.setdefault("cover", {}).setdefault("elements", {})[id] = fill
    if flags.get("link"):
        links = tables.setdefault("cover", {}).setdefault("links", [])
        tables["cover"]["links"] = [*links, *map(_link, flags["link"])]
    try:
        return _validated(tables, "settings")
    except InputError as error:
        for flag, (group, name) in _PLACES.items():
            if flags.get(flag) is not None and error.problem.startswith(f"{group} {name} "):
                raise InputError(error.problem, f"--{flag.replace('_', '-')}") from None
        raise


def tables_of(options: Options) -> dict[str, Any]:
    """Plain tables of options, to be changed by flags."""
    from optplan.schema.options import options_model

    return options_model(options).model_dump(mode="json")


def config_text(options: Options, robot: str) -> str:
    """Options as the text of a configuration file; settings left to the program are comments."""
    lines = [f'robot = "{robot}"']
    for group, table in tables_of(options).items():
        lines += ["", f"[{group}]"]
        for name, value in table.items():
            if name == "elements":
                lines += [f'elements."{id}" = {_inline(fill)}' for id, fill in value.items()]
            else:
                lines.append(f"# {name} =" if value is None else f"{name} = {_toml(value)}")
    return "\n".join(lines) + "\n"


def _validated(tables: dict[str, Any], where: str) -> Options:
    from pydantic import ValidationError

    from optplan.schema.base import fault
    from optplan.schema.options import OptionsModel, options_from

    try:
        model = OptionsModel.model_validate(tables)
    except ValidationError as error:
        raise fault(error, where) from None
    return options_from(model)


def _canvas(text: str) -> tuple[float, float]:
    from optplan.domain.units import length

    parts = re.split(r"\s*[x×]\s*", text.strip())
    if len(parts) != 2:
        raise InputError(f"{text!r} is no canvas; expected width x height, such as 20x15", "--canvas")
    # a unit that stands only at the end holds for both
    unit = re.sub(r"^[\d.eE+-]*\s*", "", parts[1])
    first = parts[0] if re.search(r"[a-z]", parts[0]) else f"{parts[0]} {unit}".strip()
    try:
        return length(first), length(parts[1])
    except InputError as error:
        raise InputError(error.problem, "--canvas") from None


def pose(text: str, flag: str) -> dict[str, Any]:
    """Settings of where the robot stands, from X,Y or X,Y,HEADING (a heading that is not given is free)."""
    parts = [part.strip() for part in text.split(",")]
    if len(parts) not in (2, 3):
        raise InputError(f"{text!r} is no place; expected X,Y or X,Y,HEADING", flag)
    return {"start": parts[:2], "heading": parts[2] if len(parts) == 3 else None}


def _areas(file: Path) -> dict[str, Any]:
    """Polygons of a JSON file, as settings; they are checked with the rest."""
    import json

    from optplan.schema.files import read_text

    try:
        found = json.loads(read_text(file))
    except (ValueError, RecursionError) as error:
        raise InputError(f"is not JSON: {error}", str(file)) from None
    known = {"keep_out", "keep_in", "clearance"}
    if not isinstance(found, dict) or not found or not set(found) <= known:
        raise InputError(f"expected an object with {', '.join(sorted(known))}", str(file))
    with located(str(file)):
        _validated({"connect": found}, str(file))
    return found


def _link(text: str) -> list[str | int]:
    ends = [part.rpartition(":") for part in text.split(",")]
    if len(ends) != 2 or not all(id.strip() and re.fullmatch(r"-?\d+", number.strip()) for id, _, number in ends):
        raise InputError(f"{text!r} is no link; expected ID:K,ID:K, vertices from 0 on or -1 for the last", "--link")
    return [value for id, _, number in ends for value in (id.strip(), int(number))]


def _element_fill(text: str) -> tuple[str, dict[str, str]]:
    id, found, rest = text.rpartition(":")
    pairs = [part.partition("=") for part in rest.split(",")]
    if not (found and id and all(equals and name.strip() and value.strip() for name, equals, value in pairs)):
        raise InputError(f"{text!r} is no fill; expected ID:direction=45,spacing=30cm,inset=10cm", "--fill")
    return id, {name.strip(): value.strip() for name, _, value in pairs}


def with_entries(job: Job, texts: list[str] | None) -> Job:
    """The job with the entry vertices that `--entry ID:K` asks for. Raises InputError."""
    from optplan.domain.job import Drawing

    for text in texts or ():
        id, _, vertex = text.rpartition(":")
        if not (id and vertex.isdecimal()):
            raise InputError(f"{text!r} is no entry; expected ID:K, K counted from 0", "--entry")
        if not isinstance(job, Drawing):
            raise InputError("only elements of drawings have entry vertices", "--entry")
        job = job.with_element(id, entry=int(vertex))
    return job


def _toml(value: Any) -> str:
    if isinstance(value, bool):
        return "true" if value else "false"
    if isinstance(value, str):
        return '"' + value.replace("\\", "\\\\").replace('"', '\\"') + '"'
    if isinstance(value, list | tuple):
        return "[" + ", ".join(map(_toml, value)) + "]"
    return repr(value)


def _inline(table: dict[str, Any]) -> str:
    return "{ " + ", ".join(f"{k} = {_toml(v)}" for k, v in table.items() if v is not None) + " }"
