"""Writing ordering problems as library files, for other solvers."""

from __future__ import annotations

from pathlib import Path

import numpy as np

from optplan.domain.arrays import FloatArray, IntArray
from optplan.domain.errors import InputError, LimitError
from optplan.domain.ordering import OrderingProblem
from optplan.ordering.arrays import dense_costs
from optplan.ordering.tsplib.instance import Instance
from optplan.ordering.tsplib.reading import FORBIDDEN, MAX_NODES
from optplan.schema.files import write_atomically

LARGEST = 2**31 - 1
"""Other programs read weights as 32-bit numbers, and add them up."""


def instance_of(problem: OrderingProblem, name: str = "optplan") -> Instance:
    """The problem as the simplest class of library instance: ATSP, SOP, GTSP or PCGTSP.

    An open path gets a depot at which the tour begins and ends; under precedence between single nodes (SOP) it gets
    two, unless its first and last node are fixed.

    Raises
    ------
    InputError : a problem that no class can state: enforced connections, or a closed one whose costs depend on where it
        begins
    LimitError : more nodes than a file takes
    """
    if problem.nodes > MAX_NODES:
        raise LimitError(f"{problem.nodes} nodes; at most {MAX_NODES} fit into a file with all costs")
    if len(problem.enforced):
        raise InputError("library files know no enforced connections; contract them first (optplan.ordering.reduce)")
    if problem.clusters < 2:
        raise InputError(f"{problem.clusters} clusters; a library file needs 2 or more")
    single = problem.nodes == problem.clusters
    everyone = np.arange(1, problem.nodes + 1)
    if problem.closed:
        return _closed_instance(problem, name, single)
    if len(problem.precedence) and single:
        start, end = np.isfinite(problem.start_costs), np.isfinite(problem.end_costs)
        if start.sum() == end.sum() == 1 and start[0] and end[-1]:
            return Instance(name, "SOP", problem, everyone)
        return Instance(name, "SOP", problem, everyone + 1, (1, problem.nodes + 2))
    kind = "ATSP" if single else "PCGTSP" if len(problem.precedence) else "GTSP"
    return Instance(name, kind, problem, everyone + 1, (1,))


def _closed_instance(problem: OrderingProblem, name: str, single: bool) -> Instance:
    everyone = np.arange(1, problem.nodes + 1)
    fixed = np.unique(problem.cluster[np.isfinite(problem.start_costs)])
    finite = problem.start_costs[np.isfinite(problem.start_costs)]
    if problem.end_costs.any() or finite.any():
        raise InputError("a closed path with costs of its first or last node is no library instance")
    if len(problem.precedence) or len(fixed) < problem.clusters:
        if len(fixed) != 1:
            raise InputError(
                "a closed path under precedence has to begin with one fixed cluster to be a library instance"
            )
        return Instance(name, "PCGTSP", problem, everyone)
    return Instance(name, "ATSP" if single else "GTSP", problem, everyone)


def instance_text(instance: Instance, scale: float | None = None) -> str:
    """The file. Weights are whole numbers, cost x scale rounded; the scale is written into the comment.

    Parameters
    ----------
    instance : from `instance_of` or read from a file
    scale : weights a unit of cost; left out, 1 where all costs are whole numbers, else as large as 32-bit sums of whole
        tours allow, so that rounding decides nothing
    """
    problem = instance.problem
    weights = _weights(instance)
    known = np.isfinite(weights)
    largest = float(np.abs(weights[known]).max(initial=0.0))
    if scale is None:
        whole = bool((weights[known] == np.round(weights[known])).all())
        # a tour, and the forbidden weight above any tour, stay below the largest number
        room = LARGEST / 4.0 / max(problem.clusters + 2, 1) / max(largest, 1e-300)
        scale = 1.0 if whole and room >= 1.0 else float(2.0 ** np.floor(np.log2(room)))
    rounded = np.round(np.where(known, weights, 0.0) * scale)
    big = (float(np.abs(rounded).max(initial=0.0)) + 1.0) * (problem.clusters + 2)
    if big > LARGEST:
        raise InputError(f"the scale {scale:g} makes weights of up to {big:.3g}; expected at most {LARGEST} for a tour")
    matrix = np.where(known, rounded, big).astype(np.int64)
    np.fill_diagonal(matrix, 0)
    header = [
        f"NAME : {instance.name}",
        f"TYPE : {instance.kind}",
        f"COMMENT : weights are costs x {scale:.17g}; {int(big)} forbids an arc",
        f"DIMENSION : {instance.dimension}",
    ]
    sets = instance.kind in ("GTSP", "PCGTSP")
    if sets:
        header.append(f"GTSP_SETS : {problem.clusters + len(instance.depots)}")
    header += ["EDGE_WEIGHT_TYPE : EXPLICIT", "EDGE_WEIGHT_FORMAT : FULL_MATRIX", "EDGE_WEIGHT_SECTION"]
    if instance.kind == "SOP":
        header.append(str(instance.dimension))
        _mark_precedence(matrix, instance)
    lines = header + [" ".join(map(str, row)) for row in matrix.tolist()]
    return "\n".join([*lines, *(_set_lines(instance) if sets else []), "EOF", ""])


