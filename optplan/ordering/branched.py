"""Tours by branching on assignments: good, often optimal, where costs are strongly asymmetric."""

from __future__ import annotations

import math
from collections.abc import Callable
from typing import TYPE_CHECKING

import numpy as np

from optplan.domain.arrays import IntArray

if TYPE_CHECKING:
    from optplan.ordering._kernels.tour import Graph

MOST = 1000
"""Clusters up to which it is tried: a step of it grows with their square at least."""
DEPTH = 100
"""Arcs excluded at once."""
LOOKS = 5_000_000
"""Costs looked at between two looks at the stop rule: a few hundredths of a second."""


def branchable(graph: Graph) -> bool:
    """Whether tours of this graph are assignments without cycles, and costs of both directions differ."""
    from optplan.ordering._kernels.tour import DISTANT, MIRROR, ORDER

    size = len(graph.data)
    return bool(not graph.flags[[DISTANT, MIRROR, ORDER]].any() and size == len(graph.first) - 1 and 2 < size <= MOST)


def branched(graph: Graph, start: IntArray, stop: Callable[[], object], looks: float) -> tuple[IntArray, bool]:
    """The better of the tour `start` and the best one found with so many looks at costs; whether it is optimal.

    Both begin with the same cluster. Branch and bound by depth first (G. Carpaneto and P. Toth, 1980): the cycles of an
    assignment are patched together to a tour, and one of them is forbidden in as many ways as it has arcs.
    """
    from optplan.ordering._kernels.assignment import assign
    from optplan.ordering._kernels.branched import LEFT_OUT, WORK, Tree, branch

    size = len(graph.data)
    costs = graph.data.copy()
    np.fill_diagonal(costs, math.inf)
    best = np.empty(size, dtype=np.int64)
    best[start] = np.roll(start, -1)
    price, row_of = np.zeros((DEPTH, size)), np.full((DEPTH, size), -1, dtype=np.int64)
    row = 0
    while row < size:
        if stop():
            return start, False
        row = assign(costs, price[0], row_of[0], row, LOOKS)
    step = 1.0 - 1e-6 if (graph.data == np.rint(graph.data)).all() else 0.0
    tree = Tree(
        costs,
        best,
        price,
        row_of,
        np.zeros((DEPTH, size), dtype=np.bool_),
        np.zeros((DEPTH, size), dtype=np.int64),
        np.zeros((DEPTH, size)),
        np.zeros((DEPTH, 3), dtype=np.int64),
        np.zeros(DEPTH),
        np.array([graph.data[start, best[start]].sum(), step]),
        np.array([-1, 0, 0]),
    )
    optimal = False
    while not optimal and looks > 0 and not stop():
        optimal = branch(tree, LOOKS)
        looks -= LOOKS - int(tree.place[WORK])
    tour = [int(start[0])]
    while len(tour) < size:
        tour.append(int(best[tour[-1]]))
    return np.array(tour, dtype=np.int64), bool(optimal and not tree.place[LEFT_OUT])
