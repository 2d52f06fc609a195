"""Shortest walks through the places of a path: the bound that guides the dynamic programme over order ideals."""

from __future__ import annotations

import math
from typing import NamedTuple

from optplan.compiled import njit
from optplan.domain.arrays import BoolArray, FloatArray, IntArray
from optplan.ordering._kernels.ideals import ShortArray


class Links(NamedTuple):
    """Arcs that are left: those of tail i are first[i] .. first[i + 1] - 1, with their heads and costs."""

    first: IntArray
    head: IntArray
    cost: FloatArray


class Walks(NamedTuple):
    """Least costs (m, n) of walks that go on from a node at a place to the last place.

    best: over all next clusters; second: over all but `following`, the next cluster of the best (m where there is
    none).
    """

    best: FloatArray
    second: FloatArray
    following: ShortArray


@njit(cache=True, nogil=True)
def walk_back(
    links: Links,
    end: FloatArray,
    cluster: IntArray,
    alive: BoolArray,
    never: BoolArray,
    walks: Walks,
    high: int,
    low: int,
) -> None:
    """Fill the places high, high - 1, ..., low of `walks`.

    A walk visits a node at each place, alive (m, n) there. It may visit a cluster twice, but not at once: nor does it
    go on from cluster a over another one to cluster b with never[a, b] (m, m + 1).
    """
    best, second, following = walks.best, walks.second, walks.following
    count, size = best.shape
    nothing = count
    for k in range(high, low - 1, -1):
        for i in range(size):
            least, other, group = math.inf, math.inf, nothing
            if not alive[k, i]:
                pass
            elif k == count - 1:
                least = end[i]
            else:
                forbidden = never[cluster[i]]
                for a in range(links.first[i], links.first[i + 1]):
                    j = links.head[a]
                    if forbidden[following[k + 1, j]]:
                        value = links.cost[a] + second[k + 1, j]
                    else:
                        value = links.cost[a] + best[k + 1, j]
                    if value < other:
                        d = cluster[j]
                        if value < least:
                            if d != group:
                                other, group = least, d
                            least = value
                        elif d != group:
                            other = value
            best[k, i], second[k, i], following[k, i] = least, other, group


@njit(cache=True, nogil=True)
def visits(links: Links, cluster: IntArray, never: BoolArray, walks: Walks, first: int, counts: IntArray) -> None:
    """How often the best walk from node `first` at place 0 visits each cluster: added to counts (m,)."""
    best, second, following = walks.best, walks.second, walks.following
    nothing = len(best)
    here, without = first, nothing
    counts[cluster[here]] += 1
    for k in range(1, len(best)):
        c = cluster[here]
        least, there = math.inf, -1
        for a in range(links.first[here], links.first[here + 1]):
            j = links.head[a]
            if cluster[j] != without:
                value = links.cost[a] + (second[k, j] if never[c, following[k, j]] else best[k, j])
                if there < 0 or value < least:
                    least, there = value, j
        without = following[k, there] if never[c, following[k, there]] else nothing
        here = there
        counts[cluster[here]] += 1


@njit(cache=True, nogil=True)
def through(links: Links, cheapest: FloatArray, before: FloatArray, after: FloatArray, high: int, low: int) -> None:
    """Lower the cost (a,) of the cheapest walk through each arc to those that take it from place k, low <= k <= high.

    before, after (m, n): least cost of coming to a node at a place, and of going on from it.
    """
    for k in range(high, low - 1, -1):
        for i in range(len(links.first) - 1):
            if before[k, i] < math.inf:
                for a in range(links.first[i], links.first[i + 1]):
                    value = before[k, i] + links.cost[a] + after[k + 1, links.head[a]]
                    if value < cheapest[a]:
                        cheapest[a] = value
