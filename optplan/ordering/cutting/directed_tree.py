"""Branch and cut for rooted tours: every node of the tree solves, prices and separates as the root does."""

from __future__ import annotations

import heapq
import math
from collections.abc import Callable
from dataclasses import dataclass, field

import numpy as np

from optplan.domain.arrays import FloatArray, IntArray
from optplan.ordering.cutting.directed_branching import INTEGRAL, Brancher, Choice
from optplan.ordering.cutting.directed_graph import Bools
from optplan.ordering.cutting.directed_root import CUTS, CutLoop

ROUNDS = 6
"""Most rounds of cuts at a fractional point of the tree."""
WORTH = 0.02
"""Share of the subproblem's gap that a round has to close to be followed by another."""
AGE = 12
"""Solves after which a slack cut is dropped."""
DIVE = 0.25
"""Share of the gap by which a child's bound may be above the least one for the child to be looked at at once."""
IMPROVE_EVERY = 10
"""Subproblems between two guesses at a better tour."""


@dataclass(order=True)
class Branch:
    """A subproblem still to be looked at: tours for which the choices `used` are true, and those `unused` are not."""

    bound: float
    number: int
    used: tuple[Choice, ...] = field(compare=False, default=())
    unused: tuple[Choice, ...] = field(compare=False, default=())


@dataclass
class Tree:
    """A search by branch and cut, which begins where a cut loop ended ("done").

    Best bound first, but a subproblem's first child is looked at at once unless its bound is much above the least.

    Parameters
    ----------
    loop : the root with its cuts and incumbent
    improve : looks at the last fractional point, and may teach the loop better tours
    least : no tour of the subproblems that ended with one costs less
    """

    loop: CutLoop
    improve: Callable[[], None]
    open: list[Branch] = field(default_factory=list)
    brancher: Brancher = field(init=False)
    least: float = math.inf

    def __post_init__(self) -> None:
        self.brancher = Brancher(self.loop.programme, self.loop.ended)

    def run(self) -> bool:
        """Look at all subproblems; whether none is left. The loop's bound rises as they are closed."""
        loop = self.loop
        branch: Branch | None = Branch(loop.bound, 0)
        while branch or self.open:
            branch = branch or heapq.heappop(self.open)
            loop.prove(min([branch.bound, self.least, *(b.bound for b in self.open[:1])]))
            known = loop.upper
            children = None if loop.ended() else self._work(branch)
            if children is None:
                return False
            loop.nodes += 1
            if loop.nodes % IMPROVE_EVERY == 0:
                self.improve()
            if loop.upper < known:
                self._tighten()
                children = [child for child in children if child.bound < loop.cutoff]
            for child in children[1:]:
                heapq.heappush(self.open, child)
            branch = children[0] if children else None
            if branch and branch.bound > loop.bound + DIVE * (loop.cutoff - loop.bound):
                heapq.heappush(self.open, branch)
                branch = None
        # there is nothing below the cut-off, and whole costs leave no room above it
        loop.prove(min(self.least, loop.upper if loop.grain else loop.cutoff))
        return True

    def _tighten(self) -> None:
        """A better incumbent: fewer arcs can be in a better one, and fewer subproblems."""
        loop = self.loop
        loop.programme.out |= loop.base + loop.reduced >= loop.cutoff
        loop.shrink()
        self.open = [b for b in self.open if b.bound < loop.cutoff]
        heapq.heapify(self.open)

    def _work(self, branch: Branch) -> list[Branch] | None:
        """The children of a subproblem, the one to go on with first; None when interrupted."""
        loop = self.loop
        lp = loop.programme
        out = self._out(branch)
        bound, rounds = branch.bound, 0
        while not loop.ended():
            self._fix(branch, out)
            status = lp.solve(loop.ended)
            if status == "Infeasible":
                if self._add_all(out):
                    continue
                return []
            if status != "Optimal":
                return None
            before = bound if rounds else -math.inf
            here, reduced = lp.priced(out)
            bound = max(bound, here)
            if bound >= loop.cutoff:
                return []
            out |= here + reduced >= loop.cutoff
            x, tails, heads = lp.primal, lp.tails, lp.heads
            added = loop.add_priced(reduced, out, len(reduced) ** 2)
            whole = not ((x > INTEGRAL) & (x < 1.0 - INTEGRAL)).any()
            gap = loop.cutoff - bound if math.isfinite(loop.cutoff) else abs(bound)
            cuts = 0
            if whole or (rounds < ROUNDS and bound - before > WORTH * gap):
                marks = loop.separator.violated(tails, heads, x, CUTS, deep=rounds == 0 or whole)
                cuts = len(marks)
                if cuts:
                    lp.purge(AGE)
                    lp.add_cuts(marks)
            if not added and not cuts and not loop.ended():
                if not whole:
                    return self._split(branch, bound)
                loop.learn(self._tour_of(x))
                self.least = min(self.least, bound)
                return []
            rounds += 1
        return None

    def _out(self, branch: Branch) -> Bools:
        """(n, n) arcs that the subproblem does not have."""
        out, tour = self.loop.programme.out.copy(), self.loop.tour
        count = np.arange(tour.nodes)
        tails, heads = np.meshgrid(count, count, indexing="ij")
        for choices, used in ((branch.used, True), (branch.unused, False)):
            for choice in choices:
                out |= choice.excluded(tour, tails, heads, used)
        return out

    def _fix(self, branch: Branch, out: Bools) -> None:
        """Give the columns the bounds of the subproblem."""
        lp = self.loop.programme
        upper = np.where(out[lp.tails, lp.heads], 0.0, 1.0)
        now = lp.programme
        changed = np.flatnonzero(now.upper != upper)
        now.set_bounds(changed, np.zeros(len(changed)), upper[changed])

    def _add_all(self, out: Bools) -> int:
        """Give all arcs of the subproblem columns; how many are new."""
        lp = self.loop.programme
        lacking = ~out
        lacking[lp.tails, lp.heads] = False
        tails, heads = np.nonzero(lacking)
        lp.add_arcs(tails, heads)
        return len(tails)

    def _tour_of(self, x: FloatArray) -> IntArray:
        lp, tour = self.loop.programme, self.loop.tour
        used = np.flatnonzero(x > 0.5)
        following = dict(zip(lp.tails[used].tolist(), lp.heads[used].tolist(), strict=True))
        nodes = [next(i for i in following if tour.cluster[i] == tour.root)]
        while (after := following[nodes[-1]]) != nodes[0]:
            nodes.append(after)
        return np.array(nodes, dtype=np.int64)

    def _split(self, branch: Branch, bound: float) -> list[Branch]:
        """With a choice, and without it."""
        choice = self.brancher.choose()
        number = 2 * self.loop.nodes
        return [
            Branch(bound, number + 1, (*branch.used, choice), branch.unused),
            Branch(bound, number + 2, branch.used, (*branch.unused, choice)),
        ]
