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

    children (m, n), nearest first, of which tried[d] (m + 1,) of size[d] have been, -1 when they are not listed yet;
    near, bound (m, n) distance and bound of each child; cost, rest (m + 1,) of the path, and of the cheapest links into
    clusters still to come; path, best (m,); waiting (m,) predecessors to come of each cluster, -1 on the path.
    """

    children: IntArray
    near: FloatArray
    bound: FloatArray
    tried: IntArray
    size: IntArray
    cost: FloatArray
    rest: FloatArray
    path: IntArray
    best: IntArray
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
    while work > 0 and counters[DEPTH] >= 0:
        depth = counters[DEPTH]
        if tree.tried[depth] < 0:
            _open(network, link, least_end, tree, depth, cutoff)
        k = tree.tried[depth]
        if k >= tree.size[depth]:
            tree.tried[depth] = -1
            counters[DEPTH] = depth - 1
            if depth > 0:
                c = cluster[tree.path[depth - 1]]
                tree.waiting[c] = 0
                for a in range(after[c], after[c + 1]):
                    tree.waiting[after[a]] += 1
            continue
        tree.tried[depth] = k + 1
        if tree.bound[depth, k] >= cutoff:
            continue
        work -= 1
        counters[VISITED] += 1
        j = tree.children[depth, k]
        tree.path[depth] = j
        cost = tree.cost[depth] + (network.arcs[tree.path[depth - 1], j] if depth > 0 else network.start[j])
        if depth + 1 == count:
            total = cost + network.end[j]
            cutoff = total - step[0] - step[1] * abs(total)
            tree.best[:] = tree.path
            counters[FOUND] += 1
            continue
        c = cluster[j]
        tree.waiting[c] = -1
        for a in range(after[c], after[c + 1]):
            tree.waiting[after[a]] -= 1
        tree.cost[depth + 1] = cost
        tree.rest[depth + 1] = tree.rest[depth] - link[c]
        counters[DEPTH] = depth + 1
    return cutoff


@njit(cache=True, nogil=True)
def _open(network: Network, link: FloatArray, least_end: float, tree: Tree, depth: int, cutoff: float) -> None:
    """List the children of the present place that are better than the cutoff, nearest first."""
    count, first, size = len(link), network.first, 0
    children, near, bounds = tree.children[depth], tree.near[depth], tree.bound[depth]
    for c in range(count):
        if tree.waiting[c] != 0:
            continue
        for j in range(first[c], first[c + 1]):
            cost = network.arcs[tree.path[depth - 1], j] if depth > 0 else network.start[j]
            ending = network.end[j] if depth + 1 == count else least_end
            bound = tree.cost[depth] + cost + tree.rest[depth] - link[c] + ending
            if bound < cutoff:
                k = size
                while k > 0 and near[k - 1] > cost:
                    children[k], near[k], bounds[k] = children[k - 1], near[k - 1], bounds[k - 1]
                    k -= 1
                children[k], near[k], bounds[k] = j, cost, bound
                size += 1
    tree.size[depth] = size
    tree.tried[depth] = 0
