"""The ordering problem: a precedence-constrained generalised travelling-salesman path, and its solution.

Clusters are strokes, nodes are their traversals. A path visits one node of every cluster; it begins at a start depot
and ends at an end depot, whose arcs may all be free, or it returns to where it began. TSP path, ATSP, GTSP and SOP are
special cases.
"""

from __future__ import annotations

import math
from dataclasses import dataclass, field
from enum import StrEnum
from typing import Any, Protocol

import numpy as np

from optplan.domain.arrays import FloatArray, IntArray, frozen_floats, frozen_ints
from optplan.domain.costs import ArcCosts, ChosenCosts, DubinsCosts, EuclidCosts, MatrixCosts
from optplan.domain.enforced import chains, missing_connections
from optplan.domain.errors import InputError
from optplan.domain.progress import ProgressCallback
from optplan.domain.stop import StopReason, StopRule

__all__ = [
    "ArcCosts",
    "ChosenCosts",
    "DubinsCosts",
    "EuclidCosts",
    "MatrixCosts",
    "Ordering",
    "OrderingProblem",
    "Solver",
    "Status",
    "TracePoint",
    "precedence_cycle",
]


@dataclass(frozen=True, eq=False)
class OrderingProblem:
    """A precedence-constrained generalised TSP path.

    Parameters
    ----------
    cluster : (n,) cluster of each node; every number 0..m-1 occurs, in non-decreasing order
    costs : arc costs between nodes of different clusters (n nodes)
    start_costs, end_costs : (n,) cost of beginning with and of ending with a node; zeros for a free start or end,
        infinite where a node may not be first or last
    node_costs : (n,) what a node costs wherever it is, usually over the cheapest of its cluster
    precedence : (k, 2) pairs of clusters: the first before the second, not necessarily directly
    enforced : (k, 3) connection, tail node, head node. Connections are numbered 0, 1, ...; of each of them one arc
        has to be used, so that its two clusters are visited one directly after the other. Connections that share
        clusters form chains
    closed : the path returns from its last node to its first, and the cost of that arc counts. Everything else, such as
        precedence and what the first and the last node cost, is about the order as it is listed

    Raises
    ------
    InputError : shapes that do not fit, NaN, precedence with a cycle (which is named), or enforced connections that
        contradict each other or the precedence
    """

    cluster: IntArray
    costs: ArcCosts
    start_costs: FloatArray = field(default_factory=lambda: np.zeros(0))
    end_costs: FloatArray = field(default_factory=lambda: np.zeros(0))
    node_costs: FloatArray = field(default_factory=lambda: np.zeros(0))
    precedence: IntArray = field(default_factory=lambda: np.zeros((0, 2), dtype=np.int64))
    enforced: IntArray = field(default_factory=lambda: np.zeros((0, 3), dtype=np.int64))
    closed: bool = False

    def __post_init__(self) -> None:
        cluster = frozen_ints(self.cluster, "cluster", (None,))
        count = len(cluster)
        if count and (cluster[0] != 0 or not np.isin(np.diff(cluster), (0, 1)).all()):
            raise InputError("cluster must number the nodes' clusters 0, 0, 1, ... without a gap, in order")
        if len(self.costs) != count:
            raise InputError(f"there are arc costs for {len(self.costs)} nodes; expected {count}")
        object.__setattr__(self, "cluster", cluster)
        for name in ("start_costs", "end_costs", "node_costs"):
            given = getattr(self, name)
            values = frozen_floats(
                given if len(given) else np.zeros(count), name, (count,), finite=name == "node_costs"
            )
            if np.isneginf(values).any():
                place = int(np.flatnonzero(np.isneginf(values))[0])
                raise InputError(f"{name}[{place}] is minus infinity; expected a number or +infinity")
            object.__setattr__(self, name, values)
        pairs = frozen_ints(self.precedence, "precedence", (None, 2))
        object.__setattr__(self, "precedence", pairs)
        if len(pairs) and not ((pairs >= 0) & (pairs < self.clusters)).all():
            raise InputError(f"precedence names cluster {int(pairs.max())}; expected 0..{self.clusters - 1}")
        cycle = precedence_cycle(self.clusters, pairs)
        if cycle:
            raise InputError(f"precedence has a cycle: {' before '.join(map(str, cycle))}")
        enforced = frozen_ints(self.enforced, "enforced", (None, 3))
        object.__setattr__(self, "enforced", enforced)
        if len(enforced):
            self._check_chains()

    def _check_chains(self) -> None:
        """Nothing may have to be visited in the middle of a chain of enforced connections."""
        chain_of = np.arange(self.clusters)
        for chain in chains(self.cluster, self.enforced, self.precedence):
            chain_of[chain] = min(chain)
        outside = chain_of[self.precedence]
        cycle = precedence_cycle(self.clusters, outside[outside[:, 0] != outside[:, 1]])
        if cycle:
            raise InputError(
                f"enforced connections contradict precedence: cluster {cycle[0]} and those tied to it would have to be "
                f"visited both before and after cluster {cycle[1]}"
            )

    @property
    def nodes(self) -> int:
        """Number of nodes."""
        return len(self.cluster)

    @property
    def clusters(self) -> int:
        """Number of clusters."""
        return int(self.cluster[-1]) + 1 if len(self.cluster) else 0

    @property
    def first_node(self) -> IntArray:
        """(m + 1,) the nodes of cluster c are first_node[c] .. first_node[c + 1] - 1."""
        return np.searchsorted(self.cluster, np.arange(self.clusters + 1))

    def cost_of(self, nodes: Any) -> float:
        """Cost of visiting these nodes in this order (0 for none): start, arcs, node costs, end, the way back."""
        order = np.asarray(nodes, dtype=np.int64)
        if len(order) == 0:
            return 0.0
        tails, heads = order[:-1], order[1:]
        if self.closed and len(order) > 1:
            tails, heads = order, np.roll(order, -1)
        arcs = self.costs.pairs(tails, heads).sum()
        return float(self.start_costs[order[0]] + arcs + self.end_costs[order[-1]] + self.node_costs[order].sum())

    def faults(self, nodes: Any) -> list[str]:
        """What is wrong with visiting these nodes in this order; empty when it is a solution."""
        order = np.asarray(nodes, dtype=np.int64)
        if order.ndim != 1 or not ((order >= 0) & (order < self.nodes)).all():
            return [f"nodes must be 0..{self.nodes - 1}"]
        visited = self.cluster[order]
        faults = []
        counts = np.bincount(visited, minlength=self.clusters)
        if (counts != 1).any():
            cluster = int(np.flatnonzero(counts != 1)[0])
            faults.append(f"cluster {cluster} is visited {int(counts[cluster])} times")
        else:
            position = np.empty(self.clusters, dtype=np.int64)
            position[visited] = np.arange(len(visited))
            broken = position[self.precedence[:, 0]] >= position[self.precedence[:, 1]]
            faults += [f"cluster {a} must come before cluster {b}" for a, b in self.precedence[broken].tolist()]
            faults += [f"enforced connection {k} is not driven" for k in missing_connections(self.enforced, order)]
            if not math.isfinite(self.cost_of(order)):
                faults.append("the cost is infinite: an arc is used that does not exist")
        return faults


