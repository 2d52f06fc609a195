"""Plans of facades: stops before walls, and the moves of a boom lift between them."""

from __future__ import annotations

import itertools
import math
from dataclasses import dataclass
from typing import Any

import numpy as np

from optplan.domain.arrays import FloatArray, IntArray
from optplan.domain.facade import Facade, Wall
from optplan.domain.options import Options
from optplan.domain.ordering import Ordering
from optplan.domain.path import Path, Trajectory
from optplan.domain.report import Check, Report, Verdict
from optplan.domain.result import Cover, Plan
from optplan.domain.robot import Boom
from optplan.judge import _continuity, _motion, _ordering, _strokes, _supplies, _water
from optplan.judge._findings import GAP, RELATIVE, finite, held, noted, place_of, unchecked
from optplan.judge._integrate import Samples, integrate
from optplan.judge._speeds import speeds
from optplan.judge._walls import OnWall, farthest, on_walls, radii_of, washable
from optplan.judge._washed import bare_spots, missed_area

SHARP = math.radians(45)
"""A direction that changes by more is a turn."""
Figures = list[tuple[str, float, str]]


@dataclass(frozen=True, eq=False)
class Moves:
    """The moving pieces of a path.

    rows (k,) of the path; step (k, 3) m; origin (k,) stop whose wall gives the axes: the one that was left
    """

    rows: IntArray
    step: FloatArray
    origin: IntArray


def verify_facade(plan: Plan, job: Facade) -> Report:
    """All checks of a facade's plan, which has a path."""
    path, robot, options, cover = plan.path, plan.robot, plan.options, plan.cover
    assert path is not None  # `verify` has made sure
    samples = integrate(path, 0.01)
    checks: list[Check] = [_continuity.gaps(path, samples)]
    figures: Figures = []
    if cover is None or not cover.strokes or not isinstance(robot.mobility, Boom):
        why = "the robot is no boom lift" if cover is not None and cover.strokes else "the plan has no stops"
        return Report((*checks, *unchecked(["strokes", "coverage", "reach", "order"], why)), ())
    boom, placed = robot.mobility, on_walls(job, cover)
    radii = radii_of(job, cover, placed, boom.reach)
    done, deviation, _, _ = _strokes.strokes(path, samples, cover, GAP)
    checks += [done, deviation, _water.order(job, path, cover, placed, radii, options), _dwell(path, cover, boom)]
    if plan.visits is None:
        checks += unchecked(["visits"], "the plan does not say in which order stops were chosen")
    else:
        checks.append(_strokes.visits(path, samples, plan.visits))
    checks += [_strokes.tool(path, robot), _pose(cover, placed, boom), _ground(job, cover)]
    checks.append(_reach(job, cover, placed, radii, boom))
    coverage, areas = _coverage(job, placed, radii, options)
    moves = _moves(path, samples, cover)
    checks += [coverage, _no_go(job, path, samples, placed, options), _walls(job, path, samples)]
    figures += _figures(path, moves) + areas
    if plan.trajectory is None:
        names = ["time", "rest", "axis speed", "axis acceleration", _supplies.NAME]
        checks += unchecked(names, "the plan has no speeds")
    else:
        profile = speeds(path, plan.trajectory)
        checks += [_motion._time(path, plan.trajectory, profile, robot), _motion._rest(plan.trajectory)]
        checks += _axes(path, plan.trajectory, moves, job, cover, boom, options)
        taken = _motion.durations(path, plan.trajectory, profile)[:3]
        known = {name: value for name, value, _ in areas}
        washed = known["wall area"] * (1 + known["overlap"])
        used, amounts = _supplies.supplies(robot, washed, taken[1][1], taken[0][1])
        checks.append(used)
        figures += [*taken, *amounts]
    if plan.ordering is None:
        checks += unchecked(["bound", "cost"], "the plan does not say how it was ordered")
    else:
        unit = "s" if options.order.metric == "time" else "m"
        claim = _ordering.bound(plan.ordering)
        checks.append(Check("bound", claim.verdict, claim.value, claim.limit, unit, None, claim.detail))
        checks.append(_cost(plan.ordering, moves, job, cover, boom, options))
        claims = [("bound", plan.ordering.bound, unit), ("gap", plan.ordering.gap, "")]
        figures += [one for one in claims if math.isfinite(one[1])]
    return Report(tuple(checks), tuple(figures))


