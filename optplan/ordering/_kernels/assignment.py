"""The assignment problem by shortest augmenting paths, in slices."""

from __future__ import annotations

import math

import numpy as np
import numpy.typing as npt

from optplan.compiled import njit
from optplan.domain.arrays import FloatArray, IntArray


@njit(cache=True, nogil=True)
def assign(costs: FloatArray, price: FloatArray, row_of: IntArray, row: int, budget: int) -> int:
    """Assign the rows from `row` on to columns, for about `budget` looks at a cost; the first row that is left.

    price (m,) of each column and row_of (m,), the row that it is assigned to or -1, go on from what an earlier slice
    left. Every assigned row has at its column the least cost less price, before, between and after slices.
    """
    size = len(costs)
    fixed = np.zeros(size, dtype=np.bool_)
    while row < size and budget > 0:
        _, looks = augment(costs, price, row_of, fixed, row, math.inf)
        budget -= looks
        row += 1
    return row


@njit(cache=True, nogil=True)
def augment(
    costs: FloatArray, price: FloatArray, row_of: IntArray, fixed: npt.NDArray[np.bool_], row: int, most: float
) -> tuple[float, int]:
    """Assign one more row, by a path that leaves the columns `fixed` alone.

    Returns by how much all rows together cost more, less the price of the column that was free, and the number of looks
    at a cost. When it is more than `most`, that is infinite, and nothing changes.
    """
    size = len(costs)
    length = costs[row] - price
    parent = np.full(size, row)
    scanned = fixed.copy()
    order = np.empty(size, dtype=np.int64)
    count = 0
    while True:
        least, column = math.inf, -1
        for k in range(size):
            # of equal ones a free column ends the search
            if not scanned[k] and (length[k] < least or (length[k] == least and row_of[k] < 0)):
                least, column = length[k], k
        if column < 0 or least > most:
            return math.inf, size * (count + 1)
        if row_of[column] < 0:
            break
        scanned[column] = True
        order[count] = column
        count += 1
        i = row_of[column]
        base = least - (costs[i, column] - price[column])
        for k in range(size):
            if not scanned[k]:
                there = base + costs[i, k] - price[k]
                if there < length[k]:
                    length[k], parent[k] = there, i
    for a in range(count):
        price[order[a]] += length[order[a]] - least
    # along the path every row moves on to the next column
    while True:
        i = parent[column]
        earlier = -1
        if i != row:
            for a in range(count):
                if row_of[order[a]] == i:
                    earlier = order[a]
                    break
        row_of[column] = i
        if i == row:
            return least, size * (count + 1)
        column = earlier
