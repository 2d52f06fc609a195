"""optplan turns a surface job into a plan that a robot can drive, and proves how good the plan is.

    import optplan as op

    plan = op.plan(op.read("lion.svg"), robot="beach-rake")
    op.save_plan(plan, "lion.json")
    op.draw(plan, "lion.png")

Each step is callable alone: `read`, `cover`, `traversals`, `ordering_problem`, `solve`, `connect`, `profile`, `verify`.
"""

from __future__ import annotations

from typing import TYPE_CHECKING

__version__ = "0.1.0"

# Where each public name lives; loaded on first use, so that `import optplan` costs nothing.
_HOMES = {
    "read": "optplan.jobs.reading",
    "load_robot": "optplan.robots",
    "robot_names": "optplan.robots",
    "cover": "optplan.coverage",
    "containment": "optplan.coverage.nesting",
    "traversals": "optplan.problem",
    "ordering_problem": "optplan.problem",
    "solve": "optplan.ordering",
    "connect": "optplan.connectors.driving",
    "profile": "optplan.timing.fastest",
    "verify": "optplan.judge",
    "plan": "optplan.pipeline",
    "plan_from": "optplan.pipeline",
    "resumed": "optplan.resuming",
    "plan_fleet": "optplan.fleets",
    "Fleet": "optplan.fleets",
    "template": "optplan.jobs.fields",
    "save_job": "optplan.schema.jobs",
    "Field": "optplan.domain.job",
    "load_plan": "optplan.schema.plans",
    "save_plan": "optplan.schema.plans",
    "draw": "optplan.plot",
    "draw_convergence": "optplan.plot",
    "animate": "optplan.plot",
    "simulate": "optplan.simulation",
    "compare_solvers": "optplan.compare",
    "load_case": "optplan.compare",
    "read_tsplib": "optplan.ordering.tsplib",
    "lower_bound": "optplan.ordering",
    "export_plan": "optplan.exports",
    "instance": "optplan.instances",
    "instance_names": "optplan.instances",
    "Options": "optplan.domain.options",
    "PageOptions": "optplan.domain.options",
    "CoverOptions": "optplan.domain.options",
    "OrderOptions": "optplan.domain.options",
    "ConnectOptions": "optplan.domain.options",
    "TimeOptions": "optplan.domain.options",
    "DriveOptions": "optplan.simulation.options",
    "FillSettings": "optplan.domain.job",
    "Drawing": "optplan.domain.job",
    "Plan": "optplan.domain.result",
    "Robot": "optplan.domain.robot",
    "OrderingProblem": "optplan.domain.ordering",
    "StopRule": "optplan.domain.stop",
    "Progress": "optplan.domain.progress",
    "OptplanError": "optplan.domain.errors",
    "InputError": "optplan.domain.errors",
    "SolverError": "optplan.domain.errors",
}

if TYPE_CHECKING:
    from optplan.compare import compare_solvers as compare_solvers
    from optplan.compare import load_case as load_case
    from optplan.connectors.driving import connect as connect
    from optplan.coverage import cover as cover
    from optplan.coverage.nesting import containment as containment
    from optplan.domain.errors import InputError as InputError
    from optplan.domain.errors import OptplanError as OptplanError
    from optplan.domain.errors import SolverError as SolverError
    from optplan.domain.job import Drawing as Drawing
    from optplan.domain.job import Field as Field
    from optplan.domain.job import FillSettings as FillSettings
    from optplan.domain.options import ConnectOptions as ConnectOptions
    from optplan.domain.options import CoverOptions as CoverOptions
    from optplan.domain.options import Options as Options
    from optplan.domain.options import OrderOptions as OrderOptions
    from optplan.domain.options import PageOptions as PageOptions
    from optplan.domain.options import TimeOptions as TimeOptions
    from optplan.domain.ordering import OrderingProblem as OrderingProblem
    from optplan.domain.progress import Progress as Progress
    from optplan.domain.result import Plan as Plan
    from optplan.domain.robot import Robot as Robot
    from optplan.domain.stop import StopRule as StopRule
    from optplan.exports import export_plan as export_plan
    from optplan.fleets import Fleet as Fleet
    from optplan.fleets import plan_fleet as plan_fleet
    from optplan.instances import instance as instance
    from optplan.instances import instance_names as instance_names
    from optplan.jobs.fields import template as template
    from optplan.jobs.reading import read as read
    from optplan.judge import verify as verify
    from optplan.ordering import lower_bound as lower_bound
    from optplan.ordering import solve as solve
    from optplan.ordering.tsplib import read_tsplib as read_tsplib
    from optplan.pipeline import plan as plan
    from optplan.pipeline import plan_from as plan_from
    from optplan.plot import animate as animate
    from optplan.plot import draw as draw
    from optplan.plot import draw_convergence as draw_convergence
    from optplan.problem import ordering_problem as ordering_problem
    from optplan.problem import traversals as traversals
    from optplan.resuming import resumed as resumed
    from optplan.robots import load_robot as load_robot
    from optplan.robots import robot_names as robot_names
    from optplan.schema.jobs import save_job as save_job
    from optplan.schema.plans import load_plan as load_plan
    from optplan.schema.plans import save_plan as save_plan
    from optplan.simulation import simulate as simulate
    from optplan.simulation.options import DriveOptions as DriveOptions
    from optplan.timing.fastest import profile as profile

__all__ = [*_HOMES]


def __getattr__(name: str) -> object:
    if name not in _HOMES:
        raise AttributeError(f"module 'optplan' has no attribute {name!r}")
    import importlib

    return getattr(importlib.import_module(_HOMES[name]), name)


def __dir__() -> list[str]:
    return sorted([*globals(), *_HOMES])