def precedence_cycle(count: int, pairs: IntArray) -> list[int]:
    """A cycle in the relation as [a, b, ..., a], or an empty list."""
    after: list[list[int]] = [[] for _ in range(count)]
    for a, b in pairs.tolist():
        after[a].append(b)
    state = [0] * count  # 0 unseen, 1 on the current walk, 2 done
    for root in range(count):
        if state[root]:
            continue
        walk, choices = [root], [iter(after[root])]
        state[root] = 1
        while walk:
            step = next(choices[-1], None)
            if step is None:
                state[walk.pop()] = 2
                choices.pop()
            elif state[step] == 1:
                return [*walk[walk.index(step) :], step]
            elif state[step] == 0:
                state[step] = 1
                walk.append(step)
                choices.append(iter(after[step]))
    return []


class Status(StrEnum):
    """What is known about a solution; why the solver stopped is kept apart (`StopReason`)."""

    OPTIMAL = "optimal"
    """Proved: the bound equals the cost."""
    FEASIBLE = "feasible"
    INFEASIBLE = "infeasible"
    """Proved: there is no solution."""
    UNKNOWN = "unknown"
    """Nothing was found and nothing proved."""


@dataclass(frozen=True)
class TracePoint:
    """Incumbent and bound at a moment of a run."""

    seconds: float
    cost: float
    bound: float


@dataclass(frozen=True, eq=False)
class Ordering:
    """An answer to an ordering problem.

    Parameters
    ----------
    nodes : (m,) chosen node of each cluster, in the order of visiting; empty when none was found
    cost : of that order; infinite when none was found
    bound : no order costs less; minus infinity when nothing is proved
    status, stopped : what is known, and why the solver stopped
    solver, seed : who found it
    seconds, iterations : work spent
    message : what people should know, e.g. why `auto` chose this solver
    trace : incumbent and bound over time
    unit : of cost and bound: "m" or "s"
    """

    nodes: IntArray
    cost: float
    bound: float
    status: Status
    stopped: StopReason
    solver: str
    seed: int = 0
    seconds: float = 0.0
    iterations: int = 0
    message: str = ""
    trace: tuple[TracePoint, ...] = ()
    unit: str = "m"

    def __post_init__(self) -> None:
        object.__setattr__(self, "nodes", frozen_ints(self.nodes, "ordering nodes", (None,)))
        if math.isnan(self.cost) or math.isnan(self.bound):
            raise InputError("cost or bound of an ordering is NaN")
        if self.status is Status.OPTIMAL and self.gap > 1e-6:
            raise InputError(f"an ordering with a gap of {self.gap:.3g} cannot be called optimal")

    @property
    def gap(self) -> float:
        """(cost - bound) / cost: 0 when proved, 1 or more when the bound says nothing, infinite without a bound."""
        if self.cost == self.bound:
            return 0.0
        if not (math.isfinite(self.cost) and math.isfinite(self.bound)):
            return math.inf
        # one part in a million of a millimetre counts as equal: coordinates are not known better
        return max(0.0, self.cost - self.bound) / max(abs(self.cost), 1e-9)


class Solver(Protocol):
    """What solves ordering problems. Solvers live in a plain registry, `optplan.ordering.SOLVERS`."""

    @property
    def name(self) -> str:
        """What the user types."""

    @property
    def summary(self) -> str:
        """One line for people."""

    @property
    def proves(self) -> bool:
        """Whether it gives a bound, and calls a solution optimal when that is proved."""

    @property
    def precedence(self) -> bool:
        """Whether it knows precedence; if not, its order may break it, and then it has no answer."""

    @property
    def improves(self) -> bool:
        """Whether it goes on improving as long as it may."""

    def refusal(self, problem: OrderingProblem) -> str | None:
        """Why this problem is out of reach, or None when it is welcome."""

    def solve(
        self,
        problem: OrderingProblem,
        stop: StopRule,
        seed: int,
        start: IntArray | None = None,
        progress: ProgressCallback | None = None,
    ) -> Ordering:
        """Solve it, perhaps from a known solution `start` (m,) of nodes."""
