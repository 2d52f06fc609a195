"""What solvers are compared on: drawings, plans, library files, washing circles."""

from __future__ import annotations

import csv
import json
import math
from dataclasses import dataclass
from pathlib import Path

from optplan.coverage import cover
from optplan.domain.errors import InputError, located
from optplan.domain.options import Options
from optplan.domain.ordering import OrderingProblem
from optplan.instances import shipped_or_file
from optplan.ordering.circles import DISTANCE, TAU, circle_problem
from optplan.ordering.tsplib import SUFFIXES, Instance, read_tsplib
from optplan.problem import problem_of
from optplan.robots import USUAL_ROBOTS, load_robot
from optplan.schema.files import read_text

DRAWINGS = (".svg", ".svgz")


@dataclass(frozen=True, eq=False)
class Case:
    """An ordering problem to compare on.

    Parameters
    ----------
    name : for people
    problem : what to solve
    best_known : least cost that anyone has found, or infinite
    library : the library file it was read from, or None
    """

    name: str
    problem: OrderingProblem
    best_known: float = math.inf
    library: Instance | None = None


def load_case(source: str | Path, robot: str | Path | None = None, options: Options | None = None) -> Case:
    """An ordering problem from a file, or from an instance that ships with optplan.

    Parameters
    ----------
    source : a drawing, a plan or a JSON job, a library file (.tsp, .atsp, .sop, .gtsp, .pcglns), a JSON file of washing
        circles, or the name of a shipped instance
    robot, options : for drawings and jobs: whose strokes they become (None: the preset that suits the job), and under
        which metric

    Raises
    ------
    InputError : no such file or instance, or one that is malformed
    """
    file = shipped_or_file(source)
    if file.suffix.lower() in SUFFIXES:
        library = read_tsplib(file)
        return Case(library.name, library.problem, _best_known(file), library)
    if file.suffix.lower() in DRAWINGS:
        return Case(file.stem, _of_job(file, robot, options or Options()))
    if file.suffix.lower() != ".json":
        expected = ", ".join((*DRAWINGS, ".json", *SUFFIXES))
        raise InputError(f"is no instance; expected the name of a shipped one, or a file of {expected}", str(source))
    data = _json(file)
    if "circles" in data:
        return _circles(file, data)
    if "job" in data:
        return Case(file.stem, _of_plan(file))
    return Case(file.stem, _of_job(file, robot, options or Options()))


def _of_job(file: Path, robot: str | Path | None, options: Options) -> OrderingProblem:
    from optplan.jobs.reading import read

    job = read(file)
    machine = load_robot(robot or USUAL_ROBOTS[type(job).__name__])
    return problem_of(job, cover(job, machine, options), machine, options)[1]


def _of_plan(file: Path) -> OrderingProblem:
    from optplan.schema.plans import load_plan

    plan = load_plan(file)
    if plan.cover is None:
        raise InputError("the plan has no strokes yet; run optplan cover first", str(file))
    return problem_of(plan.job, plan.cover, plan.robot, plan.options)[1]


def _circles(file: Path, data: dict[str, object]) -> Case:
    with located(str(file)):
        rule = data.get("rule", {})
        numbers = {name: rule.get(name) if isinstance(rule, dict) else None for name in ("tau", "d")}
        radius, optimum = data.get("radius"), data.get("optimum")
        optimum = data.get("best_known", math.inf) if optimum is None else optimum
        tau = TAU if numbers["tau"] is None else numbers["tau"]
        distance = DISTANCE if numbers["d"] is None else numbers["d"]
        for name, value in (("radius", radius), ("optimum", optimum), ("rule.tau", tau), ("rule.d", distance)):
            if isinstance(value, bool) or not isinstance(value, int | float):
                raise InputError(f"{name} is {value!r:.40}; expected a number")
        problem = circle_problem(data["circles"], radius, tau=tau, distance=distance)  # type: ignore[arg-type]
        return Case(file.stem, problem, float(optimum))  # type: ignore[arg-type]


def _json(file: Path) -> dict[str, object]:
    try:
        data = json.loads(read_text(file))
    except (ValueError, RecursionError) as error:
        raise InputError(f"is not JSON: {error}", str(file)) from None
    if not isinstance(data, dict):
        raise InputError("holds no JSON object; expected a plan, a job or washing circles", str(file))
    return data


def _best_known(file: Path) -> float:
    """What a best_known.csv beside the file, or one folder up, says: columns instance and best_known, perhaps class."""
    for folder in (file.parent, file.parent.parent):
        table = folder / "best_known.csv"
        if table.is_file():
            for row in csv.DictReader(read_text(table).splitlines()):
                if row.get("instance") == file.stem and row.get("class", file.parent.name) in (file.parent.name, None):
                    try:
                        return float(row.get("best_known") or math.inf)
                    except ValueError:
                        return math.inf
    return math.inf
