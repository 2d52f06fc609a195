"""Predecessor, successor and subtour cuts of a rooted tour: separation by minimum cuts, rows, reduced costs.

The vertices are the nodes 0..n-1 and the end n, at which arcs into the root cluster arrive. All cuts are of one family,
    x(S \\ W : S' \\ W) + y(a \\ S) + y(b & S) >= 1,    W = predecessors of X and successors of Y,
for clusters X in S (and a) that precede all clusters Y outside S (and b): the (pi, sigma) inequalities of Balas,
Fischetti and Pulleyblank (1995), at node level. With the end as b they are predecessor (pi) cuts and, without
precedence, generalised subtour cuts; with the root as a they are successor (sigma) cuts. A cut is kept as one byte of
marks a vertex, from which its coefficient at any arc follows.
"""

from __future__ import annotations

import numpy as np
import numpy.typing as npt

from optplan.compiled import njit
from optplan.domain.arrays import FloatArray, IntArray
from optplan.ordering._kernels.maxflow import SINK_SIDE, SOURCE_SIDE, Network, max_flow

Marks = npt.NDArray[np.uint8]
TAIL, HEAD, LEAVES, ENTERS = 1, 2, 4, 8
"""Marks: an arc counts from TAIL to HEAD, from LEAVES to anywhere, and from anywhere to ENTERS."""


@njit(cache=True, nogil=True)
def separate(
    net: Network,
    capacity: FloatArray,
    cluster: IntArray,
    order: IntArray,
    hubs: IntArray,
    pairs: IntArray,
    begin: int,
    work: int,
    enough: float,
    marks: Marks,
    values: FloatArray,
) -> tuple[int, int]:
    """Look for violated cuts, pair after pair, until `work` arcs have been looked at or `marks` is full.

    Parameters
    ----------
    net, capacity (2k,) : the support graph: vertices, then hubs; capacities at its slots, 0 at their mates
    cluster : (n + 1,) cluster of each vertex; the end is a cluster of its own, the last
    order : (m + 1, m + 1) 1 where a cluster must come before another: closed, the root first, the end last
    hubs : (2, m + 1) the vertex from which flow enters a cluster's nodes, and the one that collects it
    pairs : (p, 2) clusters a before b
    begin : the first pair to look at
    enough : a cut of this value is not violated
    marks, values : (c, n + 1) and (c,) output: the cuts, and their left-hand sides at these capacities

    Returns
    -------
    found, next : number of cuts, and the next pair to look at
    """
    residual = np.empty(len(capacity))
    vertices = len(net.first) - 1
    closed = np.zeros(vertices, dtype=np.int64)
    side = np.empty(vertices, dtype=np.int64)
    inside = np.zeros(len(cluster), dtype=np.int64)
    found = 0
    for p in range(begin, len(pairs)):
        if work <= 0 or found + 2 > len(marks):
            return found, p
        work -= 4 * (len(capacity) + vertices)
        a, b = pairs[p, 0], pairs[p, 1]
        residual[:] = capacity
        for v in range(len(cluster)):
            closed[v] = order[cluster[v], a] | order[b, cluster[v]]
        value = max_flow(net, residual, closed, hubs[0, a], hubs[1, b], enough, side)
        if value >= enough:
            continue
        different = False
        for v in range(len(cluster)):
            inside[v] = 1 if side[v] == SOURCE_SIDE and closed[v] == 0 else 0
            different |= side[v] == 0 and closed[v] == 0
        _mark(inside, closed, cluster, order, a, b, marks[found])
        values[found] = value
        found += 1
        if different:
            for v in range(len(cluster)):
                inside[v] = 1 if side[v] != SINK_SIDE and closed[v] == 0 else 0
            _mark(inside, closed, cluster, order, a, b, marks[found])
            values[found] = value
            found += 1
    return found, len(pairs)


@njit(cache=True, nogil=True)
def _mark(inside: IntArray, closed: IntArray, cluster: IntArray, order: IntArray, a: int, b: int, mark: Marks) -> None:
    """The marks of the cut around S (`inside`) between clusters a and b, with X, Y and so W as large as they get."""
    count = len(order)
    whole = np.full(count, 3, dtype=np.int64)  # bits: 1 wholly in S, 2 wholly outside; neither when not open
    for v in range(len(cluster)):
        whole[cluster[v]] &= 0 if closed[v] else (1 if inside[v] else 2)
    first = np.zeros(count, dtype=np.int64)
    last = np.zeros(count, dtype=np.int64)
    first[a] = last[b] = 1
    for c in range(count):
        if whole[c] == 1 and order[c, b]:
            first[c] = 1
    for c in range(count):
        if whole[c] == 2 and c != b:
            after = True
            for x in range(count):
                if first[x] and not order[x, c]:
                    after = False
                    break
            last[c] = 1 if after else 0
    banned = np.zeros(count, dtype=np.int64)
    for c in range(count):
        for other in range(count):
            if (first[other] and order[c, other]) or (last[other] and order[other, c]):
                banned[c] = 1
                break
    for v in range(len(cluster)):
        c = cluster[v]
        mark[v] = 0
        if banned[c] == 0:
            mark[v] = TAIL if inside[v] else HEAD
        if c == a and inside[v] == 0:
            mark[v] |= LEAVES
        if c == b and inside[v] == 1:
            mark[v] |= ENTERS


@njit(cache=True, nogil=True)
def rows_of(marks: Marks, tails: IntArray, ends: IntArray) -> tuple[IntArray, IntArray]:
    """Where the cuts (c, n + 1) have ones at the arcs tails[k] -> ends[k]: starts (c + 1,) and columns.

    ends : the vertex at which an arc arrives: its head, or the end n when that lies in the root cluster
    """
    starts = np.zeros(len(marks) + 1, dtype=np.int64)
    columns = np.empty(1024, dtype=np.int64)
    used = 0
    for c in range(len(marks)):
        mark = marks[c]
        for k in range(len(tails)):
            t, h = mark[tails[k]], mark[ends[k]]
            if (t & TAIL and h & HEAD) or t & LEAVES or h & ENTERS:
                if used == len(columns):
                    larger = np.empty(2 * used, dtype=np.int64)
                    larger[:used] = columns
                    columns = larger
                columns[used] = k
                used += 1
        starts[c + 1] = used
    return starts, columns[:used].copy()


@njit(cache=True, nogil=True)
def subtract_cuts(reduced: FloatArray, marks: Marks, duals: FloatArray, root: IntArray) -> None:
    """Take the duals (c,) of cuts off reduced costs (n, n), in place; root (n,) is 1 for nodes of the root cluster."""
    count = len(root)
    for c in range(len(marks)):
        if duals[c] <= 0.0:
            continue
        mark, dual = marks[c], duals[c]
        for i in range(count):
            wanted = ENTERS
            if mark[i] & LEAVES:
                wanted = -1  # every arc
            elif mark[i] & TAIL:
                wanted = ENTERS | HEAD
            for j in range(count):
                h = mark[count] if root[j] else mark[j]
                if wanted < 0 or h & wanted:
                    reduced[i, j] -= dual
