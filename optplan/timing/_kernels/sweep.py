"""The greatest squared speeds along a grid: a pass forwards and one backwards."""

from __future__ import annotations

from optplan.compiled import njit
from optplan.domain.arrays import FloatArray


@njit(cache=True, nogil=True)
def sweep(
    length: FloatArray,
    first: FloatArray,
    last: FloatArray,
    sharpness: FloatArray,
    half_track: float,
    acceleration: FloatArray,
    cap: FloatArray,
) -> FloatArray:
    """Greatest b = v^2 (n + 1,) at the ends of n intervals with curvatures first, last (n,) at their ends.

    Within an interval a = (b' - b) / (2 length) is constant, and for each wheel, at both ends of the interval,

        |a (1 +- kappa r) +- r kappa' b| <= acceleration,    b <= cap.

    Where 1 +- kappa r is too small for the length of its interval (2 length r |kappa'| or less), it is passed over: the
    caps mind it. An acceleration of 0 keeps the speed. Every constraint is of the kind "this b is at most an increasing
    function of that one", so that the greatest solution is found by one pass each way: with b <= acceleration /
    (r |kappa'|) constant speed is always allowed, and what the pass backwards lowers stays at least as fast as what
    follows.
    """
    count = len(length)
    best = cap.copy()
    for step in range(2 * count):
        forwards = step < count
        k = step if forwards else 2 * count - 1 - step
        h, most = 2.0 * length[k], acceleration[k]
        x, y = (best[k], best[k + 1]) if forwards else (best[k + 1], best[k])
        if most == 0.0:
            y = min(y, x)
        else:
            for side in (half_track, -half_track):
                near, far, g = 1.0 + side * first[k], 1.0 + side * last[k], side * sharpness[k]
                if near + far < 0.0:
                    near, far, g = -near, -far, -g
                if not forwards:
                    near, far, g = far, near, -g
                if min(near, far) > h * abs(g):
                    y = min(y, x + h * (most - g * x) / near, (h * most + x * far) / (far + h * g))
        best[k + 1 if forwards else k] = max(y, 0.0)
    return best
