"""A building in space: its walls, the circles on them, and the way of the boom lift before them."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

import numpy as np

from optplan.domain.arrays import FloatArray
from optplan.domain.facade import Facade, Wall
from optplan.domain.result import Plan
from optplan.geometry.paths import ends
from optplan.geometry.walls import places, vertices_of
from optplan.plot.facade import GLASS, MOVE, TEXT, WALL, WATER, shown

if TYPE_CHECKING:
    from matplotlib.figure import Figure

MOST_TICKS = 10
"""Of the longest axis."""
WIDE, HIGH, EDGE, HEAD = 8.0, 8.0, 0.85, 0.0
"""Inches: the most that the drawing takes, and what is kept free around it for figures, and above it for a title."""
ROUND = np.linspace(0, 2 * np.pi, 49)


def building_figure(plan: Plan, job: Facade) -> Figure:
    """A matplotlib figure in three dimensions. Raises InputError when there are no stops yet."""
    from matplotlib.figure import Figure
    from matplotlib.ticker import MultipleLocator
    from mpl_toolkits.mplot3d.art3d import Line3DCollection, Poly3DCollection

    seen = shown(plan, job)
    made = Figure(figsize=(9, 7.5), facecolor="white")
    axes = made.add_subplot(projection="3d", computed_zorder=False)
    corners = []
    for k, wall in enumerate(job.walls):
        pieces = _pieces(wall, wall.outline)
        corners += pieces
        axes.add_collection3d(Poly3DCollection(pieces, facecolor=WALL, edgecolor="none", zorder=0))
        axes.add_collection3d(Line3DCollection([_line(wall, wall.outline)], colors=TEXT, lw=1.0, zorder=1))
        for ring in wall.no_go:
            axes.add_collection3d(Poly3DCollection(_pieces(wall, ring), facecolor=GLASS, edgecolor="none", zorder=1))
            axes.add_collection3d(Line3DCollection([_line(wall, ring)], colors=TEXT, lw=0.6, zorder=2))
        own = np.flatnonzero(seen.wall == k)
        rings = [
            places(wall, seen.places[i] + seen.radii[i] * np.column_stack([np.cos(ROUND), np.sin(ROUND)])) for i in own
        ]
        axes.add_collection3d(Line3DCollection(rings, colors=WATER, lw=0.5, alpha=0.6, zorder=3))
        corners += rings
    if plan.path is not None:
        line = np.concatenate([plan.path.start, ends(plan.path).position[-1:]])
        axes.plot(*line.T, color=MOVE, lw=1.2, zorder=5)
        axes.plot(*line[:1].T, "o", color="#2e9e4f", ms=7, mec="white", zorder=6)
        axes.plot(*line[-1:].T, "s", color="#8e44ad", ms=7, mec="white", zorder=6)
        corners.append(line)
    everything = np.concatenate(corners)
    low, high = everything.min(axis=0), everything.max(axis=0)
    room = np.maximum(high - low, 0.15 * float((high - low).max()))
    middle = (low + high) / 2
    axes.set(
        xlim=(middle[0] - room[0] / 2, middle[0] + room[0] / 2),
        ylim=(middle[1] - room[1] / 2, middle[1] + room[1] / 2),
        zlim=(middle[2] - room[2] / 2, middle[2] + room[2] / 2),
    )
    axes.set_box_aspect(room.tolist())
    step = _step(float(room.max()) / MOST_TICKS)
    for axis in (axes.xaxis, axes.yaxis, axes.zaxis):
        axis.set_major_locator(MultipleLocator(step))
    axes.set_xlabel("x, m", fontsize=8)
    axes.set_ylabel("y, m", fontsize=8)
    axes.set_zlabel("z, m", fontsize=8)
    axes.tick_params(labelsize=7)
    axes.view_init(elev=22, azim=_azimuth(job))
    _fill(made, axes)
    made.suptitle(f"{job.name}  ·  {plan.robot.name}", fontsize=12, weight="bold", color=TEXT)
    return made


def _step(least: float) -> float:
    """The next of 1, 2, 5, 10 ... that is no less: one step for all axes, of which a short one has few."""
    power = 10.0 ** np.floor(np.log10(least))
    return float(next(power * k for k in (1, 2, 5, 10) if power * k >= least * (1 - 1e-9)))


def _fill(made: Figure, axes: Any) -> None:
    """Make the figure as large as what is drawn in it, which a view in three dimensions leaves half empty."""
    from mpl_toolkits.mplot3d import proj3d

    axes.set_position((0.0, 0.0, 1.0, 1.0))
    made.draw_without_rendering()
    size = np.array(made.get_size_inches())
    corners = np.array(np.meshgrid(axes.get_xlim(), axes.get_ylim(), axes.get_zlim())).reshape(3, -1)
    x, y, _ = proj3d.proj_transform(*corners, axes.get_proj())
    seen = axes.transData.transform(np.column_stack([x, y])) / made.dpi
    low, high = seen.min(axis=0), seen.max(axis=0)
    scale = min(WIDE / (high - low)[0], HIGH / (high - low)[1])
    inches = scale * (high - low) + np.array([2 * EDGE, 2 * EDGE + HEAD])
    made.set_size_inches(*inches.tolist())
    corner = EDGE - scale * low
    axes.set_position((*(corner / inches).tolist(), *(scale * size / inches).tolist()))


def _azimuth(job: Facade) -> float:
    """From where most of the walls are seen, degrees."""
    weights = [float(np.ptp(wall.outline[:, 0])) for wall in job.walls]
    facing = sum(w * np.cross(wall.across, wall.up) for w, wall in zip(weights, job.walls, strict=True))
    largest = job.walls[int(np.argmax(weights))]
    first = np.cross(largest.across, largest.up)
    toward = np.asarray(facing) + 0.6 * first
    return float(np.degrees(np.arctan2(toward[1], toward[0]))) + 25.0


def _pieces(wall: Wall, ring: FloatArray) -> list[FloatArray]:
    """Polygons in space (k, 3) that make up one on a wall: cut where the wall bends."""
    import shapely

    shape = shapely.make_valid(shapely.Polygon(ring))
    parts = [shape]
    if not wall.flat:
        at = vertices_of(wall)[0]
        low, high = shape.bounds[1] - 1, shape.bounds[3] + 1
        cuts = [shape.bounds[0] - 1, *at[1:-1].tolist(), shape.bounds[2] + 1]
        strips = shapely.box(cuts[:-1], low, cuts[1:], high)
        parts = list(shapely.intersection(strips, shape))
    flat = [
        part for shape in parts for part in shapely.get_parts(shape) if part.geom_type == "Polygon" and part.area > 0
    ]
    made = []
    for part in flat:
        points = shapely.get_coordinates(part.exterior)
        middle = points.mean(axis=0)
        # a hair inside, so that a corner on a bend belongs to its own side
        made.append(places(wall, middle + (points - middle) * (1 - 1e-9)))
    return made


def _line(wall: Wall, ring: FloatArray) -> FloatArray:
    """(k, 3) m, the border of a polygon on a wall, closed and fine enough for its bends."""
    closed = np.concatenate([ring, ring[:1]])
    if wall.flat:
        return places(wall, closed)
    share = np.linspace(0, 1, 40, endpoint=False)
    fine = (closed[:-1, None] + share[None, :, None] * np.diff(closed, axis=0)[:, None]).reshape(-1, 2)
    return places(wall, np.concatenate([fine, closed[:1]]))
