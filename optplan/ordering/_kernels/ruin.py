"""Ruin and recreate: take strings of neighbouring clusters out of the tour and insert them again where it is cheap.

After J. Christiaens and G. Vanden Berghe, Slack induction by string removals for vehicle routing problems,
Transportation Science 54 (2020), for one tour of clusters under precedence.
"""

from __future__ import annotations

import math

from optplan.compiled import njit
from optplan.ordering._kernels.tour import (
    ANCHOR,
    CHANGED,
    DISTANT,
    END,
    LABEL,
    NEXT,
    NODE,
    NOW,
    ORDER,
    PREVIOUS,
    REMOVED,
    WORK,
    Graph,
    State,
    arc,
    draw,
    push,
    renumber,
    touch,
)

MOST = 20
"""Most clusters taken out at once."""
STRING = 6
"""Longest string taken out."""
BLINK = 50
"""One in so many places for an insertion is overlooked."""
WINDOW = 12
"""Places within the window that precedence leaves which are tried one by one."""


@njit(cache=True, nogil=True)
def _remove(graph: Graph, state: State, c: int) -> None:
    """Take cluster c out of the tour."""
    rows, data, radius = state.rows, graph.data, graph.radius
    distant = graph.flags[DISTANT]
    p, n = rows[c, PREVIOUS], rows[c, NEXT]
    for x in (p, c, n):
        touch(state, x)
    i, k, j = rows[p, NODE], rows[c, NODE], rows[n, NODE]
    state.cost[NOW] -= arc(distant, radius, data, i, k) + arc(distant, radius, data, k, j)
    state.cost[NOW] += arc(distant, radius, data, i, j)
    rows[p, NEXT], rows[n, PREVIOUS] = n, p
    rows[c, NEXT] = -1
    state.lists[REMOVED, state.counts[REMOVED]] = c
    state.counts[REMOVED] += 1


@njit(cache=True, nogil=True)
def ruin(graph: Graph, state: State, seed: int) -> None:
    """Take out strings around cluster `seed` and clusters near it."""
    rows, near, count = state.rows, graph.near, state.counts
    anchor = graph.flags[ANCHOR]
    most = min(MOST, len(rows) - 1)
    wanted = 1 + draw(state.random, most)
    side = draw(state.random, 2)
    for k in range(-1, near.shape[2]):
        c = seed if k < 0 else near[side, seed, k]
        if c < 0:
            return
        if c == anchor or rows[c, NEXT] < 0:
            continue
        size = 1 + draw(state.random, min(STRING, wanted))
        for _ in range(draw(state.random, size)):
            if rows[c, PREVIOUS] == anchor:
                break
            c = rows[c, PREVIOUS]
        for _ in range(size):
            following = rows[c, NEXT]
            _remove(graph, state, c)
            if count[REMOVED] >= wanted:
                return
            if following == anchor:
                break
            c = following


@njit(cache=True, nogil=True)
def _bound(graph: Graph, state: State, c: int, side: int) -> int:
    """The last cluster in the tour that must come before c (side 0), or the first that must come after it (1).

    The anchor when there is none. Relations through clusters that are out of the tour count.
    """
    rows = state.rows
    links = graph.before if side == 0 else graph.after
    anchor = graph.flags[ANCHOR]
    found, label = anchor, 0 if side == 0 else END
    for a in range(links[c], links[c + 1]):
        b = links[a]
        if rows[b, NEXT] < 0:
            b = _bound(graph, state, b, side)
            if b == anchor:
                continue
        if (rows[b, LABEL] > label) if side == 0 else (rows[b, LABEL] < label):
            found, label = b, rows[b, LABEL]
    return int(found)


@njit(cache=True, nogil=True)
def _best_node(graph: Graph, state: State, c: int, p: int, n: int, best: float) -> tuple[float, int]:
    """The cheapest node of cluster c between clusters p and n: added cost and node, if less than `best`."""
    data, radius = graph.data, graph.radius
    distant = graph.flags[DISTANT]
    i, j = state.rows[p, NODE], state.rows[n, NODE]
    now = arc(distant, radius, data, i, j)
    found = -1
    for k in range(graph.first[c], graph.first[c + 1]):
        cost = arc(distant, radius, data, i, k) + arc(distant, radius, data, k, j) - now
        if cost < best:
            best, found = cost, k
    return best, found


@njit(cache=True, nogil=True)
def _place(graph: Graph, state: State, c: int) -> tuple[float, int, int]:
    """The best place for cluster c: added cost, cluster before it, node."""
    rows, near = state.rows, graph.near
    anchor = graph.flags[ANCHOR]
    best, where, node = math.inf, -1, -1
    lower, upper, low, high = anchor, anchor, 0, END
    if graph.flags[ORDER]:
        lower, upper = _bound(graph, state, c, 0), _bound(graph, state, c, 1)
        low = rows[lower, LABEL]
        high = END if upper == anchor else rows[upper, LABEL]
        p = lower
        if lower != anchor or upper != anchor:
            for _ in range(WINDOW):
                n = rows[p, NEXT]
                best, found = _best_node(graph, state, c, p, n, best)
                if found >= 0:
                    where, node = p, found
                p = n
                if p == upper:
                    return best, where, node
    for side in range(2):
        for k in range(near.shape[2]):
            q = near[side, c, k]
            if q < 0:
                break
            if rows[q, NEXT] < 0:
                continue
            p, n = (rows[q, PREVIOUS], q) if side == 0 else (q, rows[q, NEXT])
            if graph.flags[ORDER] and (rows[p, LABEL] < low or (END if n == anchor else rows[n, LABEL]) > high):
                continue
            if draw(state.random, BLINK) == 0:
                continue
            best, found = _best_node(graph, state, c, p, n, best)
            if found >= 0:
                where, node = p, found
    if node >= 0:
        return best, where, node
    # none of its neighbours can be one: look everywhere
    p = lower
    while True:
        n = rows[p, NEXT]
        best, found = _best_node(graph, state, c, p, n, best)
        if found >= 0:
            where, node = p, found
        p = n
        state.counts[WORK] += 1
        if p == upper:
            return best, where, node


@njit(cache=True, nogil=True)
def recreate(graph: Graph, state: State) -> None:
    """Insert the clusters that are out of the tour, in random order, each where it is cheapest at the moment."""
    rows, saved, count, lists = state.rows, state.saved, state.counts, state.lists
    anchor = graph.flags[ANCHOR]
    while count[REMOVED] > 0:
        pick = draw(state.random, count[REMOVED])
        c = lists[REMOVED, pick]
        count[REMOVED] -= 1
        lists[REMOVED, pick] = lists[REMOVED, count[REMOVED]]
        cost, p, node = _place(graph, state, c)
        n = rows[p, NEXT]
        for x in (p, n):
            touch(state, x)
        state.cost[NOW] += cost
        low = rows[p, LABEL]
        high = END if n == anchor else rows[n, LABEL]
        rows[p, NEXT], rows[n, PREVIOUS] = c, c
        rows[c, NEXT], rows[c, PREVIOUS], rows[c, NODE] = n, p, node
        rows[c, LABEL] = low + (high - low) // 2
        if high - low < 2:
            renumber(graph, state)
    for a in range(count[CHANGED]):
        c = lists[CHANGED, a]
        for k in (NEXT, PREVIOUS, NODE):
            if rows[c, k] != saved[c, k]:
                push(state, c)
                break
