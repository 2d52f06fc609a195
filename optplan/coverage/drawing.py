"""A drawing's strokes: outlines as they are drawn, areas as parallel lines."""

from __future__ import annotations

from dataclasses import replace
from itertools import pairwise
from typing import TYPE_CHECKING, NamedTuple

import numpy as np

from optplan.coverage.placing import Line, canvas_of, counter_clockwise, placed, placement
from optplan.coverage.relations import connections, inner_before_outer, of_pieces
from optplan.coverage.splitting import direction_notes, split_at_stops
from optplan.coverage.stops import tight_notes, tolerance_of
from optplan.coverage.zigzag import zigzag
from optplan.domain.arrays import FloatArray
from optplan.domain.errors import InputError, LimitError, located
from optplan.domain.job import Drawing, FillSettings, Note
from optplan.domain.options import CoverOptions, Options
from optplan.domain.ordering import precedence_cycle
from optplan.domain.path import RAISED
from optplan.domain.progress import Progress, ProgressCallback
from optplan.domain.result import Area, Cover
from optplan.domain.robot import Canvas, Robot, Tool
from optplan.domain.stroke import Stroke
from optplan.geometry.regions import region
from optplan.jobs.syntax import Mark, interpret

if TYPE_CHECKING:
    from shapely import Polygon

SAME_POINT = 1e-8
"""m within which neighbouring points of a fill are one."""
LOST = 0.05
"""Share of an area that may stay untouched without a notice: the corners of any fill."""
REACHED = 0.8
"""Share of an area that a tool setting has to reach to be the one that fills it."""
MAX_STROKES = 100_000
"""Most strokes that one plan may have."""


def cover_drawing(job: Drawing, robot: Robot, options: Options, progress: ProgressCallback) -> Cover:
    """Strokes, areas, start point and precedence of a drawing on its canvas. Raises InputError; see `cover`."""
    job = _with_settings(job, options.cover)
    read = interpret(job, robot.tool)
    drawn = [mark for mark in read.marks if mark.drawn]
    if not drawn:
        reason = "every element is white, without style, or a start point"
        raise InputError(f"nothing in this drawing is to be drawn: {reason}", job.name)
    canvas = canvas_of(options.page, robot)
    notes = [*read.notes, *_loop_note(robot, canvas, options)]
    if canvas is None:
        notes.append(Note("notice", robot.name, "has no canvas: the drawing keeps the size it has on paper"))
    tolerance = tolerance_of(options.page, robot.tool)
    with located(job.name):
        where = placement([mark.element for mark in read.marks if mark.drawn or mark.start], canvas)

    strokes: list[Stroke] = []
    areas: list[Area] = []
    vertices: dict[str, FloatArray] = {}
    for done, mark in enumerate(drawn):
        progress(Progress("cover", done / len(drawn), message=mark.element.id))
        lines = placed(mark.element, where, tolerance)
        if not lines:
            notes.append(Note("ignored", mark.element.id, "has no extent on the canvas"))
            continue
        outlines = _outlines(mark, lines)
        vertices |= {stroke.id: line.drawn for stroke, line in zip(outlines, lines, strict=False)}
        strokes += outlines
        if mark.fill:
            new, made = _filled(mark, lines, robot.tool, options.cover, notes)
            strokes += new
            areas += made
        if len(strokes) > MAX_STROKES:
            raise LimitError(f"there are more than {MAX_STROKES} strokes; widen the fill spacing or split it", job.name)
    notes += tight_notes(strokes, robot, options, progress)
    inner = inner_before_outer(strokes) if options.cover.inner_first else []
    strokes, source = split_at_stops(strokes, robot, options)
    notes += direction_notes(strokes, robot, options)
    if not strokes:
        raise InputError("nothing in this drawing is to be drawn on this canvas", job.name)
    travels = [k for k, stroke in enumerate(strokes) if stroke.tool == RAISED]
    rules = [*pairwise(travels), *of_pieces(inner, source)]
    with located(job.name):
        links = connections(options.cover.links, strokes, vertices)
        _refuse_contradictions(strokes, rules)
    progress(Progress("cover", 1.0, message=f"{len(strokes)} strokes"))
    start = None if read.start is None else where.apply(read.start[None, :])[0]
    begin = None if start is None else (float(start[0]), float(start[1]))
    return Cover(tuple(strokes), tuple(areas), tuple(rules), begin, canvas, tuple(notes), links)