def _pose(cover: Cover, placed: list[OnWall], boom: Boom) -> Check:
    """How far stops are from where they should be before the wall, m; a wrong normal counts as its length."""
    off = [max(abs(p.standoff - boom.standoff), p.slant) if p.wall >= 0 else math.inf for p in placed]
    worst = int(np.argmax(off)) if off else -1
    value = finite(off[worst]) if off else 0.0
    detail = f"Every stop is {boom.standoff:g} m before its wall and faces it."
    if value > GAP:
        detail = f"Stop {cover.strokes[worst].id} is not {boom.standoff:g} m before its wall, or does not face it."
    return held("stand-off", value, 0.0, "m", None, detail, slack=GAP)


def _ground(job: Facade, cover: Cover) -> Check:
    """How far the lowest stop is below the ground, m; stops that the job gives are where they are."""
    feet = [float((wall.origin[2] + wall.outline @ np.array([wall.across[2], wall.up[2]])).min()) for wall in job.walls]
    ground = min(feet) if job.ground is None else job.ground
    given = {wall.name for wall in job.walls if wall.stops is not None or wall.up[2] <= 0}
    deep = [ground - float(stroke.points[0, 2]) for stroke in cover.strokes if stroke.points.shape[1] == 3]
    worst = int(np.argmax(deep)) if deep else -1
    value = max(deep[worst], 0.0) if deep else 0.0
    if value <= GAP:
        return held("ground", value, 0.0, "m", detail="No stop is below the ground.", slack=GAP)
    stop = cover.strokes[worst]
    detail = f"Stop {stop.id} is {value:.3g} m below the ground"
    if all(s.element in given for s, d in zip(cover.strokes, deep, strict=True) if d > GAP):
        return noted("ground", value, "m", f"{detail}, as the job gives it.")
    return held("ground", value, 0.0, "m", place_of(stop.points[0]), f"{detail}.", slack=GAP)


def _dwell(path: Path, cover: Cover, boom: Boom) -> Check:
    """By how much a stop is too short to wash, s: each takes the robot's time, or its stroke's when that is longer."""
    rows = np.flatnonzero((path.stroke >= 0) & (path.stroke < len(cover.strokes)))
    asked = np.array([max(cover.strokes[k].dwell, boom.dwell) for k in path.stroke[rows].tolist()])
    owner, spent = path.stroke[rows], np.bincount(path.stroke[rows], path.dwell[rows], len(cover.strokes))
    short = asked - spent[owner] if len(rows) else np.zeros(1)
    worst = int(np.argmax(short))
    value = max(float(short[worst]), 0.0)
    if value <= RELATIVE * boom.dwell:
        return held("dwell", 0.0, 0.0, "s", detail=f"Every stop takes the {boom.dwell:g} s that washing takes.")
    name, had = cover.strokes[int(owner[worst])].id, spent[owner[worst]]
    detail = f"Stop {name} takes {had:g} s; washing takes {asked[worst]:g} s."
    return held("dwell", value, 0.0, "s", place_of(path.start[int(rows[worst])]), detail)


def _reach(job: Facade, cover: Cover, placed: list[OnWall], radii: FloatArray, boom: Boom) -> Check:
    """Greatest distance from a stop to what it has to wash, m."""
    far = [
        farthest(job.walls[p.wall], p, r) if p.wall >= 0 else math.inf
        for p, r in zip(placed, radii.tolist(), strict=True)
    ]
    worst = int(np.argmax(far))
    detail = f"Stop {cover.strokes[worst].id} has to reach farthest."
    if not cover.radii:
        detail = "The plan does not say how large its circles are: they are taken as large as the arm reaches."
    return held("reach", finite(far[worst]), boom.reach, "m", None, detail, slack=RELATIVE * boom.reach)


