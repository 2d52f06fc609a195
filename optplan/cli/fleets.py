"""Several robots on one job: `optplan fleet`."""

from __future__ import annotations

import math
from pathlib import Path
from typing import Annotated

import typer

from optplan.cli import output
from optplan.cli.meaning import refuse_meaningless
from optplan.cli.settings import (
    ConfigFile,
    Cut,
    Metric,
    RobotName,
    Seed,
    Start,
    TimeLimit,
    TransitSpeed,
    WorkSpeed,
    read_config,
    settings_of,
)
from optplan.domain.errors import InputError


def fleet_command(
    job: Annotated[Path, typer.Argument(help="A field, another job, or a shipped one.", show_default=False)],
    robots: Annotated[int, typer.Option(help="How many.")] = 2,
    robot: RobotName = None,
    out: Annotated[Path | None, typer.Option("--output", "-o", help="Folder; default: <job>-fleet.")] = None,
    room: Annotated[str | None, typer.Option(help="Least distance between two robots; default: 3 tracks.")] = None,
    config: ConfigFile = None,
    force: Annotated[bool, typer.Option("--force", "-f", help="Replace files that exist.")] = False,
    quiet: Annotated[bool, typer.Option("--quiet", "-q", help="No progress bar.")] = False,
    json: Annotated[bool, typer.Option("--json", help="Print JSON for machines.")] = False,
    time_limit: TimeLimit = "20s",
    metric: Metric = None,
    seed: Seed = None,
    start: Start = None,
    cut: Cut = None,
    work_speed: WorkSpeed = None,
    transit_speed: TransitSpeed = None,
) -> None:
    """Divide a job among several robots: a plan for each, and when it sets off."""
    import optplan as op
    from optplan.domain.stop import StopRule
    from optplan.domain.units import length
    from optplan.fleets import MOST
    from optplan.instances import shipped_or_file
    from optplan.robots import USUAL_ROBOTS
    from optplan.schema.files import refuse_existing

    flags = dict(locals())
    base = read_config(config)
    options = settings_of(base, flags)
    if not 1 <= robots <= MOST:
        raise InputError(f"is {robots}; expected 1..{MOST}", "--robots")
    file = shipped_or_file(job)
    folder = out or Path(f"{file.stem}-fleet")
    targets = [folder / f"{name}-{k}.{ending}" for k in range(1, robots + 1) for name, ending in _FILES]
    if folder.exists() and not folder.is_dir():
        raise InputError("is a file; expected a folder for the plans and their pictures", str(folder))
    for target in targets:
        refuse_existing(target, force)
    read = op.read(file)
    refuse_meaningless(flags, read)
    machine = op.load_robot(robot or base.get("robot") or USUAL_ROBOTS[type(read).__name__])
    seconds = math.inf if options.order.seconds is None else options.order.seconds
    with output.progress_bar(quiet or json, " s") as tell, output.cancellable() as wished:
        rule = StopRule(seconds, options.order.iterations, cancelled=lambda: bool(wished))
        apart = None if room is None else length(room)
        fleet = op.plan_fleet(read, machine, robots, options, tell, rule, apart)
    written = []
    for k, plan in enumerate(fleet.plans, start=1):
        op.save_plan(plan, folder / f"plan-{k}.json", overwrite=force)
        op.draw(plan, folder / f"picture-{k}.png", overwrite=force)
        written += [str(folder / f"{name}-{k}.{ending}") for name, ending in _FILES]
    durations = [0.0 if plan.trajectory is None else plan.trajectory.duration for plan in fleet.plans]
    if json:
        facts = {
            "ok": fleet.ok,
            "makespan": fleet.makespan,
            "bound": fleet.bound,
            "apart": output.finite(fleet.apart),
            "starts": fleet.starts,
            "durations": durations,
            "files": written,
        }
        output.print_json(facts)
    else:
        rows = [
            (str(k), f"{begin:.1f}", f"{begin + duration:.1f}", str(len(plan.cover.strokes if plan.cover else ())))
            for k, (plan, begin, duration) in enumerate(zip(fleet.plans, fleet.starts, durations, strict=True), start=1)
        ]
        output.print_table(("robot", "sets off, s", "has finished, s", "strokes"), rows, right=(1, 2, 3))
        gap = 1 - fleet.bound / fleet.makespan if fleet.makespan > 0 else 0.0
        print(f"all done after {fleet.makespan:.1f} s; no division needs less than {fleet.bound:.1f} s ({gap:.1%})")
        if math.isfinite(fleet.apart):
            print(f"robots stay {fleet.apart:.2f} m apart, {fleet.room:.2f} m were to be kept")
        print("planned and verified; written:" if fleet.ok else "A CHECK FAILED; written:")
        for name in written:
            print(f"  {name}")
    if not fleet.ok:
        raise typer.Exit(1)


_FILES = (("plan", "json"), ("picture", "png"))
