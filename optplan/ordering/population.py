"""Several annealings, and then merging what they found.

Where nodes are chosen too, or under precedence, a slow annealing ends in no better a path than a faster one: which of
some deep valleys it falls into is decided early. So a few paths are annealed, then two of them at a time are merged:
the better one is annealed again, mildly, with only those neighbours that clusters have in one of the two, among which
it mostly finds the best of both. The idea is that of tour merging (W. Cook and P. Seymour, Tour merging via
branch-decomposition, INFORMS J. Computing 15 (2003)), with annealing instead of a dynamic programme.
"""

from __future__ import annotations

import math
from typing import TYPE_CHECKING

import numpy as np

from optplan.domain.arrays import IntArray
from optplan.domain.stop import StopReason
from optplan.ordering.annealing import HOT, anneal
from optplan.ordering.arrays import fixed
from optplan.ordering.method import OPTIMAL_GAP, Run

if TYPE_CHECKING:
    from optplan.ordering._kernels.tour import Graph

SIZE = 6
"""Paths kept."""
FIRST, MERGE = 0.08, 0.04
"""Shares of the limits for each path from the beginning, and for merging two."""
PILOT = 0.28
"""Share of the limits for each beginning where they allow one long annealing only, which goes on from the best."""
ENOUGH = 60
"""Iterations a cluster that an annealing of such a share needs; with fewer, one long annealing is better."""
WARM = 0.5
"""Temperature at the beginning of a merger, mean arcs."""


def anneal_many(run: Run, graph: Graph, anchor: int | None, starts: list[IntArray]) -> StopReason:
    """Anneal from these paths in turn while the limits last: several times, and mergers, where they allow it.

    An iteration limit says whether it does; under a time limit the first annealing tells.
    """
    limit, seconds = run.rule.iterations, run.clock.remaining
    enough = ENOUGH * run.problem.clusters
    if limit is not None and FIRST * limit < enough:
        return _anneal_once(run, graph, anchor, starts)
    random = np.random.default_rng(run.seed)

    def annealed(graph: Graph, path: IntArray, share: float, hot: float = HOT) -> Run:
        part = run.within(
            share * seconds, None if limit is None else min(math.ceil(share * limit), limit - run.iterations)
        )
        part.seed = int(random.integers(2**31))
        anneal(part, graph, anchor, path, hot)
        run.adopt(part)
        return part

    members = [annealed(graph, starts[0], FIRST)]
    if run.iterations < enough and not run.stop():
        return _anneal_once(run, graph, anchor, starts)
    while (stop := run.stop()) is None:
        if len(members) < SIZE:
            members.append(annealed(graph, starts[len(members) % len(starts)], FIRST))
            continue
        pair = random.choice(SIZE, 2, replace=False)
        worse, better = (members[k] for k in sorted(pair, key=lambda k: -members[k].cost))
        near = neighbours(graph, [_circle(member, anchor) for member in (better, worse)])
        merged = annealed(graph._replace(near=near), better.nodes, MERGE, WARM)
        members.remove(worse)
        # what is known already makes room for a new beginning
        if all(abs(merged.cost - member.cost) > OPTIMAL_GAP * abs(member.cost) for member in members):
            members.append(merged)
    return stop


def _anneal_once(run: Run, graph: Graph, anchor: int | None, starts: list[IntArray]) -> StopReason:
    """Anneal from each path shortly when there are several, and then from the better of what that found."""
    path = starts[0]
    for start in starts if len(starts) > 1 else ():
        part = _part(run, PILOT)
        stopped = anneal(part, graph, anchor, start)
        run.adopt(part)
        if stopped in (StopReason.CANCELLED, StopReason.TARGET):
            return stopped
        path = from_anchor(run, run.nodes, anchor) if len(run.nodes) else path
    part = _part(run, 1.0)
    stopped = anneal(part, graph, anchor, path)
    run.adopt(part)
    return stopped


def _part(run: Run, share: float) -> Run:
    """A share of what is left of the limits."""
    limit = run.rule.iterations
    return run.within(
        share * run.clock.remaining, None if limit is None else math.ceil(share * max(0, limit - run.iterations))
    )


def from_anchor(run: Run, path: IntArray, anchor: int | None) -> IntArray:
    """The path, rotated to begin with the anchor."""
    if anchor is None:
        return path
    return np.roll(path, -int(np.flatnonzero(run.problem.cluster[path] == anchor)[0]))


def _circle(run: Run, anchor: int | None) -> IntArray:
    """(m,) the clusters of the best path in the order of the circular graph, the depot included."""
    clusters = run.problem.cluster[run.nodes]
    return clusters if anchor is not None else np.append(clusters, run.problem.clusters)


def neighbours(graph: Graph, circles: list[IntArray]) -> IntArray:
    """(2, m, k) the successors and predecessors of each cluster in any of the circles, then -1."""
    from optplan.ordering._kernels.tour import MIRROR

    pairs = np.concatenate([np.column_stack([circle, np.roll(circle, -1)]) for circle in circles])
    if graph.flags[MIRROR]:
        pairs = np.concatenate([pairs, pairs[:, ::-1]])
    size = len(graph.first) - 1
    sides = []
    for side in (pairs, pairs[:, ::-1]):
        links = np.unique(side, axis=0)
        place = np.arange(len(links)) - np.searchsorted(links[:, 0], links[:, 0])
        near = np.full((size, 2 * len(circles)), -1, dtype=np.int64)
        near[links[:, 0], place] = links[:, 1]
        sides.append(near)
    return fixed(np.array(sides))
