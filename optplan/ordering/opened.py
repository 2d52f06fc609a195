"""Closed paths as open ones: for each node that the tour may be cut open at, the path through all other clusters."""

from __future__ import annotations

import math
from dataclasses import dataclass, replace

import numpy as np

from optplan.domain.arrays import IntArray
from optplan.domain.ordering import OrderingProblem
from optplan.ordering.reduce import chosen_costs


@dataclass(frozen=True, eq=False)
class Opened:
    """A closed problem cut open at one node: the path through all other clusters, from that node and back to it.

    Parameters
    ----------
    problem : the path; its costs are those of the tour less `extra`
    root : node of the closed problem at which the tour begins
    others : (k,) node of the closed problem that each node of the path is
    extra : cost of beginning with the root, whatever comes behind it
    """

    problem: OrderingProblem
    root: int
    others: IntArray
    extra: float

    def expand(self, nodes: IntArray) -> IntArray:
        """The tour (m,) that follows this path (m - 1,)."""
        return np.concatenate([[self.root], self.others[nodes]]).astype(np.int64)

    def shrink(self, tour: IntArray) -> IntArray:
        """The path that a tour beginning with the root follows."""
        return np.searchsorted(self.others, tour[1:]).astype(np.int64)


def opened(problem: OrderingProblem) -> list[Opened]:
    """The paths of which the best is the best tour; empty when no cluster can be the first.

    Where it does not matter which cluster is listed first, it is the smallest one: each of its nodes gives a path.
    """
    cluster, first = problem.cluster, problem.first_node
    if rotatable(problem):
        smallest = int(np.diff(first).argmin())
        roots = np.arange(first[smallest], first[smallest + 1])
    else:
        has_before = np.isin(cluster, problem.precedence[:, 1])
        roots = np.flatnonzero(np.isfinite(problem.start_costs) & ~has_before)
    return [_cut_open(problem, int(root)) for root in roots]


def rotatable(problem: OrderingProblem) -> bool:
    """Whether a tour costs the same wherever its list begins."""
    return not (problem.start_costs.any() or problem.end_costs.any() or len(problem.precedence))


def rotated(problem: OrderingProblem, tour: IntArray, ways: list[Opened]) -> IntArray:
    """The same tour, listed from a root on if there is one in it."""
    places = np.flatnonzero(np.isin(tour, [way.root for way in ways]))
    return np.roll(tour, -int(places[0])) if len(places) and rotatable(problem) else tour


def _cut_open(problem: OrderingProblem, root: int) -> Opened:
    cluster = problem.cluster
    others = np.flatnonzero(cluster != cluster[root])
    here = np.full(len(others), root)
    pairs = problem.precedence
    pairs = pairs[(pairs != cluster[root]).all(axis=1)]
    path = replace(
        problem,
        cluster=cluster[others] - (cluster[others] > cluster[root]),
        costs=chosen_costs(problem.costs, others, others),
        start_costs=problem.costs.pairs(here, others),
        end_costs=problem.end_costs[others] + problem.costs.pairs(others, here),
        node_costs=problem.node_costs[others],
        precedence=pairs - (pairs > cluster[root]),
        closed=False,
    )
    extra = problem.start_costs[root] + problem.node_costs[root]
    if problem.clusters == 1:
        extra += problem.end_costs[root]
    return Opened(path, root, others, float(extra) if math.isfinite(extra) else math.inf)
