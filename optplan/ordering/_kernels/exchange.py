"""Exchanges of arcs: two neighbouring pieces change places (3-opt without reversal), or one is reversed (2-opt)."""

from __future__ import annotations

from optplan.compiled import njit
from optplan.ordering._kernels.tour import (
    ANCHOR,
    DISTANT,
    EXACT,
    GAIN,
    LABEL,
    MIRROR,
    NEXT,
    NODE,
    NOW,
    ORDER,
    PREVIOUS,
    Graph,
    State,
    arc,
    draw,
    push,
    relabel,
    touch,
)

SHORT = 100
"""Longest piece that is reversed when its inner cost changes."""
BRIDGE = 30
"""Longest piece that a perturbation swaps."""
LONGEST = 1000
"""Longest piece that is reversed under precedence."""


@njit(cache=True, nogil=True)
def _may_swap(graph: Graph, state: State, x1: int, x2: int, y1: int, y2: int) -> bool:
    """Whether no cluster of the piece x1..x2 must come before one of the piece y1..y2 that follows it."""
    rows, before, after = state.rows, graph.before, graph.after
    x_low, y_high = rows[x1, LABEL], rows[y2, LABEL]
    x_high, y_low = rows[x2, LABEL], rows[y1, LABEL]
    x, y = x2, y1
    # the shorter piece decides: all of its relations are seen when its end is reached
    while True:
        for a in range(after[x], after[x + 1]):
            if y_low <= rows[after[a], LABEL] <= y_high:
                return False
        for a in range(before[y], before[y + 1]):
            if x_low <= rows[before[a], LABEL] <= x_high:
                return False
        if x == x1 or y == y2:
            return True
        x, y = rows[x, PREVIOUS], rows[y, NEXT]


@njit(cache=True, nogil=True)
def _swap(graph: Graph, state: State, x1: int, x2: int, y1: int, y2: int) -> None:
    """Exchange the pieces x1..x2 and y1..y2 that follow each other, neither with the anchor."""
    rows = state.rows
    left, right = rows[x1, PREVIOUS], rows[y2, NEXT]
    x, y, size = x2, y1, 1
    while x != x1 and y != y2:
        x, y, size = rows[x, PREVIOUS], rows[y, NEXT], size + 1
    first, last = (x1, x2) if x == x1 else (y1, y2)
    c = first
    while True:
        touch(state, c)
        if c == last:
            break
        c = rows[c, NEXT]
    for c in (left, x1, x2, y1, y2, right):
        touch(state, c)
        push(state, c)
    rows[left, NEXT], rows[y1, PREVIOUS] = y1, left
    rows[y2, NEXT], rows[x1, PREVIOUS] = x1, y2
    rows[x2, NEXT], rows[right, PREVIOUS] = right, x2
    relabel(graph, state, first, last, size)


@njit(cache=True, nogil=True)
def _may_reverse(graph: Graph, state: State, first: int, last: int) -> bool:
    """Whether the piece is short and no cluster of it must come before another one of it."""
    rows, after = state.rows, graph.after
    if graph.flags[ORDER] == 0:
        return True
    low, high = rows[first, LABEL], rows[last, LABEL]
    c = first
    for _ in range(LONGEST):
        for a in range(after[c], after[c + 1]):
            if low <= rows[after[a], LABEL] <= high:
                return False
        if c == last:
            return True
        c = rows[c, NEXT]
    return False


@njit(cache=True, nogil=True)
def _reverse(graph: Graph, state: State, first: int, last: int) -> None:
    """Travel the piece backwards; it is without the anchor."""
    rows, partner = state.rows, graph.partner
    left, right = rows[first, PREVIOUS], rows[last, NEXT]
    for c in (left, first, last, right):
        touch(state, c)
        push(state, c)
    c, size = first, 0
    while c != right:
        touch(state, c)
        after = rows[c, NEXT]
        rows[c, NEXT], rows[c, PREVIOUS] = rows[c, PREVIOUS], after
        rows[c, NODE] = partner[rows[c, NODE]]
        c, size = after, size + 1
    rows[left, NEXT], rows[last, PREVIOUS] = last, left
    rows[first, NEXT], rows[right, PREVIOUS] = right, first
    relabel(graph, state, last, first, size)


