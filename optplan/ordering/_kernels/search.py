"""Iterated local search in slices."""

from __future__ import annotations

import numpy as np

from optplan.compiled import njit
from optplan.ordering._kernels.choice import layer, settle
from optplan.ordering._kernels.costs import Costs, Structure
from optplan.ordering._kernels.descent import improve, may_swap, swap
from optplan.ordering._kernels.path import (
    EFFORT,
    FINISHED,
    HEAD,
    ITERATIONS,
    LAYER,
    SWEEP,
    WAITING,
    Path,
    Work,
    copy,
    push,
    refresh,
)

SWAP = 50
"""Longest segment that a perturbation swaps."""


@njit(cache=True, nogil=True)
def _random(work: Work, bound: int) -> int:
    """A number in 0..bound-1 (splitmix64)."""
    work.random[0] += np.uint64(0x9E3779B97F4A7C15)
    z = work.random[0]
    z = (z ^ (z >> np.uint64(30))) * np.uint64(0xBF58476D1CE4E5B9)
    z = (z ^ (z >> np.uint64(27))) * np.uint64(0x94D049BB133111EB)
    z = z ^ (z >> np.uint64(31))
    return int(np.int64(z >> np.uint64(1)) % bound)


@njit(cache=True, nogil=True)
def _perturb(costs: Costs, structure: Structure, path: Path, work: Work) -> None:
    """Swap two neighbouring segments of random length (a double bridge close by), if precedence lets any through."""
    count = len(path.nodes)
    longest = max(1, min(SWAP, count // 2))
    for _ in range(10):
        one, two = 1 + _random(work, longest), 1 + _random(work, longest)
        low = _random(work, count - one - two + 1)
        middle, high = low + one, low + one + two - 1
        if may_swap(structure.cluster, structure.before, path.nodes, path.place, low, middle, high):
            swap(path.nodes, work.buffer, low, middle, high)
            work.cost[0] = refresh(costs, structure, path, low, high)
            for p in (low - 1, low, low + two - 1, low + two, high, high + 1):
                push(work.queue, work.counters, structure.cluster, path.nodes, p)
            return
        longest = max(1, longest // 2)


@njit(cache=True, nogil=True)
def search(
    costs: Costs,
    structure: Structure,
    path: Path,
    best: Path,
    work: Work,
    limit: int,
    target: float,
    budget: int,
) -> None:
    """Go on for about `budget` arc costs, or until `limit` iterations or the target are reached (counters[FINISHED]).

    One iteration is a perturbation of the best path, a descent to the next local optimum, and a return to the best
    path unless the new one is as good. The descent from the first path is not counted. Every now and then all nodes
    are chosen anew for the present order of clusters (counters[SWEEP]: 1 in progress, 0 not, -1 never).
    """
    counters = work.counters
    count = len(path.nodes)
    counters[EFFORT] = 0
    begin: int = np.int64(0)  # type: ignore[assignment]  # a plain 0 would be compiled as a signature of its own
    while counters[EFFORT] < budget:
        if counters[WAITING] > 0:
            c = work.queue[0, counters[HEAD]]
            counters[HEAD] = (counters[HEAD] + 1) % count
            counters[WAITING] -= 1
            work.queue[1, c] = 0
            improve(costs, structure, path, work, c)
            continue
        if counters[SWEEP] == 1:
            counters[EFFORT] += layer(costs, structure, path, work, begin, counters[LAYER])
            counters[LAYER] += 1
            if counters[LAYER] == count:
                counters[LAYER] = 0
                counters[SWEEP] = 0
                if settle(costs, structure, path, work, begin, count - 1):
                    work.cost[0] = refresh(costs, structure, path, begin, count - 1)
                    for p in range(count):
                        push(work.queue, work.counters, structure.cluster, path.nodes, p)
            continue
        if work.cost[0] <= work.cost[1]:
            work.cost[1] = work.cost[0]
            copy(path, best)
        else:
            work.cost[0] = work.cost[1]
            copy(best, path)
        counters[EFFORT] += count
        if counters[ITERATIONS] >= limit or work.cost[1] <= target:
            counters[FINISHED] = 1
            return
        counters[ITERATIONS] += 1
        _perturb(costs, structure, path, work)
        if counters[ITERATIONS] % (20 * count) == 0 and counters[SWEEP] == 0:
            counters[SWEEP] = 1
