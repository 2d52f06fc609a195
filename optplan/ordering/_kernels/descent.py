"""Local search over a path of nodes: 2-opt, or-opt and node choice.

The path is an array of nodes, one per cluster. Prefix sums of its cost in both directions price the reversal of any
piece in constant time, for asymmetric costs too.
"""

from __future__ import annotations

from optplan.compiled import njit
from optplan.domain.arrays import IntArray
from optplan.ordering._kernels.choice import choose_nodes
from optplan.ordering._kernels.costs import Costs, Structure, link
from optplan.ordering._kernels.path import EFFORT, ENDS, Path, Work, at, push, refresh

LONGEST = 3
"""Longest segment that or-opt moves."""


@njit(cache=True, nogil=True)
def may_reverse(cluster: IntArray, before: IntArray, nodes: IntArray, place: IntArray, low: int, high: int) -> bool:
    """Whether no cluster in low..high must come before another one there."""
    for p in range(low, high + 1):
        c = cluster[nodes[p]]
        for a in range(before[c], before[c + 1]):
            if low <= place[before[a]] <= high:
                return False
    return True


@njit(cache=True, nogil=True)
def may_swap(
    cluster: IntArray, before: IntArray, nodes: IntArray, place: IntArray, low: int, middle: int, high: int
) -> bool:
    """Whether the pieces low..middle-1 and middle..high may change places."""
    for p in range(middle, high + 1):
        c = cluster[nodes[p]]
        for a in range(before[c], before[c + 1]):
            if low <= place[before[a]] < middle:
                return False
    return True


@njit(cache=True, nogil=True)
def may_move(
    cluster: IntArray, before: IntArray, nodes: IntArray, place: IntArray, low: int, high: int, to: int, flip: bool
) -> bool:
    """Whether the segment low..high may go behind place `to`, turned round or not."""
    if flip and not may_reverse(cluster, before, nodes, place, low, high):
        return False
    if to > high:
        return may_swap(cluster, before, nodes, place, low, high + 1, to)
    return may_swap(cluster, before, nodes, place, to + 1, low, high)


@njit(cache=True, nogil=True)
def reverse(partner: IntArray, nodes: IntArray, low: int, high: int) -> None:
    """Travel the piece low..high backwards."""
    while low < high:
        a, b = nodes[low], nodes[high]
        nodes[low], nodes[high] = partner[b], partner[a]
        low += 1
        high -= 1
    if low == high:
        nodes[low] = partner[nodes[low]]


@njit(cache=True, nogil=True)
def swap(nodes: IntArray, buffer: IntArray, low: int, middle: int, high: int) -> None:
    """Exchange the pieces low..middle-1 and middle..high."""
    for p in range(low, high + 1):
        buffer[p] = nodes[p]
    size = high + 1 - middle
    for p in range(size):
        nodes[low + p] = buffer[middle + p]
    for p in range(middle - low):
        nodes[low + size + p] = buffer[low + p]


@njit(cache=True, nogil=True)
def _joined(costs: Costs, left: int, low: int, high: int, right: int) -> float:
    """Cost of the two links of a piece that begins with node `low` and ends with node `high`."""
    return link(costs, left, low) + link(costs, high, right)


@njit(cache=True, nogil=True)
def _best_node(costs: Costs, left: int, right: int, low: int, high: int) -> tuple[float, int]:
    """The cheapest of the nodes low..high-1 between two nodes: its cost, itself."""
    best, chosen = _joined(costs, left, low, low, right) + costs.ends[2, low], low
    for k in range(low + 1, high):
        cost = _joined(costs, left, k, k, right) + costs.ends[2, k]
        if cost < best:
            best, chosen = cost, k
    return best, chosen


@njit(cache=True, nogil=True)
def _destination(structure: Structure, path: Path, c: int, a: int, reach: float) -> int:
    """Place of the a-th place to go to, -3 when there is none any more; the two ends of the path come first (a < 0)."""
    if a < 0:
        return -1 if a == -2 else len(path.nodes)
    # a better neighbour must be nearer than a present one
    if a >= structure.near.shape[1] or structure.distance[c, a] >= reach:
        return -3
    return int(path.place[structure.near[c, a]])


