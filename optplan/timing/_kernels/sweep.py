"""The greatest squared speeds along a grid: a pass forwards and one backwards."""

from __future__ import annotations

from optplan.compiled import njit
from optplan.domain.arrays import FloatArray


@njit(cache=True, nogil=True)
def sweep(
    length: FloatArray,
    weight: FloatArray,
    steer: FloatArray,
    acceleration: FloatArray,
    cap: FloatArray,
) -> FloatArray:
    """Greatest b = v^2 (n + 1,) at the ends of n intervals.

    Within an interval a = (b' - b) / (2 length) is constant, and for each wheel, at both ends of the interval,

        |a weight + steer b| <= acceleration,    b <= cap.

    weight (n, 2, 2) : of each wheel at the beginning and at the end, >= 0; steer (n, 2) of each wheel. A weight too
    small for its interval (2 length |steer| or less) is passed over: the caps mind it. acceleration (n,): 0 keeps the
    speed. Every constraint is of the kind "this b is at most an increasing function of that one", so that the greatest
    solution is found by one pass each way: with b <= acceleration / |steer| constant speed is always allowed, and what
    the pass backwards lowers stays at least as fast as what follows.
    """
    count = len(length)
    best = cap.copy()
    for k in range(count):
        x, h, most = best[k], 2.0 * length[k], acceleration[k]
        y = best[k + 1]
        if most == 0.0:
            y = min(y, x)
        else:
            for wheel in range(2):
                first, last, g = weight[k, wheel, 0], weight[k, wheel, 1], steer[k, wheel]
                if min(first, last) > h * abs(g):
                    y = min(y, x + h * (most - g * x) / first, (h * most + x * last) / (last + h * g))
        best[k + 1] = max(y, 0.0)
    for k in range(count - 1, -1, -1):
        y, h, most = best[k + 1], 2.0 * length[k], acceleration[k]
        x = best[k]
        if most == 0.0:
            x = min(x, y)
        else:
            for wheel in range(2):
                first, last, g = weight[k, wheel, 0], weight[k, wheel, 1], steer[k, wheel]
                if min(first, last) > h * abs(g):
                    x = min(x, y + h * (most + g * y) / last, (h * most + y * first) / (first - h * g))
        best[k] = max(x, 0.0)
    return best
