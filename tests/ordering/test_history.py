"""Orders in which what is done before matters, against all orders."""

from __future__ import annotations

from itertools import permutations, product

import numpy as np
import pytest

from optplan.ordering.history import History, annealed


def _case(seed: int, rules: bool) -> tuple[History, np.ndarray]:
    """Five clusters of two nodes, which drive them either way."""
    random = np.random.default_rng(seed)
    n, m = 10, 5
    cluster = np.repeat(np.arange(m), 2)
    costs = random.uniform(1, 9, (n, n))
    costs[random.random((n, n)) < 0.05] = np.inf
    on_node = random.uniform(0, 1, (n, m)) * (random.random((n, m)) < 0.4)
    on_node[np.arange(n), cluster] = 0
    on_arc = random.uniform(0, 1, (n, n, m)) * (random.random((n, n, m)) < 0.4)
    must = np.array([[0, 3], [1, 3]]) if rules else np.zeros((0, 2), dtype=np.int64)
    start, end = random.uniform(0, 3, n), random.uniform(0, 3, n)
    return History(cluster, costs, start, end, on_node, on_arc, must), np.arange(n) ^ 1


def _by_hand(history: History, order: list[int], weight: float) -> float:
    done: set[int] = set()
    found = float(history.start[order[0]] + history.end[order[-1]])
    met = 0.0
    for k, node in enumerate(order):
        if k:
            found += float(history.costs[order[k - 1], node])
            met += sum(float(history.on_arc[order[k - 1], node, c]) for c in done)
        met += sum(float(history.on_node[node, c]) for c in done)
        for first, second in history.must.tolist():
            if history.cluster[node] == first and second in done:
                return np.inf
        done.add(int(history.cluster[node]))
    return found + weight * met


def _go_on(share: float) -> bool:
    return 0 <= share <= 1


@pytest.mark.parametrize("rules", [False, True])
@pytest.mark.parametrize("seed", range(4))
def test_annealing_finds_the_best_of_all_orders(seed: int, rules: bool) -> None:
    history, twin = _case(seed, rules)
    weight = 3.0
    orders = [
        [2 * c + side for c, side in zip(clusters, sides, strict=True)]
        for clusters in permutations(range(5))
        for sides in product((0, 1), repeat=5)
    ]
    values = [_by_hand(history, order, weight) for order in orders]
    some = orders[::97]
    assert [history.value(np.array(order), weight) for order in some] == pytest.approx(
        [_by_hand(history, order, weight) for order in some]
    )
    first = orders[int(np.argmax(np.where(np.isfinite(values), values, -1)))]
    best = annealed(history, twin, np.array(first), weight, seed, _go_on, 1)
    assert history.value(best, weight) == pytest.approx(min(values))
    again = annealed(history, twin, np.array(first), weight, seed, _go_on, 1)
    assert best.tolist() == again.tolist()


def test_a_cancel_is_heard_and_the_best_so_far_is_kept() -> None:
    history, twin = _case(7, False)
    told: list[float] = []

    def proceed(share: float) -> bool:
        told.append(share)
        return False

    first = np.array([0, 2, 4, 6, 8])
    history = history._replace(costs=np.where(np.isinf(history.costs), 50.0, history.costs))
    best = annealed(history, twin, first, 1.0, 0, proceed, 5)
    assert len(told) == 1
    assert history.value(best, 1.0) <= history.value(first, 1.0)
