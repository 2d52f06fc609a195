"""Commands about a robot that drives a plan: simulation and animation."""

from __future__ import annotations

from pathlib import Path
from typing import TYPE_CHECKING, Any

import typer

from optplan.cli import output
from optplan.domain.errors import InputError
from optplan.domain.units import angle, duration, length

if TYPE_CHECKING:
    from optplan.domain.drive import Drive
    from optplan.domain.result import Plan
    from optplan.simulation.options import DriveOptions


def drive_options(flags: dict[str, Any]) -> DriveOptions:
    """The robot's circumstances from flags, units and all. Raises InputError."""
    from optplan.simulation.options import DriveOptions

    def si(name: str, read: Any) -> float | None:
        return None if flags.get(name) is None else float(read(flags[name]))

    return DriveOptions(
        tracker=flags["tracker"],
        lag=si("lag", duration),
        mass=flags.get("mass"),
        motor=flags.get("motor"),
        slip=flags["slip"] or 0.0,
        noise=si("noise", length) or 0.0,
        heading_noise=si("heading_noise", angle) or 0.0,
        seed=flags["seed"] or 0,
        lookahead=si("lookahead", length),
        ideal=flags["ideal"],
    )


def driven(plan: Plan, options: DriveOptions, quiet: bool) -> Drive:
    """Simulate with a progress bar; Ctrl-C ends the drive where it is."""
    import optplan as op
    from optplan.domain.stop import StopRule

    with output.progress_bar(quiet) as tell, output.cancellable() as wished:
        return op.simulate(plan, options, tell, StopRule(cancelled=lambda: bool(wished)))


def unwanted(flags: dict[str, Any]) -> None:
    """Refuse flags of `optplan show` that would change nothing. Raises InputError."""
    if flags["animate"] and flags["convergence"]:
        raise InputError("is no film; expected one of --animate and --convergence", "--convergence")
    for other in ("animate", "convergence"):
        if flags["in_space"] and flags[other]:
            raise InputError(f"is a picture of the building; expected one of --3d and --{other}", "--3d")
    asked = [name for name in ("frames", "simulated", "duration", "speed_up", "fps", "size") if flags[name]]
    if asked and not flags["animate"]:
        raise InputError("is about a film; say --animate, too", f"--{asked[0].replace('_', '-')}")
    drive = [name for name in ("ideal", "lag", "slip", "noise", "seed") if flags[name]]
    drive += ["tracker"] if flags["tracker"] != "path-frame" else []
    if drive and not flags["simulated"]:
        raise InputError("is about a simulated drive; say --simulated, too", f"--{drive[0].replace('_', '-')}")


def film(plan: Plan, file: Path, out: Path | None, flags: dict[str, Any], force: bool, quiet: bool) -> Path:
    """Write the film that the flags of `optplan show` ask for; returns where."""
    import optplan as op

    target = out or (file.with_name(f"{file.stem}-frames") if flags["frames"] else file.with_suffix(".gif"))
    if flags["frames"] and target.suffix.lower() not in ("", ".json"):
        raise InputError("is no place for frames; expected a folder, or a .json file", str(target))
    chosen = {name: flags[name] for name in ("speed_up", "fps", "size", "dpi") if flags[name] is not None}
    if flags["duration"] is not None:
        chosen["seconds"] = duration(flags["duration"])
    if flags["simulated"]:
        chosen["drive"] = driven(plan, drive_options(flags), quiet)
    with output.progress_bar(quiet) as tell:
        op.animate(plan, target, overwrite=force, progress=tell, **chosen)
    return target


def simulate_and_print(
    file: Path, out: Path | None, flags: dict[str, Any], force: bool, quiet: bool, json: bool
) -> None:
    """Drive a plan, print the figures, write the trace if a file is given; exit 1 unless it came to the end."""
    import optplan as op
    from optplan.schema.files import refuse_existing, write_atomically
    from optplan.simulation.trace import trace_text

    if out is not None:
        refuse_existing(out, force)
    options = drive_options(flags)
    plan = op.load_plan(file)
    drive = driven(plan, options, quiet or json)
    if out is not None:
        write_atomically(out, trace_text(drive, plan.robot), overwrite=force)
    if json:
        output.print_json(
            {
                "finished": drive.finished,
                "reason": drive.reason,
                "method": drive.method,
                "moments": len(drive),
                "figures": {name: {"value": output.finite(value), "unit": unit} for name, value, unit in drive.figures},
                "files": [] if out is None else [str(out)],
            }
        )
    else:
        rows = [(name, f"{value:.4g}", unit) for name, value, unit in drive.figures]
        output.print_table(("figure", "value", "unit"), rows, right=(1,))
        print(f"{drive.method}: {drive.reason}")
        if out is not None:
            print(f"written: {out}")
    if not drive.finished:
        raise typer.Exit(1)
