"""Ways around forbidden areas: connectors that keep a clearance from them.

A road map of states along the borders of the areas, some distance off, is searched for the shortest chain of
connectors: A* that looks at an edge only when it is about to be used, as in lazy road maps (R. Bohlin and L. E.
Kavraki, Path planning using lazy PRM, 2000). What is found is shortened by connectors between states along it.
"""

from __future__ import annotations

import heapq
import math
from abc import ABC, abstractmethod
from collections.abc import Iterator
from functools import cached_property
from itertools import pairwise
from typing import Any, NamedTuple

import numpy as np

from optplan.connectors.families import family_of
from optplan.connectors.pace import Pace
from optplan.connectors.surroundings import ROUND, Surroundings, surroundings_of
from optplan.domain.arrays import FloatArray
from optplan.domain.errors import InputError
from optplan.domain.options import Options
from optplan.domain.result import Cover
from optplan.domain.robot import Robot
from optplan.geometry.cc import cc_lengths, cc_matrix, cc_path
from optplan.geometry.curves import Curve, evaluate, joined, part
from optplan.geometry.reversing import reversing_path

LEVELS = (0.05, 0.5, 1.5)
"""Distances of road-map states from what is forbidden, in least turning radii."""
MOST_STATES = 360
"""Of a road map: all connectors between them are measured."""
SHORTCUTS = 32
"""States along a way between which shorter connectors are looked for."""
SAG = 1e-3
"""Distance between a curve and the chords it is checked by, in least turning radii."""


class Way(NamedTuple):
    """A connector that keeps out of forbidden areas, or why there is none."""

    curves: tuple[Curve, ...]
    """in driving order: one of continuous curvature, or lines between which the robot turns; none: there is no way"""
    source: str
    """ "direct", "another speed", "road map" or "shortened", or "in one gear" where others change it; without a curve,
    what is the matter"""
    gear: int = 1
    """of a way that is not direct: 1 forwards, -1 backwards"""

    @property
    def length(self) -> float:
        """m; infinite when there is no way"""
        return sum(curve.total for curve in self.curves) if self.curves else math.inf


class Roads(ABC):
    """States along the borders of what is forbidden, and connectors between them; states are rows (k, d)."""

    def __init__(self, surroundings: Surroundings) -> None:
        self.surroundings = surroundings
        self._known: dict[tuple[int, int], bool] = {}

    @cached_property
    @abstractmethod
    def states(self) -> FloatArray:
        """(n, d)"""

    @cached_property
    @abstractmethod
    def lengths(self) -> FloatArray:
        """(n, n) m of connectors between the states, whether they keep out or not."""

    @abstractmethod
    def measured(self, starts: FloatArray, ends: FloatArray) -> FloatArray:
        """Lengths (k,) m of connectors between rows of states, that heed nothing."""

    @abstractmethod
    def clear(self, start: FloatArray, end: FloatArray) -> bool:
        """Whether the connector between two states keeps out."""

    @abstractmethod
    def between(self, start: FloatArray, end: FloatArray) -> Way:
        """A short connector between states (4,) x, y, heading, curvature that keeps out.

        There is none when an end is inside a forbidden area, when the areas separate the ends, or when no way was
        found along the road map (which proves nothing: a narrow place may have been missed).
        """

    def open(self, u: int, v: int) -> bool:
        """Whether the connector between two states of the road map keeps out; remembered."""
        if (u, v) not in self._known:
            self._known[u, v] = self.clear(self.states[u], self.states[v])
        return self._known[u, v]

    def refused(self, start: FloatArray, end: FloatArray) -> str:
        """Why there can be no way between two places, or "" when there may be one."""
        for name, place in (("start", start[:2]), ("end", end[:2])):
            if not self.surroundings.clear(place[None]):
                return f"the {name} ({place[0]:g}, {place[1]:g}) lies inside a forbidden area or its clearance"
        if not self.surroundings.connected(start[:2], end[:2]):
            return "forbidden areas separate the ends: there is no way around"
        return ""


class StraightRoads(Roads):
    """For a robot that turns on the spot: lines between the corners of what is forbidden; the ways are shortest."""

    @cached_property
    def states(self) -> FloatArray:
        import shapely

        # a hair away from the border, on which predicates would hang on the last digit
        size = 1e-7 * (1 + float(np.abs(self.surroundings.forbidden.bounds).max()))
        corners = shapely.get_coordinates(self.surroundings.forbidden.buffer(size, join_style="mitre"))
        corners = np.unique(corners, axis=0)
        return corners[[self.surroundings.clear(corner[None]) for corner in corners]]

    @cached_property
    def lengths(self) -> FloatArray:
        lengths: FloatArray = np.linalg.norm(self.states[:, None] - self.states, axis=2)
        return lengths

    def measured(self, starts: FloatArray, ends: FloatArray) -> FloatArray:
        lengths: FloatArray = np.linalg.norm(starts[:, :2] - ends[:, :2], axis=1)
        return lengths

    def clear(self, start: FloatArray, end: FloatArray) -> bool:
        return self.surroundings.clear(np.array([start[:2], end[:2]]))

    def between(self, start: FloatArray, end: FloatArray) -> Way:
        if self.clear(start, end):
            stations, source = [start[:2], end[:2]], "direct"
        else:
            refused = self.refused(start, end)
            found = None if refused else _search(start[:2], end[:2], self)
            if found is None:
                return Way((), refused or "no way around was found")
            stations, source = found, "road map"
        curves = []
        for here, there in pairwise(stations):
            step = there - here
            length = math.hypot(*step)
            if length > 0:
                line = np.array([*here, math.atan2(step[1], step[0])])
                curves.append(Curve(line, np.zeros(1), np.zeros(1), np.array([length])))
        return Way(tuple(curves), source if curves else "the ends are the same")


