"""Generalised TSP paths as asymmetric travelling-salesman problems, after Noon and Bean (1993).

Cities are a start (index 0) and the nodes, cluster by cluster. The nodes of a cluster form a ring of arcs that cost
nothing; its other own arcs do not exist. A tour that enters a cluster at node v goes round and is left one node short,
at v - 1: so what leaves v - 1 costs what leaving v costs ("weight shifting"). With two cities for each node, one to
enter and one to leave it, nothing has to be shifted. In both forms a tour may also leave a cluster half way and come
back later, for less than any path through the clusters costs: every arc between clusters therefore costs a big M more,
and a tour with as few of them as possible splits no cluster.

A stroke with two ends is a cluster of two nodes, which need no ring to be tied: entered at one end, it is left at the
other. A polygon is a ring of its vertices, each entered and left at the same place.
"""

from __future__ import annotations

from collections.abc import Sequence
from typing import NamedTuple

import numpy as np
import numpy.typing as npt

Floats = npt.NDArray[np.float64]
Ints = npt.NDArray[np.int64]


class Drawing(NamedTuple):
    """The ends of open strokes and the vertices of polygons as nodes.

    cluster (n,) stroke of each node, 0, 0, 1, ...; vertex (n,) its place in the stroke's points; enter, leave (n, d)
    where the node is entered and left: a polygon's vertices in clockwise order, the first and last point of a stroke
    that is open.
    """

    cluster: Ints
    vertex: Ints
    enter: Floats
    leave: Floats

    def costs(self) -> Floats:
        """(n, n) straight lines from where a node is left to where another is entered."""
        distances: Floats = np.linalg.norm(self.leave[:, None] - self.enter[None], axis=2)
        return distances


def drawing(strokes: Sequence[tuple[Floats, bool]]) -> Drawing:
    """The nodes of a drawing.

    Parameters
    ----------
    strokes : points (k, d), m, and whether they are closed: a polygon with its vertices in either sense, or a polyline
    """
    rows: list[tuple[int, int, Floats, Floats]] = []
    for number, (points, closed) in enumerate(strokes):
        if closed:
            x, y = points[:, 0], points[:, 1]
            left_turning = float(x @ np.roll(y, -1) - np.roll(x, -1) @ y) > 0
            ring = range(len(points))[::-1] if left_turning else range(len(points))
            rows += [(number, v, points[v], points[v]) for v in ring]
        else:
            last = len(points) - 1
            rows += [(number, 0, points[0], points[last]), (number, last, points[last], points[0])]
    cluster, vertex = (np.array([row[k] for row in rows], dtype=np.int64) for k in (0, 1))
    enter, leave = (np.array([row[k] for row in rows], dtype=np.float64) for k in (2, 3))
    return Drawing(cluster, vertex, enter, leave)


def sufficient(costs: Floats, cluster: Ints, start_costs: Floats, end_costs: Floats, node_costs: Floats) -> float:
    """A big M: with it a tour of one arc more between clusters costs more than any tour without."""
    between = np.where(cluster[:, None] != cluster, costs, np.inf) + node_costs
    spreads = [_spread(values) for values in (between, start_costs + node_costs, end_costs)]
    least = min(0.0, float(between.min(initial=0.0)))
    return 1.01 * ((int(cluster[-1]) + 1) * spreads[0] + spreads[1] + spreads[2] - least) or 1.0


def _spread(values: Floats) -> float:
    known = values[np.isfinite(values)]
    return float(known.max() - known.min()) if known.size else 0.0


def weight_shifted(
    costs: Floats,
    cluster: Ints,
    start_costs: Floats,
    end_costs: Floats,
    node_costs: Floats,
    *,
    big: float = 0.0,
    back: float = 1.0,
) -> Floats:
    """One city a node, weights shifted.

    Parameters
    ----------
    costs : (n, n) arc costs, infinite where there is no arc; inside a cluster they do not matter
    cluster : (n,) cluster of each node, 0, 0, 1, ...; a cluster's nodes in the order of its ring
    start_costs, end_costs, node_costs : (n,) of beginning and ending with a node, and of visiting it
    big : added to every arc between clusters; see `sufficient`. Without it the problem is only a relaxation
    back : cost of the way back to the start from everywhere

    Returns
    -------
    weights : (n + 1, n + 1); city 0 is the start, city i + 1 is node i. A tour that splits no cluster costs what its
        path costs, plus `back`, plus `big` times the number of clusters less one
    """
    onward = following(cluster)
    weights = np.full((len(cluster) + 1,) * 2, np.inf)
    weights[0, 1:] = start_costs + node_costs
    between = np.where(cluster[:, None] != cluster, costs, np.inf) + node_costs + big
    weights[1:, 1:] = between[onward]
    weights[1:, 0] = end_costs[onward] + back
    ring = onward != np.arange(len(cluster))
    weights[1:, 1:][ring, onward[ring]] = 0.0
    return weights


def double_cities(
    costs: Floats,
    cluster: Ints,
    start_costs: Floats,
    end_costs: Floats,
    node_costs: Floats,
    *,
    big: float = 0.0,
    back: float = 1.0,
) -> Floats:
    """Two cities a node: it is entered at the first and left from the second. Parameters as of `weight_shifted`.

    Returns
    -------
    weights : (2 n + 1, 2 n + 1); city 0 is the start, node i has cities 2 i + 1 and 2 i + 2
    """
    onward = following(cluster)
    size = len(cluster)
    enter, leave = 2 * np.arange(size) + 1, 2 * np.arange(size) + 2
    weights = np.full((2 * size + 1,) * 2, np.inf)
    weights[0, enter] = start_costs + node_costs
    weights[np.ix_(leave, enter)] = np.where(cluster[:, None] != cluster, costs, np.inf) + node_costs + big
    weights[leave, 0] = end_costs + back
    # entered at v: to the leaving city of the next, to its entering city, and so on to the leaving city of v
    weights[enter, leave[onward]] = 0.0
    weights[leave, enter] = np.where(onward == np.arange(size), np.inf, 0.0)
    return weights


def following(cluster: Ints) -> Ints:
    """(n,) the node after each node on the ring of its cluster."""
    first = np.searchsorted(cluster, cluster)
    size = np.searchsorted(cluster, cluster, side="right") - first
    ring: Ints = first + (np.arange(len(cluster)) - first + 1) % size
    return ring


def tour_of(nodes: Ints, cluster: Ints) -> Ints:
    """The tour of the weight-shifted problem, numbered from 1 and ended by -1, that follows this path (m,) of nodes."""
    tour = [1]
    for node in nodes.tolist():
        own = np.flatnonzero(cluster == cluster[node])
        tour += (np.roll(own, -int(np.searchsorted(own, node))) + 2).tolist()
    return np.array([*tour, -1], dtype=np.int64)


def nodes_of(tour: Sequence[int], cluster: Ints, *, double: bool = False) -> Ints:
    """The path of nodes that a tour follows: where it enters each cluster; a cluster it splits is there several times.

    Parameters
    ----------
    tour : cities numbered from 1, the start first; -1 ends it
    cluster : (n,) cluster of each node
    double : whether nodes have two cities
    """
    cities = list(tour)
    cities = cities[: cities.index(-1)] if -1 in cities else cities
    nodes = np.array(cities[1:], dtype=np.int64) - 2
    nodes = nodes // 2 if double else nodes
    entered: Ints = nodes[np.diff(cluster[nodes], prepend=-1) != 0]
    return entered
