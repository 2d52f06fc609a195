"""Other programs on the same problems: OR-Tools and PyVRP, where `.peers` holds them (`make .peers/.ready`)."""

from __future__ import annotations

import json
import math
import subprocess
from pathlib import Path

import numpy as np

from optplan.domain.arrays import IntArray
from optplan.domain.ordering import OrderingProblem
from optplan.ordering.opened import opened

HERE = Path(__file__).parent
PYTHON = HERE.parent / ".peers" / "bin" / "python"
PEERS = ("or-tools", "pyvrp")
FINE = 10_000.0
"""Peers count in whole numbers: costs that are none are taken as multiples of the mean arc over this."""


def available() -> bool:
    """Whether peers are installed."""
    return (PYTHON.parent.parent / ".ready").is_file()


def peer_cost(problem: OrderingProblem, peer: str, seconds: float) -> float:
    """Cost of what a peer finds in so many seconds, checked and counted here; infinite when it finds nothing valid."""
    if not problem.closed:
        nodes = _ask(problem, peer, seconds)
        return problem.cost_of(nodes) if len(nodes) and not problem.faults(nodes) else math.inf
    best, ways = math.inf, opened(problem)
    for way in ways:
        nodes = _ask(way.problem, peer, seconds / len(ways))
        tour = way.expand(nodes) if len(nodes) else nodes
        if len(tour) and not problem.faults(tour):
            best = min(best, problem.cost_of(tour))
    return best


def _ask(path: OrderingProblem, peer: str, seconds: float) -> IntArray:
    """The nodes of a path that a peer finds; none when it finds nothing."""
    everything = np.arange(path.nodes)
    costs = np.zeros((path.nodes + 1, path.nodes + 1))
    costs[0, 1:], costs[1:, 0] = path.start_costs + path.node_costs, path.end_costs
    for i in everything.tolist():
        costs[i + 1, 1:] = path.costs.pairs(np.full(path.nodes, i), everything) + path.node_costs
    known = np.isfinite(costs)
    whole = bool((costs[known] == np.round(costs[known])).all())
    scale = 1.0 if whole else FINE / float(np.abs(costs[known]).mean())
    # what is forbidden costs more than any path without it
    costs[~known] = costs[known].max() * (path.clusters + 1)
    question = {
        "costs": np.round(scale * costs).astype(np.int64).tolist(),
        "clusters": [(1 + np.flatnonzero(path.cluster == c)).tolist() for c in range(path.clusters)],
        "precedence": path.precedence.tolist(),
    }
    command = [str(PYTHON), str(HERE / "peer_worker.py"), peer, str(seconds)]
    done = subprocess.run(command, input=json.dumps(question), capture_output=True, text=True, check=True)
    return np.array(json.loads(done.stdout), dtype=np.int64) - 1
