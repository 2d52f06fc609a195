"""Pictures of facades: every wall unrolled, its circles, and the order of the stops as arrows."""

from __future__ import annotations

import math
from typing import TYPE_CHECKING, NamedTuple

import numpy as np

from optplan.domain.arrays import FloatArray, IntArray
from optplan.domain.errors import InputError
from optplan.domain.facade import Facade, Wall
from optplan.domain.path import Path
from optplan.domain.result import Cover, Plan
from optplan.domain.robot import Boom
from optplan.geometry.paths import ends
from optplan.geometry.walls import unrolled

if TYPE_CHECKING:
    from matplotlib.axes import Axes
    from matplotlib.figure import Figure

WALL, GLASS, WATER, MOVE, AWAY, TEXT = "#f3ede2", "#b9d3e3", "#2f7fb8", "#c0392b", "#e59866", "#1c2a39"
NUMBERED = 200
"""Up to this many stops carry their number."""


class Shown(NamedTuple):
    """A plan's stops and moves on its unrolled walls."""

    wall: IntArray
    """(n,) of every stop"""
    places: FloatArray
    """(n, 2) m"""
    radii: FloatArray
    """(n,) m"""
    order: IntArray
    """(k,) stops in the order of visiting"""
    offset: FloatArray
    """(w,) m to the right of which each wall is drawn"""

    def flat(self) -> FloatArray:
        """(n, 2) m, places in the picture."""
        return self.places + np.column_stack([self.offset[self.wall], np.zeros(len(self.wall))])


def shown(plan: Plan, job: Facade) -> Shown:
    """Where everything goes. Raises InputError when there are no stops yet."""
    cover = plan.cover
    if cover is None:
        raise InputError("the plan has nothing to draw yet; run the stage cover first")
    names = {wall.name: k for k, wall in enumerate(job.walls)}
    wall = np.array([names[stroke.element] for stroke in cover.strokes], dtype=np.int64)
    away = plan.robot.mobility.standoff if isinstance(plan.robot.mobility, Boom) else 0.0
    places = np.zeros((len(wall), 2))
    for k, one in enumerate(job.walls):
        own = np.flatnonzero(wall == k)
        feet = np.array([cover.strokes[i].points[0] for i in own]).reshape(-1, 3)
        facing = np.array([_normal(cover, i) for i in own.tolist()]).reshape(-1, 3)
        places[own] = unrolled(one, feet, facing, away)
    reached = plan.robot.mobility.radius if isinstance(plan.robot.mobility, Boom) else 1.0
    radii = np.array(cover.radii or [job.radius or reached] * len(wall))
    order = np.zeros(0, dtype=np.int64)
    if plan.path is not None:
        order = plan.path.stroke[plan.path.stroke >= 0]
    elif plan.visits is not None:
        order = plan.visits.stroke
    room = float(radii.max(initial=1.0))
    left = np.array([one.outline[:, 0].min() for one in job.walls])
    width = np.array([np.ptp(one.outline[:, 0]) for one in job.walls])
    offset = np.concatenate([[0.0], np.cumsum(width + 2.5 * room)[:-1]]) - left
    return Shown(wall, places, radii, order, offset)


def _normal(cover: Cover, stop: int) -> FloatArray:
    normals = cover.strokes[stop].normals
    if normals is None:
        raise InputError(f"stop {cover.strokes[stop].id!r} has no normal; expected a stop of a facade")
    normal: FloatArray = normals[0]
    return normal


def facade_figure(plan: Plan, job: Facade) -> Figure:
    """A matplotlib figure. Raises InputError when there are no stops yet."""
    from matplotlib.collections import PatchCollection
    from matplotlib.figure import Figure
    from matplotlib.patches import Circle

    seen = shown(plan, job)
    flat = seen.flat()
    corners = np.concatenate(
        [wall.outline + np.array([offset, 0.0]) for wall, offset in zip(job.walls, seen.offset, strict=True)]
    )
    everything = np.concatenate([corners, flat - seen.radii[:, None], flat + seen.radii[:, None]])
    low, high = everything.min(axis=0) - 0.3, everything.max(axis=0) + 0.3
    size = high - low
    inches = np.maximum(9 * size / size.max(), 2.5)
    inches = np.array([max(inches[0], 6.0), max(inches[1], 3.0)])
    made = Figure(figsize=(float(inches[0]) + 1.0, float(inches[1]) + 1.4), facecolor="white")
    width, height = made.get_size_inches()
    axes = made.add_axes((0.7 / width, 0.5 / height, inches[0] / width, inches[1] / height))
    axes.set(xlim=(low[0], high[0]), ylim=(low[1], high[1]), aspect="equal")
    axes.tick_params(labelsize=8, color="#999999")
    axes.set_xlabel("m", fontsize=8)
    for side in ("top", "right"):
        axes.spines[side].set_visible(False)
    for wall, offset in zip(job.walls, seen.offset.tolist(), strict=True):
        draw_wall(axes, wall, offset, named=len(job.walls) > 1)
    circles = [Circle((float(x), float(y)), float(r)) for (x, y), r in zip(flat, seen.radii, strict=True)]
    axes.add_collection(
        PatchCollection(circles, facecolor=WATER + "1f", edgecolor=WATER + "99", linewidths=0.6, zorder=2)
    )
    points = inches.min() * 72 / size.min()
    draw_order(axes, plan, job, seen, float(points))
    made.text(
        0.7 / width, 1 - 0.33 / height, f"{job.name}  ·  {plan.robot.name}", fontsize=12, weight="bold", color=TEXT
    )
    made.text(0.7 / width, 1 - 0.6 / height, "   ".join(_facts(plan, seen)), fontsize=9, color=TEXT)
    return made


