"""Commands that take a plan as it is: check, show, simulate, export."""

from __future__ import annotations

from pathlib import Path
from typing import Annotated

import typer

from optplan.cli import output
from optplan.cli.settings import (
    Animate,
    FilmDuration,
    FilmSize,
    Force,
    Fps,
    Frames,
    HeadingNoise,
    Ideal,
    Json,
    Lag,
    LengthUnit,
    Lookahead,
    Mass,
    Motor,
    Noise,
    OutFile,
    PlanFile,
    Quiet,
    Seed,
    Simulated,
    Slip,
    SpeedUp,
    Tracker,
)
from optplan.domain.errors import InputError
from optplan.domain.units import check_unit


def check(file: PlanFile, json: Json = False, units: LengthUnit = "m") -> None:
    """Check a plan with the independent judge; exit 1 when a limit is broken."""
    import optplan as op

    check_unit(units)
    report = op.verify(op.load_plan(file))
    if json:
        output.print_json(output.report_facts(report))
    else:
        output.print_report(report, units)
        missing = [check.name for check in report.checks if check.detail.startswith("Not checked")]
        passed = "all checks passed" if not missing else f"passed as far as it goes; not checked: {', '.join(missing)}"
        print(passed if report.ok else "A CHECK FAILED")
    if not report.ok:
        raise typer.Exit(1)


def show(
    file: PlanFile,
    out: Annotated[
        Path | None,
        typer.Option("--output", "-o", help=".png, .svg, .pdf; a film: .gif, .mp4, .json. Default: beside the plan."),
    ] = None,
    dpi: Annotated[
        int | None, typer.Option(min=20, max=1200, help="Pixels per inch; default: 150, of a film 80.")
    ] = None,
    convergence: Annotated[
        bool, typer.Option("--convergence", help="What the solver found and proved over time, instead of the plan.")
    ] = False,
    in_space: Annotated[bool, typer.Option("--3d", help="A facade's building in three dimensions.")] = False,
    animate: Animate = False,
    frames: Frames = False,
    simulated: Simulated = False,
    duration: FilmDuration = None,
    speed_up: SpeedUp = None,
    fps: Fps = None,
    size: FilmSize = None,
    tracker: Tracker = "path-frame",
    ideal: Ideal = False,
    lag: Lag = None,
    slip: Slip = None,
    noise: Noise = None,
    seed: Seed = None,
    force: Force = False,
    quiet: Quiet = False,
    json: Json = False,
) -> None:
    """Picture of a plan, or a film of the robot driving it."""
    import optplan as op
    from optplan.cli.driving import film, unwanted

    flags = dict(locals())
    unwanted(flags)
    plan = op.load_plan(file)
    if animate:
        target = film(plan, file, out, flags, force, quiet or json)
    elif convergence:
        if plan.ordering is None:
            raise InputError("the plan has no order yet; run optplan order first", str(file))
        target = out or file.with_name(f"{file.stem}-convergence.png")
        op.draw_convergence(plan.ordering, target, title=plan.job.name, overwrite=force, dpi=dpi or 150)
    else:
        target = out or file.with_suffix(".png")
        op.draw(plan, target, overwrite=force, dpi=dpi or 150, in_space=in_space)
    _tell_file(target, json)


def simulate(
    file: PlanFile,
    out: Annotated[
        Path | None, typer.Option("--output", "-o", help="CSV of the drive, a line a control step.", show_default=False)
    ] = None,
    tracker: Tracker = "path-frame",
    ideal: Ideal = False,
    lag: Lag = None,
    mass: Mass = None,
    motor: Motor = None,
    slip: Slip = None,
    noise: Noise = None,
    heading_noise: HeadingNoise = None,
    seed: Seed = None,
    lookahead: Lookahead = None,
    force: Force = False,
    quiet: Quiet = False,
    json: Json = False,
) -> None:
    """Let a simulated robot drive a plan: how far off it gets, and what its wheels do."""
    from optplan.cli.driving import simulate_and_print

    simulate_and_print(file, out, dict(locals()), force, quiet, json)


def export(
    file: PlanFile,
    to: Annotated[
        str,
        typer.Option(
            "--to",
            "-t",
            help="csv: points in time; txt: lines 'x y tool'; tool: its commands; tsplib: the ordering problem; "
            "stops, stops-json: of a facade.",
        ),
    ],
    out: OutFile = None,
    spacing: Annotated[str | None, typer.Option(help="Greatest distance between points, e.g. 5cm.")] = None,
    units: LengthUnit = "m",
    force: Force = False,
    json: Json = False,
) -> None:
    """Write a plan for another system."""
    import optplan as op
    from optplan.domain.units import length
    from optplan.exports import FORMATS

    if to not in FORMATS:
        raise InputError(f"there is no format {to!r}; expected one of {', '.join(FORMATS)}", "--to")
    target = out or file.with_suffix(FORMATS[to].suffix)
    distance = None if spacing is None else length(spacing)
    op.export_plan(op.load_plan(file), to, target, spacing=distance, overwrite=force, unit=units)
    _tell_file(target, json)


def _tell_file(file: Path, json: bool) -> None:
    if json:
        output.print_json({"files": [str(file)]})
    else:
        print(file)
