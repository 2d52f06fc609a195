"""The generalised travelling-salesman tour in an undirected graph, with generalised subtour cuts.

    min  sum c_e x_e + sum w_k y_k
    sum of y over the options of a cluster = 1
    x(delta(v)) = 2 y_v          an option that is a point v
    x(delta(p)) = x(delta(q)) = y_k    an option that is a fixed edge p, q
    x(delta(S)) + (y of fixed edges that S cuts) >= 2    every set S of points that holds a whole cluster and
                                                         leaves a whole cluster outside

    x(delta(S)) >= 1 - t + 2 x(teeth)    blossoms: every set S and t pairs of clusters (teeth), where t and the number
                                         of fixed edges that S cuts, each its cluster's only option, add up to an odd
                                         number; S cuts no other fixed edge

after Fischetti, Salazar Gonzalez and Toth ("A branch-and-cut algorithm for the symmetric generalized traveling
salesman problem", 1997); a path between depots is a tour with a cluster for the depot. The cuts are exponentially many
and given explicitly. With all of them, x <= 1 follows.
"""

from __future__ import annotations

from collections.abc import Iterable
from typing import Any

import numpy as np
import numpy.typing as npt
import pyomo.environ as pyo

Floats = npt.NDArray[np.float64]
Ints = npt.NDArray[np.int64]


def build(
    cluster: Ints, mate: Ints, edges: Ints, costs: Floats, node_costs: Floats, sets: Iterable[Ints] = ()
) -> pyo.ConcreteModel:
    """The model; needs three clusters or more.

    Parameters
    ----------
    cluster : (n,) cluster of each point, 0, 0, 1, ...
    mate : (n,) the other end of a point's fixed edge, or the point itself
    edges (k, 2), costs (k,) : between points of different clusters
    node_costs : (n,) of choosing a point; of a fixed edge, the same at both its ends
    sets : points (., ) of each S that is cut

    Returns
    -------
    model : variables x[u, v] (integer) and y[v] (binary; of a fixed edge, v is the end with the smaller number)
    """
    ends = [(min(u, v), max(u, v)) for u, v in edges.tolist()]
    option = np.minimum(np.arange(len(mate)), mate).tolist()
    around: list[list[tuple[int, int]]] = [[] for _ in option]
    for u, v in ends:
        around[u].append((u, v))
        around[v].append((u, v))
    members: list[list[int]] = [[] for _ in range(int(cluster[-1]) + 1)]
    for v in sorted(set(option)):
        members[int(cluster[v])].append(v)

    model = pyo.ConcreteModel("ordering_generalised")
    model.x = pyo.Var(ends, domain=pyo.NonNegativeIntegers)
    model.y = pyo.Var(sorted(set(option)), domain=pyo.Binary)
    model.cost = pyo.Objective(
        expr=pyo.quicksum(float(c) * model.x[e] for c, e in zip(costs, ends, strict=True))
        + pyo.quicksum(float(node_costs[v]) * model.y[v] for v in model.y)
    )
    model.visit = pyo.Constraint(range(len(members)), rule=lambda m, c: pyo.quicksum(m.y[v] for v in members[c]) == 1)
    model.links = pyo.Constraint(
        range(len(option)),
        rule=lambda m, v: pyo.quicksum(m.x[e] for e in around[v]) - (2 if mate[v] == v else 1) * m.y[option[v]] == 0,
    )
    model.cut = pyo.ConstraintList()
    for points in sets:
        add_cut(model, mate, points)
    return model


def add_cut(model: Any, mate: Ints, points: Ints) -> None:
    """Add the cut of a set of points (., ) that holds a whole cluster and leaves one outside."""
    inside = set(points.tolist())
    crossing = [model.x[u, v] for u, v in model.x if (u in inside) != (v in inside)]
    fixed = [model.y[v] for v in model.y if (v in inside) != (int(mate[v]) in inside)]
    model.cut.add(pyo.quicksum(crossing) + pyo.quicksum(fixed) >= 2)


def add_blossom(model: Any, cluster: Ints, points: Ints, teeth: Ints) -> None:
    """Add the blossom of a handle, points (., ), and its teeth (t, 2), pairs of clusters: see above.

    x(teeth) counts the edges between the two clusters of a tooth that have one end in the handle.
    """
    inside = set(points.tolist())
    pairs = {(min(a, b), max(a, b)) for a, b in teeth.tolist()}
    crossing = [e for e in model.x if (e[0] in inside) != (e[1] in inside)]
    terms = []
    for u, v in crossing:
        a, b = sorted((int(cluster[u]), int(cluster[v])))
        terms.append((-1 if (a, b) in pairs else 1) * model.x[u, v])
    if terms:  # else it says 0 >= 1 - t
        model.cut.add(pyo.quicksum(terms) >= 1 - len(pairs))
