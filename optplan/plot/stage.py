"""Frames of an animation: the ground with its growing marks, and the robot on it.

Nothing is drawn twice: new marks go onto a sheet of twice the resolution, and only what they touched is brought down to
the frame's resolution (which smooths its edges). The robot is drawn on a copy of the piece of the sheet around it.
"""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np

from optplan.domain.arrays import FloatArray
from optplan.domain.drive import Motion
from optplan.domain.path import RAISED
from optplan.domain.robot import DiffDrive, Robot
from optplan.plot.scene import FINE, PAPER, SAND, Colours, Ground, robot_shapes

if TYPE_CHECKING:
    from PIL.Image import Image

HEAD = 30
"""Height of the line of text above the ground, pixels."""


class Stage:
    """Draws frame after frame. Only `frame` changes it, and only forwards in time."""

    def __init__(
        self, motion: Motion, robot: Robot, ground: Ground, title: str, colours: Colours | None = None
    ) -> None:
        from PIL import Image, ImageDraw, ImageFont

        self.motion, self.robot, self.ground = motion, robot, ground
        self.colours = colours or (SAND if isinstance(robot.mobility, DiffDrive) else PAPER)
        size = (ground.width * FINE, ground.height * FINE)
        self.sheet = Image.new("RGB", size, self.colours.ground)
        self._pen = ImageDraw.Draw(self.sheet)
        self._track = ground.pixels(np.column_stack([motion.tool_x, motion.tool_y]))
        self._place = ground.pixels(np.column_stack([motion.x, motion.y]))
        self._lift: list[tuple[float, float]] = []
        self._drawn = 0
        self._font = ImageFont.load_default(15)
        self._hints()
        self._small = Image.new("RGB", (ground.width, ground.height + HEAD), "white")
        self._small.paste(self.sheet.reduce(FINE), (0, HEAD))
        self._title = self._shortened(title, ground.width * 0.55)

    def frame(self, moment: int) -> Image:
        """The picture at a moment of the motion, one not before the last that was asked for."""
        self._grow(moment)
        picture = self._small.copy()
        self._robot(picture, moment)
        self._text(picture, moment)
        return picture

    @property
    def size(self) -> tuple[int, int]:
        """Width and height of a frame, pixels."""
        return self._small.size

    def palette(self) -> list[tuple[int, int, int]]:
        """Colours of the frames, and what lies between any two of them along edges."""
        from PIL import ImageColor

        named = np.array([ImageColor.getrgb(colour)[:3] for colour in dict.fromkeys((*self.colours, "#ffffff"))])
        first, second = np.triu_indices(len(named), 1)
        shares = np.array([0.25, 0.5, 0.75])[:, None, None]
        mixed = np.round(named[first] + shares * (named[second] - named[first])).astype(np.int64).reshape(-1, 3)
        return [(int(r), int(g), int(b)) for r, g, b in dict.fromkeys(map(tuple, np.concatenate([named, mixed])))]

    def _width(self, tool: int) -> float:
        return max(self.robot.tool.settings[tool].width * self.ground.scale, 1.0)

    def _hints(self) -> None:
        """What will be marked, faintly."""
        for begin, end, tool in _runs(self.motion.tool):
            if tool != RAISED:
                self._mark(begin, min(end, len(self.motion) - 1), self._width(tool), self.colours.hint)

    def _mark(self, begin: int, end: int, width: float, colour: str) -> None:
        """A line with round ends along the tool's track."""
        points = self._track[begin : end + 1]
        keep = np.ones(len(points), dtype=np.bool_)
        if len(points) > 2:  # points on top of one another say nothing
            cell = np.round(points)
            keep[1:-1] = (cell[1:-1] != cell[:-2]).any(axis=1)
        line = [(float(x), float(y)) for x, y in points[keep]]
        if len(line) > 1:
            self._pen.line(line, fill=colour, width=max(1, round(width)))
        if width > 3:  # discs make ends and joints round
            half = width / 2
            for x, y in line:
                self._pen.ellipse((x - half, y - half, x + half, y + half), fill=colour)

    def _grow(self, moment: int) -> None:
        """Mark what has been driven since the last frame."""
        if moment <= self._drawn:
            return
        begun = self._drawn
        for begin, end, tool in _runs(self.motion.tool[begun : moment + 1]):
            first, last = begun + begin, min(begun + end, moment)
            if tool == RAISED:
                self._mark(first, last, FINE, self.colours.travel)
            else:
                self._mark(first, last, self._width(tool), self.colours.work)
        self._drawn = moment
        widest = max(self._width(k) for k in range(len(self.robot.tool.settings)))
        self._bring_down(self._track[begun : moment + 1], widest)

    def _bring_down(self, points: FloatArray, room: float) -> None:
        box = self._box(points, room)
        if box is not None:
            left, top = box[0] // FINE, box[1] // FINE
            self._small.paste(self.sheet.crop(box).reduce(FINE), (left, top + HEAD))

    def _box(self, points: FloatArray, room: float) -> tuple[int, int, int, int] | None:
        """Whole frame pixels around points, on the sheet; None where nothing of it is on the sheet."""
        low = np.floor((points.min(axis=0) - room - 2) / FINE).astype(int)
        high = np.ceil((points.max(axis=0) + room + 2) / FINE).astype(int)
        left, top = max(int(low[0]), 0), max(int(low[1]), 0)
        right, bottom = min(int(high[0]), self.ground.width), min(int(high[1]), self.ground.height)
        if right <= left or bottom <= top:
            return None
        return left * FINE, top * FINE, right * FINE, bottom * FINE

    def _robot(self, picture: Image, moment: int) -> None:
        """The robot in its place: body, wheels, front, tool."""
        from PIL import ImageDraw

        shapes = robot_shapes(self.robot, self.motion, moment, self.ground, self.colours)
        box = self._box(np.concatenate([points for points, _, _ in shapes]), 4)
        if box is None:
            return
        patch = self.sheet.crop(box)
        pen = ImageDraw.Draw(patch)
        for points, fill, outline in shapes:
            corners = [(float(x) - box[0], float(y) - box[1]) for x, y in points]
            pen.polygon(corners, fill=fill, outline=outline, width=2)
        picture.paste(patch.reduce(FINE), (box[0] // FINE, box[1] // FINE + HEAD))

    def _text(self, picture: Image, moment: int) -> None:
        from PIL import ImageDraw

        pen = ImageDraw.Draw(picture)
        m = self.motion
        minutes, seconds = divmod(int(m.time[moment]), 60)
        facts = f"{minutes}:{seconds:02d}   {_speed(float(m.speed[moment]))}"
        pen.text((8, 6), self._title, fill=self.colours.text, font=self._font)
        wide = self._font.getlength(facts)
        pen.text((picture.width - 8 - wide, 6), facts, fill=self.colours.text, font=self._font)

    def _shortened(self, text: str, most: float) -> str:
        if self._font.getlength(text) <= most:
            return text
        while text and self._font.getlength(text + "...") > most:
            text = text[:-1]
        return text + "..."


def _runs(tool: np.ndarray) -> list[tuple[int, int, int]]:
    """Runs of one setting: first index, the index after the last, the setting."""
    cuts = np.flatnonzero(np.diff(tool)) + 1
    begins, ends = [0, *cuts.tolist()], [*cuts.tolist(), len(tool)]
    return [(b, e, int(tool[b])) for b, e in zip(begins, ends, strict=True)]


def _speed(speed: float) -> str:
    return f"{1000 * speed:.0f} mm/s" if 0 < abs(speed) < 0.1 else f"{speed:.2f} m/s"
