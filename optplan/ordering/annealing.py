"""One annealing: from a path to the best path that the kernel finds while the limits last."""

from __future__ import annotations

import math
import time
from typing import TYPE_CHECKING

import numpy as np

from optplan.domain.arrays import IntArray
from optplan.domain.stop import StopReason
from optplan.ordering.method import Run

if TYPE_CHECKING:
    from optplan.ordering._kernels.tour import Graph, State

HOT = 2.0
COLD, MILD = 0.02, 0.05
"""Temperatures in the beginning and at the end of a run, in mean arcs of the best path: one of fewer than `EACH`
iterations a cluster ends mild, as it has no time to freeze."""
LEAST, EACH = 5_000, 200
"""Iterations when nothing ends the search, and those added for each cluster."""
SLICE = 0.03
"""Seconds between two looks at the stop rule."""
ENDLESS = 2**62


def anneal(run: Run, graph: Graph, anchor: int | None, start: IntArray, hot: float = HOT) -> StopReason:
    """Anneal from this path, while the limits last; the temperature falls from `hot` mean arcs of the best path."""
    from optplan.ordering._kernels.search import search as advance
    from optplan.ordering._kernels.tour import BEST, FINISHED, ITERATION

    state = _state(graph, run.problem.cluster[start], start, run.seed)
    limit = run.rule.iterations
    timed = limit is None and math.isfinite(run.rule.seconds)
    if limit is None:
        limit = ENDLESS if timed else LEAST + EACH * run.problem.clusters
    cold = COLD if limit >= EACH * run.problem.clusters else MILD
    known, budget, used = math.inf, 500, 0.0
    while True:
        began = time.perf_counter()
        if timed:
            used = min(1.0, run.clock.elapsed / run.rule.seconds)
        now = hot * (cold / hot) ** used
        advance(graph, state, limit, run.rule.target, budget, now, cold, 0 if timed else limit)
        run.iterations = int(state.counts[ITERATION])
        if state.cost[BEST] < known:
            known = float(state.cost[BEST])
            run.offer(_path(state, anchor, len(graph.first) - 2))
        stop = run.stop()
        if stop or state.counts[FINISHED]:
            return stop or StopReason.FINISHED
        # how long a slice takes changes only when the rules are looked at, not what is found
        spent = max(time.perf_counter() - began, 1e-6)
        budget = int(budget * min(2.0, max(0.5, SLICE / spent)))


def _state(graph: Graph, clusters: IntArray, nodes: IntArray, seed: int) -> State:
    """The search at its beginning, with every cluster in the queue."""
    from optplan.ordering._kernels.tour import ACTIVE, ANCHOR, END, QUEUE, State
    from optplan.ordering._kernels.tour import total as cost_of

    anchor, size = int(graph.flags[ANCHOR]), len(graph.first) - 1
    if len(clusters) < size:
        clusters, nodes = np.append(anchor, clusters), np.append(graph.first[anchor], nodes)
    rows = np.zeros((size, 4), dtype=np.int64)
    steps = np.arange(size) * (END // (size + 1))
    rows[clusters] = np.column_stack([np.roll(clusters, -1), np.roll(clusters, 1), nodes, steps])
    lists, marks = np.zeros((5, size), dtype=np.int64), np.full((5, size), -1, dtype=np.int64)
    lists[ACTIVE], lists[QUEUE] = clusters, clusters
    marks[ACTIVE:] = 0
    marks[QUEUE] = 1
    count = np.zeros(9, dtype=np.int64)
    count[ACTIVE] = count[QUEUE] = size
    cost = float(cost_of(graph, rows))
    mean = max(abs(cost + graph.offset) / size, 1e-300)
    return State(
        rows,
        rows.copy(),
        rows[:, [0, 2]].copy(),
        marks,
        lists,
        np.zeros(graph.first[-1]),
        np.zeros(graph.first[-1], dtype=np.int64),
        count,
        # gains in the last digits are rounding, and could go on for ever
        np.array([cost, cost, cost, 1e-10 * mean]),
        np.array([seed % 2**64], dtype=np.uint64),
    )


def _path(state: State, anchor: int | None, depot: int) -> IntArray:
    """The best tour's nodes from the anchor on; without the depot."""
    following, nodes = state.best.T.tolist()
    first = depot if anchor is None else anchor
    path, c = [], following[first]
    while c != first:
        path.append(nodes[c])
        c = following[c]
    return np.array(path if anchor is None else [nodes[first], *path], dtype=np.int64)
