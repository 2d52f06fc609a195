"""One picture of a plan, on sand or paper."""

from __future__ import annotations

import math
from typing import TYPE_CHECKING, NamedTuple

import numpy as np

from optplan.domain.arrays import BoolArray, FloatArray
from optplan.domain.errors import InputError
from optplan.domain.job import Field
from optplan.domain.path import RAISED, Path
from optplan.domain.result import Plan
from optplan.domain.robot import MIDDLE, DiffDrive, ToolPlace
from optplan.domain.units import LENGTH, shown
from optplan.geometry.paths import along
from optplan.geometry.tools import tool_positions
from optplan.plot.faults import draw_faults, faults_of, height_of, legend_of

if TYPE_CHECKING:
    from matplotlib.axes import Axes
    from matplotlib.figure import Figure

ARROWS = 12
"""Direction arrows along work or travel as long as the picture is wide; no more than 100 of each."""
NUMBERED = 60
"""Up to this many strokes carry their number."""
LABEL = np.array([13.0, 9.0])
"""Width and height of such a number, points."""
CHORD = 0.05
"""Turning between the points of a drawn arc, rad."""


class _Colours(NamedTuple):
    ground: str
    work: str
    travel: str
    arrow: str
    text: str
    back: str
    """driven backwards"""


_SAND = _Colours("#ecdcb4", "#8a6a3f", "#1f6f8b", "#fff6dd", "#3b2f1e", "#b0367a")
_GRASS = _Colours("#4f8a3c", "#ffffff", "#ffd166", "#1d3b14", "#102408", "#ff9f6b")
_PAPER = _Colours("#ffffff", "#1c2a39", "#d1495b", "#ffffff", "#1c2a39", "#7a3fb0")


def figure(plan: Plan, unit: str = "m") -> Figure:
    """A matplotlib figure of a plan, with lengths in m, ft or yd. Raises InputError when it has no strokes yet."""
    from matplotlib.figure import Figure

    if plan.cover is None:
        raise InputError("the plan has nothing to draw yet; run the stage cover first")
    low, high = _extent(plan)
    size = np.maximum(high - low, 1e-9)
    inches = 8 * size / size.max()
    inches = np.maximum(inches, 2.5)
    wide, faults = max(float(inches[0]) + 1.1, 7.0), faults_of(plan)
    legend = legend_of(faults, 72 * min(float(inches[0]) + 0.5, wide - 0.9))
    below = 0.55 + height_of(legend)
    made = Figure(figsize=(wide, float(inches[1]) + 0.95 + below), facecolor="white")
    width, height = made.get_size_inches()
    left = max(0.75, (width - inches[0]) / 2)
    axes = made.add_axes((left / width, below / height, inches[0] / width, inches[1] / height))
    axes.set(xlim=(low[0], high[0]), ylim=(low[1], high[1]), aspect="equal")
    small = size.max() < 1
    colours = _SAND if isinstance(plan.robot.mobility, DiffDrive) else _PAPER
    if isinstance(plan.job, Field):
        colours = _GRASS
    axes.set_facecolor(colours.ground)
    axes.tick_params(labelsize=8, color="#999999")
    for spine in axes.spines.values():
        spine.set_color("#bbbbbb")
    if unit != "m":
        _ticks_in(axes, unit)
    elif small:
        axes.xaxis.set_major_formatter(lambda value, _: f"{value * 1000:g}")
        axes.yaxis.set_major_formatter(lambda value, _: f"{value * 1000:g}")
    axes.set_xlabel("mm" if small and unit == "m" else unit, fontsize=8)
    points_per_metre = 72 * min(inches / size)
    if plan.path is None:
        _draw_strokes(axes, plan, colours, points_per_metre)
    else:
        _draw_path(axes, plan, plan.path, colours, points_per_metre)
    _draw_areas(axes, plan)
    _draw_places(axes, plan, colours)
    draw_faults(axes, faults, legend)
    _draw_title(made, plan, colours, unit)
    return made


