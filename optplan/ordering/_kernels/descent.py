"""Local search over a path of nodes: 2-opt, or-opt and node choice.

The path is an array of nodes, one per cluster. Prefix sums of its cost in both directions price the reversal of any
piece in constant time, for asymmetric costs too.
"""

from __future__ import annotations

from numba import njit

from optplan.domain.arrays import IntArray
from optplan.ordering._kernels.choice import choose_nodes
from optplan.ordering._kernels.costs import Costs, Structure, link
from optplan.ordering._kernels.path import EFFORT, Path, Work, at, push, refresh

LONGEST = 3
"""Longest segment that or-opt moves."""


@njit(cache=True, nogil=True)
def _may_reverse(structure: Structure, path: Path, low: int, high: int) -> bool:
    """Whether no cluster in low..high must come before another one there."""
    for p in range(low, high + 1):
        c = structure.cluster[path.nodes[p]]
        for a in range(structure.before_first[c], structure.before_first[c + 1]):
            if path.place[structure.before[a]] >= low and path.place[structure.before[a]] <= high:
                return False
    return True


@njit(cache=True, nogil=True)
def may_swap(structure: Structure, path: Path, low: int, middle: int, high: int) -> bool:
    """Whether the pieces low..middle-1 and middle..high may change places."""
    if middle - low <= high + 1 - middle:
        for p in range(low, middle):
            c = structure.cluster[path.nodes[p]]
            for a in range(structure.after_first[c], structure.after_first[c + 1]):
                if middle <= path.place[structure.after[a]] <= high:
                    return False
    else:
        for p in range(middle, high + 1):
            c = structure.cluster[path.nodes[p]]
            for a in range(structure.before_first[c], structure.before_first[c + 1]):
                if low <= path.place[structure.before[a]] < middle:
                    return False
    return True


@njit(cache=True, nogil=True)
def _reverse(structure: Structure, path: Path, low: int, high: int) -> None:
    while low < high:
        a, b = path.nodes[low], path.nodes[high]
        path.nodes[low], path.nodes[high] = structure.partner[b], structure.partner[a]
        low += 1
        high -= 1
    if low == high:
        path.nodes[low] = structure.partner[path.nodes[low]]


@njit(cache=True, nogil=True)
def swap(path: Path, buffer: IntArray, low: int, middle: int, high: int) -> None:
    """Exchange the pieces low..middle-1 and middle..high."""
    for p in range(low, high + 1):
        buffer[p] = path.nodes[p]
    size = high + 1 - middle
    for p in range(size):
        path.nodes[low + p] = buffer[middle + p]
    for p in range(middle - low):
        path.nodes[low + size + p] = buffer[low + p]


