"""What going from one node to another costs: written out, or computed on demand."""

from __future__ import annotations

import math
from collections.abc import Callable
from dataclasses import dataclass
from typing import Protocol

import numpy as np

from optplan.domain.arrays import FloatArray, IntArray, frozen_floats, frozen_ints
from optplan.domain.errors import InputError


class ArcCosts(Protocol):
    """Costs of arcs between nodes; infinite where there is none, never NaN or minus infinity."""

    def __len__(self) -> int:
        """Number of nodes."""

    def pairs(self, tails: IntArray, heads: IntArray) -> FloatArray:
        """Costs (k,) of the arcs tails[i] -> heads[i]."""


@dataclass(frozen=True, eq=False)
class MatrixCosts:
    """Costs written out.

    Parameters
    ----------
    matrix : (n, n); matrix[i, j] is the cost of going from the exit of node i to the entry of node j
    """

    matrix: FloatArray

    def __post_init__(self) -> None:
        matrix = frozen_floats(self.matrix, "the cost matrix", (None, None), finite=False)
        if matrix.shape[0] != matrix.shape[1]:
            raise InputError(f"the cost matrix is {matrix.shape[0]} x {matrix.shape[1]}; expected a square one")
        if np.isneginf(matrix).any():
            place = [int(k) for k in np.argwhere(np.isneginf(matrix))[0]]
            raise InputError(f"the cost matrix{place} is minus infinity; expected a number or +infinity")
        object.__setattr__(self, "matrix", matrix)

    def __len__(self) -> int:
        return len(self.matrix)

    def pairs(self, tails: IntArray, heads: IntArray) -> FloatArray:
        """Costs (k,) of the arcs tails[i] -> heads[i]."""
        return self.matrix[tails, heads]


@dataclass(frozen=True, eq=False)
class EuclidCosts:
    """Straight lines.

    Parameters
    ----------
    exits, entries : (n, d) m, where node i is left and entered
    """

    exits: FloatArray
    entries: FloatArray

    def __post_init__(self) -> None:
        exits = frozen_floats(self.exits, "exits", (None, None))
        object.__setattr__(self, "exits", exits)
        object.__setattr__(self, "entries", frozen_floats(self.entries, "entries", exits.shape))

    def __len__(self) -> int:
        return len(self.exits)

    def pairs(self, tails: IntArray, heads: IntArray) -> FloatArray:
        """Costs (k,) of the arcs tails[i] -> heads[i], m."""
        lengths: FloatArray = np.linalg.norm(self.exits[tails] - self.entries[heads], axis=-1)
        return lengths


@dataclass(frozen=True, eq=False)
class DubinsCosts:
    """Shortest paths of a car that only drives forwards.

    Parameters
    ----------
    exits, entries : (n, 3) x, y, heading: m, m, rad
    radius : turning radius, m, > 0
    batch : function (starts (k, 3), ends (k, 3), radius) -> lengths (k,); the geometry layer supplies it
    """

    exits: FloatArray
    entries: FloatArray
    radius: float
    batch: Callable[[FloatArray, FloatArray, float], FloatArray]

    def __post_init__(self) -> None:
        exits = frozen_floats(self.exits, "exits", (None, 3))
        object.__setattr__(self, "exits", exits)
        object.__setattr__(self, "entries", frozen_floats(self.entries, "entries", exits.shape))
        if not (math.isfinite(self.radius) and self.radius > 0):
            raise InputError(f"the turning radius is {self.radius} m; expected a finite number above 0")

    def __len__(self) -> int:
        return len(self.exits)

    def pairs(self, tails: IntArray, heads: IntArray) -> FloatArray:
        """Costs (k,) of the arcs tails[i] -> heads[i], m."""
        return self.batch(self.exits[tails], self.entries[heads], self.radius)


@dataclass(frozen=True, eq=False)
class ChosenCosts:
    """Costs of nodes made of other nodes: entered as one of them, left as another.

    Parameters
    ----------
    costs : of the other nodes
    firsts, lasts : (n,) as which node i is entered and left
    """

    costs: ArcCosts
    firsts: IntArray
    lasts: IntArray

    def __post_init__(self) -> None:
        object.__setattr__(self, "firsts", frozen_ints(self.firsts, "firsts", (None,)))
        object.__setattr__(self, "lasts", frozen_ints(self.lasts, "lasts", self.firsts.shape))

    def __len__(self) -> int:
        return len(self.firsts)

    def pairs(self, tails: IntArray, heads: IntArray) -> FloatArray:
        """Costs (k,) of the arcs tails[i] -> heads[i]."""
        return self.costs.pairs(self.lasts[tails], self.firsts[heads])
