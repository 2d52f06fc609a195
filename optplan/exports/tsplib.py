"""The ordering problem of a plan as a library file."""

from __future__ import annotations

from optplan.domain.errors import InputError
from optplan.domain.result import Plan
from optplan.ordering.reduce import contracted
from optplan.ordering.tsplib import instance_of, instance_text
from optplan.problem import problem_of


def tsplib_text(plan: Plan) -> str:
    """What a solver of generalised problems needs; enforced connections are contracted to single strokes.

    Raises
    ------
    InputError : the plan has no strokes yet, or only one
    LimitError : its strokes have more traversals than a file with all costs can hold
    """
    if plan.cover is None:
        raise InputError("the plan has no strokes yet; run the stage cover first")
    _, problem = problem_of(plan.job, plan.cover, plan.robot, plan.options)
    return instance_text(instance_of(contracted(problem).problem, plan.job.name or "optplan"))
