"""Commands that say what there is: robots, solvers, instances, schemas."""

from __future__ import annotations

from typing import Annotated, Any

import typer

from optplan.cli import output
from optplan.cli.settings import (
    Json,
)
from optplan.domain.errors import InputError


def robots(json: Json = False) -> None:
    """The robots there are."""
    import optplan as op

    known = [op.load_robot(name) for name in op.robot_names()]
    if json:
        output.print_json([{"name": robot.name, "summary": robot.summary} for robot in known])
    else:
        output.print_table(("robot", ""), [(robot.name, robot.summary) for robot in known])


def solvers(json: Json = False) -> None:
    """The solvers there are."""
    from optplan.ordering import SOLVERS

    known = SOLVERS.values()
    if json:
        abilities = ("name", "summary", "proves", "precedence", "improves")
        output.print_json([{name: getattr(solver, name) for name in abilities} for solver in known])
        return
    marks = [("yes" if s.proves else "", "yes" if s.precedence else "", "yes" if s.improves else "") for s in known]
    rows = [(solver.name, *mark, solver.summary) for solver, mark in zip(known, marks, strict=True)]
    output.print_table(("solver", "proves", "precedence", "any-time", ""), rows)
    print("proves: gives a bound; precedence: knows rules of order; any-time: improves as long as it may")


def instances(json: Json = False) -> None:
    """The jobs that ship with optplan."""
    import optplan as op

    known = [(name, str(op.instance(name))) for name in op.instance_names()]
    if json:
        output.print_json([{"name": name, "file": file} for name, file in known])
    else:
        output.print_table(("instance", "file"), known)
        print("drawings, facades, washing: optplan plan; ordering: optplan order; optplan compare takes them all")


def schema(
    of: Annotated[str, typer.Argument(help="plan, job, robot, options or messages.")] = "plan",
) -> None:
    """JSON Schema of the files that optplan reads and writes."""
    from pydantic import TypeAdapter

    from optplan.schema.jobs import JobModel
    from optplan.schema.messages import TrajectoryMessage
    from optplan.schema.options import OptionsModel
    from optplan.schema.plans import PlanModel
    from optplan.schema.robots import RobotModel

    known: dict[str, Any] = {"plan": PlanModel, "job": JobModel, "robot": RobotModel, "options": OptionsModel}
    known["messages"] = TrajectoryMessage
    if of not in known:
        raise InputError(f"there is no schema of {of!r}; expected one of {', '.join(known)}")
    output.print_json(TypeAdapter(known[of]).json_schema())