class CurvedRoads(Roads):
    """Connectors of continuous curvature under limits (1/m, 1/m^2); the direct ones as fast as a pace allows."""

    def __init__(
        self, surroundings: Surroundings, curvature: float, sharpness: float, pace: Pace | None = None
    ) -> None:
        super().__init__(surroundings)
        self.curvature, self.sharpness, self.sag, self.pace = curvature, sharpness, SAG / curvature, pace

    @cached_property
    def states(self) -> FloatArray:
        """Along the borders of what is forbidden, both ways round, at several distances."""
        import shapely

        radius = 1 / self.curvature
        rings: list[Any] = []
        for level in LEVELS:
            for polygon in shapely.get_parts(self.surroundings.forbidden.buffer(level * radius, quad_segs=ROUND)):
                rings += [polygon.exterior, *polygon.interiors]
        spacing = max(0.5 * radius, 2 * sum(ring.length for ring in rings) / MOST_STATES)
        states: list[FloatArray] = [np.zeros((0, 4))]
        for ring in rings:
            count = max(4, math.ceil(ring.length / spacing))
            at = np.arange(count) * ring.length / count
            points, ahead, back = (
                shapely.get_coordinates(shapely.line_interpolate_point(ring, (at + shift) % ring.length))
                for shift in (0.0, 1e-3 * spacing, -1e-3 * spacing)
            )
            heading = np.arctan2(ahead[:, 1] - back[:, 1], ahead[:, 0] - back[:, 0])
            free = np.array([self.surroundings.clear(point[None]) for point in points])
            for turn in (0.0, math.pi):
                states.append(np.column_stack([points, heading + turn, np.zeros(count)])[free])
        return np.concatenate(states)

    @cached_property
    def lengths(self) -> FloatArray:
        return cc_matrix(self.states, self.states, self.curvature, self.sharpness)

    def measured(self, starts: FloatArray, ends: FloatArray) -> FloatArray:
        return cc_lengths(starts, ends, self.curvature, self.sharpness)

    def connector(self, start: FloatArray, end: FloatArray) -> Curve | None:
        """The shortest connector that heeds nothing; None when both states are the same."""
        made = cc_path(start, end, self.curvature, self.sharpness)
        return Curve(start[:3], made.curvatures, made.sharpnesses, made.lengths) if made.length > 0 else None

    def _direct(self, start: FloatArray, end: FloatArray) -> Iterator[Curve | None]:
        """Connectors that heed nothing: the shortest, or with a pace those of its speeds, the fastest first."""
        if self.pace is None:
            yield self.connector(start, end)
            return
        times = self.pace.by_rung(start[None], end[None])[:, 0]
        for rung in np.argsort(times, kind="stable")[: int(np.isfinite(times).sum())].tolist():
            made = cc_path(start, end, *self.pace.rungs[rung])
            yield Curve(start[:3], made.curvatures, made.sharpnesses, made.lengths) if made.length > 0 else None

    def clear(self, start: FloatArray, end: FloatArray) -> bool:
        curve = self.connector(start, end)
        return curve is None or self.surroundings.allows(curve, self.sag)

    def between(self, start: FloatArray, end: FloatArray) -> Way:
        for rank, direct in enumerate(self._direct(start, end)):
            if direct is None:
                return Way((), "the ends are the same")
            if self.surroundings.allows(direct, self.sag):
                return Way((direct,), "another speed" if rank else "direct")
        refused = self.refused(start, end)
        stations = None if refused else _search(start, end, self)
        if stations is None:
            return Way((), refused or "no way around was found within the limits of curvature")
        legs = [self.connector(here, there) for here, there in pairwise(stations)]
        chain = joined(*(leg for leg in legs if leg is not None))
        shorter = _shortened(chain, self)
        return Way((shorter,), "shortened") if shorter.total < chain.total * (1 - 1e-9) else Way((chain,), "road map")


class ReversingRoads(CurvedRoads):
    """Connectors that may change gear. Where these would enter, the way around is driven in one gear, the better."""

    def between(self, start: FloatArray, end: FloatArray) -> Way:
        made = reversing_path(start, end, self.curvature, self.sharpness)
        direct = made.curves(start[:3])
        if not direct:
            return Way((), "the ends are the same")
        if all(self.surroundings.allows(curve, self.sag) for curve in direct):
            return Way(direct, "direct")
        forwards = super().between(start, end)
        backwards = super().between(*(np.array([*at[:2], at[2] + math.pi, -at[3]]) for at in (start, end)))
        if not (forwards.curves or backwards.curves):
            return forwards
        if backwards.length < forwards.length * (1 - 1e-9):
            return Way(backwards.curves, "in one gear", -1)
        return Way(forwards.curves, "in one gear")


