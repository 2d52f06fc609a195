"""Run-ins and run-outs: what is driven with the tool up straight towards a stroke and away from it."""

from __future__ import annotations

import math

import numpy as np

from optplan.domain.arrays import FloatArray
from optplan.domain.options import ConnectOptions
from optplan.domain.path import RAISED, Path
from optplan.domain.report import Check
from optplan.domain.result import Cover
from optplan.judge._findings import GAP, Place, count_of, held, noted, place_of
from optplan.judge._integrate import Samples
from optplan.judge._strokes import runs

NAME = "padding"
Figures = list[tuple[str, float, str]]


def padding(path: Path, samples: Samples, cover: Cover | None, asked: ConnectOptions) -> tuple[Check, Figures]:
    """How many strokes lack the padding that was asked for, and the metres of it that are driven.

    Before a stroke the last `pad_before` metres, behind it the first `pad_after`, must be driven with the tool up, on
    the tangent of the stroke's end or, curved, on its circle of curvature. Stops have none.
    """
    if asked.pad_before == 0 and asked.pad_after == 0:
        return noted(NAME, 0.0, "", "No padding is asked for."), []
    lacking: list[Place] = []
    metres = 0.0
    strokes = () if cover is None else cover.strokes
    done = [run for run in runs(path) if not (run.stroke < len(strokes) and strokes[run.stroke].is_stop)]
    for run in done:
        begin = _pose(path.start[run.first], path.heading[run.first], path.curvature[run.first], asked)
        end = _pose(samples.ends[run.last], samples.end_heading[run.last], samples.end_curvature[run.last], asked)
        before = _driven(path, samples, run.first - 1, begin, -asked.pad_before)
        after = _driven(path, samples, run.last + 1, end, asked.pad_after)
        metres += (asked.pad_before if before else 0.0) + (asked.pad_after if after else 0.0)
        lacking += [place_of(pose) for pose, good in ((begin, before), (end, after)) if not good][:1]
    detail = "Every stroke has its run-in and run-out."
    if lacking:
        detail = f"{count_of(len(lacking), 'stroke')} of {len(done)} without the run-in or run-out that was asked for."
    check = held(NAME, len(lacking), 0, "", lacking[0] if lacking else None, detail)
    return check, [(NAME, metres, "m")]


def _pose(point: FloatArray, heading: float, curvature: float, asked: ConnectOptions) -> FloatArray:
    """(5,) x, y, z, heading, and the curvature that padding there has."""
    return np.array([*point, heading, curvature if asked.curved_padding else 0.0])


def _driven(path: Path, samples: Samples, row: int, pose: FloatArray, distance: float) -> bool:
    """Whether the pieces from a row on, backwards when `distance` is negative, begin with padding so long (m)."""
    gone, step = 0.0, 1 if distance > 0 else -1
    while abs(distance) - gone > GAP:
        if not 0 <= row < len(path) or path.tool[row] != RAISED or path.stroke[row] >= 0 or path.turn[row] != 0:
            return False
        if path.gear[row] < 0 and path.length[row] > 0:
            return False
        here = slice(int(samples.first[row]), int(samples.first[row + 1]))
        along = samples.along[here]
        away = gone + (along if step > 0 else float(path.length[row]) - along)
        use = away <= abs(distance) + GAP
        off = samples.points[here][use] - _expected(pose, step * away[use])
        if use.any() and float(np.linalg.norm(off, axis=1).max()) > 10 * GAP:
            return False
        gone += float(path.length[row])
        row += step
    return True


def _expected(pose: FloatArray, along: FloatArray) -> FloatArray:
    """(k, 3) places so far along a line or a circle through a pose, m."""
    half = pose[4] * along / 2
    chord = along * np.sinc(half / math.pi)
    places = np.tile(pose[:3], (len(along), 1))
    places[:, 0] += chord * np.cos(pose[3] + half)
    places[:, 1] += chord * np.sin(pose[3] + half)
    return places