def draw_wall(axes: Axes, wall: Wall, offset: float = 0.0, *, named: bool = False) -> None:
    """A wall and what is not washed of it."""
    shift = np.array([offset, 0.0])
    axes.fill(*(wall.outline + shift).T, facecolor=WALL, edgecolor=TEXT, lw=1.2, zorder=0)
    for ring in wall.no_go:
        axes.fill(*(ring + shift).T, facecolor=GLASS, edgecolor=TEXT, lw=0.8, hatch="//", alpha=0.8, zorder=1)
    if named:
        x = float(wall.outline[:, 0].mean()) + offset
        axes.annotate(wall.name, (x, float(wall.outline[:, 1].max())), (0, 20), textcoords="offset points", ha="center",
                      fontsize=9, color=TEXT)  # fmt: skip


def draw_order(axes: Axes, plan: Plan, job: Facade, seen: Shown, scale: float) -> None:
    """Arrows from stop to stop; moves away from the wall, and from wall to wall, are paler."""
    flat, order = seen.flat(), seen.order
    if len(order) == 0:
        axes.plot(*flat.T, ".", color=MOVE, ms=3, zorder=4)
        return
    lines = moves_of(plan, job, seen) if plan.path is not None else []
    for line, along in lines:
        colour = MOVE if along else AWAY
        axes.plot(*line.T, "-" if along else ":", color=colour, lw=1.1, zorder=3)
        steps = np.diff(line, axis=0)
        long = int(np.argmax(np.hypot(*steps.T)))
        middle, way = (line[long] + line[long + 1]) / 2, steps[long]
        size = math.hypot(*way)
        if size > 1e-9:
            arrow = {"arrowstyle": "-|>", "color": colour, "lw": 0.8, "mutation_scale": 8}
            axes.annotate(
                "",
                (middle + way / size * 0.01).tolist(),
                (middle - way / size * 0.01).tolist(),
                zorder=4,
                arrowprops=arrow,
            )
    font = min(6.5, 0.45 * float(seen.radii.min()) * scale)
    if len(order) <= NUMBERED and font >= 3:
        for number, stop in enumerate(order.tolist(), start=1):
            axes.annotate(str(number), flat[stop].tolist(), (2, 2), textcoords="offset points", fontsize=font,
                          color=TEXT, zorder=5)  # fmt: skip
    for stop, marker, colour, label in ((order[0], "o", "#2e9e4f", "start"), (order[-1], "s", "#8e44ad", "end")):
        axes.plot(*flat[stop], marker, ms=7, color=colour, mec="white", mew=1, label=label, ls="none", zorder=6)
    axes.legend(loc="lower right", bbox_to_anchor=(1, 1), fontsize=7, frameon=False, ncols=2)


def moves_of(plan: Plan, job: Facade, seen: Shown) -> list[tuple[FloatArray, bool]]:
    """Polylines (k, 2) of the moves in the picture, and whether each stays on its wall at the stand-off."""
    path = plan.path
    assert path is not None
    flat = seen.flat()
    stops = np.flatnonzero(path.stroke >= 0)
    lines: list[tuple[FloatArray, bool]] = []
    last = ends(path).position
    for a, b in zip(stops[:-1].tolist(), stops[1:].tolist(), strict=True):
        i, j = int(path.stroke[a]), int(path.stroke[b])
        way, along = np.array([flat[i], flat[j]]), seen.wall[i] == seen.wall[j]
        inner = np.arange(a + 1, b - 1)
        wall = job.walls[int(seen.wall[i])]
        if along and wall.flat and len(inner):
            apart = last[inner] - wall.origin
            away = np.abs(apart @ np.cross(wall.across, wall.up))
            along = bool((away < _standoff(plan) + 1e-6).all())
            corners = np.column_stack([apart @ wall.across, apart @ wall.up]) + np.array(
                [seen.offset[seen.wall[i]], 0.0]
            )
            way = np.concatenate([way[:1], corners, way[1:]])
        lines.append((way, bool(along)))
    return lines


def _standoff(plan: Plan) -> float:
    return plan.robot.mobility.standoff if isinstance(plan.robot.mobility, Boom) else 0.0


def _facts(plan: Plan, seen: Shown) -> list[str]:
    facts = ["1 stop" if len(seen.wall) == 1 else f"{len(seen.wall)} stops"]
    if plan.path is not None:
        facts.append(f"{_between(plan.path):.1f} m between them")
    if plan.trajectory is not None:
        minutes, seconds = divmod(round(plan.trajectory.duration), 60)
        facts.append(f"{minutes}:{seconds:02d} min")
    gap = plan.ordering.gap if plan.ordering is not None else math.inf
    if math.isfinite(gap):
        facts.append("order proved best" if gap <= 1e-6 else f"no order is more than {100 * gap:.1f} % shorter")
    return facts


def _between(path: Path) -> float:
    return float(path.length.sum())