def roads_of(cover: Cover, robot: Robot, options: Options) -> Roads | None:
    """The road map that a plan's connectors need; None when nothing is forbidden.

    Raises
    ------
    InputError : areas that are none, or a metric without ways around
    """
    surroundings = surroundings_of(cover, options)
    if surroundings is None:
        return None
    family = family_of(robot, options)
    if family.metric == "dubins":
        raise InputError("there are no ways around areas under the metric 'dubins'; expected 'cc'")
    if family.reversing:
        return ReversingRoads(surroundings, 1 / family.radius, family.sharpness)
    if family.curved:
        return CurvedRoads(surroundings, 1 / family.radius, family.sharpness, family.pace)
    return StraightRoads(surroundings)


def way_around(
    start: FloatArray, end: FloatArray, curvature: float, sharpness: float, surroundings: Surroundings
) -> Way:
    """A short connector of continuous curvature that keeps out of forbidden areas.

    Parameters
    ----------
    start, end : (4,) x, y, heading, curvature: m, m, rad, 1/m
    curvature, sharpness : limits, 1/m and 1/m^2, > 0
    surroundings : what is forbidden

    Raises
    ------
    InputError : what `cc_path` raises
    """
    first, last = np.asarray(start, dtype=np.float64), np.asarray(end, dtype=np.float64)
    return CurvedRoads(surroundings, curvature, sharpness).between(first, last)


def _search(start: FloatArray, end: FloatArray, roads: Roads) -> list[FloatArray] | None:
    """The states of the shortest chain through the road map: A* with edges looked at when they come first."""
    states, count = roads.states, len(roads.states)
    if count == 0:
        return None
    first = roads.measured(np.tile(start, (count, 1)), states)
    last = roads.measured(states, np.tile(end, (count, 1)))
    # what is left is at least as long as the connector that heeds nothing
    left = np.append(last, 0.0)
    settled = np.zeros(count + 1, dtype=np.bool_)
    before = np.full(count + 1, -1)
    queue = [(float(first[k] + left[k]), float(first[k]), -1, k) for k in range(count)]
    heapq.heapify(queue)
    while queue and not settled[count]:
        _, gone, u, v = heapq.heappop(queue)
        if settled[v]:
            continue
        if u >= 0 and v < count:
            good = roads.open(u, v)
        else:
            good = roads.clear(start if u < 0 else states[u], end if v == count else states[v])
        if not good:
            continue
        settled[v], before[v] = True, u
        if v < count:
            steps = np.append(roads.lengths[v], last[v])
            for w in np.flatnonzero(~settled).tolist():
                far = gone + float(steps[w])
                heapq.heappush(queue, (far + float(left[w]), far, v, w))
    if not settled[count]:
        return None
    chain, v = [end], int(before[count])
    while v >= 0:
        chain.append(states[v])
        v = int(before[v])
    return [start, *chain[::-1]]


def _shortened(curve: Curve, roads: CurvedRoads) -> Curve:
    """The shortest chain of connectors between states along a curve, again until nothing is gained."""
    for _ in range(4):
        at = evaluate(curve, np.linspace(0, curve.total, SHORTCUTS))
        bend = np.clip(at.curvature, -roads.curvature, roads.curvature)
        states = np.column_stack([at.points, at.heading, bend])
        i, j = np.triu_indices(SHORTCUTS, 1)
        lengths = np.full((SHORTCUTS, SHORTCUTS), np.inf)
        lengths[i, j] = roads.measured(states[i], states[j])
        # backwards from the end, the most promising first; only what would be used is looked at
        best, following = np.full(SHORTCUTS, np.inf), np.zeros(SHORTCUTS, dtype=np.int64)
        best[-1] = 0.0
        along = curve.total / (SHORTCUTS - 1)
        for k in range(SHORTCUTS - 2, -1, -1):
            # to stay on the curve is always allowed
            best[k], following[k] = best[k + 1] + along, -(k + 1)
            total = lengths[k] + best
            for m in np.argsort(total).tolist():
                if total[m] >= best[k] - 1e-9 * curve.total:
                    break
                if roads.clear(states[k], states[m]):
                    best[k], following[k] = total[m], m
                    break
        parts, k = [], 0
        while k < SHORTCUTS - 1:
            m = int(following[k])
            if m > 0:
                parts.append(roads.connector(states[k], states[m]))
            else:
                m = -m
                parts.append(part(curve, k * along, min(m * along, curve.total)))
            k = m
        made = joined(*(curve for curve in parts if curve is not None))
        if made.total >= curve.total * (1 - 1e-4):
            return made if made.total < curve.total else curve
        curve = made
    return curve
