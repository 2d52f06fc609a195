"""A field's strokes: lines and arcs, joined where they go on, cut where others meet them."""

from __future__ import annotations

import math
from dataclasses import replace
from itertools import pairwise
from typing import NamedTuple

import numpy as np

from optplan.coverage.clearing import refuse_bad_areas, stuck, with_free_ways
from optplan.coverage.splitting import direction_notes, split_at_stops
from optplan.coverage.stops import tolerance_of
from optplan.domain.arrays import FloatArray
from optplan.domain.errors import InputError, LimitError, located
from optplan.domain.job import ACTUATIONS, Field, FieldSegment, Note
from optplan.domain.options import Options
from optplan.domain.progress import Progress, ProgressCallback
from optplan.domain.result import Cover
from optplan.domain.robot import DiffDrive, Robot
from optplan.domain.stroke import Stroke
from optplan.geometry.crossings import Primitive, junctions
from optplan.geometry.tangents import meets

TOUCH = 0.01
"""m within which lines meet."""
GOES_ON = 1e-3
"""rad within which a line goes on where another ends, and 1e-3 m."""
SHORTEST = 1.9
"""Shortest piece of a line that is cut, m."""
SAG = 1e-4
"""Between an arc and the chords that stand for it, m; less for tools of less tolerance."""
ARC_POINTS = 16
"""Points of a circle are a multiple of this: so many entries are evenly spread."""
MOST_TIMED = 200
"""Most strokes whose order is chosen by time, unless that is asked for: it takes several times as long as metres."""
MAX_STROKES = 5000
"""Most strokes of a field: logos and all."""


class Chain(NamedTuple):
    """Lines and arcs, each going on where the one before ends, that are marked in one go."""

    parts: tuple[Primitive, ...]
    closed: bool
    segment: FieldSegment
    """the first of them"""
    id: str
    inner: bool = False
    """whether it lies between other lines of one wide segment: these do for cutting others"""
    members: tuple[Chain, ...] = ()
    """what it was joined of"""

    @property
    def length(self) -> float:
        """m"""
        return sum(part.length for part in self.parts)


def cover_field(job: Field, robot: Robot, options: Options, progress: ProgressCallback) -> Cover:
    """Strokes of a field, and what happened on the way. Raises InputError; see `cover`."""
    with located(job.name):
        notes = list(job.notes)
        marked = [segment for segment in job.segments if segment.actuation != "NONE"]
        notes += [
            Note("ignored", s.id, "is not marked: the plan finds its own ways between marks")
            for s in job.segments
            if s.actuation == "NONE"
        ]
        notes += _width_notes(marked, job, robot)
        if not marked:
            raise InputError("nothing is to be marked; expected a segment whose actuation is not NONE")
        refuse_bad_areas(job, options)
        spots = [segment for segment in marked if segment.spot > 0]
        _refuse_too_many(marked, job, robot)
        chains = [part for segment in marked if segment.spot == 0 for part in _wide(segment, job, robot)]
        progress(Progress("cover", 0.1, message=f"{len(marked)} segments"))
        tolerance, areas = tolerance_of(options.page, robot.tool), with_areas(job, robot, options)
        chains = _apart(_joined(chains), robot, areas, tolerance)
        pieces = _cut(chains) if options.cover.cut else chains
        strokes = [_stroke(piece, robot, tolerance) for piece in pieces]
        strokes += [_spot(segment, number, robot, options) for segment in spots for number in range(segment.passes)]
        order = {segment.id: k for k, segment in enumerate(job.segments)}
        strokes.sort(key=lambda stroke: order[stroke.element])  # stable: pieces keep their order
        _refuse_obstructed(strokes, job, options)
        strokes, _ = split_at_stops(strokes, robot, options)
        notes += direction_notes(strokes, robot, options)
        strokes, lost = with_free_ways(strokes, robot, areas)
        notes += lost
        progress(Progress("cover", 1.0, message=f"{len(strokes)} strokes"))
        return Cover(tuple(strokes), start=job.start, notes=tuple(notes))


