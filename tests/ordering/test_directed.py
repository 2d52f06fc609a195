"""Exact ordering of directed and precedence-constrained problems by cuts."""

from __future__ import annotations

import math

import numpy as np
import pytest
from scipy.sparse import csr_array
from scipy.sparse.csgraph import maximum_flow

from optplan.ordering._kernels.maxflow import SINK_SIDE, SOURCE_SIDE, max_flow, network


@pytest.mark.parametrize("seed", range(60))
def test_both_minimum_cuts_have_the_value_of_the_flow(seed: int) -> None:
    rng = np.random.default_rng(seed)
    count = int(rng.integers(2, 30))
    arcs = rng.integers(0, count, (int(rng.integers(1, 6 * count)), 2))
    arcs = np.ascontiguousarray(arcs[arcs[:, 0] != arcs[:, 1]])
    capacity = rng.integers(0, 6, len(arcs)).astype(np.float64)
    closed = (rng.random(count) < 0.2).astype(np.int64)
    closed[[0, count - 1]] = 0
    tails, heads = arcs[:, 0].copy(), arcs[:, 1].copy()
    net = network(count, tails, heads)
    residual = np.zeros(2 * len(arcs))
    residual[net.slot] = capacity
    side = np.zeros(count, dtype=np.int64)
    value = max_flow(net, residual, closed, 0, count - 1, math.inf, side)

    capacity[(closed[tails] == 1) | (closed[heads] == 1)] = 0.0
    matrix = csr_array((capacity.astype(np.int32), (tails, heads)), shape=(count, count))
    assert value == maximum_flow(matrix, 0, count - 1).flow_value
    reached, reaching = side == SOURCE_SIDE, side == SINK_SIDE
    assert capacity[reached[tails] & ~reached[heads]].sum() == value
    assert capacity[~reaching[tails] & reaching[heads]].sum() == value
