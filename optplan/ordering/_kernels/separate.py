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
    sides: Marks,
    which: IntArray,
    values: FloatArray,
) -> tuple[int, int]:
    """Look for violated cuts, pair after pair, until `work` arcs have been looked at or `sides` is full.

    Parameters
    ----------
    net, capacity (2k,) : the support graph: vertices, then hubs; capacities at its slots, 0 at their mates
    cluster : (n + 1,) cluster of each vertex; the end is a cluster of its own, the last
    order : (m + 1, m + 1) 1 where a cluster must come before another: closed, the root first, the end last
    hubs : (2, m + 1) the vertex from which flow enters a cluster's nodes, and the one that collects it
    pairs : (p, 2) clusters a before b
    begin : the first pair to look at
    enough : a cut of this value is not violated
    sides, which, values : (c, n + 1), (c,) and (c,) output: of each cut 1 for vertices in S, its pair, and its
        left-hand side at these capacities; `mark_cuts` makes marks of them

    Returns
    -------
    found, next : number of cuts, and the next pair to look at
    """
    residual = np.empty(len(capacity))
    vertices = len(net.first) - 1
    closed = np.zeros(vertices, dtype=np.int64)
    side = np.empty(vertices, dtype=np.int64)
    found = 0
    for p in range(begin, len(pairs)):
        if work <= 0 or found + 2 > len(sides):
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
            sides[found, v] = 1 if side[v] == SOURCE_SIDE and closed[v] == 0 else 0
            different |= side[v] == 0 and closed[v] == 0
        which[found], values[found] = p, value
        found += 1
        if different:
            for v in range(len(cluster)):
                sides[found, v] = 1 if side[v] != SINK_SIDE and closed[v] == 0 else 0
            which[found], values[found] = p, value
            found += 1
    return found, len(pairs)


@njit(cache=True, nogil=True)
def mark_cuts(sides: Marks, which: IntArray, pairs: IntArray, cluster: IntArray, order: IntArray) -> Marks:
    """The marks (c, n + 1) of cuts that `separate` found, with X, Y and so W as large as they get."""
    marks = np.zeros(sides.shape, dtype=np.uint8)
    count = len(order)
    whole = np.empty(count, dtype=np.int64)  # bits: 1 wholly in S, 2 wholly outside; neither when not open
    first = np.empty(count, dtype=np.int64)
    last = np.empty(count, dtype=np.int64)
    for k in range(len(sides)):
        inside, mark = sides[k], marks[k]
        a, b = pairs[which[k], 0], pairs[which[k], 1]
        whole[:] = 3
        for v in range(len(cluster)):
            c = cluster[v]
            whole[c] &= 0 if order[c, a] | order[b, c] else (1 if inside[v] else 2)
        first[0], last[0] = a, b
        firsts = lasts = 1
        for c in range(count):
            if whole[c] == 1 and order[c, b] and c != a:
                first[firsts] = c
                firsts += 1
        for c in range(count):
            if whole[c] == 2 and c != b:
                after = True
                for x in range(firsts):
                    if not order[first[x], c]:
                        after = False
                        break
                if after:
                    last[lasts] = c
                    lasts += 1
        # where `whole` is, from here on: 1 for what must be before X or behind Y
        for c in range(count):
            banned = False
            for x in range(firsts):
                if order[c, first[x]]:
                    banned = True
                    break
            if not banned:
                for y in range(lasts):
                    if order[last[y], c]:
                        banned = True
                        break
            whole[c] = 1 if banned else 0
        for v in range(len(cluster)):
            c = cluster[v]
            if whole[c] == 0:
                mark[v] = TAIL if inside[v] else HEAD
            if c == a and inside[v] == 0:
                mark[v] |= LEAVES
            if c == b and inside[v] == 1:
                mark[v] |= ENTERS
    return marks


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
