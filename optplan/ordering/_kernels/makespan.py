"""Annealing of several paths, the longest of which is to be short, in compiled code."""

from __future__ import annotations

import math

import numpy as np
import numpy.typing as npt

from optplan.compiled import njit
from optplan.domain.arrays import FloatArray, IntArray
from optplan.ordering._kernels.history import BITS, propose
from optplan.ordering._kernels.tour import draw

TOTAL = 1e-3
"""Weight of the sum of all paths, besides the longest."""


@njit(cache=True, nogil=True)
def longest(order: IntArray, work: FloatArray, costs: FloatArray, breaks: int) -> tuple[float, float]:
    """The longest path, and the sum of all, in an order whose nodes from `breaks` on begin a new path.

    costs (n, n) between nodes, those from a break being what a path's beginning costs; work (n,) of each node.
    """
    most = total = here = 0.0
    for i in range(len(order)):
        node = order[i]
        if i > 0:
            here += costs[order[i - 1], node]
        if node >= breaks:
            most = max(most, here)
            total += here
            here = 0.0
        else:
            here += work[node]
    return max(most, here), total + here


@njit(cache=True, nogil=True)
def anneal_makespan(
    order: IntArray,
    best: IntArray,
    cluster: IntArray,
    twin: IntArray,
    first: IntArray,
    members: IntArray,
    work: FloatArray,
    costs: FloatArray,
    breaks: int,
    value: float,
    known: float,
    hot: float,
    cold: float,
    steps: int,
    random: npt.NDArray[np.uint64],
) -> tuple[float, float]:
    """So many steps from `order`, which is changed, as is `best`; returns the values of both: longest path + `TOTAL`
    times the sum."""
    m = len(order)
    tried = np.empty(m, dtype=np.int64)
    for step in range(steps):
        heat = hot * (cold / hot) ** (step / steps)
        for i in range(m):
            tried[i] = order[i]
        if not propose(order, tried, cluster, twin, first, members, random):
            continue
        if tried[0] < breaks:  # the first path begins like the others
            continue
        most, total = longest(tried, work, costs, breaks)
        new = most + TOTAL * total
        if new <= value or (new < math.inf and draw(random, BITS) / BITS < math.exp((value - new) / heat)):
            value = new
            for i in range(m):
                order[i] = tried[i]
            if value < known - 1e-9:
                known = value
                for i in range(m):
                    best[i] = order[i]
    return value, known
