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
CANDIDATES = 12
"""Clusters, and edges, that look most undecided: among them is the branch."""
SHORT, LONG = 10, 80
"""Dual simplex steps of a look at a branch: at those that have not been looked at often, and at the best."""
KEPT = 4
"""How many get a long look."""
TRUSTED = 3
"""After so many short looks at a cluster or an edge their mean is taken instead."""
ROUNDS = 12
WORTH = 0.02
"""Cutting goes on at a node while a round closes this part of its gap."""
AGE = 8


class Node(NamedTuple):
    """An open node: its bound, a number that breaks ties, edges (., 2) that it may use and that it must."""

    bound: float
    number: int
    allowed: IntArray
    present: IntArray


class Branch(NamedTuple):
    """Two children: each without some points; the first without an edge (0 or 1, 2), the second with it."""

    points: tuple[IntArray, IntArray]
    edge: IntArray


Looks = dict[tuple[int, int], list[float]]
"""Scores of short looks, by what was looked at."""
NONE = np.zeros(0, dtype=np.int64)
NO_EDGE = np.zeros((0, 2), dtype=np.int64)


def branch_and_cut(root: Root, solution: Solution, found: Callable[[IntArray], None]) -> bool:
    """Prove the optimum, or raise the bound; whether it is proved.

    root : after `tighten`, which returned `solution`; found : told the edges (m, 2) of each better tour
    """
    pool = useful_edges(root, solution)
    if pool is None:
        return False
    form = root.programme.form
    heap = [Node(root.bound, 0, pool, NO_EDGE)]
    number = 0
    looks: Looks = {}
    while heap:
        root.raise_bound(min(heap[0].bound, root.cutoff))
        if root.closed():
            return True
        node, branch = _explore(root, heapq.heappop(heap), looks, found)
        if root.remaining <= 0:
            return False
        if branch is None:
            continue
        for side, present in ((0, node.present), (1, np.concatenate([node.present, branch.edge]))):
            number += 1
            gone = np.isin(node.allowed, _with_mates(form, branch.points[side])).any(axis=1)
            if side == 0:
                gone |= _among(form, node.allowed, branch.edge)
            heapq.heappush(heap, Node(node.bound, number, node.allowed[~gone], present))
    root.raise_bound(root.cutoff)
    return True


def _with_mates(form: Undirected, points: IntArray) -> IntArray:
    return np.union1d(points, form.mate[points])


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


def _explore(root: Root, node: Node, looks: Looks, found: Callable[[IntArray], None]) -> tuple[Node, Branch | None]:
    """Cut and price at a node, then choose a branch; None when nothing better is below it. The node, with its bound.

    Edges whose reduced cost exceeds the node's gap are in no better tour below it, and are taken away.
    """
    programme, form = root.programme, root.programme.form
    rounds = 0
    while root.remaining > 0:
        _restrict(programme, node)
        solution = programme.programme.solve(root.remaining)
        if solution == "TimeLimit":
            break
        if isinstance(solution, str):
            if solution != "Infeasible":
                raise RuntimeError(f"HiGHS ends a linear programme with status {solution}")
            # perhaps for want of columns
            if programme.add_edges(node.allowed):
                continue
            break
        dual = programme.dual(solution)
        reduced = programme.reduced_costs(dual, node.allowed, exact_below=max(0.0, root.cutoff - node.bound))
        if programme.add_edges(node.allowed[reduced < -ROUNDING]):
            continue
        bound = _node_bound(programme, dual, reduced, node.present)
        if max(bound, node.bound) >= root.cutoff:
            break
        rise = bound - node.bound
        useful = bound + reduced < root.cutoff
        useful |= _among(form, node.allowed, node.present)
        node = Node(max(bound, node.bound), node.number, node.allowed[useful], node.present)
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
                break
        rounds += 1
        pays = whole or (rounds <= ROUNDS and rise >= WORTH * (root.cost - node.bound))
        if not (sets or handles) or not pays:
            return node, _choose(root, solution, looks)
        programme.purge(AGE)
        programme.add_cuts(sets)
        programme.add_cuts(handles, teeth)
    return node, None


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


