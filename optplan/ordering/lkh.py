"""`lkh`: the program LKH by K. Helsgaun, where the user has installed it.

It is for research use only and no part of optplan: only its files are written and read here.
"""

from __future__ import annotations

import os
import shutil
import subprocess
import tempfile
import time
from pathlib import Path

import numpy as np

from optplan.domain.arrays import IntArray
from optplan.domain.errors import InputError
from optplan.domain.ordering import MatrixCosts, OrderingProblem
from optplan.domain.stop import StopReason
from optplan.ordering.arrays import dense_costs
from optplan.ordering.method import Run
from optplan.ordering.tsplib import Instance, instance_of, read_tour, write_tsplib

VARIABLE = "OPTPLAN_LKH"
RUNS = 10
"""Runs from different starts when no number of iterations is given."""
ASCENT_NODES = 2000
"""Beyond, its subgradient ascent takes longer than it is worth, and minds no time limit."""
TIME_SHARE = 0.9
"""Share of the time after which it ends by itself and writes its tour."""
MOST_NODES = 3000
"""Cities whose weights are written out."""
POLL = 0.03
"""Seconds between two looks at the stop rule."""


def program() -> str | None:
    """Where LKH is: the file named by the variable OPTPLAN_LKH, else LKH on PATH."""
    return shutil.which(os.environ.get(VARIABLE) or "LKH")


def refuse_without_lkh(problem: OrderingProblem) -> str | None:
    """Why LKH cannot be asked: it is not installed, or does not know problems of this kind."""
    if program() is None:
        return (
            f"the program LKH is not installed; put it on PATH, or its place into the variable {VARIABLE} (it is for "
            "research use only, and no part of optplan)"
        )
    if problem.nodes > problem.clusters and len(problem.precedence):
        return "it knows precedence only between strokes that have a single traversal"
    if problem.nodes > MOST_NODES:
        return f"{problem.nodes} nodes; at most {MOST_NODES} are written out"
    return None


def lkh(run: Run) -> StopReason:
    """Write the problem as a library file, run LKH on it in a child process, read its tour. An iteration is a run.

    Strokes of several traversals become a travelling-salesman problem by shifted weights. Helsgaun, "An effective
    implementation of the Lin-Kernighan traveling salesman heuristic" (2000).
    """
    if stop := run.stop():
        return stop
    cities = _single_cities(run.problem)
    instance = instance_of(cities)
    with tempfile.TemporaryDirectory(prefix="optplan-lkh-") as name:
        folder = Path(name)
        write_tsplib(folder / "problem.txt", instance)
        parameters = folder / "parameters.txt"
        parameters.write_text(_parameters(run, instance.dimension))
        stopped = _execute(run, folder, parameters)
        tour = folder / "best.tour"
        if tour.is_file():
            _take(run, tour, instance)
        elif stopped is StopReason.FINISHED:
            run.message, stopped = "LKH wrote no tour", StopReason.FAILED
    return stopped


def _single_cities(problem: OrderingProblem) -> OrderingProblem:
    """The problem itself if every cluster is a single node, else its nodes as cities."""
    if problem.nodes == problem.clusters:
        return problem
    from optplan_models.ordering import noon_bean

    parts = (dense_costs(problem), problem.cluster, problem.start_costs, problem.end_costs, problem.node_costs)
    weights = noon_bean.weight_shifted(*parts, big=noon_bean.sufficient(*parts), back=0.0)
    return OrderingProblem(np.arange(problem.nodes), MatrixCosts(weights[1:, 1:]), weights[0, 1:], weights[1:, 0])


def _parameters(run: Run, size: int) -> str:
    lines = [
        "PROBLEM_FILE = problem.txt",
        "TOUR_FILE = best.tour",
        f"RUNS = {run.rule.iterations or RUNS}",
        f"SEED = {run.seed % 2**30 + 1}",  # 0 would mean the clock
        "PRECISION = 1",  # the weights have their digits already
        f"SUBGRADIENT = {'YES' if size <= ASCENT_NODES else 'NO'}",
        "TRACE_LEVEL = 0",
    ]
    if np.isfinite(run.rule.seconds):
        lines.append(f"TIME_LIMIT = {max(TIME_SHARE * run.clock.remaining, 0.01):.3f}")
    return "\n".join([*lines, "EOF", ""])


def _execute(run: Run, folder: Path, parameters: Path) -> StopReason:
    """Let it work until it is done or has to stop; it never outlives this call."""
    with (folder / "output.txt").open("wb") as output:
        try:
            process = subprocess.Popen(
                [str(program()), str(parameters)],
                cwd=folder,
                stdin=subprocess.DEVNULL,
                stdout=output,
                stderr=subprocess.STDOUT,
            )
        except OSError as error:
            run.message = f"LKH cannot be started ({error})"
            return StopReason.FAILED
        try:
            while process.poll() is None:
                if stop := run.stop():
                    return stop
                time.sleep(POLL)
        finally:
            process.kill()
            process.wait()
    if process.returncode:
        lines = (folder / "output.txt").read_text(errors="replace").strip().splitlines()
        run.message = f"LKH failed with exit code {process.returncode}" + (f": {lines[-1]:.200}" if lines else "")
        return StopReason.FAILED
    run.iterations = run.rule.iterations or RUNS
    return StopReason.FINISHED


def _take(run: Run, file: Path, instance: Instance) -> None:
    """Offer the path in a tour file."""
    try:
        nodes: IntArray = instance.path(read_tour(file))
    except InputError as error:
        run.message = f"LKH's tour cannot be used: {error}"
        return
    if run.problem.nodes > run.problem.clusters:
        from optplan_models.ordering import noon_bean

        nodes = noon_bean.nodes_of([1, *(nodes + 2).tolist()], run.problem.cluster)
    if faults := run.problem.faults(nodes):
        run.message = f"LKH's tour is no solution: {faults[0]}"
    else:
        run.offer(nodes)
