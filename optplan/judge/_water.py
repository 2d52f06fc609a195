"""The order that the water asks for, worked out again from the stops."""

from __future__ import annotations

import numpy as np

from optplan.domain.arrays import FloatArray, IntArray
from optplan.domain.facade import Facade
from optplan.domain.options import Options
from optplan.domain.path import Path
from optplan.domain.report import Check
from optplan.domain.result import Cover
from optplan.judge._findings import count_of, held, place_of
from optplan.judge._strokes import runs
from optplan.judge._walls import OnWall

CLEARLY = 1e-9
"""m by which a stop has to be higher, or nearer, for the rule to speak."""
LEVEL = 0.25
"""Rows are apart by at least this share of the radius."""


def order(job: Facade, path: Path, cover: Cover, placed: list[OnWall], radii: FloatArray, options: Options) -> Check:
    """How many pairs of stops are visited against the rule; the first one, in the order of visiting, by name."""
    pairs = [_rule(job, number, placed, radii, options) for number in range(len(job.walls))]
    before = np.concatenate([np.array(cover.precedence, dtype=np.int64).reshape(-1, 2), *pairs])
    before = np.unique(before, axis=0).reshape(-1, 2)
    position = np.full(len(cover.strokes), -1)
    for k, run in enumerate(runs(path)):
        if run.stroke < len(position) and position[run.stroke] < 0:
            position[run.stroke] = k
    seen = before[(position[before] >= 0).all(axis=1)]
    broken = seen[position[seen[:, 0]] > position[seen[:, 1]]]
    names = [stroke.id for stroke in cover.strokes]
    if len(broken) == 0:
        return held("order", 0, 0, "", detail=f"{count_of(len(before), 'rule')} of order, all kept.")
    first, then = broken[np.lexsort((position[broken[:, 0]], position[broken[:, 1]]))[0]].tolist()
    detail = f"Stop {names[then]} is visited before {names[first]}, from where its water would run over it"
    detail += f"; {len(broken)} of {len(before)} rules of order are broken."
    return held("order", len(broken), 0, "", place_of(np.array([placed[then].x, placed[then].y])), detail)


def _rule(job: Facade, number: int, placed: list[OnWall], radii: FloatArray, options: Options) -> IntArray:
    """Pairs (k, 2) of the stops of one wall."""
    wash = options.wash
    own = np.array([k for k, stop in enumerate(placed) if stop.wall == number], dtype=np.int64)
    if wash.rule == "none" or len(own) < 2:
        return np.zeros((0, 2), dtype=np.int64)
    x = np.array([placed[k].x for k in own.tolist()])
    y = np.array([placed[k].y for k in own.tolist()]) * (1.0 if wash.direction == "up" else -1.0)
    radius = radii[own]
    if wash.rule == "rows":
        levels: FloatArray = np.sort(y)
        starts = levels[np.append(True, np.diff(levels) > LEVEL * radius.min() + CLEARLY)]
        row = np.searchsorted(starts, y + CLEARLY, side="right")
        return own[np.argwhere(row[:, None] + 1 == row)]
    tau = job.tau if wash.tau is None else wash.tau
    width = job.width if wash.width is None else wash.width
    higher = y[None] - y[:, None] >= tau * radius[:, None] + CLEARLY
    beside = np.abs(x[None] - x[:, None]) < width * radius[:, None] - CLEARLY
    return own[np.argwhere(higher & beside)]
