"""Every ordering problem as a rooted tour: one node of each cluster, beginning and ending in the root cluster."""

from __future__ import annotations

import math
from dataclasses import dataclass

import numpy as np
import numpy.typing as npt

from optplan.domain.arrays import FloatArray, IntArray
from optplan.domain.ordering import OrderingProblem
from optplan.ordering.arrays import dense_costs

Bools = npt.NDArray[np.bool_]


@dataclass(frozen=True, eq=False)
class RootedTour:
    """A tour through one node of each of m clusters, in an order in which the root cluster comes first.

    An open path becomes one through a depot: a node and a cluster more, the last of each.

    Parameters
    ----------
    costs : (n, n) of arcs, node costs included; infinite where no solution, or none that is looked for, has the arc
    cluster : (n,)
    root : the root cluster
    order : (m + 1, m + 1) 1 where a cluster comes before another: closed transitively, the root first; the last row and
        column stand for the return to the root
    closed : whether the problem is a tour, so that there is no depot
    """

    costs: FloatArray
    cluster: IntArray
    root: int
    order: IntArray
    closed: bool

    @property
    def nodes(self) -> int:
        """Number of nodes."""
        return len(self.cluster)

    @property
    def clusters(self) -> int:
        """Number of clusters."""
        return len(self.order) - 1

    @property
    def in_root(self) -> IntArray:
        """(n,) 1 for nodes of the root cluster."""
        inside: IntArray = (self.cluster == self.root).astype(np.int64)
        return inside

    def ends(self, heads: IntArray) -> IntArray:
        """(k,) the vertices at which arcs arrive in cuts: their heads, or n where those lie in the root cluster."""
        ends: IntArray = np.where(self.cluster[heads] == self.root, self.nodes, heads)
        return ends

    def tour_of(self, path: IntArray) -> IntArray:
        """The nodes of a tour, from the root, in the order of the problem's path (m,)."""
        if not self.closed:
            return np.concatenate([[self.nodes - 1], path])
        return np.roll(path, -int(np.flatnonzero(self.cluster[path] == self.root)[0]))

    def path_of(self, tour: IntArray) -> IntArray:
        """The problem's path of a tour that begins in the root."""
        path: IntArray = tour if self.closed else tour[1:]
        return path


def takes_closed(problem: OrderingProblem) -> bool:
    """Whether a closed problem is a rooted tour: only one cluster can be first, or it does not matter which one is."""
    return _root_of_closed(problem) is not None


def rooted_tour(problem: OrderingProblem) -> RootedTour:
    """The rooted tour of a problem of two clusters or more; of a closed one only if `takes_closed`."""
    count = problem.clusters
    costs = dense_costs(problem) + problem.node_costs
    cluster = problem.cluster
    if problem.closed:
        found = _root_of_closed(problem)
        assert found is not None
        root = found
        nodes = np.flatnonzero(cluster == root)
        costs[:, nodes] += problem.start_costs[nodes] + problem.end_costs[:, None]
    else:
        costs = np.pad(costs, (0, 1), constant_values=math.inf)
        costs[-1, :-1] = problem.start_costs + problem.node_costs
        costs[:-1, -1] = problem.end_costs
        cluster, root = np.append(cluster, count), count
        count += 1
    before = _order(count, root, problem.precedence)
    costs[~_adjacent(before, root)[np.ix_(cluster, cluster)]] = math.inf
    return RootedTour(costs, cluster, root, before.astype(np.int64), problem.closed)


def _order(count: int, root: int, precedence: IntArray) -> Bools:
    before = np.zeros((count + 1, count + 1), dtype=np.bool_)
    before[precedence[:, 0], precedence[:, 1]] = True
    before[root] = before[:, count] = True
    before[:, root] = before[count, count] = False
    for middle in range(count):
        before |= np.outer(before[:, middle], before[middle])
    return before


def _adjacent(before: Bools, root: int) -> Bools:
    """(m, m) which cluster may follow which directly: not against the order, nor skipping one that comes between."""
    weights = before.astype(np.float32)
    allowed = ~(before.T | (weights @ weights > 0))
    np.fill_diagonal(allowed, False)
    allowed[:, root] = allowed[:, -1]  # what goes into the root arrives at the end
    allowed[root, root] = False
    return allowed[:-1, :-1]


def _root_of_closed(problem: OrderingProblem) -> int | None:
    first = problem.first_node
    ready = np.logical_or.reduceat(np.isfinite(problem.start_costs), first[:-1])
    ready[problem.precedence[:, 1]] = False
    if ready.sum() == 1:
        return int(np.flatnonzero(ready)[0])
    ends = np.concatenate([problem.start_costs, problem.end_costs])
    same = bool((problem.start_costs == ends[0]).all() and (problem.end_costs == ends[-1]).all())
    if len(problem.precedence) or not same or not np.isfinite(ends).all():
        return None
    return int(np.diff(first).argmin())


def granularity(costs: FloatArray) -> float:
    """The largest number of which all finite costs are whole multiples; 0 when they are not whole numbers."""
    finite = costs[np.isfinite(costs)]
    if len(finite) == 0 or np.abs(finite).max() > 2**40 or (finite != np.rint(finite)).any():
        return 0.0
    return float(np.gcd.reduce(np.abs(finite).astype(np.int64)))
