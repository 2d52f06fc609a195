"""Dynamic programming over subsets of clusters (Held and Karp 1962), precedence aware."""

from __future__ import annotations

from optplan.compiled import njit
from optplan.domain.arrays import FloatArray, IntArray


@njit(cache=True, nogil=True)
def extend(
    matrix: FloatArray,
    node_costs: FloatArray,
    first: IntArray,
    needs: IntArray,
    value: FloatArray,
    parent: IntArray,
    low: int,
    high: int,
) -> None:
    """Extend the best paths through the cluster sets low..high-1 (bit masks) by one cluster.

    value (2^m, n): cost of the best path through the set that ends with the node, infinite for none; parent: the node
    before it; needs (m,): the set that must come before a cluster.
    """
    count = len(needs)
    for mask in range(low, high):
        for c in range(count):
            bit = 1 << c
            if mask & bit != 0 or needs[c] & mask != needs[c]:
                continue
            grown = mask | bit
            for b in range(count):
                if mask & (1 << b) == 0:
                    continue
                for i in range(first[b], first[b + 1]):
                    so_far = value[mask, i]
                    if so_far == float("inf"):
                        continue
                    for k in range(first[c], first[c + 1]):
                        cost = so_far + matrix[i, k] + node_costs[k]
                        if cost < value[grown, k]:
                            value[grown, k] = cost
                            parent[grown, k] = i
