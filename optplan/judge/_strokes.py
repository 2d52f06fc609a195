"""Whether every stroke was done: once, where it should be, with its own tool and in a legal order."""

from __future__ import annotations

from dataclasses import dataclass
from itertools import pairwise

import numpy as np

from optplan.domain.arrays import BoolArray, FloatArray
from optplan.domain.path import RAISED, Path
from optplan.domain.report import Check, Verdict
from optplan.domain.result import Cover
from optplan.domain.robot import Robot
from optplan.domain.stroke import Stroke, Traversals
from optplan.judge._findings import GAP, Place, count_of, held, noted, place_of
from optplan.judge._integrate import Samples
from optplan.judge._trace import Trace, arc_lengths, in_space, trace

NEAR = 0.005
"""m: what counts as on the line in the figure `within 5 mm`."""
Figures = list[tuple[str, float, str]]
_TWICE = 1.75
"""Driven length over stroke length from which a stroke counts as driven twice in one go."""


@dataclass(frozen=True)
class Run:
    """Consecutive pieces of one stroke: rows first .. last."""

    stroke: int
    first: int
    last: int


def runs(path: Path) -> list[Run]:
    """The path cut into strokes. A stop between two pieces of a stroke belongs to it, however it is labelled."""
    rows = np.flatnonzero(~(path.is_stop & (path.stroke < 0)))
    if len(rows) == 0:
        return []
    label = path.stroke[rows]
    cuts = np.flatnonzero(np.diff(label) != 0)
    first, last = np.append(0, cuts + 1), np.append(cuts, len(rows) - 1)
    return [Run(int(label[a]), int(rows[a]), int(rows[b])) for a, b in zip(first, last, strict=True) if label[a] >= 0]


def strokes(path: Path, samples: Samples, cover: Cover, limit: float) -> tuple[Check, Check, BoolArray, Figures]:
    """The checks `strokes` (how many are not done exactly once as they should be) and `deviation` (m).

    Also (n,) which strokes were driven faultlessly along their own points, to within `GAP`: their marks are theirs; and
    the mean deviation, with the share of the driven length that is within `NEAR` of its stroke.
    """
    aside = _Aside()
    exact = np.zeros(len(cover.strokes), dtype=bool)
    faults: dict[int, str] = {}
    where: dict[int, Place] = {}
    seen: dict[int, int] = {}
    farthest, spot, culprit = 0.0, None, ""
    for run in runs(path):
        where.setdefault(run.stroke, place_of(path.start[run.first]))
        seen[run.stroke] = seen.get(run.stroke, 0) + 1
        if run.stroke >= len(cover.strokes):
            faults[run.stroke] = "is driven, but there is no such stroke"
            continue
        stroke = cover.strokes[run.stroke]
        points = _driven(samples, run)
        found = trace(points, stroke, limit)
        if spot is None or found.deviation > farthest:
            farthest, spot, culprit = found.deviation, place_of(found.place), stroke.id
        aside.add(points, stroke, found.deviation)
        fault = _fault(path, run, stroke, found, float(arc_lengths(points)[-1]), limit)
        exact[run.stroke] = found.deviation <= GAP
        if fault:
            faults.setdefault(run.stroke, fault)
    for index, stroke in enumerate(cover.strokes):
        times = seen.get(index, 0)
        if times != 1:
            faults[index] = "is not driven" if times == 0 else f"is driven {times} times"
            where.setdefault(index, place_of(stroke.points[0]))
    exact[[k for k in faults if k < len(exact)]] = False
    names = [stroke.id for stroke in cover.strokes]
    detail = f"{count_of(len(names), 'stroke')}, each driven once with its own tool."
    if faults:
        told = [f"{names[k] if k < len(names) else k!r} {text}" for k, text in sorted(faults.items())]
        detail = "; ".join(told[:3]) + (f"; and {len(told) - 3} more." if len(told) > 3 else ".")
    place = where[min(faults)] if faults else None
    done = held("strokes", len(faults), 0, "", place, detail)
    detail = f"Stroke {culprit} is followed least closely." if culprit else "No stroke is driven."
    return done, held("deviation", farthest, limit, "m", spot, detail, slack=GAP), exact, aside.figures()


