"""Costs and precedence as the dynamic programme over order ideals takes them, seen from either end."""

from __future__ import annotations

from typing import TYPE_CHECKING, NamedTuple

import numpy as np

from optplan.domain.arrays import BoolArray, FloatArray, IntArray
from optplan.domain.ordering import OrderingProblem
from optplan.ordering.arrays import dense_costs

if TYPE_CHECKING:
    from optplan.ordering._kernels.ideals import Network, WordArray

MAX_NODES = 3000
"""Most nodes: the arcs are written out."""


class Reduced(NamedTuple):
    """Reduced costs from the dual solution of a relaxation.

    Every path costs at least `bound` + the sum of `arcs` (n, n) over its arcs + `start` (n,) of its first node + `end`
    (n,) of its last one. All are 0 or more; infinite where a path better than the best one known does not go.
    """

    bound: float
    arcs: FloatArray
    start: FloatArray
    end: FloatArray


class Side(NamedTuple):
    """The problem seen from one end.

    network: costs and precedence; ahead (m,) how many must come before a cluster; free (1, w) bit set of those that may
    come first; never (m, m + 1): no path goes from a over another cluster to b; reduced: costs that bound it.
    """

    network: Network
    ahead: IntArray
    free: WordArray
    never: BoolArray
    reduced: Reduced


def sides(problem: OrderingProblem, reduced: Reduced | None = None) -> tuple[Side, Side]:
    """The problem from its start to its end, and from its end to its start.

    Without arcs against precedence, and without those that skip over a cluster that must come in between. Without
    `reduced`, the costs bound themselves.
    """
    count, cluster = problem.clusters, problem.cluster
    before = closure(count, problem.precedence)
    # float products are fast, and exact for counts
    skipping = before.astype(np.float32) @ before.astype(np.float32) > 0
    usable = ~(before.T | skipping | np.eye(count, dtype=np.bool_))
    costs = np.where(usable[cluster][:, cluster], dense_costs(problem) + problem.node_costs, np.inf)
    start, end = problem.start_costs + problem.node_costs, problem.end_costs
    bound, arcs, first, last = reduced or Reduced(0.0, costs, start, end)
    arcs = np.where(np.isfinite(costs), arcs, np.inf)
    direct = before & ~skipping
    return (
        _side(problem, (costs, start, end), before, direct, Reduced(bound, arcs, first, last)),
        _side(problem, (costs.T, end, start), before.T, direct.T, Reduced(bound, arcs.T, last, first)),
    )


def closure(count: int, pairs: IntArray) -> BoolArray:
    """(m, m) whether a cluster must come before another one, directly or not; pairs (k, 2) without a cycle."""
    before = np.zeros((count, count), dtype=np.bool_)
    before[pairs[:, 0], pairs[:, 1]] = True
    waiting = before.sum(axis=0)
    ready = np.flatnonzero(waiting == 0).tolist()
    for c in ready:  # grows: a topological order
        waiting[before[c]] -= 1
        ready += np.flatnonzero(before[c] & (waiting == 0)).tolist()
    for c in reversed(ready):
        before[c] |= before[before[c]].any(axis=0)
    return before


def _side(
    problem: OrderingProblem,
    costs: tuple[FloatArray, FloatArray, FloatArray],
    before: BoolArray,
    direct: BoolArray,
    reduced: Reduced,
) -> Side:
    from optplan.ordering._kernels.ideals import Network

    count = problem.clusters
    names = np.random.default_rng(count).integers(1, 2**63, count).astype(np.uint64)
    order, successors = np.nonzero(direct)
    after = np.concatenate([np.searchsorted(order, np.arange(count + 1)) + count + 1, successors])
    network = Network(
        np.array(costs[0], order="C"),
        np.array(costs[1]),
        np.array(costs[2]),
        np.array(problem.cluster),
        problem.first_node.astype(np.int64),
        bit_sets(before.T),
        after,
        names,
    )
    never = np.zeros((count, count + 1), dtype=np.bool_)
    never[:, :count] = before.T | np.eye(count, dtype=np.bool_)
    fixed = Reduced(reduced.bound, *(np.array(values, order="C") for values in reduced[1:]))
    ahead = before.sum(axis=0)
    return Side(network, ahead, bit_sets(ahead[None, :] == 0), never, fixed)


def bit_sets(members: BoolArray) -> WordArray:
    """(k, w) the rows of members (k, m) as sets of 64 bits a word."""
    size = -members.shape[1] % 64
    padded = np.ascontiguousarray(np.pad(members, ((0, 0), (0, size))))
    sets: WordArray = np.packbits(padded, axis=1, bitorder="little").view(np.uint64)
    return sets
