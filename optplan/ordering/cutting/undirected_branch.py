"""Branch and cut below the root: on the points that a cluster may choose, and on edges."""

from __future__ import annotations

import heapq
import math
from collections.abc import Callable
from typing import NamedTuple

import numpy as np
import numpy.typing as npt

from optplan.domain.arrays import FloatArray, IntArray
from optplan.ordering.cutting.lp import Solution
from optplan.ordering.cutting.undirected import Undirected
from optplan.ordering.cutting.undirected_cuts import violated_blossoms, violated_sets
from optplan.ordering.cutting.undirected_lp import SAFETY, CutProgramme, Dual
from optplan.ordering.cutting.undirected_root import ROUNDING, Root

Bools = npt.NDArray[np.bool_]
MOST_EDGES = 500_000
"""With more edges that a better tour may use there is no branching."""
SHARE = 0.3
"""Edges of a reduced cost below this part of the gap become columns before branching."""
FRACTION = 0.02
"""Values closer to an integer are not branched on."""
CANDIDATES = 8
PROBE = 40
"""Dual simplex steps of a look at a branch."""
ROUNDS = 12
WORTH = 0.02
"""Cutting goes on at a node while a round closes this part of its gap."""
AGE = 8


class Node(NamedTuple):
    """An open node: its bound, a number that breaks ties, points not chosen, edges not used and used (by ends)."""

    bound: float
    number: int
    points: IntArray
    absent: IntArray
    present: IntArray


class Branch(NamedTuple):
    """Two children: each without some points, without some edges (k, 2), and with some."""

    points: tuple[IntArray, IntArray]
    edge: IntArray


NONE = np.zeros(0, dtype=np.int64)
NO_EDGE = np.zeros((0, 2), dtype=np.int64)


def branch_and_cut(root: Root, solution: Solution, found: Callable[[IntArray], None]) -> bool:
    """Prove the optimum, or raise the bound; whether it is proved.

    root : after `tighten`, which returned `solution`; found : told the edges (m, 2) of each better tour
    """
    pool = useful_edges(root, solution)
    if pool is None:
        return False
    heap = [Node(root.bound, 0, NONE, NO_EDGE, NO_EDGE)]
    number = 0
    while heap:
        root.raise_bound(min(heap[0].bound, root.cutoff))
        if root.closed():
            return True
        node = heapq.heappop(heap)
        branch, bound = _explore(root, node, pool, found)
        if root.remaining <= 0:
            return False
        if branch is None:
            continue
        for side, absent, present in ((0, branch.edge, NO_EDGE), (1, NO_EDGE, branch.edge)):
            number += 1
            child = Node(
                bound,
                number,
                np.union1d(node.points, branch.points[side]),
                np.concatenate([node.absent, absent]),
                np.concatenate([node.present, present]),
            )
            heapq.heappush(heap, child)
    root.raise_bound(root.cutoff)
    return True


def useful_edges(root: Root, solution: Solution) -> IntArray | None:
    """(k, 2) the edges that a tour better than the best known may use; None when they are too many.

    Every tour costs at least bound + sum of the reduced costs of its edges, all of which are 0 or more (but for
    rounding, which the bound has taken off): an edge of more than the gap is in no better tour, and a point is in none
    whose two cheapest links together are.
    """
    programme, form = root.programme, root.programme.form
    gap = root.cost - root.bound
    priced = programme.price(solution, gap, MOST_EDGES)
    if len(priced.edges) >= MOST_EDGES:
        return None
    ends, costs = priced.edges.ravel(), np.repeat(np.maximum(priced.reduced, 0.0), 2)
    order = np.lexsort((costs, ends))
    first = np.searchsorted(ends[order], np.arange(form.points + 1))
    ranked = np.append(costs[order], [math.inf, math.inf])
    links = np.diff(first)
    one = np.where(links > 0, ranked[first[:-1]], math.inf)
    two = np.where(links > 1, ranked[first[:-1] + 1], math.inf)
    single = form.mate == np.arange(form.points)
    useless = np.where(single, one + two, one + one[form.mate]) > gap
    useful = ~useless[priced.edges].any(axis=1)
    near = useful & (priced.reduced <= SHARE * gap)
    programme.add_edges(priced.edges[near])
    return priced.edges[useful]


def _explore(root: Root, node: Node, pool: IntArray, found: Callable[[IntArray], None]) -> tuple[Branch | None, float]:
    """Cut and price at a node, then choose a branch; None when nothing better is below it. Also the node's bound."""
    programme, form = root.programme, root.programme.form
    allowed = _allowed(form, node, pool)
    _restrict(programme, allowed, node.present)
    bound, rounds = node.bound, 0
    while root.remaining > 0:
        solution = programme.programme.solve(root.remaining)
        if solution == "TimeLimit":
            break
        if isinstance(solution, str):
            if solution != "Infeasible":
                raise RuntimeError(f"HiGHS ends a linear programme with status {solution}")
            # perhaps for want of columns
            if programme.add_edges(allowed):
                continue
            return None, bound
        dual = programme.dual(solution)
        reduced = programme.reduced_costs(dual, allowed, exact_below=0.0)
        cheap = reduced < -ROUNDING
        if programme.add_edges(allowed[cheap]):
            continue
        before, bound = bound, max(bound, _node_bound(programme, dual, reduced, node.present))
        if bound >= root.cutoff:
            return None, bound
        sets = violated_sets(form, programme.edges, solution.primal)
        handles, teeth = violated_blossoms(form, programme.edges, solution.primal)
        whole = (np.abs(solution.primal - np.round(solution.primal)) < 1e-6).all()
        if not sets and whole:
            edges = programme.edges[solution.primal > 0.5]
            if form.nodes_of(edges) is not None:
                cost = float(form.edge_costs(edges[:, 0], edges[:, 1]).sum())
                if cost < root.cost:
                    root.tour, root.cost = edges, cost
                    found(edges)
                return None, bound
        rounds += 1
        pays = whole or (rounds <= ROUNDS and bound - before >= WORTH * (root.cost - bound))
        if not (sets or handles) or not pays:
            return _choose(root, solution), bound
        programme.purge(AGE)
        programme.add_cuts(sets)
        programme.add_cuts(handles, teeth)
    return None, bound


