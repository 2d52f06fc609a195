"""Which arc to branch on: the one that raises both bounds most (Achterberg, Koch and Martin 2005)."""

from __future__ import annotations

import math
from collections.abc import Callable
from dataclasses import dataclass, field

import numpy as np

from optplan.domain.arrays import FloatArray, IntArray
from optplan.ordering.cutting.directed_lp import ArcProgramme

INTEGRAL = 1e-6
"""Values nearer than this to 0 or 1 are whole."""
CANDIDATES = 8
"""Most arcs that are probed before one is chosen."""
ITERATIONS = 40
"""Dual simplex iterations of a probe."""
RELIABLE = 4
"""Probes after which an arc's mean is trusted."""


@dataclass
class Brancher:
    """Chooses arcs by reliability branching.

    ended : stops probing
    gains, counts : (2, n, n) sum of the objective's rises for a unit of the arc's value, and how many: used, unused
    """

    lp: ArcProgramme
    ended: Callable[[], bool]
    gains: FloatArray = field(init=False)
    counts: IntArray = field(init=False)

    def __post_init__(self) -> None:
        count = self.lp.tour.nodes
        self.gains, self.counts = np.zeros((2, count, count)), np.zeros((2, count, count), dtype=np.int64)

    def choose(self) -> tuple[int, int]:
        """The arc to branch on at the programme's fractional point."""
        lp = self.lp
        x = lp.primal
        columns = np.flatnonzero((x > INTEGRAL) & (x < 1.0 - INTEGRAL))
        tails, heads = lp.tails[columns], lp.heads[columns]
        distance = np.stack([1.0 - x[columns], x[columns]])
        counts = self.counts[:, tails, heads]
        typical = (self.gains.sum(axis=(1, 2)) + 1e-9) / (self.counts.sum(axis=(1, 2)) + 1)
        means = np.where(counts > 0, self.gains[:, tails, heads] / np.maximum(counts, 1), typical[:, None])
        score = np.prod(np.maximum(means * distance, 1e-9), axis=0)
        # ties, such as at the beginning, go to the most fractional
        order = np.lexsort((-distance.min(axis=0), -score))
        unsure = [k for k in order.tolist() if counts[:, k].min() < RELIABLE][:CANDIDATES]
        if unsure:
            basis = lp.programme.basis()
            for k in unsure:
                if self.ended():
                    break
                rises = self._probe(int(columns[k]), basis)
                for side in (0, 1):
                    if math.isfinite(rises[side]):
                        self.gains[side, tails[k], heads[k]] += rises[side] / distance[side, k]
                        self.counts[side, tails[k], heads[k]] += 1
                score[k] = math.prod(max(rise, 1e-9) for rise in rises)
            score[np.setdiff1d(order[counts[:, order].min(axis=0) < RELIABLE], unsure)] = -1.0
        best = int(np.argmax(score))
        return int(tails[best]), int(heads[best])

    def _probe(self, column: int, basis: object) -> list[float]:
        """By how much the objective rises with the arc, and without it, as far as some iterations tell."""
        lp = self.lp
        assert lp.solution is not None
        one, rises = np.array([column]), []
        for value in (1.0, 0.0):
            lp.programme.set_bounds(one, np.array([value]), np.array([value]))
            rises.append(max(0.0, lp.programme.probe(ITERATIONS) - lp.solution.objective))
            lp.programme.set_bounds(one, np.zeros(1), np.ones(1))
            lp.programme.set_basis(basis)
        return rises
