"""`2opt`: nearest neighbours, then reversals of pieces until none makes the path shorter."""

from __future__ import annotations

import numpy as np

from optplan.domain.arrays import FloatArray, IntArray
from optplan.domain.ordering import OrderingProblem
from optplan.domain.stop import StopReason
from optplan.ordering.arrays import partners
from optplan.ordering.baselines.honest import offer_as_published
from optplan.ordering.baselines.nearest import nearest_path
from optplan.ordering.method import Run

ROUNDING = 1e-10
"""A smaller gain, relatively, is none: else the descent might never end."""


def two_opt(run: Run) -> StopReason:
    """Nearest neighbour and 2-opt: for each first place the best piece to reverse, until no reversal gains anything.

    After Croes, "A method for solving traveling-salesman problems" (1958). A reversed piece drives every stroke by its
    reversed traversal where there is one. It begins with the given solution if there is one, knows nothing of
    precedence, and one iteration is one reversal.
    """
    problem = run.problem
    nodes = nearest_path(run, problem.precedence[:0]) if run.start is None else run.start
    if nodes is None:
        return StopReason.CANCELLED
    offer_as_published(run, nodes)
    reversals = Reversals(problem, nodes)
    stop = _descend(run, reversals)
    offer_as_published(run, reversals.nodes)
    return stop or run.stop() or StopReason.FINISHED


def _descend(run: Run, reversals: Reversals) -> StopReason | None:
    """Sweep over the path until a sweep finds nothing; why it was stopped earlier, or None."""
    improved = True
    while improved:
        improved = False
        for low in range(reversals.fixed, len(reversals.nodes)):
            if stop := run.stop():
                return stop
            if reversals.improve(low):
                improved = True
                run.iterations += 1
    return None


class Reversals:
    """A path, and what it costs to reverse each of its pieces, by sums over the places of the path.

    Infinite costs are replaced by a large penalty, so that the descent finds a way out of an impossible path.

    Parameters
    ----------
    problem : gives the costs, which may be asymmetric
    nodes : (m,) the path
    """

    def __init__(self, problem: OrderingProblem, nodes: IntArray) -> None:
        self.problem = problem
        self.nodes = np.array(nodes, dtype=np.int64)
        self.fixed = int(problem.closed)  # a closed path is listed from the same node on
        self._partners = partners(problem)
        known = [problem.start_costs, problem.end_costs, problem.node_costs]
        known += [problem.costs.pairs(np.full(problem.nodes, i), np.arange(problem.nodes)) for i in self.nodes.tolist()]
        largest = max(float(np.abs(values[np.isfinite(values)]).max(initial=0.0)) for values in known)
        self._penalty = (largest + 1.0) * 4.0 * (len(nodes) + 1)
        self._least = ROUNDING * largest
        self._sum_up()

    def improve(self, low: int) -> bool:
        """Reverse the piece from `low` on whose reversal gains most; False when none gains anything."""
        gains = self._gains(low)
        best = int(gains.argmax())
        if not gains[best] > self._least:
            return False
        piece = slice(low, low + best + 1)
        self.nodes[piece] = self._turned[piece][::-1]
        self._sum_up()
        return True

    def _gains(self, low: int) -> FloatArray:
        """(m - low,) what is gained by reversing the piece low..high, for every high."""
        nodes, turned, end = self.nodes, self._turned, len(self.nodes)
        highs = np.arange(low, end)
        inside = (self._there[highs] - self._there[low]) - (self._back[highs] - self._back[low])
        own = self._own[highs + 1] - self._own[low]
        into = self._enter(low, nodes[low : low + 1]) - self._enter(low, turned[highs])
        out = self._leave(nodes[highs], highs) - self._leave(np.full(end - low, turned[low]), highs)
        gains: FloatArray = inside + own + into + out
        return gains

    def _enter(self, place: int, heads: IntArray) -> FloatArray:
        """Cost of coming to `heads` at that place."""
        if place == 0:
            return self._finite(self.problem.start_costs[heads])
        return self._arcs(np.full(len(heads), self.nodes[place - 1]), heads)

    def _leave(self, tails: IntArray, places: IntArray) -> FloatArray:
        """Cost of going on from `tails` at those places."""
        last = places == len(self.nodes) - 1
        following = self.nodes[np.where(last, 0, places + 1)]
        onward = self._arcs(tails, following)
        ends = self._finite(self.problem.end_costs[tails]) + (onward if self.problem.closed else 0.0)
        return np.where(last, ends, onward)

    def _sum_up(self) -> None:
        """Sums along the path: arcs there, arcs back on the reversed traversals, own costs saved by these."""
        nodes = self.nodes
        turned = self._turned = self._partners[nodes]
        own = self.problem.node_costs
        self._there = np.concatenate([[0.0], np.cumsum(self._arcs(nodes[:-1], nodes[1:]))])
        self._back = np.concatenate([[0.0], np.cumsum(self._arcs(turned[1:], turned[:-1]))])
        self._own = np.concatenate([[0.0], np.cumsum(own[nodes] - own[turned])])

    def _arcs(self, tails: IntArray, heads: IntArray) -> FloatArray:
        return self._finite(self.problem.costs.pairs(tails, heads))

    def _finite(self, costs: FloatArray) -> FloatArray:
        return np.where(np.isinf(costs), self._penalty, costs)
