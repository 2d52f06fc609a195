"""Violated generalised subtour cuts of a point of the linear programme."""

from __future__ import annotations

import numpy as np
import numpy.typing as npt

from optplan.domain.arrays import FloatArray, IntArray
from optplan.ordering.cutting.undirected import Undirected
from optplan.ordering.cutting.undirected_lp import pair_numbers

Bools = npt.NDArray[np.bool_]
USED = 1e-7
"""An edge with less than this is not there."""
UNLIMITED = 2**31
"""Sets that a cluster may be in."""
BLOSSOMS = 40
"""Most blossoms at a time."""
BLOSSOM_VIOLATION = 0.02
BLOSSOM_CLUSTERS = 1500
"""Most clusters for blossoms: a cut tree takes a matrix (18 MB)."""
HOPELESS = 1.6
"""Handles that lack more (1 is enough) are not improved."""


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
    """Handles (points) of violated blossoms, and their teeth (numbers of pairs of clusters).

    After Letchford, Reinelt and Theis ("Odd minimum cut sets and b-matchings revisited", 2008): handles are the least
    cuts of a cut tree of a graph in which a link weighs what it lacks to being used or not; teeth are the links across
    that are rather used, one more or less where their number is even. There are two such graphs: of clusters, and of
    points, whose handles split clusters. A local search makes the most of each handle, and of each point alone: edges
    between the same two clusters are one link, which no graph of points knows.
    """
    from optplan.ordering._kernels.blossoms import improve_handles
    from optplan.ordering._kernels.mincut import cut_tree_sets

    if form.clusters > BLOSSOM_CLUSTERS:
        return [], []
    used = weights > USED
    points, ends, mate = _vertices(form, edges[used])
    tails, heads = np.ascontiguousarray(ends.T)
    amounts = weights[used]
    pairs, bundle = np.unique(pair_numbers(form, *edges[used].T), return_inverse=True)
    bundle = bundle.ravel()
    links = np.bincount(bundle, amounts)
    a, b = np.divmod(pairs, form.clusters)
    clusters = cut_tree_sets(form.clusters, a, b, np.maximum(np.minimum(links, 1.0 - links), 0.0))
    split = cut_tree_sets(len(points), tails, heads, np.maximum(np.minimum(amounts, 1.0 - amounts), 0.0))
    cluster = form.cluster[points]
    rows = np.concatenate([clusters[:, cluster], split, np.eye(len(points), dtype=np.int64)]).astype(np.uint8)
    lacks = improve_handles(rows, tails, heads, amounts, bundle, mate, HOPELESS)
    found: dict[bytes, tuple[IntArray, IntArray]] = {}
    seen: set[bytes] = set()
    in_support = np.bincount(cluster, minlength=form.clusters)
    for k in np.argsort(lacks, kind="stable").tolist():
        if lacks[k] > 1.0 - BLOSSOM_VIOLATION or len(found) == BLOSSOMS:
            break
        if rows[k].tobytes() in seen:
            continue
        seen.add(rows[k].tobytes())
        handle = rows[k] == 1
        crossing = handle[tails] != handle[heads]
        x = np.bincount(bundle[crossing], amounts[crossing], len(pairs))
        tooth = x > 0.5
        always = int((handle != handle[mate]).sum()) // 2
        if (tooth.sum() + always) % 2 == 0:
            # one more or less of those across
            flip = int(np.abs(x - 0.5).argmin())
            tooth[flip] = not tooth[flip]
        if tooth.sum() + always < 3:
            continue  # a subtour cut says more
        members = np.zeros(form.points, dtype=np.bool_)
        members[points[handle]] = True
        # points that are not in use go where all others of their cluster are
        held = np.bincount(cluster[handle], minlength=form.clusters) == in_support
        members |= (held & (in_support > 0))[form.cluster]
        members |= members[form.mate] & ~_always(form)
        if 2 * members.sum() > form.points:
            members = ~members
        teeth = pairs[tooth]
        found.setdefault(members.tobytes() + teeth.tobytes(), (np.flatnonzero(members), teeth))
    return [handle for handle, _ in found.values()], [teeth for _, teeth in found.values()]


def _always(form: Undirected) -> Bools:
    """(n,) which points are ends of a fixed edge that is their cluster's only option."""
    single = form.mate == np.arange(form.points)
    two: Bools = (np.bincount(form.cluster) == 2)[form.cluster] & ~single
    return two


def _vertices(form: Undirected, edges: IntArray) -> tuple[IntArray, IntArray, IntArray]:
    """Points (n,) in use, the edges (k, 2) between their numbers, and the number (n,) of the other end of each.

    Both ends of a fixed edge are one vertex unless every tour uses it; other vertices are their own other ends.
    """
    everything = np.arange(form.points)
    always = _always(form)
    vertex = np.where(always, everything, np.minimum(everything, form.mate))
    points, numbered = np.unique(np.concatenate([vertex[edges].ravel(), everything[always]]), return_inverse=True)
    mate = np.searchsorted(points, np.where(always[points], form.mate[points], points))
    return points, numbered.ravel()[: edges.size].reshape(edges.shape), mate