def _refuse_contradictions(strokes: list[Stroke], rules: list[tuple[int, int]]) -> None:
    cycle = precedence_cycle(len(strokes), np.array(rules, dtype=np.int64).reshape(-1, 2))
    if cycle:
        names = " before ".join(strokes[k].id for k in cycle)
        raise InputError(f"travel drawn by hand contradicts 'inner first': {names}")


def _loop_note(robot: Robot, canvas: Canvas | None, options: Options) -> list[Note]:
    """A notice when a robot that cannot turn on the spot has little room for its turning loops."""
    if canvas is None or not robot.heading_counts:
        return []
    curvature = robot.mobility.curvature_limits(options.time.speeds(robot.mobility)[1]).curvature
    if curvature <= 0 or canvas.margin >= 3 / curvature:
        return []
    text = (
        f"turns in loops of {1 / curvature:.2g} m radius, which may leave a canvas with a margin of {canvas.margin:g} m"
    )
    return [Note("notice", robot.name, text)]


def _with_settings(job: Drawing, options: CoverOptions) -> Drawing:
    for id, wanted in options.elements:
        own = next((element.fill_settings for element in job.elements if element.id == id), FillSettings())
        merged = FillSettings(
            own.direction if wanted.direction is None else wanted.direction,
            own.spacing if wanted.spacing is None else wanted.spacing,
            own.inset if wanted.inset is None else wanted.inset,
        )
        job = job.with_element(id, fill_settings=merged)
    return job


def _outlines(mark: Mark, lines: list[Line]) -> list[Stroke]:
    if mark.outline is None:
        return []
    names = [mark.element.id] if len(lines) == 1 else [f"{mark.element.id}.{k}" for k in range(1, len(lines) + 1)]
    return [
        Stroke(
            name,
            # a ring to travel along is a line that comes back
            np.concatenate([line.points, line.points[:1]]) if line.closed and mark.outline == RAISED else line.points,
            tool=mark.outline,
            closed=line.closed and mark.outline != RAISED,
            directed=mark.outline == RAISED,
            entry=_entry(mark, line, name),
            element=mark.element.id,
            layer=mark.layer,
        )
        for name, line in zip(names, lines, strict=True)
    ]


def _entry(mark: Mark, line: Line, name: str) -> int | None:
    """The vertex of the polyline that is the drawn vertex at which the element must be entered."""
    wanted: int | None = mark.element.entry
    if wanted is None:
        return None
    if not 0 <= wanted < len(line.drawn):
        raise InputError(f"must be entered at vertex {wanted}; it has the vertices 0..{len(line.drawn) - 1}", name)
    vertex = int(np.argmin(np.linalg.norm(line.points - line.drawn[wanted], axis=1)))
    if not line.closed and vertex not in (0, len(line.points) - 1):
        raise InputError(f"must be entered at vertex {wanted}; an open line can only be entered at its ends", name)
    return vertex