@njit(cache=True, nogil=True)
def _best_reversal(
    costs: Costs, structure: Structure, path: Path, c: int, ends: int, reach: float, best: float
) -> tuple[float, int, int]:
    """The best reversal that makes c and a place close to it neighbours: change of cost, low, high."""
    nodes, partner, sums = path.nodes, structure.partner, path.sums
    p = path.place[c]
    found_low, found_high = -1, -1
    for a in range(ends, structure.near.shape[1]):
        q = _destination(structure, path, c, a, reach)
        if q == -3:
            break
        for side in range(2):
            low, high = min(p, q) + 1 - side, max(p, q) - side
            if low < 0 or high >= len(nodes) or low >= high:
                continue
            left, right = at(nodes, low - 1), at(nodes, high + 1)
            turned_low, turned_high = partner[nodes[low]], partner[nodes[high]]
            delta = sums[3, high] - sums[3, low] - sums[2, high] + sums[2, low]
            delta += costs.ends[2, turned_low] - costs.ends[2, nodes[low]]
            delta += _joined(costs, left, turned_high, turned_low, right)
            delta -= _joined(costs, left, nodes[low], nodes[high], right)
            if delta < best and may_reverse(structure.cluster, structure.before, nodes, path.place, low, high):
                best, found_low, found_high = delta, low, high
    return best, found_low, found_high


@njit(cache=True, nogil=True)
def _best_segment(
    costs: Costs, structure: Structure, path: Path, c: int, ends: int, reach: float, best: float
) -> tuple[float, int, int, int, bool, int]:
    """The best move of a segment that begins or ends with c: change of cost, low, high, to, flip, node of c or -1."""
    nodes, partner, sums = path.nodes, structure.partner, path.sums
    count = len(nodes)
    p = path.place[c]
    found = (-1, -1, -1, False, -1)
    for variant in range(2 * LONGEST - 1):
        low = p if variant < LONGEST else p - (variant - LONGEST + 1)
        high = p + variant if variant < LONGEST else p
        if low < 0 or high >= count:
            continue
        left, right = at(nodes, low - 1), at(nodes, high + 1)
        gain = _joined(costs, left, nodes[low], nodes[high], right) - link(costs, left, right)
        turned_low, turned_high = partner[nodes[low]], partner[nodes[high]]
        turning = sums[3, high] - sums[3, low] - sums[2, high] + sums[2, low]
        turning += costs.ends[2, turned_low] - costs.ends[2, nodes[low]]
        if low == high:
            gain += costs.ends[2, nodes[p]]
            turning = 0.0
        # lines obey the triangle inequality: putting a piece somewhere costs at least nothing
        if costs.kind > 0 and gain - min(turning, 0.0) <= -best:
            continue
        for a in range(ends, structure.near.shape[1]):
            q = _destination(structure, path, c, a, reach)
            if q == -3:
                break
            for to in range(max(-1, q - 1), min(q + 1, count)):
                if low - 1 <= to <= high:
                    continue
                left, right = at(nodes, to), at(nodes, to + 1)
                saved = link(costs, left, right) + gain
                node, flip = -1, False
                if low == high:
                    delta, node = _best_node(costs, left, right, structure.first[c], structure.first[c + 1])
                else:
                    delta = _joined(costs, left, nodes[low], nodes[high], right)
                    turned = _joined(costs, left, turned_high, turned_low, right) + turning
                    if turned < delta:
                        delta, flip = turned, True
                if delta - saved < best and may_move(
                    structure.cluster, structure.before, nodes, path.place, low, high, to, flip
                ):
                    best = delta - saved
                    found = (low, high, to, flip, node)
    return best, found[0], found[1], found[2], found[3], found[4]


@njit(cache=True, nogil=True)
def improve(costs: Costs, structure: Structure, path: Path, work: Work, c: int) -> bool:
    """Make the best improving move around cluster c, if there is one."""
    nodes, partner, counters = path.nodes, structure.partner, work.counters
    p = path.place[c]
    reach = max(link(costs, at(nodes, p - 1), nodes[p]), link(costs, nodes[p], at(nodes, p + 1)))
    best, r_low, r_high = _best_reversal(costs, structure, path, c, counters[ENDS], reach, -work.cost[2])
    best, s_low, s_high, to, flip, node = _best_segment(costs, structure, path, c, counters[ENDS], reach, best)
    counters[EFFORT] += 100 + 8 * (structure.first[c + 1] - structure.first[c])
    if s_low >= 0:
        if flip:
            reverse(partner, nodes, s_low, s_high)
        if node >= 0:
            nodes[s_low] = node
        size = s_high - s_low + 1
        if to > s_high:
            swap(nodes, work.buffer, s_low, s_high + 1, to)
            low, high, seam = s_low, to, to - size
        else:
            swap(nodes, work.buffer, to + 1, s_low, s_high)
            low, high, seam = to + 1, s_high, to + size
    elif r_low >= 0:
        reverse(partner, nodes, r_low, r_high)
        low, high, seam = r_low, r_high, r_low
    else:
        return choose_nodes(costs, structure, path, work, p)
    work.cost[0] = refresh(costs, structure, path, low, high)
    counters[EFFORT] += 2 * (high - low)
    for q in (low - 1, low, seam, seam + 1, high, high + 1, path.place[c]):
        push(work.queue, counters, structure.cluster, nodes, q)
    return True
