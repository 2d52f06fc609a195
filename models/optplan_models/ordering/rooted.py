"""The ordering problem as a tour through a root cluster: what the models by arcs alone share.

    min  sum c_ij x_ij
    x(arcs into a cluster) = x(arcs out of it) = 1;    x(arcs into a node) = x(arcs out of it)

An open path becomes a tour through a depot: one node and one cluster more, the last of each, whose arcs are the
beginnings and the ends of the path. In the order of clusters the root is first; the return to it counts as one more
cluster, the end, number m. Arcs that precedence rules out are left out.
"""

from __future__ import annotations

import math
from typing import Any, NamedTuple

import numpy as np
import numpy.typing as npt
import pyomo.environ as pyo

from optplan_models.ordering.mtz import closure, possible_arcs

Floats = npt.NDArray[np.float64]
Ints = npt.NDArray[np.int64]
Bools = npt.NDArray[np.bool_]


class Rooted(NamedTuple):
    """A tour through one node of each of m clusters.

    costs (n, n), node costs included, infinite where there is no arc; cluster (n,): 0, 0, 1, ...; root, the cluster in
    which the tour begins and ends; precedence (k, 2) pairs of other clusters, without a cycle.
    """

    costs: Floats
    cluster: Ints
    root: int
    precedence: Ints

    @property
    def clusters(self) -> int:
        """Their number m."""
        return int(self.cluster[-1]) + 1

    def order(self) -> Bools:
        """(m + 1, m + 1) which cluster must come before which; the last is the end."""
        count, others = self.clusters, np.delete(np.arange(self.clusters), self.root)
        pairs = [self.precedence, *(np.array([[self.root, c], [c, count]]) for c in others)]
        return closure(count + 1, np.concatenate(pairs).astype(np.int64))

    def ends(self) -> Ints:
        """(n,) the cluster in which an arc into each node arrives: its own, or the end for nodes of the root."""
        ends: Ints = np.where(self.cluster == self.root, self.clusters, self.cluster)
        return ends

    def arcs(self) -> Ints:
        """(k, 2) arcs that precedence allows."""
        count = len(self.cluster)
        # nodes of the root appear twice, as tails and as heads
        doubled = np.full((2 * count, 2 * count), math.inf)
        doubled[:count, count:] = self.costs
        doubled[:count, count:][self.cluster[:, None] == self.cluster] = math.inf
        pairs = possible_arcs(doubled, np.concatenate([self.cluster, self.ends()]), self.order())
        pairs[:, 1] -= count
        return pairs


def with_depot(
    costs: Floats, cluster: Ints, start_costs: Floats, end_costs: Floats, node_costs: Floats, precedence: Ints
) -> Rooted:
    """The open path as a tour through a depot; arguments as in `optplan_models.ordering.mtz.build`."""
    wide = np.pad(costs + node_costs, (0, 1), constant_values=math.inf)
    wide[-1, :-1] = start_costs + node_costs
    wide[:-1, -1] = end_costs
    depot = int(cluster[-1]) + 1
    return Rooted(wide, np.append(cluster, depot), depot, precedence)


def degrees(problem: Rooted, name: str) -> pyo.ConcreteModel:
    """A model with variables x[i, j] (binary), the cost, and rows that ask for cycles which visit each cluster once."""
    count = problem.clusters
    model = pyo.ConcreteModel(name)
    model.nodes = pyo.RangeSet(0, len(problem.cluster) - 1)
    model.clusters = pyo.RangeSet(0, count - 1)
    model.x = pyo.Var([(int(i), int(j)) for i, j in problem.arcs()], domain=pyo.Binary)
    model.cost = pyo.Objective(expr=pyo.quicksum(float(problem.costs[i, j]) * model.x[i, j] for i, j in model.x))
    into: list[list[Any]] = [[] for _ in problem.cluster]
    out: list[list[Any]] = [[] for _ in problem.cluster]
    for i, j in model.x:
        out[i].append(model.x[i, j])
        into[j].append(model.x[i, j])
    members = [np.flatnonzero(problem.cluster == c).tolist() for c in range(count)]

    def once(lists: list[list[Any]]) -> Any:
        def rule(_: Any, c: int) -> Any:
            terms = [variable for i in members[c] for variable in lists[i]]
            # a cluster that cannot be reached: say so in a row that nothing satisfies
            return pyo.quicksum(terms) == 1 if terms else pyo.Constraint.Infeasible

        return rule

    model.enter = pyo.Constraint(model.clusters, rule=once(into))
    model.leave = pyo.Constraint(model.clusters, rule=once(out))
    shared = [i for own in members if len(own) > 1 for i in own if into[i] or out[i]]
    model.through = pyo.Constraint(shared, rule=lambda _, i: pyo.quicksum(into[i]) - pyo.quicksum(out[i]) == 0)
    return model


def set_tour(model: Any, nodes: Ints) -> None:
    """Give x the values of this tour (m,) of nodes."""
    steps = set(zip(nodes.tolist(), np.roll(nodes, -1).tolist(), strict=True))
    for key, variable in model.x.items():
        variable.set_value(float(key in steps), skip_validation=True)


def tour_of(model: Any, problem: Rooted) -> Ints:
    """The tour in the values of x, from the root on; shorter than m when they describe none."""
    following = {i: j for (i, j), variable in model.x.items() if (variable.value or 0.0) > 0.5}
    nodes = [i for i in following if problem.cluster[i] == problem.root][:1]
    while nodes and (after := following.get(nodes[-1], nodes[0])) != nodes[0] and len(nodes) <= len(following):
        nodes.append(after)
    return np.array(nodes, dtype=np.int64)
