"""Handles of violated blossoms: local search over sets of vertices."""

from __future__ import annotations

import numpy as np
import numpy.typing as npt

from optplan.compiled import njit
from optplan.domain.arrays import FloatArray, IntArray

Rows = npt.NDArray[np.uint8]
STEP = 1e-6
"""A move that lowers the lack by less is none."""


@njit(cache=True, nogil=True)
def improve_handles(
    handles: Rows,
    tails: IntArray,
    heads: IntArray,
    weights: FloatArray,
    bundle: IntArray,
    mate: IntArray,
    hopeless: float,
) -> FloatArray:
    """Move vertices into and out of each handle, in place, while that lowers what its blossom lacks; the lacks.

    A tour crosses a handle an even number of times. Its edges across, by bundles: the lack is how far the bundles are
    from being used or not, in the nearest way in which the tour would cross an odd number of times.

    Parameters
    ----------
    handles : (h, n) 1 for vertices in the handle
    tails, heads, weights (k,) : edges in use; bundle (k,) : edges of which a tour uses one at most have one number
    mate : (n,) the other end of an edge that every tour uses, or the vertex itself
    hopeless : a handle that lacks more is left as it is

    Returns
    -------
    lack : (h,) below 1 when the blossom is violated
    """
    count, edges = handles.shape[1], len(tails)
    first = np.zeros(count + 1, dtype=np.int64)
    for e in range(edges):
        first[tails[e] + 1] += 1
        first[heads[e] + 1] += 1
    for v in range(count):
        first[v + 1] += first[v]
    free = first[:-1].copy()
    links = np.empty(2 * edges, dtype=np.int64)
    for e in range(edges):
        links[free[tails[e]]] = e
        free[tails[e]] += 1
        links[free[heads[e]]] = e
        free[heads[e]] += 1
    amounts = np.zeros(bundle.max() + 1)
    marked = np.zeros(len(amounts), dtype=np.int64)
    active = np.empty(len(amounts), dtype=np.int64)
    near = np.empty(count, dtype=np.int64)
    lacks = np.empty(len(handles))
    for h in range(len(handles)):
        inside = handles[h]
        while True:
            # bundles across, and the vertices at them: no other move helps
            length = _across(inside, tails, heads, weights, bundle, mate, amounts, marked, active, near)
            odd = 0
            for v in range(count):
                if mate[v] > v and inside[v] != inside[mate[v]]:
                    odd += 1
            now = _lack(amounts, active, length, odd)
            best, move = now - STEP, -1
            for v in range(count if now <= hopeless else 0):
                if near[v] == 0:
                    continue
                longer = length
                for s in range(first[v], first[v + 1]):
                    e = links[s]
                    b = bundle[e]
                    amounts[b] += -weights[e] if inside[tails[e]] != inside[heads[e]] else weights[e]
                    if marked[b] == 0:
                        marked[b] = 1
                        active[longer] = b
                        longer += 1
                lack = _lack(amounts, active, longer, odd + (0 if mate[v] == v else 1))
                if lack < best:
                    best, move = lack, v
                for s in range(first[v], first[v + 1]):
                    e = links[s]
                    amounts[bundle[e]] += weights[e] if inside[tails[e]] != inside[heads[e]] else -weights[e]
                for k in range(length, longer):
                    marked[active[k]] = 0
                    amounts[active[k]] = 0.0
            for k in range(length):
                marked[active[k]] = 0
                amounts[active[k]] = 0.0
            if move < 0:
                break
            inside[move] = 1 - inside[move]
        lacks[h] = now
    return lacks


@njit(cache=True, nogil=True)
def _across(
    inside: npt.NDArray[np.uint8],
    tails: IntArray,
    heads: IntArray,
    weights: FloatArray,
    bundle: IntArray,
    mate: IntArray,
    amounts: FloatArray,
    marked: IntArray,
    active: IntArray,
    near: IntArray,
) -> int:
    """How much of each bundle crosses a handle, which do (`active`, `marked`), and the vertices `near`; how many do."""
    length = 0
    for v in range(len(near)):
        near[v] = 1 if inside[v] != inside[mate[v]] else 0
    for e in range(len(tails)):
        if inside[tails[e]] == inside[heads[e]]:
            continue
        near[tails[e]] = near[heads[e]] = 1
        b = bundle[e]
        amounts[b] += weights[e]
        if marked[b] == 0:
            marked[b] = 1
            active[length] = b
            length += 1
    return length


@njit(cache=True, nogil=True)
def _lack(amounts: FloatArray, active: IntArray, length: int, odd: int) -> float:
    """What a blossom lacks with these bundles across and `odd` edges that are always used."""
    total, flip = 0.0, np.inf
    for k in range(length):
        z = amounts[active[k]]
        if z > 0.5:
            odd += 1
            total += max(0.0, 1.0 - z)
        else:
            total += max(0.0, z)
        flip = min(flip, abs(1.0 - 2.0 * z))
    return total if odd % 2 == 1 else total + flip