def _coverage(job: Facade, placed: list[OnWall], radii: FloatArray, options: Options) -> tuple[Check, Figures]:
    """m2 of wall that no circle washes when every stop is off by the tolerance, in the worst direction."""
    import shapely

    missed, total, worked, beside, spot, name = 0.0, 0.0, 0.0, 0.0, None, ""
    for number, wall in enumerate(job.walls):
        own = [k for k, stop in enumerate(placed) if stop.wall == number]
        centres = np.array([[placed[k].x, placed[k].y] for k in own]).reshape(-1, 2)
        area, radius = washable(wall), np.maximum(radii[own] - options.wash.tolerance, 0.0)
        spots = bare_spots(area, centres, radius)
        if spots:
            missed += max(missed_area(area, centres, radius), 1e-9)
            spot, name = spot or spots[0], name or wall.name
        discs = shapely.buffer(shapely.points(centres), radii[own], quad_segs=32)
        worked += float(shapely.area(shapely.intersection(discs, area)).sum())
        beside += float(shapely.union_all(discs).difference(area).area)
        total += float(area.area)
    detail = "Every part of every wall is washed"
    detail += f", though every stop may be off by {options.wash.tolerance:g} m." if options.wash.tolerance else "."
    if spot is not None:
        detail = f"Wall {name} is not washed everywhere."
    figures: Figures = [
        ("wall area", total, "m2"),
        ("missed area", missed, "m2"),
        ("overlap", worked / total - 1 if total > 0 else 0.0, ""),
        ("washed beside", beside, "m2"),
    ]
    return held("coverage", missed, 0.0, "m2", spot, detail), figures


def _moves(path: Path, samples: Samples, cover: Cover) -> Moves:
    rows = np.flatnonzero(path.length > 0)
    stops = np.flatnonzero((path.stroke >= 0) & (path.stroke < len(cover.strokes)))
    at = np.searchsorted(stops, rows, side="right") - 1
    origin = path.stroke[stops[np.maximum(at, 0)]] if len(stops) else np.zeros(len(rows), dtype=np.int64)
    return Moves(rows, samples.ends[rows] - path.start[rows], origin)


def _components(moves: Moves, job: Facade, cover: Cover) -> FloatArray:
    """(k, 3) m across the wall, up and away from it: what the axes move."""
    ups = {wall.name: wall.up for wall in job.walls}
    frames = [
        (ups.get(s.element, np.zeros(3)), np.zeros(3) if s.normals is None else s.normals[0]) for s in cover.strokes
    ]
    parts = []
    for step, origin in zip(moves.step, moves.origin.tolist(), strict=True):
        up, normal = frames[origin]
        high, away = float(step @ up), float(step @ normal)
        parts.append((math.sqrt(max(float(step @ step) - high**2 - away**2, 0.0)), abs(high), abs(away)))
    return np.array(parts).reshape(-1, 3)


