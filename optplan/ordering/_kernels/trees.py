"""Minimum 1-trees for the lower bound of Held and Karp (1970)."""

from __future__ import annotations

import math

from numba import njit

from optplan.domain.arrays import FloatArray, IntArray


@njit(cache=True, nogil=True)
def spanning_tree(
    weights: FloatArray, shift: FloatArray, degree: IntArray, key: FloatArray, origin: IntArray, seen: IntArray
) -> float:
    """Weight of the minimum spanning tree (Prim) under weights[a, b] + shift[a] + shift[b]; adds to degree (m,)."""
    count = len(shift)
    for a in range(count):
        key[a], origin[a], seen[a] = math.inf, -1, 0
    key[0] = 0.0
    total = 0.0
    for _ in range(count):
        near, best = -1, math.inf
        for a in range(count):
            if seen[a] == 0 and (near < 0 or key[a] < best):
                near, best = a, key[a]
        if best == math.inf:
            return math.inf
        seen[near] = 1
        total += best
        if origin[near] >= 0:
            degree[near] += 1
            degree[origin[near]] += 1
        for a in range(count):
            if seen[a] == 0:
                cost = weights[near, a] + shift[near] + shift[a]
                if cost < key[a]:
                    key[a], origin[a] = cost, near
    return total
