"""Enforced connections: pairs of clusters that must be visited one after the other, and the chains they form."""

from __future__ import annotations

from itertools import pairwise

import numpy as np

from optplan.domain.arrays import IntArray
from optplan.domain.errors import InputError


def chains(cluster: IntArray, enforced: IntArray, precedence: IntArray) -> list[list[int]]:
    """The clusters that enforced connections tie together, each chain in one of its two directions.

    Parameters
    ----------
    cluster : (n,) cluster of each node
    enforced : (k, 3) connection, tail node, head node: of each connection 0, 1, ... one of its arcs is driven
    precedence : (p, 2) pairs of clusters, the first before the second

    Raises
    ------
    InputError : connections that contradict each other or the precedence; says which
    """
    neighbours: dict[int, list[int]] = {}
    for link, (a, b) in enumerate(_pairs(cluster, enforced)):
        for here, there in ((a, b), (b, a)):
            known = neighbours.setdefault(here, [])
            if there in known or len(known) == 2:
                others = " and ".join(map(str, [*known, there]))
                raise InputError(
                    f"enforced[{link}]: cluster {here} would be tied to clusters {others}; "
                    "expected one other before it and one behind it"
                )
            known.append(there)
    found: list[list[int]] = []
    done: set[int] = set()
    for end in sorted(c for c, known in neighbours.items() if len(known) == 1):
        if end in done:
            continue
        chain = [end]
        while further := [c for c in neighbours[chain[-1]] if c not in chain[-2:]]:
            chain.append(further[0])
        done.update(chain)
        found.append(chain)
    if left := sorted(set(neighbours) - done):
        raise InputError(
            f"enforced connections close a ring through cluster {left[0]}; a path cannot follow all of them"
        )
    for chain in found:
        if not any(directions(chain, cluster, enforced, precedence)):
            names = " - ".join(map(str, chain))
            raise InputError(
                f"the enforced connections of clusters {names} cannot all be driven: they need different nodes of one "
                "cluster, or precedence asks for another order"
            )
    return found


def directions(chain: list[int], cluster: IntArray, enforced: IntArray, precedence: IntArray) -> tuple[bool, bool]:
    """Whether a chain can be driven as listed, and backwards."""
    return _drivable(chain, cluster, enforced, precedence), _drivable(chain[::-1], cluster, enforced, precedence)


def arcs_between(cluster: IntArray, enforced: IntArray, a: int, b: int) -> IntArray:
    """(k, 2) enforced arcs from cluster a to cluster b."""
    chosen = (cluster[enforced[:, 1]] == a) & (cluster[enforced[:, 2]] == b)
    return np.unique(enforced[chosen, 1:], axis=0).reshape(-1, 2)


def missing_connections(enforced: IntArray, nodes: IntArray) -> list[int]:
    """The connections of which no arc is driven when these nodes are visited in this order."""
    if not len(enforced):
        return []
    driven = set(zip(nodes[:-1].tolist(), nodes[1:].tolist(), strict=True))
    kept = {link for link, tail, head in enforced.tolist() if (tail, head) in driven}
    return sorted(set(enforced[:, 0].tolist()) - kept)


def _pairs(cluster: IntArray, enforced: IntArray) -> list[tuple[int, int]]:
    """The two clusters of each connection."""
    links = enforced[:, 0]
    if not np.array_equal(np.unique(links), np.arange(len(np.unique(links)))):
        raise InputError("enforced connections must be numbered 0, 1, 2, ... without a gap")
    nodes = enforced[:, 1:]
    if not ((nodes >= 0) & (nodes < len(cluster))).all():
        raise InputError(f"an enforced connection names node {int(nodes.max())}; expected 0..{len(cluster) - 1}")
    ends = np.sort(cluster[nodes], axis=1)
    pairs = []
    for link in range(len(np.unique(links))):
        own = np.unique(ends[links == link], axis=0)
        if len(own) != 1 or own[0, 0] == own[0, 1]:
            raise InputError(f"enforced[{link}] must join two different clusters, the same two in each of its arcs")
        pairs.append((int(own[0, 0]), int(own[0, 1])))
    return pairs


def _drivable(chain: list[int], cluster: IntArray, enforced: IntArray, precedence: IntArray) -> bool:
    position = {c: k for k, c in enumerate(chain)}
    if any(a in position and b in position and position[a] > position[b] for a, b in precedence.tolist()):
        return False
    reached: set[int] | None = None
    for a, b in pairwise(chain):
        arcs = arcs_between(cluster, enforced, a, b).tolist()
        reached = {head for tail, head in arcs if reached is None or tail in reached}
    return reached is None or bool(reached)
