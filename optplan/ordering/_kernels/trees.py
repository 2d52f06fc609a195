"""Minimum 1-trees for the lower bound of Held and Karp (1970)."""

from __future__ import annotations

import math

from optplan.compiled import njit
from optplan.domain.arrays import FloatArray, IntArray


@njit(cache=True, nogil=True)
def spanning_tree(
    weights: FloatArray,
    mate: IntArray,
    shift: FloatArray,
    degree: IntArray,
    key: FloatArray,
    origin: IntArray,
    seen: IntArray,
) -> float:
    """Weight of the minimum spanning tree (Prim) under weights[a, b] + shift[a] + shift[b]; adds to degree (t,).

    A terminal and its mate (-1 for none) are joined at no cost, which does not count in the degree.
    """
    count = len(shift)
    for a in range(count):
        key[a], origin[a], seen[a] = math.inf, -1, 0
    key[0] = 0.0
    total = 0.0
    while True:
        near, best = -1, math.inf
        for a in range(count):
            if seen[a] == 0 and (near < 0 or key[a] < best):
                near, best = a, key[a]
        if near < 0:
            return total
        if best == math.inf:
            return math.inf
        total += best
        if origin[near] >= 0:
            degree[near] += 1
            degree[origin[near]] += 1
        while near >= 0 and seen[near] == 0:
            seen[near] = 1
            for a in range(count):
                if seen[a] == 0:
                    cost = weights[near, a] + shift[near] + shift[a]
                    if cost < key[a]:
                        key[a], origin[a] = cost, near
            near = mate[near]
