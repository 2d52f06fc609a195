"""Ordering problems without a direction: a generalised tour of points in an undirected graph."""

from __future__ import annotations

from dataclasses import dataclass, replace

import numpy as np

from optplan.domain.arrays import FloatArray, IntArray
from optplan.domain.ordering import EuclidCosts, MatrixCosts, OrderingProblem
from optplan.ordering.arrays import partners


@dataclass(frozen=True, eq=False)
class Undirected:
    """A generalised tour: one option of every cluster, an option being a point, or two points tied by a fixed edge.

    A node of the ordering problem becomes the point where it is entered; the node that drives the same piece the other
    way is entered where this one is left, and becomes the other end of the fixed edge. The depot is a cluster like
    others: one point, or two tied ones when beginning and ending cost differently.

    cluster (n,) of each point, the depot's last; mate (n,) the other end of its fixed edge, or the point itself;
    node_costs (n,) of the option, the same at both its ends; nodes: how many points are nodes of the problem, the rest
    are depots. Costs of edges (symmetric, infinite where there is none): matrix (nodes, nodes) or, where that is
    empty, distances between places (nodes, d) m; depot (n - nodes, nodes).
    """

    cluster: IntArray
    mate: IntArray
    node_costs: FloatArray
    nodes: int
    matrix: FloatArray
    places: FloatArray
    depot: FloatArray

    @property
    def points(self) -> int:
        """Number of points."""
        return len(self.cluster)

    @property
    def clusters(self) -> int:
        """Number of clusters, the depot's included."""
        return int(self.cluster[-1]) + 1

    def scaled(self, factor: float) -> Undirected:
        """The same with all costs multiplied."""
        return replace(
            self,
            node_costs=self.node_costs * factor,
            matrix=self.matrix * factor,
            places=self.places * factor,
            depot=self.depot * factor,
        )

    def edge_costs(self, tails: IntArray, heads: IntArray) -> FloatArray:
        """Costs (k,) of edges between points of different clusters, half of both node costs included."""
        low, high = np.minimum(tails, heads), np.maximum(tails, heads)
        inner = np.minimum(high, self.nodes - 1)
        if len(self.matrix):
            costs = self.matrix[low, inner]
        else:
            costs = np.linalg.norm(self.places[low] - self.places[inner], axis=-1)
        ends = high >= self.nodes
        costs = np.where(ends, 0.0, costs)
        costs[ends] = self.depot[high[ends] - self.nodes, low[ends]]
        total: FloatArray = costs + 0.5 * (self.node_costs[tails] + self.node_costs[heads])
        return total

    def edges_of(self, nodes: IntArray) -> IntArray:
        """(k, 2) points joined by a path (or closed tour) through these nodes (m,) in this order."""
        depots = np.arange(self.nodes, self.points)
        entered, left = nodes, self.mate[nodes]
        if len(depots):
            entered, left = np.append(nodes, depots[-1]), np.append(left, depots[0])
        return np.column_stack([np.roll(left, 1), entered])

    def nodes_of(self, edges: IntArray) -> IntArray | None:
        """The nodes in the order of the tour with these edges (k, 2), beginning at the depot; None for no tour."""
        links: dict[int, list[int]] = {}
        for a, b in edges.tolist():
            links.setdefault(a, []).append(b)
            links.setdefault(b, []).append(a)
        first = self.points - 1 if self.points > self.nodes else int(edges[0, 0])
        order: list[int] = []
        here, before = first, -1
        while len(order) < self.clusters:
            around = links.get(here, [])
            last = int(self.mate[here])
            order.append(here)
            if last == here:
                if len(around) != 2:
                    return None
                onward = around[1] if around[0] == before else around[0]
            else:
                # arrived at one end, on from the other
                if len(around) != 1 or len(links.get(last, [])) != 1:
                    return None
                onward = links[last][0]
            before, here = last, onward
        if here != first or len(edges) != self.clusters:
            return None
        if len(np.unique(self.cluster[order])) < self.clusters:
            return None
        if first >= self.nodes:
            return np.array(order[1:], dtype=np.int64)
        return np.array(order, dtype=np.int64)


def undirected_form(problem: OrderingProblem) -> Undirected | None:
    """The problem as a generalised tour in an undirected graph, or None when it is none.

    It is one when nothing changes as a stroke, or a whole piece of path, is driven the other way: no precedence, and
    straight lines between strokes that can be driven both ways, or a matrix that is symmetric in this sense.
    """
    costs = problem.costs
    if len(problem.precedence) or len(problem.enforced) or not isinstance(costs, EuclidCosts | MatrixCosts):
        return None
    if problem.clusters < (3 if problem.closed else 2):
        return None  # two links between the same points would be one edge used twice
    mate = _mates(problem)
    if mate is None or not np.array_equal(problem.node_costs[mate], problem.node_costs):
        return None
    count = problem.nodes
    start, end = problem.start_costs, problem.end_costs[mate]
    cluster, matrix, places = problem.cluster, np.zeros((0, 0)), np.zeros((0, 0))
    if isinstance(costs, MatrixCosts):
        matrix = costs.matrix[mate]
    else:
        places = costs.entries
    if problem.closed:
        if start.any() or end.any():
            return None
        return Undirected(cluster, mate, problem.node_costs, count, matrix, places, np.zeros((0, count)))
    # beginning and ending cost the same but for a constant: one depot with two links has no symmetry
    alike = np.isfinite(start).all() and np.isfinite(end).all() and np.ptp(start - end) == 0
    depot = 0.5 * (start + end)[None] if alike else np.stack([start, end])
    size = len(depot)
    return Undirected(
        np.append(cluster, np.full(size, problem.clusters)),
        np.append(mate, count + np.arange(size)[::-1]),
        np.append(problem.node_costs, np.zeros(size)),
        count,
        matrix,
        places,
        depot,
    )


def _mates(problem: OrderingProblem) -> IntArray | None:
    """(n,) the node driven the other way, itself for a point; None when some node has none."""
    costs, everything = problem.costs, np.arange(problem.nodes)
    if isinstance(costs, EuclidCosts):
        mate = partners(problem)
        # equal to the bit, or distances would not be
        back = np.array_equal(costs.entries[mate], costs.exits) and np.array_equal(mate[mate], everything)
        return mate if back else None
    assert isinstance(costs, MatrixCosts)
    for mate in (everything, partners(problem)):
        there = costs.matrix[mate]
        outside = problem.cluster[:, None] != problem.cluster
        if np.array_equal(there[outside], there.T[outside]):
            return mate
    return None
