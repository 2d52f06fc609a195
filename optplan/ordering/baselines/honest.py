"""What a method that ignores a rule says about its answer."""

from __future__ import annotations

import math

import numpy as np

from optplan.domain.arrays import IntArray
from optplan.domain.ordering import OrderingProblem
from optplan.ordering.method import Run


def offer_as_published(run: Run, nodes: IntArray) -> None:
    """Offer a path that was found without looking at precedence; where it is no solution, say why in the message."""
    if run.offer(nodes):
        run.message = ""
        return
    problem = run.problem
    broken, cost = broken_rules(problem, nodes), problem.cost_of(nodes)
    order = f"its order of {cost:.6g}" if math.isfinite(cost) else "its order"
    if broken:
        rules = len(problem.precedence)
        run.message = f"as published it does not look at precedence: {order} breaks {broken} of {rules} rules"
    elif not math.isfinite(cost):
        run.message = "as published it does not look ahead: its order uses an arc that does not exist"


def broken_rules(problem: OrderingProblem, nodes: IntArray) -> int:
    """How many precedence pairs a path (m,) through all clusters breaks."""
    place = np.empty(problem.clusters, dtype=np.int64)
    place[problem.cluster[nodes]] = np.arange(problem.clusters)
    return int((place[problem.precedence[:, 0]] > place[problem.precedence[:, 1]]).sum())
