"""An ordering problem as the circular graph that the search works on."""

from __future__ import annotations

from collections.abc import Callable
from typing import TYPE_CHECKING

import numpy as np
import numpy.typing as npt

from optplan.domain.arrays import FloatArray, IntArray
from optplan.domain.costs import DubinsCosts, EuclidCosts
from optplan.domain.ordering import OrderingProblem
from optplan.ordering.arrays import DENSE_DUBINS, DENSE_NODES, dense_costs, fixed, grouped, partners
from optplan.ordering.duals import prices
from optplan.ordering.near import nearest_clusters

if TYPE_CHECKING:
    from optplan.ordering._kernels.tour import Graph

NEAR = 10
"""Neighbours of a cluster on each side."""
CLOSURE = 3000
"""Up to this many clusters precedence is closed transitively, and neighbours that it forbids are left out."""
ROUGH = 0.35
"""Costs that differ by less from those of the way back, on average and relatively, are roughly symmetric."""
BoolArray = npt.NDArray[np.bool_]


def circular_graph(problem: OrderingProblem, anchor: int | None, stop: Callable[[], object]) -> Graph:
    """The graph for the kernels. When `stop` says so while it is made, near lists may be worse.

    An open path gets a depot as a cluster of its own, with the last number; a closed one begins with cluster `anchor`.
    Costs of the first and the last node are added to the arcs from and to the anchor, node costs to all arcs into a
    node.
    """
    from optplan.ordering._kernels.tour import MIRROR, Graph

    count = problem.clusters
    first = problem.first_node.astype(np.int64)
    pairs = np.unique(problem.precedence, axis=0).reshape(-1, 2)
    if anchor is None:
        first = np.append(first, first[-1] + 1)
    else:
        pairs = pairs[(pairs != anchor).all(axis=1)]
    size = len(first) - 1
    forbidden: BoolArray | None = None
    if len(pairs) and count <= CLOSURE:
        pairs, forbidden = _relations(pairs, count)
    distant = _is_distant(problem)
    data = _placed(problem, anchor) if distant else _dense(problem, anchor)
    partner = np.append(partners(problem), problem.nodes)[: first[-1]]
    sizes = np.diff(first)
    flags = (
        distant,
        _mirror(problem, partner[: problem.nodes]),
        len(pairs) > 0,
        count if anchor is None else anchor,
        int(sizes.argmin()),
        0 if problem.nodes == count else int((sizes * np.roll(sizes, 1)).sum()) * int(sizes.min()),
    )
    offset = 0.0
    if distant:
        near = _near_placed(problem, size)
    else:
        arcs = _cheapest(data, first, forbidden)
        # where both directions cost about the same, assignments are pairs back and forth and their prices say little;
        # where all clusters are near, prices would leave out none
        if flags[MIRROR] == 0 and size - 1 > NEAR:
            leave, enter = prices(arcs, stop)
            arcs -= leave[:, None] + enter
            data -= np.repeat(leave, sizes)[:, None] + np.repeat(enter, sizes)
            offset = float(leave.sum() + enter.sum())
        near = _nearest(arcs)
    return Graph(
        offset,
        float(problem.costs.radius) if isinstance(problem.costs, DubinsCosts) else 0.0,
        fixed(data),
        fixed(first),
        fixed(near),
        fixed(grouped(pairs[:, 1], pairs[:, 0], size)),
        fixed(grouped(pairs[:, 0], pairs[:, 1], size)),
        fixed(partner),
        fixed(np.array(flags, dtype=np.int64)),
    )


def _is_distant(problem: OrderingProblem) -> bool:
    """Whether costs are computed on demand, because writing them out takes too much memory or time."""
    if isinstance(problem.costs, EuclidCosts):
        return problem.nodes > DENSE_NODES
    return isinstance(problem.costs, DubinsCosts) and problem.nodes > DENSE_DUBINS


def _dense(problem: OrderingProblem, anchor: int | None) -> FloatArray:
    """(n, n) all costs; with a depot (n + 1, n + 1)."""
    count = problem.nodes
    size = count + (anchor is None)
    data = np.zeros((size, size))
    data[:count, :count] = dense_costs(problem)
    if anchor is None:
        data[count, :count] = problem.start_costs
        data[:count, count] = problem.end_costs
    else:
        own = problem.cluster == anchor
        data[:count, own] += problem.end_costs[:, None] + problem.start_costs[own]
    data[:, :count] += problem.node_costs
    first = problem.first_node
    for low, high in zip(first[:-1].tolist(), first[1:].tolist(), strict=True):
        data[low:high, low:high] = 0.0
    return _penalised(data, problem.clusters)


