"""The precedence-constrained generalised TSP path with depots, after Miller, Tucker and Zemlin (1960).

    min  sum c_ij x_ij + sum s_i first_i + sum e_i last_i + sum w_i y_i
    sum of y over a cluster = 1;   one first, one last node
    first_i + sum_j x_ji = y_i;    last_i + sum_j x_ij = y_i
    u_a - u_b + M_ab X_ab + (M_ab - 2) X_ba <= M_ab - 1    for clusters a, b;   X_ab: sum of x from a to b

u_a is the position of cluster a, 1..m; M_ab = latest_a - earliest_b + 1. The term in X_ba is the lifting of Desrochers
and Laporte ("Improvements and extensions to the Miller-Tucker-Zemlin subtour elimination constraints", 1991); earliest
and latest positions follow from precedence, which also removes arcs: backwards ones, and those that skip a cluster
that must come in between.

As published (`lifted=False`) the last rows are u_a - u_b + m X_ab <= m - 1 for all pairs of the m clusters, precedence
is u_a - u_b <= -1, positions are within 1..m, and no arc is removed. (The m - 2 that is sometimes printed leaves no
solution for three clusters or more.)
"""

from __future__ import annotations

from typing import Any

import numpy as np
import numpy.typing as npt
import pyomo.environ as pyo

Floats = npt.NDArray[np.float64]
Ints = npt.NDArray[np.int64]


def closure(count: int, precedence: Ints) -> npt.NDArray[np.bool_]:
    """(m, m) which cluster must come before which, directly or not; from pairs (k, 2) without a cycle."""
    before = np.zeros((count, count), dtype=np.bool_)
    before[precedence[:, 0], precedence[:, 1]] = True
    for middle in range(count):
        before |= np.outer(before[:, middle], before[middle])
    return before


def possible_arcs(costs: Floats, cluster: Ints, before: npt.NDArray[np.bool_]) -> Ints:
    """(k, 2) arcs of finite cost between different clusters that precedence allows."""
    # a before c before b: b never follows a directly
    skips = (before.astype(np.float64) @ before.astype(np.float64)) > 0
    allowed = ~(before.T | skips)
    np.fill_diagonal(allowed, False)
    return np.argwhere(np.isfinite(costs) & allowed[np.ix_(cluster, cluster)]).astype(np.int64)


def build(
    costs: Floats,
    cluster: Ints,
    start_costs: Floats,
    end_costs: Floats,
    node_costs: Floats,
    precedence: Ints,
    *,
    lifted: bool = True,
) -> pyo.ConcreteModel:
    """The model; needs two clusters or more.

    Parameters
    ----------
    costs : (n, n) arc costs, infinite where there is no arc; inside a cluster they do not matter
    cluster : (n,) cluster of each node, 0, 0, 1, ...
    start_costs, end_costs : (n,) of beginning and ending with a node; infinite where that is forbidden
    node_costs : (n,)
    precedence : (k, 2) pairs of clusters, the first before the second; no cycle
    lifted : whether to strengthen the published rows, and to draw conclusions from precedence

    Returns
    -------
    model : variables x[i, j], y[i], first[i], last[i] (binary) and u[a]
    """
    count = int(cluster[-1]) + 1
    before = closure(count, precedence if lifted else precedence[:0])
    arcs = possible_arcs(costs, cluster, before)
    earliest = 1 + before.sum(axis=0)
    latest = count - before.sum(axis=1)
    firsts = np.flatnonzero(np.isfinite(start_costs) & (earliest[cluster] == 1))
    lasts = np.flatnonzero(np.isfinite(end_costs) & (latest[cluster] == count))

    model = pyo.ConcreteModel("ordering_mtz")
    model.nodes = pyo.RangeSet(0, len(cluster) - 1)
    model.clusters = pyo.RangeSet(0, count - 1)
    model.x = pyo.Var([(int(i), int(j)) for i, j in arcs], domain=pyo.Binary)
    model.y = pyo.Var(model.nodes, domain=pyo.Binary)
    model.first = pyo.Var([int(i) for i in firsts], domain=pyo.Binary)
    model.last = pyo.Var([int(i) for i in lasts], domain=pyo.Binary)
    model.u = pyo.Var(model.clusters, bounds=lambda _, a: (int(earliest[a]), int(latest[a])))

    model.cost = pyo.Objective(
        expr=pyo.quicksum(float(costs[i, j]) * model.x[i, j] for i, j in model.x)
        + pyo.quicksum(float(start_costs[i]) * model.first[i] for i in model.first)
        + pyo.quicksum(float(end_costs[i]) * model.last[i] for i in model.last)
        + pyo.quicksum(float(node_costs[i]) * model.y[i] for i in model.nodes)
    )
    _add_visits(model, cluster, count)
    if lifted:
        _add_lifted_positions(model, cluster, before, earliest, latest)
    else:
        _add_positions(model, cluster, count, precedence)
    return model


