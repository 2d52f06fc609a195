"""A tour that a fractional point suggests."""

from __future__ import annotations

import numpy as np

from optplan.domain.arrays import FloatArray, IntArray
from optplan.ordering.cutting.directed_graph import RootedTour


def guess(
    tour: RootedTour, reduced: FloatArray, tails: IntArray, heads: IntArray, values: FloatArray
) -> IntArray | None:
    """Follow, from the root on, the arc of largest value into a cluster that may come next; None when that fails.

    Parameters
    ----------
    reduced : (n, n) reduced costs, which decide where no arc has a value
    tails, heads, values : (k,) the fractional point
    """
    finite = reduced[np.isfinite(reduced)]
    score = np.minimum(reduced, 10.0 * float(finite.max(initial=0.0)) + 1.0)
    score[~np.isfinite(tour.costs)] = np.inf
    score[tails, heads] -= values * (1.0 + 20.0 * float(finite.max(initial=0.0)))
    inner = tour.order[: tour.clusters, : tour.clusters]
    waits = inner.sum(axis=0)
    left = np.ones(tour.clusters, dtype=np.bool_)
    here = int(np.flatnonzero(tour.cluster == tour.root)[0])
    if len(leaving := np.flatnonzero(tour.cluster[tails] == tour.root)):
        here = int(tails[leaving[np.argmax(values[leaving])]])
    nodes = [here]
    for _ in range(tour.clusters - 1):
        cluster = tour.cluster[here]
        left[cluster] = False
        waits = waits - inner[cluster]
        able = np.where((left & (waits == 0))[tour.cluster], score[here], np.inf)
        here = int(np.argmin(able))
        if not np.isfinite(able[here]):
            return None
        nodes.append(here)
    return np.array(nodes, dtype=np.int64) if np.isfinite(tour.costs[here, nodes[0]]) else None
