"""The precedence-constrained generalised TSP by degree rows and cuts that are listed.

    min  sum c_ij x_ij    over cycles that visit each cluster once (`optplan_models.ordering.rooted`)
    x(S \\ W : S' \\ W) + y(X \\ S) + y(Y & S) >= 1

for a set S of nodes, its complement S' (which holds the end), and clusters X that all precede all clusters Y, where W
are the nodes of predecessors of X and of successors of Y, y_i = x(arcs through i), y(X \\ S) is the sum over nodes of X
outside S, y(Y & S) over nodes of Y inside. The tour goes from the last of X to the first of Y, and on the way meets no
predecessor of X and no successor of Y; unless it visits X outside S or Y inside, it leaves S on the way.

- Y = end, X a cluster in S: the generalised subtour cut x(S : S') >= 1, or >= y(X & S) when X is not wholly in S
- Y = end, X all clusters in S: the predecessor cut (pi)
- X = root, Y all clusters in S': the successor cut (sigma)
- otherwise: the (pi, sigma) cut
E. Balas, M. Fischetti, W. Pulleyblank, "The precedence-constrained asymmetric traveling salesman polytope", 1995;
N. Ascheuer, M. Juenger, G. Reinelt, "A branch & cut algorithm for the asymmetric traveling salesman problem with
precedence constraints", 2000; here with clusters of several nodes.
"""

from __future__ import annotations

from collections.abc import Iterable
from typing import NamedTuple

import numpy as np
import pyomo.environ as pyo

from optplan_models.ordering.rooted import Bools, Ints, Rooted, degrees


class Cut(NamedTuple):
    """x(tails : heads) + x(arcs out of leaves) + x(arcs into enters) >= 1, an arc of several of these counted once.

    All (n,) of nodes; `heads` of a node of the root says whether the end is a head.
    """

    tails: Bools
    heads: Bools
    leaves: Bools
    enters: Bools

    def arcs(self, arcs: Ints) -> Bools:
        """(k,) which arcs count."""
        i, j = arcs.T
        counted: Bools = (self.tails[i] & self.heads[j]) | self.leaves[i] | self.enters[j]
        return counted


def build(problem: Rooted, cuts: Iterable[Cut] = ()) -> pyo.ConcreteModel:
    """The model with these cuts; complete only when they include enough of them.

    Returns
    -------
    model : variables x[i, j] (binary)
    """
    model = degrees(problem, "ordering_cuts")
    arcs = np.array(list(model.x), dtype=np.int64).reshape(-1, 2)
    model.cut = pyo.ConstraintList()
    for cut in cuts:
        counted = arcs[cut.arcs(arcs)].tolist()
        if counted:
            model.cut.add(pyo.quicksum(model.x[i, j] for i, j in counted) >= 1)
        else:
            model.cut.add(pyo.Constraint.Infeasible)
    return model


def combined(problem: Rooted, inside: Bools, first: Iterable[int], last: Iterable[int]) -> Cut:
    """The cut around S = inside (n,) from the clusters X = first to Y = last (number m: the end).

    Nodes of the root are inside as the beginning; as the end, the root is outside.

    Raises
    ------
    ValueError : some cluster of X need not come before some of Y
    """
    order, own, ends = problem.order(), problem.cluster, problem.ends()
    first, last = list(first), list(last)
    if not order[np.ix_(first, last)].all():
        raise ValueError("the first clusters must all precede the last ones")
    banned: Bools = np.logical_or(order[:, first].any(axis=1), order[last].any(axis=0))
    outside = ~inside | (own == problem.root)
    return Cut(
        tails=inside & ~banned[own],
        heads=outside & ~banned[ends],
        leaves=np.isin(own, first) & ~inside,
        enters=np.isin(ends, last) & ~outside,
    )


def subtour(problem: Rooted, inside: Bools, cluster: int) -> Cut:
    """The generalised subtour cut: a tour that visits the cluster in S leaves S. S holds nothing of the root."""
    outside = ~inside
    return Cut(inside, outside, (problem.cluster == cluster) & outside, np.zeros_like(inside))


def predecessor(problem: Rooted, inside: Bools) -> Cut:
    """The pi cut around S, which holds some cluster and nothing of the root."""
    return combined(problem, inside, _whole(problem, inside), [problem.clusters])


def successor(problem: Rooted, inside: Bools) -> Cut:
    """The sigma cut around S, which holds the root and not all."""
    return combined(problem, inside, [problem.root], _whole(problem, ~inside))


def _whole(problem: Rooted, nodes: Bools) -> list[int]:
    return [c for c in range(problem.clusters) if nodes[problem.cluster == c].all()]