def write_tsplib(file: str | Path, instance: Instance, *, scale: float | None = None, overwrite: bool = False) -> None:
    """Write a library file; see `instance_text`.

    Raises
    ------
    InputError : the file exists and may not be replaced, or a scale that overflows 32 bits
    """
    write_atomically(Path(file), instance_text(instance, scale), overwrite=overwrite)


def _weights(instance: Instance) -> FloatArray:
    """(d, d) costs between all nodes of the file, its depots among them; what a node costs is paid on the way in."""
    problem = instance.problem
    count = instance.dimension
    place: IntArray = instance.numbers - 1
    weights = np.full((count, count), np.inf)
    weights[np.ix_(place, place)] = dense_costs(problem) + problem.node_costs
    if instance.depots:
        first, last = instance.depots[0] - 1, instance.depots[-1] - 1
        weights[first, place] = problem.start_costs + problem.node_costs
        weights[place, last] = problem.end_costs
    elif not problem.closed:
        # the first node's own cost is paid on the way out: it has no way in
        begin = place[np.isfinite(problem.start_costs)]
        own = problem.node_costs + np.where(np.isfinite(problem.start_costs), problem.start_costs, 0.0)
        weights[begin] += own[np.isfinite(problem.start_costs)][:, None]
        weights[:, place] += np.where(np.isfinite(problem.end_costs), problem.end_costs, 0.0)
    if instance.kind in ("GTSP", "PCGTSP"):
        same = problem.cluster[:, None] == problem.cluster
        weights[np.ix_(place, place)] = np.where(same, np.inf, weights[np.ix_(place, place)])
    return weights


def _mark_precedence(matrix: IntArray, instance: Instance) -> None:
    """-1 where the column's node must come before the row's, as the format wants it."""
    place = instance.numbers - 1
    pairs = instance.problem.precedence
    matrix[place[pairs[:, 1]], place[pairs[:, 0]]] = int(FORBIDDEN)
    matrix[1:, 0], matrix[-1, :-1] = int(FORBIDDEN), int(FORBIDDEN)


def _set_lines(instance: Instance) -> list[str]:
    """Sets, and for precedence their order and the start group."""
    problem = instance.problem
    depots = len(instance.depots)
    groups = [[instance.depots[0]]] if depots else []
    groups += [instance.numbers[problem.cluster == c].tolist() for c in range(problem.clusters)]
    lines = ["GTSP_SET_SECTION"]
    lines += [f"{k} {' '.join(map(str, group))} -1" for k, group in enumerate(groups, start=1)]
    if instance.kind == "PCGTSP":
        lines.append("GTSP_SET_ORDERING")
        for c in np.unique(problem.precedence[:, 0]).tolist():
            others = problem.precedence[problem.precedence[:, 0] == c, 1] + 1 + depots
            lines.append(f"{c + 1 + depots} {' '.join(map(str, sorted(others.tolist())))} -1")
        start = 1 if depots else int(problem.cluster[np.isfinite(problem.start_costs)][0]) + 1
        lines += ["START_GROUP_SECTION", str(start)]
    return lines
