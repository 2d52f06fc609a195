"""What tests draw at random, and small things that many of them need."""

from __future__ import annotations

import math

import numpy as np
from hypothesis import strategies as st

from optplan.domain.arrays import FloatArray
from optplan.domain.job import Curve, Drawing, Element
from optplan.domain.robot import Canvas, DiffDrive, Gantry, Robot, Tool, ToolSetting

TOOL = Tool((ToolSetting("up", 0.0), ToolSetting("narrow", 0.1, 1), ToolSetting("wide", 0.4, 3)), fill=2)
WHEELS = DiffDrive(0.5, 0.1, 20.0, 40.0, 0.4, 0.6, turns_on_spot=True, turn_rate=1.0, radius=0.5)
RAKE = Robot("rake", "turns on the spot", TOOL, WHEELS, Canvas(20.0, 20.0, 0.5))
CAR = Robot("car", "does not", TOOL, DiffDrive(0.5, 0.1, 20.0, 40.0, 0.4, 0.6, radius=0.5), Canvas(20.0, 20.0, 0.5))
PLOTTER = Robot("plotter", "has no heading", TOOL, Gantry(0.4, 0.6, 1.0), Canvas(20.0, 20.0, 0.5))

coordinates = st.floats(-20, 20, allow_subnormal=False)
angles = st.floats(-10, 10, allow_subnormal=False)
radii = st.floats(0.05, 10)
points = st.tuples(coordinates, coordinates)
states = st.tuples(coordinates, coordinates, angles)
seeds = st.integers(0, 2**32 - 1)


def array(values: object) -> FloatArray:
    """Numbers as an array."""
    return np.array(values, dtype=np.float64)


@st.composite
def polylines(draw: st.DrawFn, least: int = 3, most: int = 12) -> FloatArray:
    """(n, 2) a walk of steps 0.1..3 m with deflections up to 175 degrees."""
    count = draw(st.integers(least - 1, most - 1))
    steps = draw(st.lists(st.floats(0.1, 3), min_size=count, max_size=count))
    turns = draw(st.lists(st.floats(-3.05, 3.05), min_size=count, max_size=count))
    headings = np.cumsum(np.round(turns, 6))
    moves = array(steps)[:, None] * np.column_stack([np.cos(headings), np.sin(headings)])
    return np.concatenate([np.zeros((1, 2)), np.cumsum(moves, axis=0)])


@st.composite
def star_shaped(draw: st.DrawFn, least: int = 3, most: int = 12) -> FloatArray:
    """(n, 2) a simple ring around the origin, counterclockwise, 0.5..4 m from it."""
    count = draw(st.integers(least, most))
    reach = draw(st.lists(st.floats(0.5, 4), min_size=count, max_size=count))
    turn = draw(st.floats(0, 2 * math.pi))
    heading = turn + np.arange(count) * 2 * math.pi / count
    ring: FloatArray = array(reach)[:, None] * np.column_stack([np.cos(heading), np.sin(heading)])
    return ring


def circle(radius: float, count: int, center: tuple[float, float] = (0.0, 0.0)) -> FloatArray:
    """(n, 2) evenly spaced vertices, counterclockwise."""
    heading = np.arange(count) * 2 * math.pi / count
    return array(center) + radius * np.column_stack([np.cos(heading), np.sin(heading)])


def box(x: float, y: float, width: float, height: float) -> FloatArray:
    """(4, 2) corners, counterclockwise."""
    return array([[x, y], [x + width, y], [x + width, y + height], [x, y + height]])


def element(name: str, ring: object, closed: bool = True, **more: object) -> Element:
    """An element of one subpath of straight lines; black outline unless said otherwise."""
    given: dict[str, object] = {"stroke": "#000000", "fill": None} | more
    return Element(name, (Curve(array(ring), closed=closed),), **given)  # type: ignore[arg-type]


def drawing(*elements: Element) -> Drawing:
    """A drawing of these elements."""
    return Drawing("test", elements)