def _restrict(programme: CutProgramme, node: Node) -> None:
    """Give the columns the bounds of a node."""
    form, edges = programme.form, programme.edges
    lower = _among(form, edges, node.present).astype(np.float64)
    upper = np.where(_among(form, edges, node.allowed), math.inf, 0.0)
    # a contradiction stays one: the cluster's two links or a cut cannot hold
    upper = np.maximum(upper, lower)
    now = programme.programme
    changed = np.flatnonzero((lower != now.lower) | (upper != now.upper))
    now.set_bounds(changed, lower[changed], upper[changed])


def _choose(root: Root, solution: Solution, looks: Looks) -> Branch | None:
    """The branch that raises the objective most in both children, as far as some dual simplex steps tell."""
    form, edges = root.programme.form, root.programme.edges
    branches = _splits(form, edges, solution.primal) + _edges(edges, solution.primal)
    if len(branches) > 1:
        scores = []
        for branch in branches:
            seen = looks.setdefault(_subject(form, branch), [])
            if len(seen) < TRUSTED:
                seen.append(_score(root, solution, branch, SHORT))
            scores.append(sum(seen) / len(seen))
        order = np.argsort(scores, kind="stable")[::-1]
        branches = [branches[k] for k in order[:KEPT].tolist()]
    if len(branches) > 1:
        branches = [max(branches, key=lambda branch: _score(root, solution, branch, LONG))]
    return branches[0] if branches else None


def _subject(form: Undirected, branch: Branch) -> tuple[int, int]:
    """What is branched on: a cluster (and -1), or the two ends of an edge."""
    if len(branch.edge):
        return int(branch.edge[0, 0]), int(branch.edge[0, 1])
    return int(form.cluster[branch.points[0][0]]), -1


def _score(root: Root, solution: Solution, branch: Branch, steps: int) -> float:
    """Product of the rises of both children after so many steps, none counted beyond the gap."""
    form, edges, now = root.programme.form, root.programme.edges, root.programme.programme
    gap = root.cost - solution.objective
    basis, score = now.basis(), 1.0
    for side in (0, 1):
        gone = np.isin(edges, _with_mates(form, branch.points[side])).any(axis=1)
        edge = _among(form, edges, branch.edge)
        columns = np.flatnonzero(gone | edge)
        kept = now.lower[columns].copy(), now.upper[columns].copy()
        lower = np.where(edge[columns] & (side == 1), 1.0, kept[0])
        now.set_bounds(columns, lower, lower if side == 0 else np.where(edge[columns], kept[1], lower))
        rise = now.probe(steps) - solution.objective
        now.set_bounds(columns, *kept)
        now.set_basis(basis)
        score *= min(max(rise, 1e-6 * gap), gap) if math.isfinite(gap) else max(rise, 1e-9)
    return score


def _splits(form: Undirected, edges: IntArray, primal: FloatArray) -> list[Branch]:
    """For clusters without a clear choice, their points in two parts chosen about half each."""
    first = np.minimum(np.arange(form.points), form.mate)
    chosen = 0.5 * np.bincount(first[edges].ravel(), np.repeat(primal, 2), form.points)
    starts = np.searchsorted(form.cluster, np.arange(form.clusters + 1))
    options = []
    for c in np.unique(form.cluster[(chosen > FRACTION) & (chosen < 1 - FRACTION)]).tolist():
        points = np.arange(starts[c], starts[c + 1])
        points = points[first[points] == points]
        total = np.cumsum(chosen[points])[:-1]
        k = int(np.abs(total - 0.5).argmin())
        options.append((abs(total[k] - 0.5), k, Branch((points[: k + 1], points[k + 1 :]), NO_EDGE)))
    return [branch for *_, branch in sorted(options, key=lambda option: option[:2])[:CANDIDATES]]


def _edges(edges: IntArray, primal: FloatArray) -> list[Branch]:
    """Edges that are neither used nor not."""
    away = np.abs(primal - 0.5)
    places = np.argsort(away, kind="stable")[:CANDIDATES]
    return [Branch((NONE, NONE), edges[k : k + 1]) for k in places.tolist() if away[k] < 0.5 - FRACTION]
