"""A peer at work, in a process and an environment of its own: `python peer_worker.py NAME SECONDS < problem.json`.

The problem: `costs` (n + 1, n + 1) whole numbers, row and column 0 a depot; `clusters`, lists of nodes 1..n of which
one each is visited; `precedence`, pairs of clusters. Prints the nodes in the order found, as JSON; [] for none.
"""

from __future__ import annotations

import json
import sys
from typing import Any


def or_tools(problem: dict[str, Any], seconds: float) -> list[int]:
    """Routing with guided local search; clusters as disjunctions, precedence by position."""
    from ortools.constraint_solver import pywrapcp, routing_enums_pb2

    costs = problem["costs"]
    manager = pywrapcp.RoutingIndexManager(len(costs), 1, 0)
    routing = pywrapcp.RoutingModel(manager)
    arc = routing.RegisterTransitMatrix(costs)
    routing.SetArcCostEvaluatorOfAllVehicles(arc)
    for cluster in problem["clusters"]:
        if len(cluster) > 1:
            routing.AddDisjunction([manager.NodeToIndex(i) for i in cluster], -1, 1)
    if problem["precedence"]:
        routing.AddConstantDimension(1, len(costs) + 1, True, "position")
        position = routing.GetDimensionOrDie("position")
        for a, b in problem["precedence"]:
            (i,), (j,) = problem["clusters"][a], problem["clusters"][b]
            first, second = (position.CumulVar(manager.NodeToIndex(k)) for k in (i, j))
            routing.solver().Add(first + 1 <= second)
    how = pywrapcp.DefaultRoutingSearchParameters()
    how.first_solution_strategy = routing_enums_pb2.FirstSolutionStrategy.PATH_CHEAPEST_ARC
    how.local_search_metaheuristic = routing_enums_pb2.LocalSearchMetaheuristic.GUIDED_LOCAL_SEARCH
    how.time_limit.FromMilliseconds(int(1000 * seconds))
    found = routing.SolveWithParameters(how)
    if found is None:
        return []
    nodes, index = [], found.Value(routing.NextVar(routing.Start(0)))
    while not routing.IsEnd(index):
        nodes.append(manager.IndexToNode(index))
        index = found.Value(routing.NextVar(index))
    return nodes


def pyvrp(problem: dict[str, Any], seconds: float) -> list[int]:
    """One vehicle; clusters as client groups. It knows no precedence."""
    from pyvrp import Model
    from pyvrp.stop import MaxRuntime

    costs = problem["costs"]
    model = Model()
    places = [model.add_location(0, 0) for _ in costs]
    model.add_depot(places[0])
    for cluster in problem["clusters"]:
        group = model.add_client_group() if len(cluster) > 1 else None
        for i in cluster:
            model.add_client(places[i], required=group is None, group=group, name=str(i))
    model.add_vehicle_type(1)
    for a, row in enumerate(costs):
        for b, cost in enumerate(row):
            if a != b:
                model.add_edge(places[a], places[b], distance=cost)
    found = model.solve(MaxRuntime(seconds), seed=0, display=False)
    if not found.is_feasible():
        return []
    order = [i for cluster in problem["clusters"] for i in cluster]
    return [order[visit] for visit in _visits(found)]


def _visits(found: Any) -> list[int]:
    """Clients in the order visited, counted from 0 as they were added."""
    (route,) = found.best.routes()
    return [int(activity.idx) for activity in route if activity.is_client()]


if __name__ == "__main__":
    peer = {"or-tools": or_tools, "pyvrp": pyvrp}[sys.argv[1]]
    print(json.dumps(peer(json.load(sys.stdin), float(sys.argv[2]))))
