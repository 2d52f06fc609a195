"""Strokes to traversals to an ordering problem."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace

import numpy as np

from optplan.connectors.families import family_of, metric_of, start_states
from optplan.connectors.padding import padded, padding_of
from optplan.connectors.ways import ends_of
from optplan.coverage.beside import refusals
from optplan.domain.arrays import FloatArray, IntArray
from optplan.domain.errors import InputError, LimitError
from optplan.domain.facade import Facade
from optplan.domain.job import Job
from optplan.domain.options import Options
from optplan.domain.ordering import ArcCosts, DubinsCosts, EuclidCosts, MatrixCosts, OrderingProblem
from optplan.domain.progress import Progress, ProgressCallback, silent
from optplan.domain.result import Cover
from optplan.domain.robot import Robot
from optplan.domain.stroke import Stroke, Traversals

DUBINS_ENTRIES = 16
"""Vertices at which a closed stroke may be entered when headings count, unless the options say otherwise."""
MOST_CURVED = 3000
"""Ways of driving under continuous curvature or with reversing: all connectors between them are computed, which takes
100 s at 10 us."""
MOST_TIMED = 1200
"""The same where each is computed for several speeds."""


def traversals(
    strokes: Sequence[Stroke],
    robot: Robot,
    options: Options | None = None,
    links: Sequence[tuple[int, int, int, int]] = (),
) -> Traversals:
    """All ways of driving each stroke.

    An open stroke can be driven from either end, a closed one from any of its vertices, in both directions where
    headings count (elsewhere the direction changes nothing that matters to the order). Strokes that are directed or
    have a fixed entry offer less; `options.order.entries` thins the vertices out evenly. With the tool beside the robot
    the two directions are different ways, and those that it cannot drive are none.

    Parameters
    ----------
    strokes : (m,) what has to be driven
    robot, options : who drives it, and how
    links : enforced connections, as `Cover` has them: their vertices are never thinned out
    """
    options = options or Options()
    kept: dict[int, list[int]] = {}
    for a, i, b, j in links:
        kept.setdefault(a, []).append(i)
        kept.setdefault(b, []).append(j)
    speed = options.time.speeds(robot.mobility)[0]
    both = metric_of(robot, options) != "euclid" or robot.offset.aside
    most = options.order.entries or (DUBINS_ENTRIES if both else None)
    parts = [_ways(stroke, robot, options, both, most, kept.get(k, [])) for k, stroke in enumerate(strokes)]
    index = np.repeat(np.arange(len(parts)), [len(part[0]) for part in parts])
    shapes = ((0,), (0,), (0, 5), (0, 5), (0,), (0,))
    vertex, reverse, entry, exit, length, turned = (
        np.concatenate([np.zeros(shape), *(part[k] for part in parts)]) for k, shape in enumerate(shapes)
    )
    dwell = np.array([stroke.dwell for stroke in strokes])[index] if len(index) else np.zeros(0)
    duration = length / speed + turned / robot.mobility.turn_rate + dwell
    return Traversals(index, vertex.astype(np.int64), reverse != 0, entry, exit, length, duration)


def _ways(
    stroke: Stroke, robot: Robot, options: Options, both: bool, most: int | None, kept: list[int]
) -> tuple[FloatArray, ...]:
    """entry vertex, reverse, entry state, exit state, length and angle turned of every way of one stroke."""
    count = len(stroke.points)
    offers: list[tuple[IntArray, bool]]
    if stroke.is_stop:
        offers = [(np.array([0]), False)]
    elif stroke.headings > 1:
        # a line driven backwards is the same line half a turn further on
        offers = [(np.arange(stroke.headings), False)]
    elif stroke.closed:
        choice = np.arange(count) if stroke.entry is None else np.array([stroke.entry])
        if most is not None and len(choice) > most:
            choice = np.union1d(choice[np.linspace(0, count, most, endpoint=False).astype(np.int64)], kept)
        offers = [(choice.astype(np.int64), False)]
        if both and not stroke.directed:
            offers.append((choice.astype(np.int64), True))
    else:
        offers = [(np.array([0]), False), (np.array([count - 1]), True)]
        if stroke.directed or stroke.entry == 0:
            offers = offers[:1]
        elif stroke.entry is not None:
            offers = offers[1:]
    if robot.offset.aside and not stroke.is_stop:
        refused = refusals(stroke, robot, options)
        reasons = {refused[reverse] for _, reverse in offers}
        offers = [offer for offer in offers if not refused[offer[1]]]
        if not offers:
            raise InputError(f"stroke {stroke.id!r} cannot be driven: {'; '.join(sorted(reasons))}")
    rows = [ends_of(stroke, vertex, reverse, robot, options) for vertex, reverse in offers]
    return (
        np.concatenate([vertex for vertex, _ in offers]),
        np.concatenate([np.full(len(vertex), reverse) for vertex, reverse in offers]),
        *(np.concatenate(column) for column in zip(*rows, strict=True)),
    )


def visits_of_tour(tour: Sequence[int], strokes: Sequence[Stroke]) -> list[tuple[int, int, bool]]:
    """Project a tour through cities back to strokes.

    The cities are those of the travelling-salesman form of a drawing, numbered from 1: the start, then in the order of
    the strokes both ends of an open one and every vertex of a closed one. A tour begins at city 1; -1 ends it.

    Parameters
    ----------
    tour : cities in the order of visiting
    strokes : (m,)

    Returns
    -------
    stroke, entry vertex and direction (True: against its points) of each visit; closed strokes are driven all the way
    round, back to where they were entered

    Raises
    ------
    InputError : a city that does not exist, is missing or comes twice, or a tour that leaves a stroke half done
    """
    cities = [(k, v) for k, s in enumerate(strokes) for v in (range(len(s.points)) if s.closed else (0, -1))]
    numbers = list(tour)
    numbers = numbers[: numbers.index(-1)] if -1 in numbers else numbers
    if sorted(numbers) != list(range(1, len(cities) + 2)):
        raise InputError(f"a tour of {len(numbers)} cities; expected each of 1..{len(cities) + 1} once, then -1")
    if numbers[0] != 1:
        raise InputError(f"the tour begins at city {numbers[0]}; expected the start, city 1")
    visits: list[tuple[int, int, bool]] = []
    at = 1
    while at < len(numbers):
        k, vertex = cities[numbers[at] - 2]
        size = len(strokes[k].points) if strokes[k].closed else 2
        block = [cities[number - 2] for number in numbers[at : at + size]]
        if any(stroke != k for stroke, _ in block):
            raise InputError(f"the tour leaves stroke {strokes[k].id!r} half done; expected its cities together")
        reverse = vertex == -1 if not strokes[k].closed else block[1][1] == (vertex - 1) % size
        visits.append((k, vertex % len(strokes[k].points), reverse))
        at += size
    return visits


def ordering_problem(
    ways: Traversals,
    cover: Cover,
    robot: Robot,
    options: Options | None = None,
    progress: ProgressCallback = silent,
) -> OrderingProblem:
    """The problem of visiting every stroke once: nodes are the rows of `ways`, costs what lies between strokes, m or s.

    Parameters
    ----------
    ways : traversals of the strokes of `cover`
    cover : gives precedence and, unless the options name one, the start point
    robot, options : give the metric: straight lines, Dubins or continuous-curvature paths within the limits at transit
        speed, or the time that continuous-curvature paths take, each at the speed that suits it
    progress : told how many connectors have been measured, where that takes time

    Raises
    ------
    InputError : a metric that this robot cannot have, or a start outside the canvas
    """
    options = options or Options()
    family = family_of(robot, options)
    start = _start(cover, options)
    entry, leave = padded(ways, options)
    ways = replace(ways, entry=entry, exit=leave)
    costs: ArcCosts
    if family.curved or family.reversing:
        most = MOST_TIMED if family.pace is not None else MOST_CURVED
        if len(ways) > most:
            what = f"the metric {family.metric!r}{' with reversing' if family.reversing else ''}"
            raise LimitError(
                f"{len(ways)} ways of driving the strokes; {what} takes at most {most}: "
                "offer fewer entries, or take 'dubins' without reversing"
            )

        def told(share: float) -> None:
            progress(Progress("order", share, message="lengths of connectors"))

        costs = MatrixCosts(family.matrix(ways.exit, ways.entry, told))
    elif family.metric == "dubins":
        from optplan.geometry.dubins import dubins_lengths

        costs = DubinsCosts(ways.exit[:, [0, 1, 3]], ways.entry[:, [0, 1, 3]], family.radius, dubins_lengths)
    else:
        costs = EuclidCosts(ways.exit[:, :3], ways.entry[:, :3])
    begin = np.zeros(0)
    if start is not None and family.headings:
        begin = start_states(start, options.order.heading, ways.entry, family)[1]
    elif start is not None:
        begin = np.linalg.norm(ways.entry[:, :3] - np.array([*start, 0.0]), axis=1)
    return OrderingProblem(
        ways.stroke,
        costs,
        start_costs=begin,
        precedence=np.array(cover.precedence).reshape(-1, 2),
        enforced=_enforced(ways, cover),
        node_costs=padding_of(ways, options.connect),
    )


def problem_of(
    job: Job, cover: Cover, robot: Robot, options: Options | None = None, progress: ProgressCallback = silent
) -> tuple[Traversals, OrderingProblem]:
    """All ways of driving the strokes of a job, and the problem of ordering them: of any kind of job.

    Raises InputError like `ordering_problem`, or because a facade asks for what a boom lift cannot do.
    """
    options = options or Options()
    ways = traversals(cover.strokes, robot, options, cover.links)
    if not isinstance(job, Facade):
        return ways, ordering_problem(ways, cover, robot, options, progress)
    from optplan.connectors.wall_travel import Travel

    if options.order.avoid > 0 or options.connect.keep_out or options.connect.keep_in is not None:
        raise InputError("avoid, keep_out and keep_in say nothing about a facade; expected wash.travel instead")
    travel = Travel(job, cover, robot, options)
    pairs = np.array(cover.precedence).reshape(-1, 2)
    return ways, OrderingProblem(ways.stroke, travel.costs(), start_costs=travel.start_costs(), precedence=pairs)


def _enforced(ways: Traversals, cover: Cover) -> IntArray:
    """Enforced connections between traversals: rows of connection, the one left, the one entered."""
    closed = np.array([stroke.closed for stroke in cover.strokes])[ways.stroke]
    last = np.array([len(stroke.points) - 1 for stroke in cover.strokes])[ways.stroke]
    leaves = np.where(closed, ways.entry_vertex, last - ways.entry_vertex)
    rows: list[tuple[int, int, int]] = []
    for number, (a, i, b, j) in enumerate(cover.links):
        before = len(rows)
        for (out, at), (into, there) in (((a, i), (b, j)), ((b, j), (a, i))):
            tails = np.flatnonzero((ways.stroke == out) & (leaves == at))
            heads = np.flatnonzero((ways.stroke == into) & (ways.entry_vertex == there))
            rows += [(number, tail, head) for tail in tails.tolist() for head in heads.tolist()]
        if len(rows) == before:
            names = f"{cover.strokes[a].id!r} and {cover.strokes[b].id!r}"
            raise InputError(
                f"the connection of {names} cannot be driven: one of them must be entered elsewhere", "link"
            )
    return np.array(rows, dtype=np.int64).reshape(-1, 3)


def _start(cover: Cover, options: Options) -> tuple[float, float] | None:
    """Where the robot stands: as the options say, else as the drawing does."""
    start, canvas = options.order.start or cover.start, cover.canvas
    if start is None or canvas is None:
        return start
    if not (0 <= start[0] <= canvas.width and 0 <= start[1] <= canvas.height):
        size = f"{canvas.width:g} x {canvas.height:g} m"
        raise InputError(f"the start ({start[0]:g}, {start[1]:g}) lies outside the canvas of {size}")
    return start
