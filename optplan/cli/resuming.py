"""The rest of a plan: `optplan resume`."""

from __future__ import annotations

from typing import Annotated

import typer

from optplan.cli import output
from optplan.cli.settings import Force, Json, OutFile, PlanFile, Quiet, TimeLimit, pose, settings_of, tables_of


def resume(
    file: PlanFile,
    done: Annotated[int, typer.Option("--done", help="Strokes that are finished, in driving order.", min=0)],
    start: Annotated[str, typer.Option("--from", help="Where the robot stands: X,Y or X,Y,HEADING (m, degrees).")],
    out: OutFile = None,
    reorder: Annotated[bool, typer.Option("--reorder/--same-order", help="Find a new order for the rest.")] = False,
    force: Force = False,
    quiet: Quiet = False,
    json: Json = False,
    time_limit: TimeLimit = None,
) -> None:
    """Resume: the rest of a plan after an interruption, from where the robot stands."""
    import optplan as op
    from optplan.schema.files import refuse_existing
    from optplan.schema.plans import save_plan

    earlier = op.load_plan(file)
    target = out or file.with_name(f"{file.stem}-rest{file.suffix}")
    refuse_existing(target, force)
    tables = tables_of(earlier.options)
    tables["order"].update(pose(start, "--from"))
    with output.progress_bar(quiet or json) as tell:
        made = op.resumed(
            earlier, done, settings_of(tables, {"time_limit": time_limit}), reorder=reorder, progress=tell
        )
    save_plan(made, target, overwrite=force)
    good = made.visits is not None and (made.report is None or made.report.ok)
    if json:
        output.print_json({"ok": good, **output.plan_facts(made), "files": [str(target)]})
    else:
        output.print_stage(made, "verify")
        print(f"written: {target}")
    if not good:
        raise typer.Exit(1)
