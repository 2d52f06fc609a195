"""One layer of the dynamic programme over order ideals: states extended by one cluster, equal ones merged."""

from __future__ import annotations

import math
from typing import NamedTuple

import numpy as np
import numpy.typing as npt

from optplan.compiled import njit
from optplan.domain.arrays import FloatArray, IntArray

WordArray = npt.NDArray[np.uint64]
ShortArray = npt.NDArray[np.int32]

_BRUIJN = np.uint64(0x03F79D71B4CB0A89)
_PLACES = np.zeros(64, dtype=np.int64)
for _k in range(64):
    _PLACES[((int(_BRUIJN) << _k) & (2**64 - 1)) >> 58] = _k
_GOLDEN = np.uint64(0x9E3779B97F4A7C15)
_ONE = np.uint64(1)
_ZERO = np.uint64(0)
_TOP = np.uint64(58)

NEXT, FOUND, FULL = 0, 1, 2
"""Places in `counters`: the state to extend next, candidates found, whether their arrays are full."""


class Network(NamedTuple):
    """Costs and precedence, in the direction in which the layers go.

    arcs (n, n), the cost of the head included; start, end (n,); cluster (n,); first (m + 1,) nodes of a cluster; needs
    (m, w) bit set of all that must come before a cluster; the clusters that may become free when c is done are
    after[after[c]:after[c + 1]]; name (m,) random word of each cluster, of which the names of sets are made.
    """

    arcs: FloatArray
    start: FloatArray
    end: FloatArray
    cluster: IntArray
    first: IntArray
    needs: WordArray
    after: IntArray
    name: WordArray


class Guide(NamedTuple):
    """A lower bound of each path: base + reduced costs so far + least reduced cost of what is to come.

    arcs (n, n), start (n,) reduced costs; best, second (m, n) least reduced cost from a node at a place to the end,
    over all next clusters and over all but following (m, n), that of the best (m where there is none).
    """

    base: float
    arcs: FloatArray
    start: FloatArray
    best: FloatArray
    second: FloatArray
    following: ShortArray


class Layer(NamedTuple):
    """States (s): sets of clusters done and of those that may come next (s, w), last node, cost, reduced cost, name."""

    done: WordArray
    ready: WordArray
    last: ShortArray
    cost: FloatArray
    spent: FloatArray
    name: WordArray


class Candidates(NamedTuple):
    """States to be (k): the state they come from, node appended, cost, reduced cost, bound, name; slots finds them."""

    parent: ShortArray
    node: ShortArray
    cost: FloatArray
    spent: FloatArray
    bound: FloatArray
    name: WordArray
    slots: ShortArray


@njit(cache=True, nogil=True)
def _lowest(word: np.uint64) -> int:
    """Place of the lowest bit that is set."""
    return int(_PLACES[int(((word & (~word + _ONE)) * _BRUIJN) >> _TOP)])


@njit(cache=True, nogil=True)
def _same(layer: Layer, s: int, t: int) -> bool:
    """Whether two states have done the same clusters."""
    same = True
    for w in range(layer.done.shape[1]):
        same = same and layer.done[s, w] == layer.done[t, w]
    return same


@njit(cache=True, nogil=True)
def _slot(layer: Layer, candidates: Candidates, s: int, node: int, name: np.uint64) -> int:
    """The slot in which the candidate of that set and node is, or would be."""
    slots = candidates.slots
    mask = len(slots) - 1
    place = int(((name + np.uint64(node) * _GOLDEN) * _GOLDEN) >> np.uint64(20)) & mask
    while slots[place] >= 0:
        k = slots[place]
        # names may collide: the sets decide
        if candidates.name[k] == name and candidates.node[k] == node and _same(layer, s, int(candidates.parent[k])):
            return place
        place = (place + 1) & mask
    return place


@njit(cache=True, nogil=True)
def expand(
    layer: Layer,
    network: Network,
    guide: Guide,
    candidates: Candidates,
    place: int,
    cutoff: float,
    work: int,
    counters: IntArray,
) -> float:
    """Extend states from counters[NEXT] on; the new states are at `place`. The least bound at or above the cutoff.

    Ends when all states are extended, when `work` extensions are done, or when the candidates' arrays are full. Of
    candidates with the same set and last node the cheapest is kept.
    """
    first, cluster = network.first, network.cluster
    limit = len(candidates.parent)
    least, clusters = math.inf, len(network.name)
    while counters[NEXT] < len(layer.last) and work > 0:
        s = counters[NEXT]
        if counters[FOUND] + len(cluster) > limit:
            counters[FULL] = 1
            break
        last = layer.last[s]
        for w in range(layer.ready.shape[1]):
            word = layer.ready[s, w]
            while word != _ZERO:
                c = 64 * w + _lowest(word)
                word &= word - _ONE
                name = layer.name[s] ^ network.name[c]
                for j in range(first[c], first[c + 1]):
                    work -= 1
                    spent = layer.spent[s]
                    cost = layer.cost[s]
                    if last < 0:
                        spent += guide.start[j]
                        cost += network.start[j]
                    else:
                        spent += guide.arcs[last, j]
                        cost += network.arcs[last, j]
                    f = guide.following[place, j]
                    if f < clusters and (layer.done[s, f >> 6] >> np.uint64(f & 63)) & _ONE == _ONE:
                        bound = guide.base + spent + guide.second[place, j]
                    else:
                        bound = guide.base + spent + guide.best[place, j]
                    if not bound < cutoff:
                        least = min(least, bound)
                        continue
                    slot = _slot(layer, candidates, s, j, name)
                    k = candidates.slots[slot]
                    if k < 0:
                        k = counters[FOUND]
                        counters[FOUND] += 1
                        candidates.slots[slot] = k
                        candidates.node[k] = j
                        candidates.name[k] = name
                    elif cost > candidates.cost[k] or (cost == candidates.cost[k] and bound <= candidates.bound[k]):
                        continue
                    candidates.parent[k] = s
                    candidates.cost[k] = cost
                    candidates.spent[k] = spent
                    candidates.bound[k] = bound
        counters[NEXT] += 1
    return least


@njit(cache=True, nogil=True)
def index(layer: Layer, candidates: Candidates, count: int) -> None:
    """Fill the slots anew."""
    for place in range(len(candidates.slots)):
        candidates.slots[place] = -1
    for k in range(count):
        slot = _slot(layer, candidates, int(candidates.parent[k]), int(candidates.node[k]), candidates.name[k])
        candidates.slots[slot] = k


@njit(cache=True, nogil=True)
def grow(layer: Layer, network: Network, parent: ShortArray, grown: Layer) -> None:
    """The sets of the next layer, whose states extend parent (k,)."""
    words = layer.done.shape[1]
    after = network.after
    for k in range(len(parent)):
        s = parent[k]
        c = network.cluster[grown.last[k]]
        for w in range(words):
            grown.done[k, w] = layer.done[s, w]
            grown.ready[k, w] = layer.ready[s, w]
        bit = _ONE << np.uint64(c & 63)
        grown.done[k, c >> 6] |= bit
        grown.ready[k, c >> 6] &= ~bit
        for a in range(after[c], after[c + 1]):
            d = after[a]
            free = True
            for w in range(words):
                if network.needs[d, w] & ~grown.done[k, w] != _ZERO:
                    free = False
                    break
            if free:
                grown.ready[k, d >> 6] |= _ONE << np.uint64(d & 63)