def _filled(
    mark: Mark, lines: list[Line], tool: Tool, options: CoverOptions, notes: list[Note]
) -> tuple[list[Stroke], list[Area]]:
    import shapely

    element = mark.element
    polygons, crossed = region([line.points for line in lines], element.fill_rule)
    if crossed:
        notes.append(Note("changed", element.id, f"crosses itself; filled by the {element.fill_rule.value} rule"))
    if not polygons:
        notes.append(Note("ignored", element.id, "its fill encloses no area"))
    strokes: list[Stroke] = []
    areas: list[Area] = []
    for polygon in polygons:
        setting = _fitting(polygon, tool)
        if setting != tool.fill:
            text = f"too narrow for {tool.settings[tool.fill].name!r}: filled with {tool.settings[setting].name!r}"
            notes.append(Note("changed", element.id, text))
        width = tool.settings[setting].width
        asked = _asked(element.fill_settings, options, width)
        with located(element.id):
            new, kept = _fill_polygon(polygon, asked, width, options.boundary)
        if kept < asked.inset:
            text = f"too narrow for lines {asked.inset:.3g} m inside its outline; they keep {kept:.3g} m"
            notes.append(Note("changed", element.id, text))
        oriented = shapely.orient_polygons(polygon)
        rings = [oriented.exterior, *oriented.interiors]
        area = Area(element.id, tuple(np.array(ring.coords)[:-1] for ring in rings), setting)
        lost = _lost(area, new, width)
        if lost > LOST:
            text = f"{100 * lost:.0f} % of an area stays untouched: corners and places too narrow for the tool"
            notes.append(Note("notice", element.id, text))
        areas.append(area)
        strokes += [replace(stroke, tool=setting) for stroke in new]
    named = [
        replace(stroke, id=f"{element.id}/fill.{k}", element=element.id, layer=mark.layer)
        for k, stroke in enumerate(strokes, start=1)
    ]
    return named, areas


def _fitting(polygon: Polygon, tool: Tool) -> int:
    """The widest setting, up to the one that fills areas, that reaches most of a polygon."""
    usual = tool.settings[tool.fill].width
    narrower = [k for k in range(1, len(tool.settings)) if tool.settings[k].width <= usual]
    by_width = sorted(narrower, key=lambda k: -tool.settings[k].width)
    for k in by_width:
        half = tool.settings[k].width / 2
        if polygon.buffer(-half, join_style="mitre").buffer(half, join_style="mitre").area >= REACHED * polygon.area:
            return k
    return by_width[-1]


def _asked(own: FillSettings, options: CoverOptions, width: float) -> _Asked:
    return _Asked(
        options.direction if own.direction is None else own.direction,
        own.spacing or options.spacing or width,
        # with a border, lines run up to the middle of its mark
        next((inset for inset in (own.inset, options.inset) if inset is not None), width / 2),
    )


class _Asked(NamedTuple):
    """Fill settings with every choice made: rad, m, m."""

    direction: float
    spacing: float
    inset: float


def _fill_polygon(polygon: Polygon, asked: _Asked, width: float, boundary: bool) -> tuple[list[Stroke], float]:
    """Strokes of one polygon, and the inset that its lines keep, m."""
    strokes = _border(polygon, width) if boundary else []
    fill = zigzag(polygon, asked.direction, asked.spacing, asked.inset, width if strokes else 0.0)
    lines = [points for points in map(_apart, fill.strokes) if len(points) > 1]
    return [*strokes, *(Stroke("", points) for points in lines)], fill.inset


def _border(polygon: Polygon, width: float) -> list[Stroke]:
    """Closed strokes half a tool width inside the outline; none where the polygon is narrower than the tool."""
    import shapely

    strokes = []
    for part in shapely.get_parts(polygon.buffer(-width / 2, join_style="mitre")):
        for ring in () if part.is_empty else (part.exterior, *part.interiors):
            around = _apart(np.array(ring.coords)[:-1])
            if np.abs(around[-1] - around[0]).max() <= SAME_POINT:
                around = around[:-1]
            if len(around) > 2:
                strokes.append(Stroke("", counter_clockwise(around), closed=True))
    return strokes


def _apart(points: FloatArray) -> FloatArray:
    """Points without those that all but coincide with the one before: insets leave such."""
    keep = np.concatenate([[True], np.any(np.abs(np.diff(points, axis=0)) > SAME_POINT, axis=1)])
    kept: FloatArray = points[keep]
    return kept


def _lost(area: Area, strokes: list[Stroke], width: float) -> float:
    """Share of an area that the marks of its fill leave untouched."""
    import shapely

    wanted = shapely.Polygon(area.rings[0], area.rings[1:])
    lines = [shapely.LineString(stroke.closed_points) for stroke in strokes]
    done = shapely.union_all(shapely.buffer(lines, width / 2, quad_segs=4))
    return float(shapely.difference(wanted, done).area / wanted.area)
