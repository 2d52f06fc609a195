"""An ordering problem and the numbers that a library file gives to its nodes."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from optplan.domain.arrays import IntArray, frozen_ints
from optplan.domain.errors import InputError
from optplan.domain.ordering import OrderingProblem


@dataclass(frozen=True, eq=False)
class Instance:
    """A problem as a library file states it.

    Parameters
    ----------
    name : of the instance
    kind : TSP, ATSP, SOP, GTSP or PCGTSP
    problem : what it asks for
    numbers : (n,) the file's number of each node of the problem, from 1
    depots : numbers that stand for the start and the end of an open path and are no node of the problem: none, one that
        is both, or two
    """

    name: str
    kind: str
    problem: OrderingProblem
    numbers: IntArray
    depots: tuple[int, ...] = ()

    def __post_init__(self) -> None:
        object.__setattr__(self, "numbers", frozen_ints(self.numbers, "numbers", (self.problem.nodes,)))

    @property
    def dimension(self) -> int:
        """Number of nodes in the file."""
        return self.problem.nodes + len(self.depots)

    def tour(self, nodes: IntArray) -> list[int]:
        """The file's numbers (k,) along a path (m,) of nodes."""
        return [*self.depots[:1], *self.numbers[nodes].tolist(), *self.depots[1:]]

    def path(self, tour: Sequence[int]) -> IntArray:
        """The path (m,) of nodes along a tour in the file's numbers, which may begin anywhere.

        Raises
        ------
        InputError : numbers that the file does not have, or that are missing
        """
        numbers = list(tour)
        known = {int(number): node for node, number in enumerate(self.numbers.tolist())}
        for number in numbers:
            if number not in known and number not in self.depots:
                raise InputError(f"the tour has node {number}; expected 1..{self.dimension}")
        for depot in self.depots:
            if numbers.count(depot) != 1:
                raise InputError(
                    f"the tour passes the depot, node {depot}, {numbers.count(depot)} times; expected once"
                )
        if self.depots:
            begin = numbers.index(self.depots[0])
            numbers = numbers[begin + 1 :] + numbers[:begin]
            if len(self.depots) > 1:
                if numbers[-1] != self.depots[1]:
                    raise InputError(f"the tour does not return from node {self.depots[1]} to node {self.depots[0]}")
                numbers.pop()
        nodes = np.array([known[number] for number in numbers], dtype=np.int64)
        if not self.depots and self.problem.closed and len(nodes):
            # listed from where the path may begin
            firsts = np.flatnonzero(np.isfinite(self.problem.start_costs[nodes]))
            nodes = np.roll(nodes, -int(firsts[0])) if len(firsts) else nodes
        if faults := self.problem.faults(nodes):
            raise InputError(f"the tour is no solution of {self.name}: {faults[0]}")
        return nodes
