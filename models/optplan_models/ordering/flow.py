"""The precedence-constrained generalised TSP as a flow of one commodity, after Gavish and Graves (1978).

    min  sum c_ij x_ij    over cycles that visit each cluster once (`optplan_models.ordering.rooted`)
    f(arcs into i) - f(arcs out of i) = x(arcs into i)     for nodes outside the root
    f(arcs into a) >= f(arcs into b) + 1                   for clusters a before b
    low_ij x_ij <= f_ij <= high_ij x_ij

The root sends one unit to every other cluster, so that f_ij counts the clusters still to be visited when the tour takes
the arc i -> j, and nothing goes round without the root. Of m - 1 clusters outside the root, cluster a is at a position
in [E_a, L_a], by the transitive closure of precedence; on an arc from a to b the flow is therefore at least
max(m - L_b, m - 1 - L_a) and at most min(m - E_b, m - 1 - E_a); on an arc into the root it is 0.
"""

from __future__ import annotations

from typing import Any

import numpy as np
import pyomo.environ as pyo

from optplan_models.ordering.rooted import Ints, Rooted, degrees


def build(problem: Rooted) -> pyo.ConcreteModel:
    """The model; needs two clusters or more.

    Returns
    -------
    model : variables x[i, j] (binary) and f[i, j] (continuous)
    """
    model = degrees(problem, "ordering_flow")
    order, root = problem.order(), problem.root
    count = problem.clusters
    earliest = order.sum(axis=0)[:count]  # the root is before all
    latest = count - order.sum(axis=1)[:count]  # the end is after all
    own = problem.cluster
    model.f = pyo.Var(model.x.index_set(), domain=pyo.NonNegativeReals)
    into: list[list[Any]] = [[] for _ in own]
    out: list[list[Any]] = [[] for _ in own]
    entries: list[list[Any]] = [[] for _ in own]
    for i, j in model.x:
        out[i].append(model.f[i, j])
        into[j].append(model.f[i, j])
        entries[j].append(model.x[i, j])
    inner = [i for i in model.nodes if own[i] != root and (into[i] or out[i])]
    model.deliver = pyo.Constraint(
        inner,
        rule=lambda _, i: pyo.quicksum(into[i]) - pyo.quicksum(out[i]) - pyo.quicksum(entries[i]) == 0,
    )

    def limits(i: int, j: int) -> tuple[int, int]:
        a, b = own[i], own[j]
        if b == root:
            return 0, 0
        # the root is at position 0
        low_a, high_a = (0, 0) if a == root else (earliest[a], latest[a])
        return (
            int(max(count - latest[b], count - 1 - high_a)),
            int(min(count - earliest[b], count - 1 - low_a)),
        )

    model.most = pyo.Constraint(model.x.index_set(), rule=lambda m, i, j: m.f[i, j] - limits(i, j)[1] * m.x[i, j] <= 0)
    model.least = pyo.Constraint(model.x.index_set(), rule=lambda m, i, j: m.f[i, j] - limits(i, j)[0] * m.x[i, j] >= 0)
    pairs = [(int(a), int(b)) for a, b in np.argwhere(order[:count, :count]) if a != root]

    def earlier(_: Any, a: int, b: int) -> Any:
        units = [[f for i in np.flatnonzero(own == c) for f in into[i]] for c in (a, b)]
        if not units[0] and not units[1]:
            return pyo.Constraint.Infeasible
        return pyo.quicksum(units[0]) - pyo.quicksum(units[1]) >= 1

    model.earlier = pyo.Constraint(pairs, rule=earlier)
    return model


def set_flow(model: Any, nodes: Ints) -> None:
    """Give f the values that belong to this tour (m,) of nodes, from the root on; x is set by `rooted.set_tour`."""
    steps = zip(nodes.tolist(), np.roll(nodes, -1).tolist(), strict=True)
    left = {step: len(nodes) - 1 - place for place, step in enumerate(steps)}
    for key, variable in model.f.items():
        variable.set_value(float(left.get(key, 0)), skip_validation=True)