@njit(cache=True, nogil=True)
def improve(costs: Costs, structure: Structure, path: Path, work: Work, c: int) -> bool:
    """Make the best improving move around cluster c, if there is one."""
    nodes, place, partner = path.nodes, path.place, structure.partner
    count = len(nodes)
    p = place[c]
    best = -work.cost[2]
    # the best move: reverse b_low..b_high (kind 1), or put the segment b_low..b_high after place b_to (kind 2)
    kind, b_low, b_high, b_to, b_flip, b_node = 0, 0, 0, 0, False, -1
    near = structure.near
    effort = 0
    reach = max(link(costs, at(nodes, p - 1), nodes[p]), link(costs, nodes[p], at(nodes, p + 1)))
    for a in range(-2, near.shape[1]):
        # besides the neighbours, the two ends of the path are places to go to
        if a == -2:
            q = -1
        elif a == -1:
            q = count
        else:
            # a better neighbour must be nearer than a present one
            if structure.distance[c, a] >= reach:
                break
            q = place[near[c, a]]
        for side in range(2):
            low, high = (min(p, q) + 1, max(p, q)) if side == 0 else (min(p, q), max(p, q) - 1)
            if low < 0 or high >= count or low >= high:
                continue
            before, after = at(path.nodes, low - 1), at(path.nodes, high + 1)
            delta = (
                link(costs, before, partner[nodes[high]])
                + link(costs, partner[nodes[low]], after)
                - link(costs, before, nodes[low])
                - link(costs, nodes[high], after)
                + path.sums[3, high]
                - path.sums[3, low]
                + costs.ends[2, partner[nodes[low]]]
                - path.sums[2, high]
                + path.sums[2, low]
                - costs.ends[2, nodes[low]]
            )
            effort += 4
            if delta < best and _may_reverse(structure, path, low, high):
                best, kind, b_low, b_high = delta, 1, low, high
        for variant in range(2 * LONGEST - 1):
            # segments that begin (variants 0..) or end with c
            low = p if variant < LONGEST else p - (variant - LONGEST + 1)
            high = p + variant if variant < LONGEST else p
            if low < 0 or high >= count:
                continue
            before, after = at(path.nodes, low - 1), at(path.nodes, high + 1)
            gain = (
                link(costs, before, nodes[low]) + link(costs, nodes[high], after)
                - link(costs, before, after)
            )  # fmt: skip
            forwards = path.sums[2, high] - path.sums[2, low] + costs.ends[2, nodes[low]]
            backwards = path.sums[3, high] - path.sums[3, low] + costs.ends[2, partner[nodes[low]]]
            for to in range(q - 1, q + 1):
                if to < -1 or to >= count or (to >= low - 1 and to <= high):
                    continue
                left, right = at(path.nodes, to), at(path.nodes, to + 1)
                gap = link(costs, left, right)
                effort += 5
                if low == high:
                    for k in range(structure.first[c], structure.first[c + 1]):
                        delta = (
                            link(costs, left, k) + link(costs, k, right) + costs.ends[2, k] - costs.ends[2, nodes[p]]
                            - gap - gain
                        )  # fmt: skip
                        if delta < best and _may_move(structure, path, low, high, to):
                            best, kind, b_low, b_high, b_to, b_flip, b_node = delta, 2, low, high, to, False, k
                    effort += 2 * (structure.first[c + 1] - structure.first[c])
                    continue
                delta = link(costs, left, nodes[low]) + link(costs, nodes[high], right) - gap - gain
                if delta < best and _may_move(structure, path, low, high, to):
                    best, kind, b_low, b_high, b_to, b_flip, b_node = delta, 2, low, high, to, False, -1
                delta = (
                    link(costs, left, partner[nodes[high]]) + link(costs, partner[nodes[low]], right)
                    - gap - gain + backwards - forwards
                )  # fmt: skip
                if (
                    delta < best
                    and _may_move(structure, path, low, high, to)
                    and _may_reverse(structure, path, low, high)
                ):
                    best, kind, b_low, b_high, b_to, b_flip, b_node = delta, 2, low, high, to, True, -1
    work.counters[EFFORT] += effort
    if kind == 0:
        return choose_nodes(costs, structure, path, work, p)
    if kind == 1:
        _reverse(structure, path, b_low, b_high)
        push(work, structure, path, b_low)
        push(work, structure, path, b_high)
        low, high = b_low, b_high
    else:
        if b_flip:
            _reverse(structure, path, b_low, b_high)
        if b_node >= 0:
            nodes[b_low] = b_node
        size = b_high - b_low + 1
        if b_to > b_high:
            swap(path, work.buffer, b_low, b_high + 1, b_to)
            low, high = b_low, b_to
            seam = b_to - size
        else:
            swap(path, work.buffer, b_to + 1, b_low, b_high)
            low, high = b_to + 1, b_high
            seam = b_to + size
        for q in range(seam, seam + 2):
            push(work, structure, path, q)
        push(work, structure, path, low)
        push(work, structure, path, high)
    push(work, structure, path, low - 1)
    push(work, structure, path, high + 1)
    work.cost[0] = refresh(costs, structure, path, low, high)
    work.counters[EFFORT] += 2 * (high - low)
    push(work, structure, path, place[c])
    return True


@njit(cache=True, nogil=True)
def _may_move(structure: Structure, path: Path, low: int, high: int, to: int) -> bool:
    """Whether the segment low..high may go behind place `to`."""
    if to > high:
        return may_swap(structure, path, low, high + 1, to)
    return may_swap(structure, path, to + 1, low, high)
