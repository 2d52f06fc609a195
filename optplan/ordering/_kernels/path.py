"""A path that a search changes, and its cost."""

from __future__ import annotations

from typing import NamedTuple

import numpy as np
import numpy.typing as npt

from optplan.compiled import njit
from optplan.domain.arrays import FloatArray, IntArray
from optplan.ordering._kernels.costs import Costs, Structure, arc


class Path(NamedTuple):
    """A path: nodes (m,), place (m,) of each cluster in it, and sums (4, m).

    Row 0: cost of arriving at place p from p - 1 and of the node there; row 1: the same travelled backwards by the
    partners; rows 2 and 3: their running totals.
    """

    nodes: IntArray
    place: IntArray
    sums: FloatArray


class Work(NamedTuple):
    """What the search remembers between two slices.

    queue (2, m): ring of clusters to look at, and whether a cluster is in it; value, parent (n,) of the dynamic
    programme; buffer (m,); counters (8,), see the constants below; cost (3,): now, best, smallest gain that counts;
    random (1,) state of the generator.
    """

    queue: IntArray
    value: FloatArray
    parent: IntArray
    buffer: IntArray
    counters: IntArray
    cost: FloatArray
    random: npt.NDArray[np.uint64]


HEAD, WAITING, ITERATIONS, LAYER, SWEEP, FINISHED, EFFORT, ENDS = 0, 1, 2, 3, 4, 5, 6, 7


@njit(cache=True, nogil=True)
def at(nodes: IntArray, p: int) -> int:
    """The node at place p, or -1 for a depot."""
    return nodes[p] if 0 <= p < len(nodes) else -1


@njit(cache=True, nogil=True)
def refresh(costs: Costs, structure: Structure, path: Path, low: int, high: int) -> float:
    """Bring places and sums up to date after nodes[low..high] changed; the path's cost."""
    nodes, sums, partner = path.nodes, path.sums, structure.partner
    count = len(nodes)
    for p in range(low, min(high + 2, count)):
        here = nodes[p]
        path.place[structure.cluster[here]] = p
        sums[0, p] = costs.ends[2, here]
        sums[1, p] = costs.ends[2, partner[here]]
        if p > 0:
            sums[0, p] += arc(costs, nodes[p - 1], here)
            sums[1, p] += arc(costs, partner[here], partner[nodes[p - 1]])
    for p in range(low, count):
        sums[2, p] = sums[0, p] + (sums[2, p - 1] if p > 0 else 0.0)
        sums[3, p] = sums[1, p] + (sums[3, p - 1] if p > 0 else 0.0)
    return float(costs.ends[0, nodes[0]] + sums[2, count - 1] + costs.ends[1, nodes[count - 1]])


@njit(cache=True, nogil=True)
def push(queue: IntArray, counters: IntArray, cluster: IntArray, nodes: IntArray, p: int) -> None:
    """Look at the cluster at place p again."""
    count = len(nodes)
    if 0 <= p < count:
        c = cluster[nodes[p]]
        if queue[1, c] == 0:
            queue[1, c] = 1
            queue[0, (counters[HEAD] + counters[WAITING]) % count] = c
            counters[WAITING] += 1


@njit(cache=True, nogil=True)
def copy(source: Path, target: Path) -> None:
    """Make one path equal to another (loops, because slice assignment brings numba's string functions along)."""
    for p in range(len(source.nodes)):
        target.nodes[p] = source.nodes[p]
        target.place[p] = source.place[p]
        for row in range(4):
            target.sums[row, p] = source.sums[row, p]
