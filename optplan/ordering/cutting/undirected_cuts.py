"""Violated generalised subtour cuts of a point of the linear programme."""

from __future__ import annotations

import numpy as np

from optplan.domain.arrays import FloatArray, IntArray
from optplan.ordering.cutting.undirected import Undirected
from optplan.ordering.cutting.undirected_lp import pair_numbers

USED = 1e-7
"""An edge with less than this is not there."""
UNLIMITED = 2**31
"""Sets that a cluster may be in."""
BLOSSOMS = 40
"""Most blossoms at a time."""
BLOSSOM_VIOLATION = 0.02
BLOSSOM_CLUSTERS = 1500
"""Most clusters for blossoms: their duals are kept by pairs of clusters (18 MB)."""


def violated_sets(form: Undirected, edges: IntArray, weights: FloatArray, most: int = UNLIMITED) -> list[IntArray]:
    """Sets of points whose cut x(delta(S)) >= 2 is violated; at least one if there is any.

    They come from the least cuts between one cluster, the root, and each other. When the root uses one point only,
    these are enough: a set that violates the cut of two other clusters has the root on one side, and violates the cut
    of that pair. Only when every cluster uses several points, all pairs are looked at, until there is a violation.

    Parameters
    ----------
    form : of the problem
    edges (k, 2), weights (k,) : how far they are used; every cluster has two links
    most : sets that a cluster may be in, the smallest first
    """
    from optplan.ordering._kernels.mincut import subtour_sets

    used = weights > USED
    ends = np.minimum(np.arange(form.points), form.mate)[edges[used]]
    points, numbered = np.unique(ends, return_inverse=True)
    numbered = numbered.reshape(ends.shape)
    cluster = form.cluster[points]
    in_support = np.bincount(cluster, minlength=form.clusters)
    order = np.argsort(in_support, kind="stable")
    found = np.zeros((0, len(points) + 1), dtype=np.int64)
    for k, root in enumerate(order.tolist()):
        tails, heads = numbered[:, 0], numbered[:, 1]
        found = subtour_sets(len(points), tails, heads, weights[used], cluster, order[k + 1 :], root, most)
        if len(found) or in_support[root] == 1:
            break
    sets: dict[bytes, IntArray] = {}
    for row in found[:, :-1] == 1:
        members = np.zeros(form.points, dtype=np.bool_)
        members[points[row]] = True
        # points that are not in use go where all others of their cluster are
        held = np.bincount(cluster[row], minlength=form.clusters) == in_support
        members |= (held & (in_support > 0))[form.cluster]
        members |= members[form.mate]
        if 2 * members.sum() > form.points:
            members = ~members
        sets[members.tobytes()] = np.flatnonzero(members)
    return list(sets.values()) if most == UNLIMITED else _smallest(form, list(sets.values()), most)


def _smallest(form: Undirected, sets: list[IntArray], most: int) -> list[IntArray]:
    """The smallest sets, whose rows are sparse, without those of a cluster that is in so many others."""
    seen = np.zeros(form.clusters, dtype=np.int64)
    kept = []
    for members in sorted(sets, key=len):
        clusters = np.unique(form.cluster[members])
        if seen[clusters].max() < most:
            seen[clusters] += 1
            kept.append(members)
    return kept


def violated_blossoms(form: Undirected, edges: IntArray, weights: FloatArray) -> tuple[list[IntArray], list[IntArray]]:
    """Handles (points of whole clusters) of violated blossoms, and their teeth (numbers of pairs of clusters).

    After Letchford, Reinelt and Theis ("Odd minimum cut sets and b-matchings revisited", 2008): handles are the least
    cuts of a cut tree of the graph of clusters, in which a link weighs what it lacks to being used or not; teeth are
    the links across that are rather used, one more or less where their number is even.
    """
    from optplan.ordering._kernels.mincut import cut_tree_sets

    if form.clusters > BLOSSOM_CLUSTERS:
        return [], []
    used = weights > USED
    pairs, place = np.unique(pair_numbers(form, *edges[used].T), return_inverse=True)
    links = np.minimum(np.bincount(place.ravel(), weights[used]), 1.0)
    a, b = np.divmod(pairs, form.clusters)
    undecided = np.minimum(links, 1.0 - links)
    rows = cut_tree_sets(form.clusters, a, b, undecided) == 1
    found: dict[bytes, tuple[float, IntArray, IntArray]] = {}
    for handle in rows:
        crossing = np.flatnonzero(handle[a] != handle[b])
        x = links[crossing]
        # nothing across: the subtour cuts see to that
        if not len(crossing) or undecided[crossing].sum() > 1.0 - BLOSSOM_VIOLATION:
            continue
        tooth = x > 0.5
        if tooth.sum() % 2 == 0:
            flip = int(np.abs(x - 0.5).argmin())
            tooth[flip] = not tooth[flip]
        lack = float(np.where(tooth, 1.0 - x, x).sum())
        if tooth.sum() < 3 or lack > 1.0 - BLOSSOM_VIOLATION:
            continue
        if 2 * handle.sum() > form.clusters:
            handle = ~handle
        teeth = pairs[crossing[tooth]]
        found[handle.tobytes() + teeth.tobytes()] = lack, np.flatnonzero(handle[form.cluster]), teeth
    best = sorted(found.values(), key=lambda blossom: blossom[0])[:BLOSSOMS]
    return [handle for _, handle, _ in best], [teeth for *_, teeth in best]