def _axes(
    path: Path, trajectory: Trajectory, moves: Moves, job: Facade, cover: Cover, boom: Boom, options: Options
) -> list[Check]:
    """Shares of what the axes can do: speeds, and changes of speed between knots."""
    parts = _components(moves, job, cover)
    share = np.zeros((len(path), 3))
    share[moves.rows] = parts / np.maximum(np.linalg.norm(moves.step, axis=1), 1e-300)[:, None]
    gone = np.diff(trajectory.s)
    middle = (trajectory.s[1:] + trajectory.s[:-1]) / 2
    row = np.clip(np.searchsorted(path.offsets, middle, side="right") - 1, 0, max(len(path) - 1, 0))
    moving = gone > 1e-9
    row, gone = row[moving], gone[moving]
    if len(row) == 0:
        return [held(name, 0.0, 1.0, "", detail="Nothing moves.") for name in ("axis speed", "axis acceleration")]
    fastest = np.maximum(trajectory.v[1:], trajectory.v[:-1])[moving]
    use = share[row] * fastest[:, None] / np.array(boom.speeds)
    if options.time.transit_speed is not None:
        use = np.column_stack([use, fastest / options.time.transit_speed])
    rate = np.abs(np.diff(trajectory.v**2))[moving] / (2 * gone)
    change = share[row].max(axis=1) * rate / boom.acceleration
    found = []
    for name, value in (("axis speed", use.max(axis=1)), ("axis acceleration", change)):
        worst = int(np.argmax(value))
        detail = f"An axis comes nearest to its limit on piece {int(row[worst])}; 1 is the limit."
        place = place_of(path.start[int(row[worst])])
        found.append(held(name, float(value[worst]), 1.0, "", place, detail, slack=10 * RELATIVE))
    return found


def _cost(ordering: Ordering, moves: Moves, job: Facade, cover: Cover, boom: Boom, options: Options) -> Check:
    """What the moves cost, against what the solver reported."""
    parts, timed = _components(moves, job, cover), options.order.metric == "time"
    if timed:
        made = sum(_seconds(part, boom, options) for part in parts.tolist())
    else:
        weight = options.wash.horizontal
        made = sum(math.hypot(weight * across, high, weight * away) for across, high, away in parts.tolist())
    unit, claimed = "s" if timed else "m", ordering.cost
    good = abs(claimed - made) <= RELATIVE * max(made, 1e-3)
    what = "take as long" if timed else "are as long"
    detail = f"The moves {what} as the solver said."
    if not good:
        detail = f"The moves cost {made:.9g} {unit}, the solver said {finite(claimed):.9g} {unit}."
    return Check("cost", Verdict.PASSED if good else Verdict.FAILED, made, finite(claimed), unit, None, detail)


def _seconds(part: list[float], boom: Boom, options: Options) -> float:
    """Least time of a straight move: axes begin and end together, at rest."""
    length = math.hypot(*part)
    speed = min(limit * length / moved for limit, moved in zip(boom.speeds, part, strict=True) if moved > 1e-9 * length)
    speed = min(speed, options.time.transit_speed or math.inf)
    rate = boom.acceleration * length / max(part)
    return length / speed + speed / rate if length * rate >= speed**2 else 2 * math.sqrt(length / rate)


def _no_go(job: Facade, path: Path, samples: Samples, placed: list[OnWall], options: Options) -> Check:
    """Metres that moves go close before no-go areas; none to be avoided where a stop at their ends stands."""
    import shapely

    metres, spot = 0.0, None
    stops = [row for row in range(len(path)) if path.stroke[row] >= 0]
    for a, b in itertools.pairwise(stops):
        first, last = placed[int(path.stroke[a])], placed[int(path.stroke[b])]
        if first.wall != last.wall or first.wall < 0 or not job.walls[first.wall].no_go:
            continue
        wall = job.walls[first.wall]
        ends = shapely.points([[first.x, first.y], [last.x, last.y]])
        holes = shapely.union_all([shapely.make_valid(shapely.Polygon(ring)) for ring in wall.no_go])
        own = options.wash.travel != "straight"
        parts = [part for part in shapely.get_parts(holes) if not (own and shapely.contains(part, ends).any())]
        for row in range(a + 1, b):
            line = _line_on(wall, path.start[row], samples.ends[row], first.standoff)
            if line is None:
                continue
            inside = shapely.length(shapely.intersection(parts, shapely.LineString(line))) if parts else np.zeros(1)
            # what runs along the border of an area is not before it
            inner = [shapely.intersects(part.buffer(-1e-6), shapely.LineString(line)) for part in parts]
            over = float(inside[np.array(inner, dtype=bool)].sum()) if parts else 0.0
            metres, spot = metres + over, spot or ((line[0][0], line[0][1]) if over > 0 else None)
    if options.wash.travel == "straight":
        return noted("no-go", metres, "m", f"Moves go {metres:.4g} m across no-go areas, as travel 'straight' allows.")
    detail = "No move goes close before a no-go area that it could avoid."
    if metres > 1e-6:
        detail = f"Moves go {metres:.4g} m close before no-go areas."
    return held("no-go", metres, 0.0, "m", spot, detail, slack=1e-6)


