"""Nearest feasible neighbour."""

from __future__ import annotations

import math

import numpy as np

from optplan.compiled import njit
from optplan.domain.arrays import FloatArray, IntArray
from optplan.ordering._kernels.costs import Costs, Structure, arc


@njit(cache=True, nogil=True)
def _choose(costs: Costs, here: int, low: int, high: int, last: bool, best: float) -> tuple[int, float]:
    """The cheapest node in low..high-1 to go to from `here`, if cheaper than `best`, and its cost."""
    chosen = -1
    for k in range(low, high):
        extra = costs.ends[2, k]
        if last:
            extra += costs.ends[1, k]
        if costs.kind == 2:
            # the straight line bounds a Dubins path and spares most of them
            straight = math.hypot(costs.data[here, 3] - costs.data[k, 0], costs.data[here, 4] - costs.data[k, 1])
            if straight + extra >= best:
                continue
        cost = arc(costs, here, k) + extra
        if cost < best:
            best = cost
            chosen = k
    return chosen, best


@njit(cache=True, nogil=True)
def nearest(
    costs: Costs,
    structure: Structure,
    may_end: IntArray,
    nodes: IntArray,
    waiting: IntArray,
    alive: IntArray,
    done: int,
    steps: int,
) -> int:
    """Extend nodes[:done] by up to `steps` nearest feasible nodes; the new `done`.

    may_end (m,) says where a path may end: the last such cluster is kept back. waiting (m,) counts a cluster's
    predecessors to come, alive (m,) lists the clusters to come in order (the first m - done of it), so that ties go to
    the lowest node; both are updated.
    """
    count = len(waiting)
    cluster, first = structure.cluster, structure.first
    finals = 0
    for a in range(count - done):
        finals += may_end[alive[a]]
    while done < count and steps > 0:
        steps -= 1
        left = count - done
        here = nodes[done - 1]
        best = math.inf
        chosen, place = -1, -1
        for a in range(left):
            c = alive[a]
            if waiting[c] > 0 or (left > 1 and finals == 1 and may_end[c] == 1):
                continue
            node, cost = _choose(costs, here, first[c], first[c + 1], left == 1, best)
            if node >= 0:
                best, chosen, place = cost, node, a
        if chosen < 0:
            # precedence forces the kept-back cluster now: take any that is ready
            for a in range(left):
                if waiting[alive[a]] == 0:
                    chosen, place = first[alive[a]], a
                    break
        c = cluster[chosen]
        nodes[done] = chosen
        done += 1
        finals -= may_end[c]
        for a in range(place, left - 1):
            alive[a] = alive[a + 1]
        for a in range(structure.after[c], structure.after[c + 1]):
            waiting[structure.after[a]] -= 1
    return done


@njit(cache=True, nogil=True)
def set_distances(exits: FloatArray, entries: FloatArray, first: IntArray, pairs: IntArray) -> FloatArray:
    """Smallest straight-line distance (k,) between clusters pairs (k, 2), in either direction."""
    result = np.empty(len(pairs))
    for p in range(len(pairs)):
        a, b = pairs[p, 0], pairs[p, 1]
        best = _least_square(exits, entries, first[a], first[a + 1], first[b], first[b + 1], math.inf)
        result[p] = math.sqrt(_least_square(entries, exits, first[a], first[a + 1], first[b], first[b + 1], best))
    return result


@njit(cache=True, nogil=True)
def _least_square(
    tails: FloatArray, heads: FloatArray, low: int, high: int, other_low: int, other_high: int, best: float
) -> float:
    """Least squared distance from tails[low:high] to heads[other_low:other_high], if below `best`."""
    size = tails.shape[1]
    lower, upper = np.empty(size), np.empty(size)
    for k in range(size):
        lower[k], upper[k] = math.inf, -math.inf
        for j in range(other_low, other_high):
            lower[k] = min(lower[k], heads[j, k])
            upper[k] = max(upper[k], heads[j, k])
    for i in range(low, high):
        # most points are further from the other's bounding box than the best pair is apart
        box = 0.0
        for k in range(size):
            gap = max(lower[k] - tails[i, k], tails[i, k] - upper[k], 0.0)
            box += gap * gap
        if box >= best:
            continue
        for j in range(other_low, other_high):
            square = 0.0
            for k in range(size):
                step = tails[i, k] - heads[j, k]
                square += step * step
            best = min(best, square)
    return best