class _Aside:
    """How far driven lines are beside their strokes, over all of their length."""

    def __init__(self) -> None:
        self.length = self.sum = self.near = 0.0

    def add(self, points: FloatArray, stroke: Stroke, most: float) -> None:
        """Points (n, 3) driven for a stroke, none farther away than `most`, m."""
        step = np.linalg.norm(np.diff(points, axis=0), axis=1)
        total = float(step.sum())
        self.length += total
        if most <= GAP or stroke.points.shape[1] == 3:
            self.near += total if most <= NEAR else 0.0
            self.sum += most * total
            return
        import shapely

        ways = [stroke.facing(k) for k in range(stroke.headings)]
        lines = [
            shapely.linestrings(way.closed_points) if not way.is_stop else shapely.points(*way.points[0])
            for way in ways
        ]
        shapely.prepare(lines)
        spots = shapely.points(points[:, :2])
        away = min((shapely.distance(line, spots) for line in lines), key=lambda found: float(found.sum()))
        # between two points the distance changes evenly
        low, high = np.minimum(away[1:], away[:-1]), np.maximum(away[1:], away[:-1])
        self.sum += float(((low + high) / 2 * step).sum())
        share = np.clip((NEAR - low) / np.maximum(high - low, GAP * NEAR), 0, 1)
        self.near += float((step * share).sum())

    def figures(self) -> Figures:
        """mean deviation, m, and the share of the length within `NEAR`"""
        if self.length == 0:
            return []
        share = min(self.near / self.length, 1.0)
        return [("mean deviation", self.sum / self.length, "m"), ("within 5 mm", share, "")]


def precedence(path: Path, cover: Cover) -> Check:
    """Pairs of strokes driven in the wrong order."""
    first: dict[int, Run] = {}
    last: dict[int, Run] = {}
    for run in runs(path):
        first.setdefault(run.stroke, run)
        last[run.stroke] = run
    broken = [(a, b) for a, b in cover.precedence if a in last and b in first and last[a].first >= first[b].first]
    detail, place = f"{count_of(len(cover.precedence), 'rule')} of order, all kept.", None
    if broken:
        a, b = broken[0]
        place = place_of(path.start[first[b].first])
        detail = f"Stroke {cover.strokes[a].id} must come before {cover.strokes[b].id}"
        detail += f"; {len(broken)} of {len(cover.precedence)} rules of order are broken."
    return held("precedence", len(broken), 0, "", place, detail)


def connections(path: Path, samples: Samples, cover: Cover, limit: float) -> Check:
    """Enforced connections that the path does not follow: from one place directly to the other, in either direction.

    What is driven may begin and end beside the vertex by `limit`, m, as it may leave the line.
    """
    done = [run for run in runs(path) if run.stroke < len(cover.strokes)]
    lines = [_driven(samples, run) for run in done]
    followed: set[int] = set()
    for (one, left), (two, entered) in pairwise(zip(done, lines, strict=True)):
        for k, (a, i, b, j) in enumerate(cover.links):
            forth = (one.stroke, two.stroke) == (a, b)
            if forth or (one.stroke, two.stroke) == (b, a):
                ends = (cover.strokes[a].points[i], cover.strokes[b].points[j])
                out, into = ends if forth else ends[::-1]
                steps = (left[-1] - in_space(out[None])[0], entered[0] - in_space(into[None])[0])
                if max(float(np.linalg.norm(step)) for step in steps) <= limit + GAP:
                    followed.add(k)
    broken = [k for k in range(len(cover.links)) if k not in followed]
    detail, place = f"{count_of(len(cover.links), 'enforced connection')}, all driven.", None
    if broken:
        a, i, b, _ = cover.links[broken[0]]
        place = place_of(cover.strokes[a].points[i])
        detail = f"The path does not go directly between {cover.strokes[a].id} and {cover.strokes[b].id} as asked"
        detail += f"; {len(broken)} of {len(cover.links)} enforced connections are not driven."
    return held("connections", len(broken), 0, "", place, detail)


def visits(path: Path, samples: Samples, chosen: Traversals) -> Check:
    """How many of the chosen ways of driving the path does not follow, in this order and between these ends."""
    done = runs(path)
    wrong = []
    for k in range(max(len(done), len(chosen))):
        if k >= len(done) or k >= len(chosen) or done[k].stroke != chosen.stroke[k]:
            wrong.append(k)
            continue
        points = _driven(samples, done[k])
        ends = (points[0] - chosen.entry[k, :3], points[-1] - chosen.exit[k, :3])
        if max(float(np.linalg.norm(end)) for end in ends) > GAP:
            wrong.append(k)
    detail, place = "The path drives the chosen ways in their order.", None
    if wrong:
        k = wrong[0]
        detail = f"Visit {k} is the first of {len(wrong)} that the path does not drive as chosen."
        place = place_of(chosen.entry[k] if k < len(chosen) else path.start[done[k].first])
    return held("visits", len(wrong), 0, "", place, detail)


def tool(path: Path, robot: Robot) -> Check:
    """Metres with the tool down outside strokes; a tool setting that does not exist fails too."""
    outside = (path.tool > RAISED) & (path.stroke < 0)
    unknown = np.flatnonzero(path.tool >= len(robot.tool.settings))
    metres = float(path.length[outside].sum())
    places = np.append(unknown, np.flatnonzero(outside & (path.length > 0)))
    place = place_of(path.start[int(places[0])]) if len(places) else None
    if len(unknown):
        row = int(unknown[0])
        detail = f"Piece {row} uses tool setting {path.tool[row]}; the tool has 0..{len(robot.tool.settings) - 1}."
        return Check("tool", Verdict.FAILED, metres, 0.0, "m", place, detail)
    detail = "The tool is up between strokes." if metres == 0 else "The tool is down between strokes."
    return held("tool", metres, 0.0, "m", place, detail)


