"""What a film shows: colours, where the world lies on the picture, and the robot's shape."""

from __future__ import annotations

import math
from typing import NamedTuple

import numpy as np

from optplan.domain.arrays import FloatArray
from optplan.domain.drive import Motion
from optplan.domain.path import RAISED
from optplan.domain.robot import DiffDrive, Robot

FINE = 2
"""Pixels of the sheet a pixel of the frame, along each side."""
SMALLEST = 20.0
"""The robot is drawn at least this many pixels across, however large the ground is."""
BORDER = 0.03
"""Room around what is driven, a share of its size."""


class Colours(NamedTuple):
    """What has which colour."""

    ground: str
    hint: str
    work: str
    travel: str
    text: str
    body: str
    wheel: str
    front: str
    down: str


SAND = Colours("#ecdcb4", "#dfcb9c", "#8a6a3f", "#1f6f8b", "#3b2f1e", "#f7f7f2", "#2b2b2b", "#c0392b", "#c0392b")
GRASS = Colours("#4f8a3c", "#5f9a4b", "#ffffff", "#ffd166", "#102408", "#e8e8e8", "#2b2b2b", "#c0392b", "#c0392b")
PAPER = Colours("#ffffff", "#e6e9ed", "#1c2a39", "#d1495b", "#1c2a39", "#f2c14e", "#2b2b2b", "#c0392b", "#c0392b")


class Ground(NamedTuple):
    """Where the world lies on the sheet."""

    low: FloatArray
    """(2,) m, the lower left corner"""
    scale: float
    """pixels of the sheet a metre"""
    width: int
    """pixels of the frame"""
    height: int
    """pixels of the frame, without the line of text"""

    def pixels(self, points: FloatArray) -> FloatArray:
        """(n, 2) places on the sheet of points (n, 2) in m."""
        flat = (np.asarray(points) - self.low) * self.scale
        return np.column_stack([flat[:, 0], self.height * FINE - flat[:, 1]])


def ground_of(points: FloatArray, canvas: tuple[float, float] | None, longer: int) -> Ground:
    """The ground that shows points (n, 2) m and the canvas (width, height), its longer side so many pixels."""
    boxes = [points] if canvas is None else [points, np.array([[0.0, 0.0], canvas])]
    everything = np.concatenate(boxes)
    low, high = everything.min(axis=0), everything.max(axis=0)
    room = max(BORDER * float((high - low).max()), 1e-6)
    low, high = low - room, high + room
    scale = longer / float((high - low).max())
    # whole numbers of two pixels, as video formats want them
    width, height = (2 * max(16, math.ceil(float(side) * scale / 2)) for side in high - low)
    return Ground(low, scale * FINE, width, height)


def robot_shapes(
    robot: Robot, motion: Motion, moment: int, ground: Ground, colours: Colours
) -> list[tuple[FloatArray, str, str | None]]:
    """Polygons on the sheet, from below to above: points, colour, outline."""
    place = ground.pixels(np.array([[motion.x[moment], motion.y[moment]]]))[0]
    tool = ground.pixels(np.array([[motion.tool_x[moment], motion.tool_y[moment]]]))[0]
    heading = float(motion.heading[moment])
    setting = int(motion.tool[moment])
    ahead = np.array([math.cos(heading), -math.sin(heading)])
    left = np.array([-math.sin(heading), -math.cos(heading)])
    least = SMALLEST * FINE

    def around(centre: FloatArray, corners: list[tuple[float, float]]) -> FloatArray:
        return np.array([centre + a * ahead + b * left for a, b in corners])

    def bar(half: float, thick: float) -> FloatArray:
        return around(tool, [(-thick, -half), (-thick, half), (thick, half), (thick, -half)])

    widest = max(choice.width for choice in robot.tool.settings) * ground.scale
    marking = setting != RAISED
    half = max((robot.tool.settings[setting].width * ground.scale if marking else widest) / 2, 3.0)
    tool_shape = (bar(half, max(FINE * 1.2, 0.06 * half)), colours.down if marking else colours.travel, None)
    if not isinstance(robot.mobility, DiffDrive):
        angles = np.linspace(0, 2 * math.pi, 25)[:-1]
        ring = place + least / 3 * np.column_stack([np.cos(angles), np.sin(angles)])
        inner = place + (ring - place) / 2.5
        return [(ring, colours.body, colours.wheel), (inner, colours.down if marking else colours.travel, None)]
    size = max(robot.mobility.track * ground.scale, least)  # between the wheels
    wheel = max(2 * robot.mobility.wheel_radius * ground.scale, 0.4 * size)
    thick = 0.2 * size
    body = around(place, [(-0.6 * size, -0.4 * size), (-0.6 * size, 0.4 * size), (0.7 * size, 0.4 * size)])
    body = np.concatenate([body, around(place, [(0.7 * size, -0.4 * size)])])
    shapes: list[tuple[FloatArray, str, str | None]] = []
    for side in (-1, 1):
        b = side * size / 2
        corners = [(-wheel / 2, b - thick / 2), (-wheel / 2, b + thick / 2)]
        corners += [(wheel / 2, b + thick / 2), (wheel / 2, b - thick / 2)]
        shapes.append((around(place, corners), colours.wheel, None))
    shapes.append((body, colours.body, colours.wheel))
    nose = around(place, [(0.62 * size, 0.0), (0.2 * size, 0.28 * size), (0.2 * size, -0.28 * size)])
    shapes.append((nose, colours.front, None))
    shapes.append(tool_shape)
    return shapes