def _ticks_in(axes: Axes, unit: str) -> None:
    """Ticks at round feet or yards instead of metres."""
    from matplotlib.ticker import MaxNLocator

    for axis, (low, high) in ((axes.xaxis, axes.get_xlim()), (axes.yaxis, axes.get_ylim())):
        metres = LENGTH[unit]
        values = [float(v) for v in MaxNLocator(8).tick_values(low / metres, high / metres)]
        shown_ones = [value for value in values if low <= value * metres <= high]
        axis.set_ticks([value * metres for value in shown_ones], labels=[f"{value:g}" for value in shown_ones])


def _extent(plan: Plan) -> tuple[FloatArray, FloatArray]:
    cover = plan.cover
    assert cover is not None  # `figure` has made sure
    boxes = [stroke.points[:, :2] for stroke in cover.strokes]
    if plan.path is not None:
        boxes.append(plan.path.start[:, :2])
    if cover.canvas is not None:
        boxes.append(np.array([[0, 0], [cover.canvas.width, cover.canvas.height]]))
    everything = np.concatenate(boxes) if boxes else np.zeros((1, 2))
    low, high = everything.min(axis=0), everything.max(axis=0)
    if cover.canvas is None:
        border = max(0.03 * float((high - low).max()), 1e-6)
        low, high = low - border, high + border
    return low, high


def _draw_strokes(axes: Axes, plan: Plan, colours: _Colours, scale: float) -> None:
    from matplotlib.collections import LineCollection

    assert plan.cover is not None
    settings = plan.robot.tool.settings
    for tool, setting in enumerate(settings):
        lines = [stroke.closed_points[:, :2] for stroke in plan.cover.strokes if stroke.tool == tool]
        if lines and tool != RAISED:
            axes.add_collection(
                LineCollection(
                    lines, colors=colours.work, linewidths=setting.width * scale, capstyle="round", joinstyle="round"
                )
            )
        elif lines:
            axes.add_collection(LineCollection(lines, colors=colours.travel, linewidths=0.9, linestyles="--"))


def _draw_path(axes: Axes, plan: Plan, path: Path, colours: _Colours, scale: float) -> None:
    from matplotlib.collections import LineCollection

    down, place = path.tool != RAISED, plan.robot.offset
    for tool, setting in enumerate(plan.robot.tool.settings[1:], start=1):
        lines = _lines(path, (path.tool == tool) & (path.length > 0), place)
        axes.add_collection(
            LineCollection(
                lines,
                colors=colours.work,
                linewidths=max(setting.width * scale, 0.3),
                capstyle="round",
                joinstyle="round",
                zorder=2,
            )
        )
    moving = path.length > 0
    between = moving & ~down & (path.stroke < 0)
    backwards = moving & (path.gear < 0)
    by_hand = moving & ~down & (path.stroke >= 0)
    forwards = between & ~backwards
    axes.add_collection(LineCollection(_lines(path, forwards), colors=colours.travel, linewidths=0.9, zorder=3))
    axes.add_collection(LineCollection(_lines(path, backwards), colors=colours.back, linewidths=1.3, zorder=3))
    if place.aside:
        beside = _lines(path, moving & down)
        axes.add_collection(LineCollection(beside, colors=colours.text, linewidths=0.6, zorder=3))
    cusps = path.start[path.cusps]
    axes.plot(cusps[:, 0], cusps[:, 1], "D", ms=3, color=colours.back, mec="white", mew=0.5, zorder=5)
    axes.add_collection(
        LineCollection(_lines(path, by_hand), colors=colours.travel, linewidths=1.1, linestyles="--", zorder=3)
    )
    spacing = float(max(np.ptp(axes.get_xlim()), np.ptp(axes.get_ylim()))) / ARROWS
    _arrows(axes, path, moving & down, spacing, colours.arrow, colours.work)
    _arrows(axes, path, forwards, spacing, colours.travel, colours.ground)
    _arrows(axes, path, backwards, spacing, colours.back, colours.ground)
    _numbers(axes, plan, colours, scale)