@njit(cache=True, nogil=True)
def _turn(graph: Graph, state: State, first: int, last: int, best: float) -> float:
    """What reversing the piece first..last gains; exact only above `best`, nothing when it has the anchor."""
    rows, partner, data, radius = state.rows, graph.partner, graph.data, graph.radius
    distant = graph.flags[DISTANT]
    if rows[first, LABEL] == 0 or rows[first, LABEL] >= rows[last, LABEL]:
        return 0.0
    i, j = rows[first, NODE], rows[last, NODE]
    left, right = rows[rows[first, PREVIOUS], NODE], rows[rows[last, NEXT], NODE]
    gain = arc(distant, radius, data, left, i) + arc(distant, radius, data, j, right)
    gain -= arc(distant, radius, data, left, partner[j]) + arc(distant, radius, data, partner[i], right)
    if graph.flags[MIRROR] == EXACT or gain <= best:
        return gain
    c = first
    for _ in range(SHORT):
        d = rows[c, NEXT]
        i, j = rows[c, NODE], rows[d, NODE]
        gain += arc(distant, radius, data, i, j) - arc(distant, radius, data, partner[j], partner[i])
        if d == last:
            return gain
        c = d
    return 0.0


@njit(cache=True, nogil=True)
def _reversal(graph: Graph, state: State, a: int, best: float) -> bool:
    """Make the best reversal that gains more than `best` and makes cluster a and one near it neighbours."""
    rows, near = state.rows, graph.near
    # no -1 where there is none: numba would compile what is called with it twice
    first = last = a
    for k in range(near.shape[2]):
        b = near[0, a, k]
        if b < 0:
            break
        for side in range(2):
            # arcs behind a and b, or before them, are replaced
            u, v = (a, b) if rows[a, LABEL] < rows[b, LABEL] else (b, a)
            if side == 0:
                u = rows[u, NEXT]
            else:
                v = rows[v, PREVIOUS]
            if u == v:
                continue
            gain = _turn(graph, state, u, v, best)
            if gain > best and _may_reverse(graph, state, u, v):
                best, first, last = gain, u, v
    if first == last:
        return False
    state.cost[NOW] -= best
    _reverse(graph, state, first, last)
    return True


@njit(cache=True, nogil=True)
def _third(graph: Graph, state: State, a: int, t: int, partial: float, best: float) -> tuple[float, int]:
    """The best third arc (c, next c) to remove when a -> t is added: gain over all, c; or best, -1.

    Between a and t lie a' .. p; the new arcs are a -> t, c -> a', p -> c'. partial: gain so far, (p, t) not counted.
    """
    rows, near, data, radius = state.rows, graph.near, graph.data, graph.radius
    distant = graph.flags[DISTANT]
    behind, p = rows[a, NEXT], rows[t, PREVIOUS]
    i, j = rows[behind, NODE], rows[p, NODE]
    base = partial + arc(distant, radius, data, j, rows[t, NODE])
    low, high = rows[t, LABEL], rows[a, LABEL]
    found = -1
    for side in range(2):
        for k in range(near.shape[2]):
            if side == 0:
                c = near[1, behind, k]
                if c < 0:
                    break
                d = rows[c, NEXT]
            else:
                d = near[0, p, k]
                if d < 0:
                    break
                c = rows[d, PREVIOUS]
            label = rows[c, LABEL]
            if low <= high:
                if label < low or label >= high:
                    continue
            elif high <= label < low:
                continue
            u, v = rows[c, NODE], rows[d, NODE]
            if side == 0:
                gain = base - arc(distant, radius, data, u, i)
                if gain <= 0.0:
                    continue
                gain += arc(distant, radius, data, u, v) - arc(distant, radius, data, j, v)
            else:
                gain = base - arc(distant, radius, data, j, v)
                if gain <= 0.0:
                    continue
                gain += arc(distant, radius, data, u, v) - arc(distant, radius, data, u, i)
            if gain > best and (graph.flags[ORDER] == 0 or _allowed(graph, state, a, t, c)):
                best, found = gain, c
    return best, found