def _add_visits(model: Any, cluster: Ints, count: int) -> None:
    """One node of each cluster, entered once and left once."""
    members: list[list[int]] = [[] for _ in range(count)]
    for i, c in enumerate(cluster.tolist()):
        members[c].append(i)
    into: list[list[Any]] = [[] for _ in cluster]
    out: list[list[Any]] = [[] for _ in cluster]
    for i in model.first:
        into[i].append(model.first[i])
    for i in model.last:
        out[i].append(model.last[i])
    for i, j in model.x:
        out[i].append(model.x[i, j])
        into[j].append(model.x[i, j])
    model.visit = pyo.Constraint(model.clusters, rule=lambda m, c: pyo.quicksum(m.y[i] for i in members[c]) == 1)
    model.enter = pyo.Constraint(model.nodes, rule=lambda m, i: pyo.quicksum(into[i]) - m.y[i] == 0)
    model.leave = pyo.Constraint(model.nodes, rule=lambda m, i: pyo.quicksum(out[i]) - m.y[i] == 0)
    if len(model.first) and len(model.last):
        model.begin = pyo.Constraint(expr=pyo.quicksum(model.first.values()) == 1)
        model.end = pyo.Constraint(expr=pyo.quicksum(model.last.values()) == 1)
    else:
        # nothing may be first or last: say so in a row that no y can satisfy
        model.begin = pyo.Constraint(expr=pyo.quicksum(model.y.values()) == count + 1)


def _between(model: Any, cluster: Ints) -> dict[tuple[int, int], list[Any]]:
    """The arcs from one cluster to another, by pairs of clusters."""
    between: dict[tuple[int, int], list[Any]] = {}
    for i, j in model.x:
        between.setdefault((int(cluster[i]), int(cluster[j])), []).append(model.x[i, j])
    return between


def _add_positions(model: Any, cluster: Ints, count: int, precedence: Ints) -> None:
    """Positions of clusters as published: no subtours, and precedence."""
    between = _between(model, cluster)
    model.order = pyo.Constraint(
        list(between), rule=lambda m, a, b: m.u[a] - m.u[b] + count * pyo.quicksum(between[a, b]) <= count - 1
    )
    model.precede = pyo.Constraint(
        sorted({(int(a), int(b)) for a, b in precedence}), rule=lambda m, a, b: m.u[a] - m.u[b] <= -1
    )


def _add_lifted_positions(
    model: Any, cluster: Ints, before: npt.NDArray[np.bool_], earliest: Ints, latest: Ints
) -> None:
    """Positions of clusters, lifted and tightened by precedence."""
    count = len(earliest)
    between = _between(model, cluster)

    def order(m: Any, a: int, b: int) -> Any:
        if a == b or earliest[b] > latest[a]:
            return pyo.Constraint.Skip
        big = int(latest[a] - earliest[b]) + 1
        if before[a, b]:
            # X_ba does not exist, and the row holds whether or not the arc is used
            return m.u[a] - m.u[b] <= -1
        there, back = between.get((a, b), []), between.get((b, a), [])
        if not there:
            return pyo.Constraint.Skip
        return m.u[a] - m.u[b] + big * pyo.quicksum(there) + (big - 2) * pyo.quicksum(back) <= big - 1

    model.order = pyo.Constraint(model.clusters, model.clusters, rule=order)

    # a cluster that is not first is second or later, one that is not last at most last but one
    def of(variables: Any, a: int) -> Any:
        return pyo.quicksum(variables[i] for i in variables if cluster[i] == a)

    model.second = pyo.Constraint(
        model.clusters,
        rule=lambda m, a: m.u[a] + of(m.first, a) >= 2 if earliest[a] == 1 else pyo.Constraint.Skip,
    )
    model.before_last = pyo.Constraint(
        model.clusters,
        rule=lambda m, a: m.u[a] - of(m.last, a) <= count - 1 if latest[a] == count else pyo.Constraint.Skip,
    )


def set_path(model: Any, cluster: Ints, nodes: Ints) -> None:
    """Give all variables the values of this path (m,) of nodes: a start for the solver."""
    chosen, steps = set(nodes.tolist()), set(zip(nodes[:-1].tolist(), nodes[1:].tolist(), strict=True))
    for key, variable in model.x.items():
        variable.set_value(float(key in steps), skip_validation=True)
    for i, variable in model.y.items():
        variable.set_value(float(i in chosen), skip_validation=True)
    for i, variable in model.first.items():
        variable.set_value(float(i == nodes[0]), skip_validation=True)
    for i, variable in model.last.items():
        variable.set_value(float(i == nodes[-1]), skip_validation=True)
    for position, i in enumerate(nodes.tolist(), start=1):
        model.u[int(cluster[i])].set_value(float(position), skip_validation=True)


def path_of(model: Any) -> Ints:
    """The path (m,) of nodes in the variables' values; shorter when they describe none."""
    following = {i: j for (i, j), variable in model.x.items() if (variable.value or 0.0) > 0.5}
    starts = [i for i, variable in model.first.items() if (variable.value or 0.0) > 0.5]
    nodes = starts[:1]
    while nodes and nodes[-1] in following and len(nodes) <= len(following):
        nodes.append(following[nodes[-1]])
    return np.array(nodes, dtype=np.int64)
