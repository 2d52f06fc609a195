"""Which half of the tours to look at first: a node used or not, or one cluster right after another or not.

Of the candidates that a fractional point leaves undecided, the one that raises both bounds most (Achterberg, Koch and
Martin 2005). When nodes and neighbours of clusters are decided, so are the arcs.
"""

from __future__ import annotations

import math
from collections.abc import Callable
from dataclasses import dataclass, field
from typing import NamedTuple

import numpy as np

from optplan.domain.arrays import FloatArray, IntArray
from optplan.ordering.cutting.directed_graph import Bools, RootedTour
from optplan.ordering.cutting.directed_lp import ArcProgramme

INTEGRAL = 1e-6
"""Values nearer than this to 0 or 1 are whole."""
CANDIDATES = 8
"""Most candidates that are probed before one is chosen."""
ITERATIONS = 20
"""Dual simplex iterations of a probe."""
RELIABLE = 4
"""Probes after which a candidate's mean is trusted."""


class Choice(NamedTuple):
    """Whether a node is used (second -1), or whether the second cluster comes right after the first."""

    first: int
    second: int = -1

    def excluded(self, tour: RootedTour, tails: IntArray, heads: IntArray, used: bool) -> Bools:
        """(k,) which arcs no tour has that decides so."""
        out: Bools
        if self.second >= 0:
            leaves, enters = tour.cluster[tails] == self.first, tour.cluster[heads] == self.second
            out = leaves ^ enters if used else leaves & enters
        elif used:
            others = tour.cluster == tour.cluster[self.first]
            others[self.first] = False
            out = others[tails] | others[heads]
        else:
            out = (tails == self.first) | (heads == self.first)
        return out


@dataclass
class Brancher:
    """Chooses by reliability branching.

    ended : stops probing
    gains, counts : (2, k) sum of the objective's rises for a unit of the choice's value, and how many: used, unused; of
        each node, then of each pair of clusters
    """

    lp: ArcProgramme
    ended: Callable[[], bool]
    gains: FloatArray = field(init=False)
    counts: IntArray = field(init=False)

    def __post_init__(self) -> None:
        size = self.lp.tour.nodes + self.lp.tour.clusters**2
        self.gains, self.counts = np.zeros((2, size)), np.zeros((2, size), dtype=np.int64)

    def choose(self) -> Choice:
        """What to decide at the programme's fractional point."""
        keys, x = self._candidates()
        distance = np.stack([1.0 - x, x])
        counts = self.counts[:, keys]
        typical = (self.gains.sum(axis=1) + 1e-9) / (self.counts.sum(axis=1) + 1)
        means = np.where(counts > 0, self.gains[:, keys] / np.maximum(counts, 1), typical[:, None])
        score = np.prod(np.maximum(means * distance, 1e-9), axis=0)
        # ties, such as at the beginning, go to the most fractional
        order = np.lexsort((-distance.min(axis=0), -score))
        unsure = [k for k in order.tolist() if counts[:, k].min() < RELIABLE][:CANDIDATES]
        if unsure:
            basis = self.lp.programme.basis()
            for k in unsure:
                if self.ended():
                    break
                rises = self._probe(self._choice(int(keys[k])), basis)
                for side in (0, 1):
                    if math.isfinite(rises[side]):
                        self.gains[side, keys[k]] += rises[side] / distance[side, k]
                        self.counts[side, keys[k]] += 1
                score[k] = math.prod(max(rise, 1e-9) for rise in rises)
            score[np.setdiff1d(order[counts[:, order].min(axis=0) < RELIABLE], unsure)] = -1.0
        return self._choice(int(keys[np.argmax(score)]))

    def _candidates(self) -> tuple[IntArray, FloatArray]:
        """Keys (k,) of what is undecided, and how far (k,) it is used."""
        lp, tour = self.lp, self.lp.tour
        pairs = tour.nodes + tour.clusters * tour.cluster[lp.tails] + tour.cluster[lp.heads]
        x = np.zeros(self.gains.shape[1])
        np.add.at(x, np.concatenate([lp.heads, pairs]), np.tile(lp.primal, 2))
        keys = np.flatnonzero((x > INTEGRAL) & (x < 1.0 - INTEGRAL))
        # neighbours move the bounds more, on both sides: nodes only when there are no others left
        if (keys >= tour.nodes).any():
            keys = keys[keys >= tour.nodes]
        return keys, x[keys]

    def _choice(self, key: int) -> Choice:
        tour = self.lp.tour
        return Choice(key) if key < tour.nodes else Choice(*divmod(key - tour.nodes, tour.clusters))

    def _probe(self, choice: Choice, basis: object) -> list[float]:
        """By how much the objective rises with the choice, and without it, as far as some iterations tell."""
        lp = self.lp
        assert lp.solution is not None
        rises = []
        for used in (True, False):
            columns = np.flatnonzero(choice.excluded(lp.tour, lp.tails, lp.heads, used))
            upper = lp.programme.upper[columns]
            columns = columns[upper > 0]
            none, upper = np.zeros(len(columns)), upper[upper > 0]
            lp.programme.set_bounds(columns, none, none)
            rises.append(max(0.0, lp.programme.probe(ITERATIONS) - lp.solution.objective))
            lp.programme.set_bounds(columns, none, upper)
            lp.programme.set_basis(basis)
        return rises