def canvas(path: Path, samples: Samples, marks: Samples, cover: Cover, tolerance: float) -> list[Check]:
    """The checks `canvas` and `margin`: how far the driven line goes beyond them, m.

    With the tool down that is the middle of the mark, with the tool up the middle of the robot. What is drawn lies
    within them, what is driven may leave that by the tolerance for rounding (m).
    """
    slack = tolerance + GAP
    if cover.canvas is None:
        return [noted(name, 0.0, "m", "There is no canvas.") for name in ("canvas", "margin")]
    size = np.array([cover.canvas.width, cover.canvas.height])
    if len(samples.points) == 0:
        return [held(name, 0.0, 0.0, "m", detail="Nothing is driven.") for name in ("canvas", "margin")]
    marking = path.tool[samples.row] > RAISED
    points = samples.points if marks is samples else np.where(marking[:, None], marks.points, samples.points)
    beyond = _beyond(points, size, 0.0)
    worst = int(np.argmax(beyond))
    detail = "All of the path is on the canvas." if beyond[worst] <= slack else "The path leaves the canvas."
    place = place_of(points[worst])
    outside = held("canvas", max(float(beyond[worst]), 0.0), 0.0, "m", place, detail, slack=slack)

    inside = _beyond(points, size, cover.canvas.margin)
    marked = np.where(marking, inside, 0.0)
    worst = int(np.argmax(marked))
    if marked[worst] > slack:
        place = place_of(points[worst])
        return [outside, held("margin", marked[worst], 0.0, "m", place, "Marks lie in the margin.", slack=slack)]
    worst = int(np.argmax(inside))
    if inside[worst] > slack:
        place = place_of(points[worst])
        return [outside, noted("margin", inside[worst], "m", "The robot travels through the margin.", place)]
    return [outside, held("margin", 0.0, 0.0, "m", detail="All of the path keeps out of the margin.")]


def _beyond(points: FloatArray, size: FloatArray, margin: float) -> FloatArray:
    """(k,) m beyond the border drawn in by `margin`; negative inside."""
    flat = points[:, :2]
    past: FloatArray = np.maximum(margin - flat, flat - (size - margin))
    worse: FloatArray = np.maximum(past[:, 0], past[:, 1])
    return worse


def _driven(samples: Samples, run: Run) -> FloatArray:
    """(k, 3) points of a run, each once, m."""
    points: FloatArray = samples.points[samples.first[run.first] : samples.first[run.last + 1]]
    apart = np.any(np.abs(np.diff(points, axis=0)) > 1e-12, axis=1)
    once: FloatArray = points[np.concatenate([[True], apart])]
    return once


def _fault(path: Path, run: Run, stroke: Stroke, found: Trace, length: float, limit: float) -> str:
    """What is wrong with the way a stroke was driven, besides where; empty when nothing is."""
    rows = slice(run.first, run.last + 1)
    used, stop = path.tool[rows], path.is_stop[rows]
    # a robot may raise its tool to turn on the spot
    wrong = used[(used != stroke.tool) & ~(stop & ((used == RAISED) & (not stroke.is_stop)))]
    if stroke.is_stop:
        wrong = wrong[wrong != RAISED] if (used == stroke.tool).any() else wrong
    if len(wrong):
        return f"is driven with tool setting {int(wrong[0])} instead of {stroke.tool}"
    if stroke.is_stop:
        dwell = float(path.dwell[rows][used == stroke.tool].sum())
        return f"is worked for {dwell:g} s instead of {stroke.dwell:g} s" if dwell < stroke.dwell * (1 - 1e-9) else ""
    if stroke.length > 2 * limit and length >= _TWICE * stroke.length:
        return f"is driven {length / stroke.length:.2g} times in one go"
    if stroke.directed and found.reverse:
        return "is driven against its direction"
    if stroke.entry is None:
        return ""
    if stroke.closed:
        return "" if _entered_at(stroke, found.begin, limit) else f"is not entered at vertex {stroke.entry}"
    begun = len(stroke.points) - 1 if found.reverse else 0
    return "" if begun == stroke.entry else f"is not entered at vertex {stroke.entry}"


def _entered_at(stroke: Stroke, begin: float, limit: float) -> bool:
    """Whether a closed stroke begun at this arc length was entered at its vertex. Where the vertex is rounded, the path
    begins a little beside it, but nearer to it than to any other."""
    along = arc_lengths(in_space(stroke.closed_points))
    apart = np.abs(along[:-1] - begin)
    apart = np.minimum(apart, along[-1] - apart)
    return bool(apart[stroke.entry] <= limit or int(np.argmin(apart)) == stroke.entry)