def with_areas(job: Field, robot: Robot, options: Options) -> Options:
    """Options that mind the areas of a field, too, at a distance of half the robot's width unless they name one."""
    if job.keep_in is None and not job.keep_out:
        return options
    asked = options.connect
    rings = tuple(tuple((float(x), float(y)) for x, y in ring) for ring in job.keep_out)
    room = asked.keep_in
    if room is None and job.keep_in is not None:
        room = tuple((float(x), float(y)) for x, y in job.keep_in)
    clearance = asked.clearance
    if clearance == 0 and isinstance(robot.mobility, DiffDrive):
        clearance = robot.mobility.track / 2
    kept = asked.keep_out + tuple(ring for ring in rings if ring not in asked.keep_out)
    return replace(options, connect=replace(asked, keep_out=kept, keep_in=room, clearance=clearance))


def with_metric(made: Cover, robot: Robot, options: Options) -> Options:
    """Options that name what "auto" means for a field: the least time, or curvature that is continuous at least, for a
    robot that cannot turn on the spot."""
    if options.order.metric != "auto" or not robot.heading_counts:
        return options
    timed = options.time.constant_speed is None and options.connect.padding == 0 and not options.connect.reversing
    metric = "time" if timed and len(made.strokes) <= MOST_TIMED else "cc"
    return replace(options, order=replace(options.order, metric=metric))


def _refuse_obstructed(strokes: list[Stroke], job: Field, options: Options) -> None:
    """InputError where a line runs into an obstacle or leaves the area that the robot stays in."""
    import shapely

    lines = [shapely.LineString(stroke.closed_points[:, :2]) for stroke in strokes]
    names = [stroke.element for stroke in strokes]
    for number, ring in enumerate((*job.keep_out, *map(np.array, options.connect.keep_out))):
        for name, found in zip(names, shapely.intersects(lines, shapely.Polygon(ring)), strict=True):
            if found:
                raise InputError(f"segment {name!r} runs through obstacle {number}; expected lines beside it")
    for room in (job.keep_in, options.connect.keep_in):
        if room is None:
            continue
        for name, inside in zip(names, shapely.covers(shapely.Polygon(np.array(room)), lines), strict=True):
            if not inside:
                raise InputError(f"segment {name!r} leaves the keep-in area; expected the field within it")


def primitive_of(segment: FieldSegment, aside: float = 0.0) -> Primitive:
    """A line or an arc, moved `aside` (m) to its left."""
    if segment.center is None:
        step = segment.end - segment.start
        heading = math.atan2(step[1], step[0])
        left = np.array([-math.sin(heading), math.cos(heading)])
        return Primitive(segment.start + aside * left, heading, 0.0, segment.length)
    away = segment.start - segment.center
    side = math.copysign(1.0, segment.sweep)
    radius = segment.radius - side * aside
    if radius <= 0:
        raise InputError(
            f"segment {segment.id!r}: a mark of its width reaches the centre of its arc; expected a narrower one"
        )
    heading = math.atan2(away[1], away[0]) + side * math.pi / 2
    start = segment.center + away * (radius / segment.radius)
    return Primitive(start, heading, side / radius, abs(segment.sweep) * radius)


def _setting(segment: FieldSegment, robot: Robot) -> int:
    """The tool setting that a segment's actuation asks for: by its code, or the only one there is."""
    code = ACTUATIONS[segment.actuation]
    settings = robot.tool.settings
    found = [k for k in range(1, len(settings)) if settings[k].code == code]
    if found:
        return found[0]
    if segment.actuation == "ALL" or len(settings) == 2:
        return 1
    known = ", ".join(f"{setting.name} ({setting.code})" for setting in settings[1:])
    raise InputError(
        f"segment {segment.id!r}: {robot.name} has no tool setting for {segment.actuation} ({code}); expected {known}"
    )


def _side_by_side(segment: FieldSegment, job: Field, robot: Robot) -> float:
    """Lines of the tool that make up the width of a segment: a whole number, kept a float as it may be huge."""
    tool = robot.tool.settings[_setting(segment, robot)].width
    width = segment.width or job.line_width or tool
    return max(1.0, float(np.ceil(width / tool - 1e-6)))


def _refuse_too_many(marked: list[FieldSegment], job: Field, robot: Robot) -> None:
    """LimitError before any line is made, naming the segment that asks for most."""
    counts = [s.passes * (1.0 if s.spot > 0 else _side_by_side(s, job, robot)) for s in marked]
    if sum(counts) > MAX_STROKES:
        worst = int(np.argmax(counts))
        raise LimitError(
            f"there are {sum(counts):.0f} lines, {counts[worst]:.0f} of them for segment {marked[worst].id!r}; "
            f"expected at most {MAX_STROKES}"
        )


