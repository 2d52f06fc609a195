"""Annealed iterations of perturbation and descent, in slices."""

from __future__ import annotations

import math

from optplan.compiled import njit
from optplan.ordering._kernels.borrow import borrowed
from optplan.ordering._kernels.choice import choose_all, choose_around
from optplan.ordering._kernels.exchange import bridge, improve
from optplan.ordering._kernels.ruin import recreate, ruin
from optplan.ordering._kernels.tour import (
    ACTIVE,
    BEFORE,
    BEST,
    CHANGED,
    CHOICES,
    FINISHED,
    GAIN,
    HEAD,
    ITERATION,
    NOW,
    QUEUE,
    WORK,
    Graph,
    State,
    draw,
    keep,
    push,
    take_back,
    total,
)

BRIDGES = 3
"""Of ten perturbations so many swap two pieces; the others ruin and recreate."""
TOGETHER = 20_000
"""Arcs that a choice of all nodes may look at each time the best tour is improved; if more, it is done less often."""
ALWAYS = 1000
"""Arcs up to which all nodes are chosen anew in every iteration."""
EXACTLY = 8192
"""Iterations after which the cost is summed anew: rounding must not pile up."""


@njit(cache=True, nogil=True)
def search(
    graph: Graph, state: State, limit: int, target: float, budget: int, hot: float, cold: float, schedule: int
) -> None:
    """Go on for about `budget` units of work (some us), or until `limit` iterations or the target (counts[FINISHED]).

    One iteration perturbs the tour, descends to the next local optimum, and keeps the result or takes it back, as in
    simulated annealing. The temperature falls from `hot` to `cold` mean arcs of the best tour over `schedule`
    iterations; 0: it stays hot. The descent from the first tour is not counted.
    """
    _search(borrowed(graph), borrowed(state), limit, target, budget, hot, cold, schedule)


@njit(cache=True, nogil=True)
def _search(
    graph: Graph, state: State, limit: int, target: float, budget: int, hot: float, cold: float, schedule: int
) -> None:
    count, lists, cost = state.counts, state.lists, state.cost
    size, choices = len(state.rows), graph.flags[CHOICES]
    count[WORK] = 0
    while count[WORK] < budget:
        count[WORK] += 1
        if count[QUEUE] > 0:
            c = lists[QUEUE, count[HEAD]]
            count[HEAD] = count[HEAD] + 1 if count[HEAD] + 1 < size else 0
            count[QUEUE] -= 1
            state.marks[QUEUE, c] = 0
            if improve(graph, state, c):
                push(state, c)
            continue
        if choices:
            choose_around(graph, state)
            better = cost[NOW] < cost[BEST] - cost[GAIN] or count[ITERATION] == 0
            whole = choices <= ALWAYS or (better and draw(state.random, 1 + choices // TOGETHER) == 0)
            if whole and choose_all(graph, state):
                continue
        temperature = hot * (cold / hot) ** (count[ITERATION] / schedule) if schedule > 0 else hot
        temperature *= abs(cost[BEST] + graph.offset) / size
        chance = (draw(state.random, 2**31) + 1.0) / 2**31
        if cost[NOW] < cost[BEFORE] - temperature * math.log(chance) or count[ITERATION] == 0:
            keep(state)
        else:
            take_back(state)
        count[CHANGED] = 0
        count[ACTIVE] = 0
        if count[ITERATION] >= limit or cost[BEST] + graph.offset <= target:
            count[FINISHED] = 1
            return
        count[ITERATION] += 1
        if count[ITERATION] % EXACTLY == 0:
            cost[NOW] = cost[BEFORE] = total(graph, state.rows)
        c = draw(state.random, size)
        if draw(state.random, 10) >= BRIDGES or not bridge(graph, state, c):
            ruin(graph, state, c)
            recreate(graph, state)
        if choices:
            # an order is judged with its own nodes, not with those of the order before it
            choose_around(graph, state)
            if choices <= ALWAYS:
                choose_all(graph, state)
