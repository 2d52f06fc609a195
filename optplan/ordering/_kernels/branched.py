"""Tours from assignments: cycles are patched together, and branching on the arcs of a cycle forbids it.

After G. Carpaneto and P. Toth, Some new branching and bounding criteria for the asymmetric travelling salesman problem,
Management Science 26 (1980), with the patching of R. Karp, SIAM Journal on Computing 8 (1979).
"""

from __future__ import annotations

import math
from typing import NamedTuple

import numpy as np
import numpy.typing as npt

from optplan.compiled import njit
from optplan.domain.arrays import FloatArray, IntArray
from optplan.ordering._kernels.assignment import augment

BEST, STEP = 0, 1
LEVEL, WORK, LEFT_OUT = 0, 1, 2


class Tree(NamedTuple):
    """Branching by depth first, and what is remembered between two slices.

    costs (m, m), that of excluded arcs infinite; best (m,) the successors in the best tour; of each level (d, m): price
    and row_of of the assignment; which columns are fixed; columns, those of the arcs to branch on; bound, what the
    subproblem without such an arc costs at least, infinite when that is done. At level d - 1 nothing branches. counts
    (d, 3): the arcs to branch on, and row and column of the arc that is excluded there, which costs excluded (d,).
    cost (2,): of the best tour, and by how much a better one costs less at least. place (3,): the level, how
    many costs may still be looked at, and whether a subproblem was too deep to be branched on.
    """

    costs: FloatArray
    best: IntArray
    price: FloatArray
    row_of: IntArray
    fixed: npt.NDArray[np.bool_]
    columns: IntArray
    bound: FloatArray
    counts: IntArray
    excluded: FloatArray
    cost: FloatArray
    place: IntArray


@njit(cache=True, nogil=True)
def _cycles(row_of: IntArray, label: IntArray) -> int:
    """How many cycles there are; label (m,) becomes that of each cluster."""
    label[:] = -1
    count = 0
    for c in range(len(row_of)):
        if label[c] < 0:
            while label[c] < 0:
                label[c] = count
                c = row_of[c]
            count += 1
    return count


@njit(cache=True, nogil=True)
def _patch(tree: Tree, row_of: IntArray, label: IntArray, cycles: int) -> None:
    """Join the cycles: always the smallest with another one, by the cheapest exchange of an arc of each."""
    costs, size = tree.costs, len(row_of)
    while cycles > 1:
        sizes = np.zeros(cycles, dtype=np.int64)
        for c in range(size):
            sizes[label[c]] += 1
        small = int(sizes.argmin())
        best, one, two = math.inf, -1, -1
        for c in range(size):
            if label[c] == small:
                i = row_of[c]
                for d in range(size):
                    if label[d] != small:
                        j = row_of[d]
                        rise = costs[i, d] + costs[j, c] - costs[i, c] - costs[j, d]
                        if rise < best:
                            best, one, two = rise, c, d
        if one < 0:
            return
        row_of[one], row_of[two] = row_of[two], row_of[one]
        cycles = _cycles(row_of, label)
    tree.place[WORK] -= size * size
    cost = _cost(tree, row_of)
    if cost < tree.cost[BEST]:
        tree.cost[BEST] = cost
        for c in range(size):
            tree.best[row_of[c]] = c


@njit(cache=True, nogil=True)
def _cost(tree: Tree, row_of: IntArray) -> float:
    cost = 0.0
    for c in range(len(row_of)):
        cost += tree.costs[row_of[c], c]
    return cost


@njit(cache=True, nogil=True)
def _without(
    tree: Tree, price: FloatArray, row_of: IntArray, fixed: npt.NDArray[np.bool_], column: int, cost: float
) -> float:
    """Assign anew the row of this column to another one; what the assignment, that costs `cost`, costs then."""
    row = row_of[column]
    saved, free = tree.costs[row, column], price[column]
    tree.costs[row, column] = math.inf
    row_of[column] = -1
    others = cost - saved + free
    more, looks = augment(tree.costs, price, row_of, fixed, row, tree.cost[BEST] - tree.cost[STEP] - others)
    tree.costs[row, column] = saved
    tree.place[WORK] -= looks
    return float(others + more)


@njit(cache=True, nogil=True)
def _expand(tree: Tree, level: int) -> None:
    """Patch the cycles of the assignment of a level; when a better tour is possible, list the arcs to branch on."""
    row_of, counts, size = tree.row_of[level], tree.counts, len(tree.best)
    counts[level, 0] = 0
    label = np.empty(size, dtype=np.int64)
    cycles = _cycles(row_of, label)
    free = np.zeros(cycles, dtype=np.int64)
    for c in range(size):
        free[label[c]] += not tree.fixed[level, c]
    patched = row_of.copy()
    _patch(tree, patched, label.copy(), cycles)
    cost = _cost(tree, row_of)
    if cycles == 1 or cost > tree.cost[BEST] - tree.cost[STEP]:
        return
    if level + 1 == len(tree.price):
        tree.place[LEFT_OUT] = 1
        return
    fewest = int(free.argmin())
    # columns become fixed in the order in which they are listed
    fixed = tree.fixed[level].copy()
    count = 0
    for c in range(size):
        if label[c] == fewest and not fixed[c]:
            bound = _without(tree, tree.price[level].copy(), row_of.copy(), fixed, c, cost)
            tree.columns[level, count], tree.bound[level, count] = c, bound
            fixed[c] = True
            count += 1
    counts[level, 0] = count


@njit(cache=True, nogil=True)
def branch(tree: Tree, budget: int) -> bool:
    """Go on for about `budget` looks at costs; whether there is nothing left to do."""
    counts, place = tree.counts, tree.place
    place[WORK] = budget
    if place[LEVEL] < 0:
        place[LEVEL] = 0
        _expand(tree, 0)
    while place[WORK] > 0:
        level = place[LEVEL]
        count = counts[level, 0]
        least, chosen = tree.cost[BEST] - tree.cost[STEP], -1
        for k in range(count):
            if tree.bound[level, k] <= least:
                least, chosen = tree.bound[level, k], k
        if chosen < 0:
            if level == 0:
                return True
            tree.costs[counts[level, 1], counts[level, 2]] = tree.excluded[level]
            place[LEVEL] -= 1
            continue
        below = level + 1
        tree.price[below], tree.row_of[below] = tree.price[level], tree.row_of[level]
        tree.fixed[below] = tree.fixed[level]
        for k in range(chosen):
            tree.fixed[below, tree.columns[level, k]] = True
        tree.bound[level, chosen] = math.inf
        column = tree.columns[level, chosen]
        row = tree.row_of[level, column]
        cost = _cost(tree, tree.row_of[level])
        if math.isinf(_without(tree, tree.price[below], tree.row_of[below], tree.fixed[below], column, cost)):
            # as good as the best tour but for rounding, which may be another now: there is no such assignment
            continue
        tree.excluded[below] = tree.costs[row, column]
        tree.costs[row, column] = math.inf
        place[LEVEL] = below
        _expand(tree, below)
        counts[below, 1], counts[below, 2] = row, column
    return False
