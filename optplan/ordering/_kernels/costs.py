"""Arc costs on demand, and the arrays that all kernels share."""

from __future__ import annotations

import math
from typing import NamedTuple

from optplan.compiled import njit
from optplan.domain.arrays import FloatArray, IntArray
from optplan.geometry._kernels.dubins import dubins_length


class Costs(NamedTuple):
    """Arc costs as arrays. `kind` 0: a matrix; 1: straight lines; 2: Dubins paths of that radius (x, y, heading).

    data (n, n) matrix, or (n, 2 d): where each node is entered, then where it is left. ends (3, n): cost of a node as
    the first, as the last, and wherever it is. Infinite costs have been replaced by a large penalty: a search may pass
    through an impossible order on its way to a possible one.

    Few arrays, because numba counts references to each of them at each call.
    """

    kind: int
    radius: float
    data: FloatArray
    ends: FloatArray


class Structure(NamedTuple):
    """Who belongs to whom.

    cluster (n,); first (m + 1,) nodes of a cluster; the direct predecessors of cluster c are
    before[before[c]:before[c + 1]], its successors after[after[c]:...].
    """

    cluster: IntArray
    first: IntArray
    before: IntArray
    after: IntArray


@njit(cache=True, nogil=True)
def arc(costs: Costs, i: int, j: int) -> float:
    """Cost of going from node i to node j."""
    data = costs.data
    if costs.kind == 0:
        return float(data[i, j])
    if costs.kind == 1:
        half = data.shape[1] // 2
        total = 0.0
        for k in range(half):
            step = data[i, half + k] - data[j, k]
            total += step * step
        return math.sqrt(total)
    return dubins_length(data[i, 3], data[i, 4], data[i, 5], data[j, 0], data[j, 1], data[j, 2], costs.radius)