def _allowed(form: Undirected, node: Node, pool: IntArray) -> IntArray:
    """The useful edges (k, 2) that a node may use."""
    gone = np.zeros(form.points, dtype=np.bool_)
    gone[node.points] = True
    gone |= gone[form.mate]
    edges = pool[~gone[pool].any(axis=1)]
    return edges[~_among(form, edges, node.absent)]


def _among(form: Undirected, edges: IntArray, others: IntArray) -> Bools:
    """(k,) which edges are among others; both (., 2) with the smaller end first."""
    key = form.points
    return np.isin(edges[:, 0] * key + edges[:, 1], others[:, 0] * key + others[:, 1])


def _node_bound(programme: CutProgramme, dual: Dual, reduced: FloatArray, present: IntArray) -> float:
    """What a tour of a node's edges costs at least: none is used twice, and some are used for certain."""
    missing = float(np.minimum(reduced, 0.0).sum())
    held = programme.reduced_costs(dual, present)
    # an edge held has been counted where its reduced cost is negative
    forced = float(np.maximum(held, 0.0).sum())
    return dual.value + missing + forced - SAFETY * (dual.size - missing + forced)


def _restrict(programme: CutProgramme, allowed: IntArray, present: IntArray) -> None:
    """Give the columns the bounds of a node."""
    form, edges = programme.form, programme.edges
    lower = _among(form, edges, present).astype(np.float64)
    upper = np.where(_among(form, edges, allowed), math.inf, 0.0)
    # a contradiction stays one: the cluster's two links or a cut cannot hold
    upper = np.maximum(upper, lower)
    now = programme.programme
    changed = np.flatnonzero((lower != now.lower) | (upper != now.upper))
    now.set_bounds(changed, lower[changed], upper[changed])


def _choose(root: Root, solution: Solution) -> Branch | None:
    """The branch whose worse child rises most, of those that look most undecided."""
    programme, form = root.programme, root.programme.form
    options = _splits(form, programme.edges, solution.primal) + _edges(programme, solution.primal)
    options.sort(key=lambda option: option[0])
    best: tuple[float, Branch] | None = None
    now = programme.programme
    basis = now.basis()
    for _, branch in options[:CANDIDATES]:
        rises = []
        for side in (0, 1):
            touched = np.zeros(form.points, dtype=np.bool_)
            touched[branch.points[side]] = True
            zero = touched[programme.edges].any(axis=1)
            column = programme.columns_of(branch.edge) > 0 if len(branch.edge) else np.zeros_like(zero)
            zero |= column & (side == 0)
            one = column & (side == 1)
            places = np.flatnonzero(zero | one)
            kept = now.lower[places].copy(), now.upper[places].copy()
            low = np.where(one[places], 1.0, kept[0])
            high = np.where(zero[places], low, kept[1])
            now.set_bounds(places, low, high)
            value = now.probe(PROBE)
            now.set_bounds(places, *kept)
            now.set_basis(basis)
            rises.append(max(value - solution.objective, 1e-6 * abs(root.cost - solution.objective)))
        rises = [min(rise, root.cost - solution.objective) for rise in rises]
        score = rises[0] * rises[1]
        if best is None or score > best[0]:
            best = score, branch
        if root.remaining <= 0:
            break
    return None if best is None else best[1]


def _splits(form: Undirected, edges: IntArray, primal: FloatArray) -> list[tuple[float, Branch]]:
    """For every cluster without a clear choice, its points in two parts chosen about half each."""
    weight = np.bincount(edges.ravel(), np.repeat(primal, 2), form.points)
    representative = np.minimum(np.arange(form.points), form.mate)
    chosen = 0.5 * np.bincount(representative, weight, form.points)
    options = []
    starts = np.searchsorted(form.cluster, np.arange(form.clusters + 1))
    fractional = np.unique(form.cluster[(chosen > FRACTION) & (chosen < 1 - FRACTION)])
    for c in fractional.tolist():
        points = np.arange(starts[c], starts[c + 1])
        points = points[representative[points] == points]
        total = np.cumsum(chosen[points])
        k = int(np.abs(total - 0.5).argmin()) + 1
        if k < len(points):
            options.append((abs(total[k - 1] - 0.5), Branch((points[:k], points[k:]), NO_EDGE)))
    return options


def _edges(programme: CutProgramme, primal: FloatArray) -> list[tuple[float, Branch]]:
    """Edges that are neither used nor not."""
    away = np.abs(primal - 0.5)
    places = np.argsort(away, kind="stable")[:CANDIDATES]
    return [
        (float(away[k]), Branch((NONE, NONE), programme.edges[k : k + 1]))
        for k in places.tolist()
        if away[k] < 0.5 - FRACTION
    ]
