"""The commands. Parsing, doing and printing are kept apart; everything heavy is imported when a command runs."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import replace
from pathlib import Path
from typing import TYPE_CHECKING, Annotated, Any

import typer

from optplan.cli import output
from optplan.cli.fields import field_command
from optplan.cli.fleets import fleet_command
from optplan.cli.inputs import facade_file, is_job, refuse_job
from optplan.cli.listings import instances, robots, schema, solvers
from optplan.cli.looking import check, export, show, simulate
from optplan.cli.meaning import flag_of, refuse_exports, refuse_meaningless
from optplan.cli.resuming import resume
from optplan.cli.settings import (
    Areas,
    Avoid,
    Boundary,
    CanvasSize,
    Clearance,
    CloseGap,
    ConfigFile,
    ConstantSpeed,
    Corner,
    CurvedPadding,
    Cut,
    Direction,
    Drying,
    ElementFill,
    Entries,
    EntryVertex,
    Fewest,
    Force,
    Horizontal,
    InnerFirst,
    Inset,
    Iterations,
    JerkLimit,
    Json,
    Keep,
    Kind,
    LengthUnit,
    Lift,
    Links,
    Margin,
    Metric,
    OnCanvas,
    OutFile,
    Padding,
    Pattern,
    Placement,
    PlanFile,
    PowerLimit,
    Quiet,
    Refill,
    Reversing,
    RobotName,
    Rule,
    Seed,
    SolverName,
    Spacing,
    SpotHeadings,
    Start,
    TimeLimit,
    Tolerance,
    TransitSpeed,
    Travel,
    Turned,
    Unit,
    Water,
    WorkSpeed,
    config_text,
    read_config,
    settings_of,
    tables_of,
    with_entries,
)
from optplan.domain.errors import InputError

if TYPE_CHECKING:
    from optplan.domain.result import Plan

DEMOS = {"drawing": "drawings/lion", "field": "fields/football-pitch", "facade": "facades/windows"}

app = typer.Typer(
    name="optplan",
    help="Turns a surface job into a plan a robot can drive, and proves how good the plan is.",
    no_args_is_help=True,
    add_completion=False,
    pretty_exceptions_enable=False,
    rich_markup_mode=None,  # plain help: rich and all it imports would double the time that --help takes
    context_settings={"help_option_names": ["-h", "--help"]},
)

Exports = Annotated[list[str] | None, typer.Option("--export", "-e", help="Also write this format. Repeatable.")]
Rest = Annotated[bool, typer.Option("--rest", help="Run the stages that follow, too.")]


def _version(wanted: bool) -> None:
    if wanted:
        from optplan import __version__

        print(f"optplan {__version__}")
        raise typer.Exit


Version = Annotated[bool, typer.Option("--version", callback=_version, is_eager=True, help="Say which one.")]


@app.callback()
def _main(
    version: Annotated[
        bool, typer.Option("--version", callback=_version, is_eager=True, help="Say which one.")
    ] = False,
) -> None:
    pass


@app.command("plan")
def plan_command(
    job: Annotated[
        Path,
        typer.Argument(
            help="A drawing (.svg), a field or another JSON job, a facade (.dxf, .csv), or the name of a shipped one.",
            show_default=False,
        ),
    ],
    robot: RobotName = None,
    out: Annotated[Path | None, typer.Option("--output", "-o", help="Folder; default: <job>-plan.")] = None,
    export: Annotated[
        list[str] | None, typer.Option("--export", "-e", help="Also write this format. Repeatable.")
    ] = None,
    config: ConfigFile = None,
    force: Force = False,
    quiet: Quiet = False,
    json: Json = False,
    print_config: Annotated[bool, typer.Option("--print-config", help="Print all settings and stop.")] = False,
    canvas: CanvasSize = None,
    margin: Margin = None,
    tolerance: Tolerance = None,
    close_gap: CloseGap = None,
    kind: Kind = None,
    unit: Unit = None,
    direction: Direction = None,
    spacing: Spacing = None,
    inset: Inset = None,
    boundary: Boundary = None,
    fill: ElementFill = None,
    entry: EntryVertex = None,
    inner_first: InnerFirst = None,
    link: Links = None,
    cut: Cut = None,
    headings: SpotHeadings = None,
    keep: Keep = None,
    solver: SolverName = None,
    metric: Metric = None,
    time_limit: TimeLimit = None,
    iterations: Iterations = None,
    seed: Seed = None,
    start: Start = None,
    entries: Entries = None,
    avoid: Avoid = None,
    drying: Drying = None,
    refill: Refill = None,
    corner: Corner = None,
    areas: Areas = None,
    on_canvas: OnCanvas = None,
    clearance: Clearance = None,
    reversing: Reversing = None,
    padding: Padding = None,
    curved_padding: CurvedPadding = None,
    work_speed: WorkSpeed = None,
    transit_speed: TransitSpeed = None,
    jerk: JerkLimit = None,
    power: PowerLimit = None,
    constant_speed: ConstantSpeed = None,
    pattern: Pattern = None,
    fewest: Fewest = None,
    turned: Turned = None,
    placement: Placement = None,
    rule: Rule = None,
    water: Water = None,
    horizontal: Horizontal = None,
    travel: Travel = None,
    lift: Lift = None,
    units: LengthUnit = "m",
) -> None:
    """Plan a job: writes plan.json and a picture, checks the plan and prints the findings."""
    from optplan.instances import shipped_or_file

    flags = dict(locals())
    base = read_config(config)
    options = settings_of(base, flags)
    job = shipped_or_file(job)
    chosen = robot or base.get("robot")
    if print_config:
        print(config_text(options, chosen or "beach-rake"), end="")
        return
    folder = out or Path(f"{job.stem}-plan")
    _plan_and_write(job, chosen, options, folder, export or [], force, quiet, json, flags)


@app.command()
def demo(
    kind: Annotated[str, typer.Argument(help="drawing, field, facade, or the name of a shipped one.")] = "drawing",
    robot: RobotName = None,
    out: Annotated[Path | None, typer.Option("--output", "-o", help="Folder; default: optplan-demo.")] = None,
    force: Force = False,
    quiet: Quiet = False,
    json: Json = False,
) -> None:
    """Plan a job that ships with optplan, in seconds."""
    from optplan.instances import instance

    file = instance(DEMOS.get(kind, kind))
    folder = out
    if folder is None:  # a demo never fails because there was one before, and never replaces it
        folder, number = Path("optplan-demo"), 1
        while folder.exists():
            number += 1
            folder = Path(f"optplan-demo-{number}")
    field = kind == "field"
    options = settings_of({}, {"time_limit": "6s", "avoid": 5.0} if field else {})
    formats = ["csv", "schedule", "messages", "pdf"] if field else ["csv", "txt"]
    if file.parent.name == "facades":
        formats = ["stops"]
    _plan_and_write(file, robot, options, folder, formats, force, quiet, json, film=field)


def _plan_and_write(
    job: Path,
    robot: str | None,
    options: Any,
    folder: Path,
    export: list[str],
    force: bool,
    quiet: bool,
    json: bool,
    flags: dict[str, Any] | None = None,
    film: bool = False,
) -> None:
    import math

    import optplan as op
    from optplan.domain.facade import Facade
    from optplan.domain.stop import StopRule
    from optplan.domain.units import check_unit, length
    from optplan.exports import FORMATS
    from optplan.robots import USUAL_ROBOTS
    from optplan.schema.files import refuse_existing

    given = flags or {}
    unit = given.get("unit")
    read = op.read(
        job, close_gap=given.get("close_gap"), kind=given.get("kind"), unit=None if unit is None else length(unit)
    )
    refuse_meaningless(given, read, job)
    refuse_exports(export, read)
    read = with_entries(read, given.get("entry"))
    lengths = check_unit(given.get("units", "m"))
    targets = [folder / "plan.json", folder / "picture.png", folder / "picture.svg"]
    targets += [folder / f"plan{FORMATS[name].suffix}" for name in export]
    films = [folder / "film.gif"] if film else []
    building = folder / "building.png" if isinstance(read, Facade) else None
    if folder.exists() and not folder.is_dir():
        raise InputError("is a file; expected a folder for the plan and its pictures", str(folder))
    for target in [*targets, *films, *([building] if building else [])]:  # find out before the work, not after it
        refuse_existing(target, force)
    machine = op.load_robot(robot or USUAL_ROBOTS[type(read).__name__])
    order = options.order
    with output.progress_bar(quiet or json) as tell, output.cancellable() as wished:
        rule = StopRule(
            seconds=math.inf if order.seconds is None else order.seconds,
            iterations=order.iterations,
            cancelled=lambda: bool(wished),
        )
        with facade_file(read, job):
            plan = op.plan(read, machine, options, tell, rule)
    op.save_plan(plan, targets[0], overwrite=force)
    for picture in targets[1:3]:
        op.draw(plan, picture, overwrite=force)
    if building is not None:
        op.draw(plan, building, overwrite=force, in_space=True)
        targets.append(building)
    if plan.path is not None:
        for name, target in zip(export, targets[3 : 3 + len(export)], strict=True):
            op.export_plan(plan, name, target, overwrite=force, unit=lengths)
        if film and plan.trajectory is not None:
            op.animate(plan, films[0], overwrite=force)
            targets += films
    written = [str(target) for target in targets if target.exists()]
    exports = {folder / f"plan{kind.suffix}" for kind in FORMATS.values()} - set(targets)
    _tell(plan, written, json, [str(file) for file in sorted(exports) if file.exists()], lengths)


def _tell(plan: Plan, written: list[str], json: bool, older: Sequence[str] = (), lengths: str = "m") -> None:
    """Print a finished plan; exit 1 unless it was verified."""
    good = plan.report is not None and plan.report.ok
    if json:
        output.print_json({"ok": good, **output.plan_facts(plan), "files": written})
    else:
        output.print_notes(plan)
        if plan.ordering is not None:
            output.print_order(plan.ordering)
        if plan.report is not None:
            output.print_report(plan.report, lengths)
        verdict = "planned and verified" if good else "NO VALID PLAN" if plan.path is None else "A CHECK FAILED"
        print(f"{verdict}; written:")
        for file in written:
            print(f"  {file}")
        if older:
            print(f"of an earlier plan, left as they were: {', '.join(older)}")
    if not good:
        raise typer.Exit(1)


def _stage(
    stage: str, file: Path, out: Path | None, flags: dict[str, Any], rest: bool, force: bool, quiet: bool, json: bool
) -> None:
    """Run one stage (and the rest) of a plan file with changed settings, and write the plan."""
    import math

    from optplan.domain.stop import StopRule
    from optplan.pipeline import plan_from, run_stage
    from optplan.schema.files import refuse_existing
    from optplan.schema.plans import save_plan

    target = out or file
    if target.suffix.lower() in {".svg", ".svgz"}:
        hint = "another file" if out else "--output"
        raise InputError(f"is a drawing, which a plan would overwrite; say {hint}", str(target))
    if "robot" not in flags:
        refuse_job(stage, file)
    refuse_existing(target, force)
    earlier = _load(file, flags)
    refuse_meaningless(flags, earlier.job)
    options = settings_of(tables_of(earlier.options), flags)
    earlier = replace(earlier, job=with_entries(earlier.job, flags.get("entry")), options=options)
    with output.progress_bar(quiet or json) as tell, output.cancellable() as wished:
        rule = StopRule(
            seconds=options.order.seconds or math.inf,
            iterations=options.order.iterations,
            cancelled=lambda: bool(wished),
        )
        run: Callable[..., Plan] = plan_from if rest else run_stage
        with facade_file(earlier.job, file):
            made = run(earlier, stage, tell, rule)
    save_plan(made, target, overwrite=force)
    good = not (stage == "order" and made.visits is None) and (made.report is None or made.report.ok)
    if json:
        output.print_json({"ok": good, **output.plan_facts(made), "files": [str(target)]})
    else:
        output.print_stage(made, stage)
        print(f"written: {target}")
    if not good:
        raise typer.Exit(1)


def _load(file: Path, flags: dict[str, Any]) -> Plan:
    """A plan file; for the first stage a job does too."""
    import optplan as op
    from optplan.domain.options import Options
    from optplan.domain.result import Plan
    from optplan.robots import USUAL_ROBOTS

    robot = flags.get("robot")
    if "robot" in flags and is_job(file):
        job = op.read(file)
        return Plan(job, op.load_robot(robot or USUAL_ROBOTS[type(job).__name__]), Options())
    plan = op.load_plan(file)
    return plan if robot is None else replace(plan, robot=op.load_robot(robot))


@app.command()
def cover(
    file: Annotated[Path, typer.Argument(help="A plan, a job, or the name of a shipped one.", show_default=False)],
    out: OutFile = None,
    robot: RobotName = None,
    rest: Rest = False,
    force: Force = False,
    quiet: Quiet = False,
    json: Json = False,
    canvas: CanvasSize = None,
    margin: Margin = None,
    tolerance: Tolerance = None,
    direction: Direction = None,
    spacing: Spacing = None,
    inset: Inset = None,
    boundary: Boundary = None,
    fill: ElementFill = None,
    entry: EntryVertex = None,
    inner_first: InnerFirst = None,
    link: Links = None,
    cut: Cut = None,
    headings: SpotHeadings = None,
    keep: Keep = None,
    pattern: Pattern = None,
    fewest: Fewest = None,
    turned: Turned = None,
    placement: Placement = None,
    rule: Rule = None,
    water: Water = None,
) -> None:
    """Cover: from the job to strokes."""
    flags = dict(locals())
    from optplan.instances import shipped_or_file

    source = shipped_or_file(file)
    if source != file and out is None:
        raise InputError("is a shipped job; say --output for the strokes", str(file))
    _stage("cover", source, out, flags, rest, force, quiet, json)


@app.command()
def order(
    file: Annotated[
        Path,
        typer.Argument(
            help="A plan, or an ordering instance (.tsp .atsp .sop .gtsp .pcglns, or the name of a shipped one).",
            show_default=False,
        ),
    ],
    out: OutFile = None,
    rest: Rest = False,
    force: Force = False,
    quiet: Quiet = False,
    json: Json = False,
    solver: SolverName = None,
    metric: Metric = None,
    time_limit: TimeLimit = None,
    iterations: Iterations = None,
    seed: Seed = None,
    start: Start = None,
    entries: Entries = None,
    avoid: Avoid = None,
    drying: Drying = None,
    refill: Refill = None,
    areas: Areas = None,
    on_canvas: OnCanvas = None,
    clearance: Clearance = None,
    reversing: Reversing = None,
    padding: Padding = None,
    curved_padding: CurvedPadding = None,
    horizontal: Horizontal = None,
    travel: Travel = None,
    lift: Lift = None,
) -> None:
    """Order: which stroke after which, entered where."""
    from optplan.cli.ordering import is_instance, order_instance
    from optplan.instances import shipped_or_file

    flags = dict(locals())
    file = shipped_or_file(file)
    if is_instance(file):
        for name in ("metric", "start", "entries", "avoid", "drying", "areas", "on_canvas", "clearance", "reversing",
                     "padding", "curved_padding", "refill", "horizontal", "travel", "lift"):  # fmt: skip
            if flags[name] is not None:
                raise InputError("says nothing about an instance of a library, which has its costs", flag_of(name))
        order_instance(file, out, settings_of({}, flags), force, quiet, json)
    else:
        _stage("order", file, out, flags, rest, force, quiet, json)


@app.command("compare")
def compare_command(
    instances: Annotated[
        list[str], typer.Argument(help="Drawings, plans, library files, or names of shipped ones.", show_default=False)
    ],
    solver: Annotated[list[str] | None, typer.Option("--solver", "-s", help="Repeatable; default: auto.")] = None,
    seed: Annotated[list[int] | None, typer.Option(help="Repeatable; default: 0.")] = None,
    budget: Annotated[
        list[str] | None, typer.Option("--budget", "-b", help="Seconds a run, e.g. 1s. Repeatable; default: 10s.")
    ] = None,
    robot: RobotName = None,
    out: Annotated[Path | None, typer.Option("--output", "-o", help="CSV of all runs.", show_default=False)] = None,
    force: Force = False,
    quiet: Quiet = False,
    json: Json = False,
) -> None:
    """Compare solvers: instances x solvers x seeds x budgets, as a table and CSV."""
    from optplan.cli.ordering import compare_and_print

    compare_and_print(instances, solver, seed, budget, robot, out, force, quiet, json)


@app.command()
def connect(
    file: PlanFile,
    out: OutFile = None,
    rest: Rest = False,
    force: Force = False,
    quiet: Quiet = False,
    json: Json = False,
    metric: Metric = None,
    corner: Corner = None,
    areas: Areas = None,
    on_canvas: OnCanvas = None,
    clearance: Clearance = None,
    reversing: Reversing = None,
    padding: Padding = None,
    curved_padding: CurvedPadding = None,
) -> None:
    """Connect: the path along all strokes and between them."""
    _stage("connect", file, out, dict(locals()), rest, force, quiet, json)


@app.command()
def time(
    file: PlanFile,
    out: OutFile = None,
    rest: Rest = False,
    force: Force = False,
    quiet: Quiet = False,
    json: Json = False,
    work_speed: WorkSpeed = None,
    transit_speed: TransitSpeed = None,
    jerk: JerkLimit = None,
    power: PowerLimit = None,
    constant_speed: ConstantSpeed = None,
) -> None:
    """Time: the speed profile along the path."""
    _stage("time", file, out, dict(locals()), rest, force, quiet, json)


for name, command in (
    ("check", check),
    ("show", show),
    ("simulate", simulate),
    ("export", export),
    ("field", field_command),
    ("fleet", fleet_command),
    ("resume", resume),
    ("robots", robots),
    ("solvers", solvers),
    ("instances", instances),
    ("schema", schema),
):
    app.command(name)(command)
