"""One generation of the genetic algorithm."""

from __future__ import annotations

from typing import NamedTuple

import numpy as np
import numpy.typing as npt

from optplan.compiled import njit
from optplan.domain.arrays import FloatArray, IntArray
from optplan.ordering._kernels.costs import Costs, Structure, arc

SeedArray = npt.NDArray[np.uint64]


class Population(NamedTuple):
    """Individuals row by row.

    order (p, m) clusters in the order of visiting; choice (p, m) node of each cluster; value (p,) cost.
    """

    order: IntArray
    choice: IntArray
    value: FloatArray


@njit(cache=True, nogil=True)
def _draw(random: SeedArray, bound: int) -> int:
    """A number in 0..bound-1 (splitmix64)."""
    random[0] += np.uint64(0x9E3779B97F4A7C15)
    z = random[0]
    z = (z ^ (z >> np.uint64(30))) * np.uint64(0xBF58476D1CE4E5B9)
    z = (z ^ (z >> np.uint64(27))) * np.uint64(0x94D049BB133111EB)
    z = z ^ (z >> np.uint64(31))
    return int(np.int64(z >> np.uint64(1)) % bound)


@njit(cache=True, nogil=True)
def _selected(value: FloatArray, rivals: int, random: SeedArray) -> int:
    """The winner of a tournament."""
    best = _draw(random, len(value))
    for _ in range(rivals - 1):
        other = _draw(random, len(value))
        if value[other] < value[best]:
            best = other
    return best


@njit(cache=True, nogil=True)
def _cross(parents: Population, one: int, two: int, order: IntArray, choice: IntArray, random: SeedArray) -> None:
    """Order crossover: a piece of the first parent in its place, all others in the order of the second behind it."""
    count = len(order)
    low, size = _draw(random, count), 1 + _draw(random, count)
    choice[:] = -1
    for k in range(size):
        p = (low + k) % count
        c = parents.order[one, p]
        order[p], choice[c] = c, parents.choice[one, c]
    p = low + size
    for k in range(count):
        c = parents.order[two, (low + size + k) % count]
        if choice[c] < 0:
            order[p % count], choice[c] = c, parents.choice[two, c]
            p += 1


@njit(cache=True, nogil=True)
def _repair(structure: Structure, order: IntArray, rank: IntArray, waiting: IntArray, ready: IntArray) -> None:
    """The order that precedence allows nearest to the given one: of all clusters that are ready the foremost."""
    count = len(order)
    before, after = structure.before, structure.after
    size = 0
    for p in range(count):
        rank[order[p]] = p
    for c in range(count):
        waiting[c] = before[c + 1] - before[c]
        if waiting[c] == 0:
            ready[size] = c
            size += 1
    for p in range(count):
        best = 0
        for k in range(1, size):
            if rank[ready[k]] < rank[ready[best]]:
                best = k
        c = ready[best]
        size -= 1
        ready[best] = ready[size]
        order[p] = c
        for k in range(after[c], after[c + 1]):
            waiting[after[k]] -= 1
            if waiting[after[k]] == 0:
                ready[size] = after[k]
                size += 1


@njit(cache=True, nogil=True)
def _cost(costs: Costs, order: IntArray, choice: IntArray, closed: bool) -> float:
    last = choice[order[-1]]
    total = costs.ends[0, choice[order[0]]] + costs.ends[1, last]
    for p in range(len(order)):
        node = choice[order[p]]
        total += costs.ends[2, node]
        if p > 0:
            total += arc(costs, choice[order[p - 1]], node)
    if closed:
        total += arc(costs, last, choice[order[0]])
    return float(total)


@njit(cache=True, nogil=True)
def breed(
    costs: Costs,
    structure: Structure,
    closed: bool,
    parents: Population,
    children: Population,
    rivals: int,
    mutation: float,
    random: SeedArray,
    buffer: IntArray,
    low: int,
    high: int,
) -> None:
    """Fill children low..high-1; with no rivals they are there already, and are only repaired and valued.

    mutation is the probability of swapping two clusters, and again that of another node for one of them. buffer (3, m)
    is room to work in; without precedence in the structure nothing is repaired.
    """
    first = structure.first
    count = children.order.shape[1]
    for k in range(low, high):
        order, choice = children.order[k], children.choice[k]
        if rivals > 0:
            one, two = _selected(parents.value, rivals, random), _selected(parents.value, rivals, random)
            _cross(parents, one, two, order, choice, random)
            if _draw(random, 1 << 30) < mutation * (1 << 30):
                a, b = _draw(random, count), _draw(random, count)
                order[a], order[b] = order[b], order[a]
            if _draw(random, 1 << 30) < mutation * (1 << 30):
                c = _draw(random, count)
                choice[c] = first[c] + _draw(random, first[c + 1] - first[c])
        if structure.before[0] < structure.before[count]:
            _repair(structure, order, buffer[0], buffer[1], buffer[2])
        children.value[k] = _cost(costs, order, choice, closed)