def _placed(problem: OrderingProblem, anchor: int | None) -> FloatArray:
    """(n, 2 d + 4) where each node is and what it costs; see `Graph`."""
    costs = problem.costs
    assert isinstance(costs, EuclidCosts | DubinsCosts)
    flag = np.zeros(problem.nodes) if anchor is None else (problem.cluster == anchor).astype(np.float64)
    own = problem.node_costs + np.where(flag > 0, problem.start_costs, 0.0)
    data = np.column_stack([costs.entries, costs.exits, problem.start_costs, problem.end_costs, own, flag])
    if anchor is None:
        depot = np.zeros((1, data.shape[1]))
        depot[0, -1] = 2.0
        data = np.concatenate([data, depot])
    return _penalised(data, problem.clusters * (2 * data.shape[1] + 14))


def _penalised(data: FloatArray, arcs: int) -> FloatArray:
    """Infinite costs become larger than a path of so many arcs."""
    infinite = np.isinf(data)
    if infinite.any():
        data[infinite] = 2.0 * (float(np.abs(data[~infinite]).max(initial=0.0)) + 1.0) * (arcs + 1)
    return data


def _mirror(problem: OrderingProblem, partner: IntArray) -> int:
    """EXACT when a piece of path costs the same travelled backwards by the partners, ROUGHLY when similar, else 0."""
    from optplan.ordering._kernels.tour import EXACT, ROUGHLY

    costs = problem.costs
    # arcs carry the cost of the node they lead to: backwards it would be another's
    alike = bool(np.ptp(problem.node_costs) == 0)
    if isinstance(costs, EuclidCosts | DubinsCosts):
        size = 2 if isinstance(costs, DubinsCosts) else costs.exits.shape[1]
        turned = (costs.exits[partner, :size] == costs.entries[:, :size]).all(axis=1)
        if isinstance(costs, DubinsCosts):
            turned &= partner != np.arange(len(partner))
        return EXACT if alike and turned.all() else ROUGHLY if turned.mean() > 1.0 - ROUGH else 0
    matrix = dense_costs(problem)
    back = matrix[np.ix_(partner, partner)].T
    if alike and np.array_equal(back, matrix):
        return EXACT
    finite = np.isfinite(back) & np.isfinite(matrix)
    there, back = matrix[finite], back[finite]
    return ROUGHLY if np.abs(back - there).sum() < ROUGH * np.abs(there).sum() else 0


def _relations(pairs: IntArray, count: int) -> tuple[IntArray, BoolArray]:
    """The pairs (k, 2) that follow from no others, and (m, m) which cluster cannot follow directly on which."""
    direct = np.zeros((count, count), dtype=bool)
    direct[pairs[:, 0], pairs[:, 1]] = True
    reach = direct.copy()
    for c in _topological(direct)[::-1]:
        reach[c] |= reach[direct[c]].any(axis=0)
    closed = reach.astype(np.float32)
    skipping = closed @ closed > 0.5
    return np.argwhere(reach & ~skipping), skipping | reach.T


def _topological(direct: BoolArray) -> list[int]:
    """The clusters, each behind those that must come before it."""
    waiting = direct.sum(axis=0)
    order = np.flatnonzero(waiting == 0).tolist()
    for c in order:
        after = np.flatnonzero(direct[c])
        waiting[after] -= 1
        order += after[waiting[after] == 0].tolist()
    return order


def _cheapest(data: FloatArray, first: IntArray, forbidden: BoolArray | None) -> FloatArray:
    """(m, m) the cheapest arc from cluster to cluster, infinite where precedence allows none."""
    arcs = np.minimum.reduceat(np.minimum.reduceat(data, first[:-1], axis=0), first[:-1], axis=1)
    if forbidden is not None:
        count = len(forbidden)
        arcs[:count, :count][forbidden] = np.inf
    np.fill_diagonal(arcs, np.inf)
    return arcs


def _nearest(arcs: FloatArray) -> IntArray:
    """(2, m, k) the successors and predecessors to which arcs cost least."""
    size = len(arcs)
    wanted = min(NEAR, size - 1)
    near = np.empty((2, size, wanted), dtype=np.int64)
    # equally near ones in random order, else the same few would be everyone's neighbours
    keys = np.empty((size, size), dtype=np.complex128)
    keys.imag = np.random.default_rng(0).random((size, size))
    for side, costs in enumerate((arcs, arcs.T)):
        keys.real = costs
        order = np.argpartition(keys, wanted - 1, axis=1)[:, :wanted]
        order = np.take_along_axis(order, np.argsort(np.take_along_axis(keys, order, axis=1), axis=1), axis=1)
        near[side] = np.where(np.isinf(np.take_along_axis(costs, order, axis=1)), -1, order)
    return near


def _near_placed(problem: OrderingProblem, size: int) -> IntArray:
    """The same by straight lines; a depot is nobody's neighbour."""
    found, _ = nearest_clusters(problem, NEAR)
    near = np.full((2, size, found.shape[1]), -1, dtype=np.int64)
    near[:, : problem.clusters] = found
    return near