def _lines(path: Path, rows: BoolArray, place: ToolPlace = MIDDLE) -> list[FloatArray]:
    """Polylines (k, 2) of consecutive rows that follow one another without a gap: where the tool at a place goes."""
    chosen = np.flatnonzero(rows)
    if len(chosen) == 0:
        return []
    turning = np.abs(path.curvature) * path.length + np.abs(path.sharpness) * path.length**2 / 2
    parts = np.maximum(1, np.ceil(turning[chosen] / CHORD)).astype(np.int64)
    piece = np.repeat(chosen, parts + 1)
    begin = np.repeat(np.cumsum(parts + 1) - parts - 1, parts + 1)
    share = (np.arange(len(piece)) - begin) / np.repeat(parts, parts + 1)
    states = along(path, piece, path.length[piece] * share)
    points = tool_positions(states.position, states.heading, path.gear[piece], place)[:, :2]
    first, last = np.cumsum(parts + 1) - parts - 1, np.cumsum(parts + 1) - 1
    # a piece goes on with the one before it when only turns on the spot lie between, and no gap
    rank = np.searchsorted(np.flatnonzero(path.length > 0), chosen)
    near = np.abs(points[first[1:]] - points[last[:-1]]).max(axis=1) < 1e-9
    follows = np.concatenate([[False], (np.diff(rank) == 1) & near])
    keep = np.ones(len(points), dtype=np.bool_)
    keep[first[follows]] = False
    line = np.cumsum(~follows)[np.repeat(np.arange(len(chosen)), parts + 1)][keep]
    return np.split(points[keep], np.flatnonzero(np.diff(line)) + 1)


def _arrows(axes: Axes, path: Path, rows: BoolArray, spacing: float, colour: str, edge: str) -> None:
    """Arrow heads at even distances (m) along the chosen rows."""
    chosen = np.flatnonzero(rows)
    total = float(path.length[chosen].sum())
    if total <= 0:
        return
    offsets = np.concatenate([[0.0], np.cumsum(path.length[chosen])])
    count = int(np.clip(round(total / spacing), 1, 100))
    places = (np.arange(count) + 0.5) * total / count
    row = np.clip(np.searchsorted(offsets, places, side="right") - 1, 0, len(chosen) - 1)
    states = along(path, chosen[row], places - offsets[row])
    axes.quiver(
        states.position[:, 0],
        states.position[:, 1],
        np.cos(states.heading),
        np.sin(states.heading),
        color=colour,
        edgecolor=edge,
        linewidth=0.3,
        scale=95,
        headwidth=7,
        headlength=7,
        headaxislength=6,
        width=0.0022,
        pivot="mid",
        zorder=4,
    )


def _labels(places: FloatArray) -> list[tuple[str, FloatArray]]:
    """Numbers from 1 at places (n, 2), points; those that would cover each other share a label."""
    labels: list[tuple[list[int], FloatArray]] = []
    for number, place in enumerate(places, start=1):
        near = [numbers for numbers, other in labels if np.all(np.abs(place - other) < LABEL)]
        if near:
            near[0].append(number)
        else:
            labels.append(([number], place))
    return [(", ".join(map(str, numbers)), place) for numbers, place in labels]


def _numbers(axes: Axes, plan: Plan, colours: _Colours, scale: float) -> None:
    if plan.visits is None or not 1 < len(plan.visits) <= NUMBERED:
        return
    for text, place in _labels(plan.visits.entry[:, :2] * scale):
        axes.annotate(
            text,
            (place / scale).tolist(),
            xytext=(4, 4),
            textcoords="offset points",
            fontsize=7,
            color=colours.text,
            bbox={"boxstyle": "round,pad=0.15", "facecolor": "white", "alpha": 0.75, "linewidth": 0},
            zorder=6,
        )


