"""Depth-first branch and bound over paths."""

from __future__ import annotations

from typing import NamedTuple

from optplan.compiled import njit
from optplan.domain.arrays import FloatArray, IntArray
from optplan.ordering._kernels.ideals import Network

DEPTH, VISITED, FOUND = 0, 1, 2
"""Places in `counters`: nodes on the path, nodes of the tree visited so far, paths found."""


class Tree(NamedTuple):
    """The way from the root to the present place, and what is still to be tried beside it.

    At each depth: children (m, n), nearest first; keys (2, m, n), how near they are, and their bounds; places
    (2, m + 1), how many of them have been tried, -1 when they are not listed yet, and how many there are; sums
    (2, m + 1), the cost of the path, and of the cheapest links into clusters still to come. paths (2, m): the present
    and the best one. waiting (m,): predecessors to come of each cluster, -1 on the path.
    """

    children: IntArray
    keys: FloatArray
    places: IntArray
    sums: FloatArray
    paths: IntArray
    waiting: IntArray


@njit(cache=True, nogil=True)
def descend(
    network: Network,
    link: FloatArray,
    least_end: float,
    tree: Tree,
    cutoff: float,
    step: FloatArray,
    work: int,
    counters: IntArray,
) -> float:
    """Go on for up to `work` nodes of the tree; the new cutoff. Done when counters[DEPTH] is -1.

    A child is the next node of the path, the nearest first; it is left out when the cost up to it, the cheapest link
    (m,) into each cluster to come and the least end reach the cutoff. A path found lowers the cutoff: to its cost less
    step[0] and less step[1] times the size of the cost.
    """
    count, cluster, after = len(link), network.cluster, network.after
    tried, size, path, waiting = tree.places[0], tree.places[1], tree.paths[0], tree.waiting
    costs, rest, bound = tree.sums[0], tree.sums[1], tree.keys[1]
    while work > 0 and counters[DEPTH] >= 0:
        depth = counters[DEPTH]
        if tried[depth] < 0:
            _open(network, link, least_end, tree, depth, cutoff)
        k = tried[depth]
        if k >= size[depth]:
            tried[depth] = -1
            counters[DEPTH] = depth - 1
            if depth > 0:
                c = cluster[path[depth - 1]]
                waiting[c] = 0
                for a in range(after[c], after[c + 1]):
                    waiting[after[a]] += 1
            continue
        tried[depth] = k + 1
        if bound[depth, k] >= cutoff:
            continue
        work -= 1
        counters[VISITED] += 1
        j = tree.children[depth, k]
        path[depth] = j
        cost = costs[depth] + (network.arcs[path[depth - 1], j] if depth > 0 else network.start[j])
        if depth + 1 == count:
            total = cost + network.end[j]
            cutoff = total - step[0] - step[1] * abs(total)
            for d in range(count):
                tree.paths[1, d] = path[d]
            counters[FOUND] += 1
            continue
        c = cluster[j]
        waiting[c] = -1
        for a in range(after[c], after[c + 1]):
            waiting[after[a]] -= 1
        costs[depth + 1] = cost
        rest[depth + 1] = rest[depth] - link[c]
        counters[DEPTH] = depth + 1
    return cutoff


@njit(cache=True, nogil=True)
def _open(network: Network, link: FloatArray, least_end: float, tree: Tree, depth: int, cutoff: float) -> None:
    """List the children of the present place that are better than the cutoff, nearest first."""
    count, first, listed = len(link), network.first, 0
    children, near, bounds = tree.children[depth], tree.keys[0, depth], tree.keys[1, depth]
    for c in range(count):
        if tree.waiting[c] != 0:
            continue
        for j in range(first[c], first[c + 1]):
            cost = network.arcs[tree.paths[0, depth - 1], j] if depth > 0 else network.start[j]
            ending = network.end[j] if depth + 1 == count else least_end
            bound = tree.sums[0, depth] + cost + tree.sums[1, depth] - link[c] + ending
            if bound < cutoff:
                k = listed
                while k > 0 and near[k - 1] > cost:
                    children[k], near[k], bounds[k] = children[k - 1], near[k - 1], bounds[k - 1]
                    k -= 1
                children[k], near[k], bounds[k] = j, cost, bound
                listed += 1
    tree.places[1, depth] = listed
    tree.places[0, depth] = 0