@njit(cache=True, nogil=True)
def _pieces(state: State, a: int, t: int, c: int) -> tuple[int, int, int, int]:
    """The two neighbouring pieces without the anchor of the three that the arcs behind a, before t, behind c bound."""
    rows = state.rows
    a1, a2, b1, b2, c1, c2 = rows[a, NEXT], rows[t, PREVIOUS], t, c, rows[c, NEXT], a
    if rows[a1, LABEL] == 0 or rows[a1, LABEL] > rows[a2, LABEL]:
        return b1, b2, c1, c2
    if rows[b1, LABEL] == 0 or rows[b1, LABEL] > rows[b2, LABEL]:
        return c1, c2, a1, a2
    return a1, a2, b1, b2


@njit(cache=True, nogil=True)
def _allowed(graph: Graph, state: State, a: int, t: int, c: int) -> bool:
    x1, x2, y1, y2 = _pieces(state, a, t, c)
    return _may_swap(graph, state, x1, x2, y1, y2)


@njit(cache=True, nogil=True)
def improve(graph: Graph, state: State, c: int) -> bool:
    """Make the best improving exchange around cluster c, if there is one."""
    rows, near, data, radius = state.rows, graph.near, graph.data, graph.radius
    distant = graph.flags[DISTANT]
    best = state.cost[GAIN]
    ahead, behind = rows[c, NEXT], rows[c, PREVIOUS]
    node = rows[c, NODE]
    out = arc(distant, radius, data, node, rows[ahead, NODE])
    into = arc(distant, radius, data, rows[behind, NODE], node)
    tail = head = third = c
    for k in range(near.shape[2]):
        t = near[0, c, k]
        if t < 0:
            break
        if t != ahead:
            partial = out - arc(distant, radius, data, node, rows[t, NODE])
            if partial > 0.0:
                best, found = _third(graph, state, c, t, partial, best)
                if found >= 0:
                    tail, head, third = c, t, found
    for k in range(near.shape[2]):
        q = near[1, c, k]
        if q < 0:
            break
        if q != behind:
            saved = arc(distant, radius, data, rows[q, NODE], node)
            if into - saved > 0.0:
                partial = arc(distant, radius, data, rows[q, NODE], rows[rows[q, NEXT], NODE]) - saved
                best, found = _third(graph, state, q, c, partial, best)
                if found >= 0:
                    tail, head, third = q, c, found
    if graph.flags[MIRROR] and _reversal(graph, state, c, best):
        return True
    if tail == head:
        return False
    x1, x2, y1, y2 = _pieces(state, tail, head, third)
    state.cost[NOW] -= best
    _swap(graph, state, x1, x2, y1, y2)
    return True


@njit(cache=True, nogil=True)
def bridge(graph: Graph, state: State, c: int) -> bool:
    """Swap the two pieces of random length behind cluster c (a double bridge close by), if they may be."""
    rows, data, radius, distant = state.rows, graph.data, graph.radius, graph.flags[DISTANT]
    anchor = graph.flags[ANCHOR]
    longest = max(1, min(BRIDGE, len(rows) // 3))
    while longest > 0:
        x1 = x2 = rows[c, NEXT]
        for _ in range(draw(state.random, longest)):
            if rows[x2, NEXT] != anchor:
                x2 = rows[x2, NEXT]
        y1 = y2 = rows[x2, NEXT]
        if x1 == anchor or y1 == anchor:
            return False
        for _ in range(draw(state.random, longest)):
            if rows[y2, NEXT] != anchor:
                y2 = rows[y2, NEXT]
        if graph.flags[ORDER] == 0 or _may_swap(graph, state, x1, x2, y1, y2):
            left, right = rows[c, NODE], rows[rows[y2, NEXT], NODE]
            i, j, g, h = rows[x1, NODE], rows[x2, NODE], rows[y1, NODE], rows[y2, NODE]
            rise = arc(distant, radius, data, left, g) + arc(distant, radius, data, h, i)
            rise += arc(distant, radius, data, j, right) - arc(distant, radius, data, left, i)
            rise -= arc(distant, radius, data, j, g) + arc(distant, radius, data, h, right)
            state.cost[NOW] += rise
            _swap(graph, state, x1, x2, y1, y2)
            return True
        longest //= 3
    return False