def _line_on(wall: Wall, start: FloatArray, end: FloatArray, standoff: float) -> list[list[float]] | None:
    """A move on the wall, when it is at the stand-off; None when it is further away."""
    out = np.cross(wall.across, wall.up)
    points = []
    gone = np.zeros(1) if wall.plan is None else np.append(0.0, np.cumsum(np.hypot(*np.diff(wall.plan, axis=0).T)))
    for place in (start, end):
        apart = place - wall.origin
        flat = np.array([apart @ wall.across, apart @ out])
        if wall.plan is None:
            x, away = float(flat[0]), float(flat[1])
        else:
            step = np.diff(wall.plan, axis=0)
            share = ((flat - wall.plan[:-1]) * step).sum(axis=1) / (step**2).sum(axis=1)
            low, high = np.zeros(len(step)), np.ones(len(step))
            low[0], high[-1] = -np.inf, np.inf
            foot = wall.plan[:-1] + np.clip(share, low, high)[:, None] * step
            near = np.hypot(*(flat - foot).T)
            k = int(np.argmin(near))
            x = float(gone[k] + np.clip(share[k], low[k], high[k]) * (gone[k + 1] - gone[k]))
            away = float(near[k])
        # on the mitre before a bend it is a little further away
        if away > standoff * 1.2 + 1e-6:
            return None
        points.append([x, float(apart @ wall.up)])
    return points


def _walls(job: Facade, path: Path, samples: Samples) -> Check:
    """How many moves go through a wall."""
    import shapely

    through, spot = 0, None
    if all(abs(float(wall.up[2]) - 1) < 1e-6 for wall in job.walls):
        lines = []
        for wall in job.walls:
            plan = wall.plan
            if plan is None:
                plan = np.array([[wall.outline[:, 0].min(), 0.0], [wall.outline[:, 0].max(), 0.0]])
            out = np.cross(wall.across, wall.up)
            lines.append((wall.origin + plan[:, :1] * wall.across + plan[:, 1:] * out)[:, :2])
        moving = np.flatnonzero(path.length > 0)
        plans: Any = shapely.MultiLineString([line.tolist() for line in lines])
        for row in moving.tolist():
            if shapely.LineString([path.start[row, :2], samples.ends[row, :2]]).crosses(plans):
                through, spot = through + 1, spot or place_of(path.start[row])
    detail = "No move goes through a wall." if through == 0 else f"{through} moves go through a wall."
    return held("walls", through, 0, "", spot, detail)


def _figures(path: Path, moves: Moves) -> Figures:
    """Counts, lengths, and how natural the order looks: turns, and changes between left and right."""
    length = np.linalg.norm(moves.step, axis=1)
    unit = moves.step / np.maximum(length, 1e-300)[:, None]
    bend = np.arccos(np.clip((unit[1:] * unit[:-1]).sum(axis=1), -1, 1)) if len(unit) > 1 else np.zeros(0)
    axis = unit[:, :2] if len(unit) else np.zeros((0, 2))
    main = axis[int(np.argmax(np.hypot(*axis.T)))] if len(axis) else np.zeros(2)
    side = np.sign(np.where(np.abs(axis @ main) > 0.3, axis @ main, 0.0))
    side = side[side != 0]
    return [
        ("stops", float((path.stroke >= 0).sum()), ""),
        ("moves", float(length.sum()), "m"),
        ("turns", float((bend > SHARP).sum()), ""),
        ("direction changes", float((np.diff(side) != 0).sum()), ""),
    ]