def _wide(segment: FieldSegment, job: Field, robot: Robot) -> list[Chain]:
    """A segment as often as it is marked: passes, and lines side by side where it is wider than the tool."""
    tool = robot.tool.settings[_setting(segment, robot)].width
    width = segment.width or job.line_width or tool
    count = int(_side_by_side(segment, job, robot))
    spread = max(width - tool, 0.0)
    sides = [0.0] if count == 1 else [spread * (k / (count - 1) - 0.5) for k in range(count)]
    made = []
    for number in range(segment.passes):
        for side, aside in enumerate(sides):
            name = segment.id + (f"|{side + 1}" if count > 1 else "") + (f"#{number + 1}" if segment.passes > 1 else "")
            inner = 0 < side < count - 1
            made.append(Chain((primitive_of(segment, aside),), segment.closed, segment, name, inner))
    return made


def _width_notes(marked: list[FieldSegment], job: Field, robot: Robot) -> list[Note]:
    """A notice for each width of lines that the tool marks wider."""
    found: dict[tuple[float, float], list[str]] = {}
    for segment in marked:
        tool = robot.tool.settings[_setting(segment, robot)].width
        width = segment.width or job.line_width or tool
        if segment.spot == 0 and width < tool * (1 - 1e-9):
            found.setdefault((width, tool), []).append(segment.id)
    return [
        Note(
            "notice",
            ids[0],
            f"lines of {100 * width:.3g} cm are marked {100 * tool:.3g} cm wide by this tool",
            len(ids),
        )
        for (width, tool), ids in found.items()
    ]


def _joined(chains: list[Chain]) -> list[Chain]:
    """Chains of what goes on: two ends, and no third one, meet in one place and direction."""
    ends: list[tuple[int, bool, FloatArray, float]] = []  # chain, its end, place, heading out of it
    for k, chain in enumerate(chains):
        if not chain.closed:
            (part,) = chain.parts
            ends.append((k, False, part.start, part.heading + math.pi))
            ends.append((k, True, part.at(part.length), part.end_heading()))
    places = np.array([place for _, _, place, _ in ends]).reshape(-1, 2)
    partner: dict[tuple[int, bool], tuple[int, bool]] = {}
    for a, (k, last, place, heading) in enumerate(ends):
        near = np.flatnonzero(np.linalg.norm(places - place, axis=1) < GOES_ON)
        others = [ends[b] for b in near.tolist() if b != a]
        if len(others) == 1 and others[0][0] != k and _alike(chains[k].segment, chains[others[0][0]].segment):
            other, at_end, _, away = others[0]
            if meets(heading, away + math.pi, GOES_ON):
                partner[k, last] = (other, at_end)
    done: set[int] = set()
    made: list[Chain] = []
    for k, chain in enumerate(chains):
        if k in done:
            continue
        first, forwards, ring = _beginning(k, partner)
        run: list[tuple[int, bool]] = []
        at: tuple[int, bool] | None = (first, forwards)
        while at is not None and at[0] not in done:
            run.append(at)
            done.add(at[0])
            follower = partner.get((at[0], at[1]))
            at = None if follower is None else (follower[0], not follower[1])
        if len(run) == 1:
            made.append(chain)
            continue
        parts = tuple(chains[j].parts[0] if way else _back(chains[j].parts[0]) for j, way in run)
        lead = min(run, key=lambda entry: entry[0])[0]
        members = tuple(chains[j] for j, _ in run)
        made.append(Chain(parts, ring, chains[lead].segment, f"{chains[lead].id}+", members=members))
    return made


def _apart(chains: list[Chain], robot: Robot, options: Options, tolerance: float) -> list[Chain]:
    """Chains without those that obstacles block in both directions: what they were joined of may be free on its own."""
    long = [chain for chain in chains if chain.members]
    blocked = stuck([_stroke(chain, robot, tolerance) for chain in long], robot, options)
    gone = {chain.id for chain, is_stuck in zip(long, blocked, strict=True) if is_stuck}
    return [part for chain in chains for part in (chain.members if chain.id in gone else (chain,))]


def _beginning(k: int, partner: dict[tuple[int, bool], tuple[int, bool]]) -> tuple[int, bool, bool]:
    """The first segment of the chain that a segment is in, whether it is driven forwards, and whether it is a ring."""
    at, forwards = k, True
    while (at, not forwards) in partner:
        before, end = partner[at, not forwards]
        at, forwards = before, end
        if at == k:
            return k, True, True
    return at, forwards, False