def _draw_places(axes: Axes, plan: Plan, colours: _Colours) -> None:
    assert plan.cover is not None
    places = []
    if plan.path is not None and len(plan.path):
        last = along(plan.path, np.array([len(plan.path) - 1]), plan.path.length[-1:]).position[0]
        places = [(plan.path.start[0], "o", "#2e9e4f", "start"), (last, "s", "#c0392b", "end")]
    elif plan.cover.start is not None:
        places = [(np.array(plan.cover.start), "o", "#2e9e4f", "start")]
    for place, marker, colour, label in places:
        axes.plot(
            place[0], place[1], marker, ms=8, color=colour, mec="white", mew=1.2, label=label, zorder=7, ls="none"
        )
    if plan.path is not None:
        shown = "#b8b8b8" if colours.work == "#ffffff" else colours.work  # on white, white is nothing
        axes.plot([], [], "-", color=shown, lw=4, label="tool down")
        axes.plot([], [], "-", color=colours.travel, lw=1, label="tool up")
        if plan.robot.offset.aside:
            axes.plot([], [], "-", color=colours.text, lw=0.6, label="robot, tool down")
        if len(plan.path.cusps) or (plan.path.gear < 0).any():
            axes.plot([], [], "-D", color=colours.back, lw=1.3, ms=3, label="backwards, gear changes")
    if places:
        axes.legend(loc="lower right", bbox_to_anchor=(1, 1), fontsize=7, frameon=False, ncols=5, columnspacing=1)
    canvas = plan.cover.canvas
    if canvas is not None and canvas.margin > 0:
        m = canvas.margin
        x, y = [m, canvas.width - m], [m, canvas.height - m]
        axes.plot(
            [x[0], x[1], x[1], x[0], x[0]], [y[0], y[0], y[1], y[1], y[0]], ":", color="#999999", lw=0.8, zorder=1
        )


def _draw_areas(axes: Axes, plan: Plan) -> None:
    """What connectors keep out of, and the border of what they keep in."""
    asked = plan.options.connect
    for ring in asked.keep_out:
        axes.fill(*np.array(ring).T, facecolor="#c0392b22", edgecolor="#c0392b", lw=0.8, hatch="///", zorder=1)
    if asked.keep_in is not None:
        axes.plot(*np.array([*asked.keep_in, asked.keep_in[0]]).T, "--", color="#c0392b", lw=0.8, zorder=1)


def _draw_title(made: Figure, plan: Plan, colours: _Colours, unit: str) -> None:
    title = f"{plan.job.name}  ·  {plan.robot.name}"
    facts = []
    path, ordering = plan.path, plan.ordering
    if path is not None:
        down = float(path.length[path.tool != RAISED].sum())
        up = float(path.length[(path.tool == RAISED) & (path.stroke < 0)].sum())
        facts += [f"{_length(down, unit)} tool down", f"{_length(up, unit)} tool up"]
    if plan.trajectory is not None:
        minutes, seconds = divmod(round(plan.trajectory.duration), 60)
        facts.append(f"{minutes}:{seconds:02d} min")
    if ordering is not None and math.isfinite(ordering.gap):
        facts.append(
            "order proved optimal"
            if ordering.gap <= 1e-6
            else f"no order is more than {100 * min(ordering.gap, 1.0):.1f} % shorter"
        )
    elif plan.cover is not None and not facts:
        facts.append(f"{len(plan.cover.strokes)} strokes")
    width, height = made.get_size_inches()
    left = 0.75 / width
    made.text(left, 1 - 0.33 / height, title, fontsize=12, weight="bold", color=colours.text)
    made.text(left, 1 - 0.6 / height, "   ".join(facts), fontsize=9, color=colours.text)


def _length(length: float, unit: str) -> str:
    if unit != "m":
        return f"{shown(length, 'm', unit)[0]:.1f} {unit}"
    return f"{length:.1f} m" if length >= 1 or length == 0 else f"{1000 * length:.0f} mm"
