"""Numbers made of straight lines, as stencils have them."""

from __future__ import annotations

from optplan.jobs.fields.pen import Pen, Place

_STROKES: dict[str, tuple[tuple[Place, ...], ...]] = {
    "0": (((0, 0), (1, 0), (1, 2), (0, 2), (0, 0)),),
    "1": (((0.5, 0), (0.5, 2)),),
    "2": (((0, 2), (1, 2), (1, 1), (0, 1), (0, 0), (1, 0)),),
    "3": (((0, 2), (1, 2), (1, 0), (0, 0)), ((0, 1), (1, 1))),
    "4": (((0, 2), (0, 1), (1, 1)), ((1, 2), (1, 0))),
    "5": (((1, 2), (0, 2), (0, 1), (1, 1), (1, 0), (0, 0)),),
    "6": (((1, 2), (0, 2), (0, 0), (1, 0), (1, 1), (0, 1)),),
    "7": (((0, 2), (1, 2), (1, 0)),),
    "8": (((0, 0), (1, 0), (1, 2), (0, 2), (0, 0)), ((0, 1), (1, 1))),
    "9": (((1, 0), (1, 2), (0, 2), (0, 1), (1, 1)),),
}
"""On a grid one wide and two high."""
SPREAD = 0.35
"""Gap between two figures, in their width."""


def numeral(pen: Pen, text: str, middle: Place, height: float, sign: int = 1) -> None:
    """A number of this height (m) around a place; it is read from below, or with sign -1 turned by half a turn, so
    that it is read from the other side line."""
    width = height * 2 / 3
    pitch = width * (1 + SPREAD)
    left = -(pitch * (len(text) - 1) + width) / 2
    # a number on the far side stands on its feet when seen from there
    turn = -1 if sign > 0 else 1
    for place, figure in enumerate(text):
        for number, stroke in enumerate(_STROKES[figure], start=1):
            points = [
                (
                    middle[0] + turn * pen.x * (left + place * pitch + x * width),
                    middle[1] + turn * (y / 2 - 0.5) * height,
                )
                for x, y in stroke
            ]
            pen.lines(f"figure {place + 1}.{number}", *points)