def _alike(one: FieldSegment, other: FieldSegment) -> bool:
    same = (one.actuation, one.width, one.passes) == (other.actuation, other.width, other.passes)
    return same and one.passes == 1 and not (one.directed or other.directed)


def _back(part: Primitive) -> Primitive:
    return Primitive(part.at(part.length), part.end_heading() + math.pi, -part.curvature, part.length)


def _cut(chains: list[Chain]) -> list[Chain]:
    """Open lines and arcs cut where others meet them, into pieces of `SHORTEST` at least."""
    near = _neighbours(chains)
    made: list[Chain] = []
    for k, chain in enumerate(chains):
        if chain.closed or chain.segment.directed or len(chain.parts) > 1:
            made.append(chain)
            continue
        (part,) = chain.parts
        places = sorted(place for other in near.get(k, ()) for place in junctions(part, other, TOUCH))
        cuts = [0.0]
        for place in places:
            if place - cuts[-1] >= SHORTEST and part.length - place >= SHORTEST:
                cuts.append(place)
        cuts.append(part.length)
        if len(made) + len(cuts) > MAX_STROKES:
            raise LimitError(
                f"there are more than {MAX_STROKES} pieces of lines; expected fewer, or whole lines (--whole)"
            )
        for number, (a, b) in enumerate(pairwise(cuts), start=1):
            piece = Primitive(part.at(a), part.heading + part.curvature * a, part.curvature, b - a)
            name = chain.id if len(cuts) == 2 else f"{chain.id}~{number}"
            made.append(chain._replace(parts=(piece,), id=name))
    return made


def _neighbours(chains: list[Chain]) -> dict[int, list[Primitive]]:
    """For each chain that may be cut, what comes near its line."""
    import shapely

    parts = [(k, part, chain.inner) for k, chain in enumerate(chains) for part in chain.parts]
    lines = [shapely.LineString(part.at(np.linspace(0, part.length, _points(part, SAG)))) for _, part, _ in parts]
    others = [n for n, (_, _, inner) in enumerate(parts) if not inner]
    if not parts:
        return {}
    tree = shapely.STRtree([lines[n] for n in others])
    found: dict[int, list[Primitive]] = {}
    for one, other in tree.query(lines, predicate="dwithin", distance=TOUCH + 2 * SAG).T.tolist():
        k, (j, part, _) = parts[one][0], parts[others[other]]
        if j != k:
            found.setdefault(k, []).append(part)
    return found


def _points(part: Primitive, sag: float) -> int:
    """How many points stand for a line or an arc so that chords between them leave it by `sag`, m, at most."""
    turn = 2 * math.acos(max(1 - sag * abs(part.curvature), 0.5))
    return 2 if part.curvature == 0 else max(2, math.ceil(part.length * abs(part.curvature) / turn)) + 1


def _stroke(chain: Chain, robot: Robot, tolerance: float) -> Stroke:
    points: list[FloatArray] = []
    sag = min(SAG, tolerance / 4)
    bends: list[float] = []
    for part in chain.parts:
        count = 1
        if part.curvature != 0:
            count = _points(part, sag) - 1
            count = ARC_POINTS * math.ceil(count / ARC_POINTS) if chain.closed else count
        points.append(part.at(np.linspace(0, part.length, count, endpoint=False)))
        bends += [part.curvature] * count
    line = np.concatenate(points)
    if not chain.closed:
        last = chain.parts[-1]
        line = np.concatenate([line, last.at(last.length)[None]])
    segment = chain.segment
    return Stroke(
        chain.id,
        line,
        tool=_setting(segment, robot),
        closed=chain.closed,
        directed=segment.directed,
        element=segment.id,
        bends=np.array(bends),
    )


def _spot(segment: FieldSegment, number: int, robot: Robot, options: Options) -> Stroke:
    """A spot: a line across it, in any of several directions."""
    half = np.array([segment.spot / 2, 0.0])
    tool = _setting(segment, robot)
    width = robot.tool.settings[tool].width
    if segment.spot > width * 2.5:
        raise InputError(
            f"segment {segment.id!r}: a spot of {segment.spot:g} m is too wide for a mark of {width:g} m; "
            "expected lines or arcs that fill it"
        )
    name = segment.id if segment.passes == 1 else f"{segment.id}#{number + 1}"
    points = np.array([segment.start - half, segment.start + half])
    return Stroke(name, points, tool=tool, element=segment.id, bends=np.zeros(1), headings=options.cover.headings)
