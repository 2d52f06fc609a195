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
        beside=flags["beside"],
        ideal=flags["ideal"],
    )


def driven(plan: Plan, options: DriveOptions, quiet: bool) -> Drive:
    """Simulate with a progress bar; Ctrl-C ends the drive where it is."""
    import optplan as op
    from optplan.domain.stop import StopRule

    with output.progress_bar(quiet) as tell, output.cancellable() as wished:
        return op.simulate(plan, options, tell, StopRule(cancelled=lambda: bool(wished)))


def simulate_and_print(
    file: Path, out: Path | None, flags: dict[str, Any], force: bool, quiet: bool, json: bool
) -> None:
    """Drive a plan, print the figures, write the trace if a file is given; exit 1 unless it came to the end."""
    import optplan as op
    from optplan.schema.files import write_atomically
    from optplan.simulation.trace import trace_text

    if out is not None and out.exists() and not force:
        raise InputError("exists already; say --force to replace it, or --output for another place", str(out))
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
