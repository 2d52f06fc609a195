"""What a tool makes of a drawing."""

from __future__ import annotations

import pytest

from optplan.domain.robot import Tool, ToolSetting
from optplan.jobs.syntax import Mark, interpret, is_green, is_red, is_white
from tests.jobs.svg_texts import PX, drawing

RAKE = Tool(
    settings=(
        ToolSetting("up", 0.0),
        *(ToolSetting(f"{pins} pins", pins * 0.05, code) for code, pins in enumerate((1, 3, 5, 7, 9), start=1)),
    ),
    stroke_widths=(1.0, 3.0, 5.0, 7.0),
    red_is_travel=True,
    green_is_start=True,
)
PEN = Tool(settings=(ToolSetting("up", 0.0), ToolSetting("pen", 0.0005)))
SHAPE = 'd="M0 0h9v9z"'


def mark(style: str, tool: Tool = RAKE) -> Mark:
    (only,) = interpret(drawing(f"<path {SHAPE} {style}/>"), tool).marks
    return only


@pytest.mark.parametrize(
    ("style", "outline", "fill"),
    [
        ('stroke="black" fill="none"', 1, False),
        ('stroke="black" fill="white"', 1, False),
        ('stroke="none" fill="black"', None, True),
        ('stroke="#fff" fill="blue"', None, True),
        ('stroke="white" fill="none"', None, False),
        ('stroke="none" fill="#fefefe"', None, False),
        ('stroke="blue" stroke-width="5" fill="yellow"', 3, True),
        ('stroke="red" fill="none"', 0, False),
        ('stroke="rgb(220,30,30)" fill="none"', 0, False),
        ('stroke="none" fill="red"', None, True),
        ('stroke="red" fill="red"', 0, True),
    ],
)
def test_what_is_drawn(style: str, outline: int | None, fill: bool) -> None:
    got = mark(style)
    assert (got.outline, got.fill, got.start) == (outline, fill, False)
    assert got.drawn == (outline is not None or fill)


@pytest.mark.parametrize(("width", "setting"), [(0.5, 1), (1, 1), (1.1, 2), (3, 2), (5, 3), (7, 4), (7.1, 5), (20, 5)])
def test_widths_pick_the_setting(width: float, setting: int) -> None:
    assert mark(f'stroke="black" fill="none" stroke-width="{width}"').outline == setting


def test_transforms_count_for_widths() -> None:
    assert mark('stroke="black" fill="none" stroke-width="1" transform="scale(5)"').outline == 3


@pytest.mark.parametrize("fill", ["none", "lime", "white", "black"])
def test_the_start_line_is_not_drawn(fill: str) -> None:
    body = f'<path d="M1 2L3 4 5 9" stroke="#00ff00" fill="{fill}"/>'
    marked = interpret(drawing(body), RAKE)
    (got,) = marked.marks
    assert (got.start, got.outline, got.fill, got.drawn) == (True, None, False, False)
    assert marked.start == pytest.approx([5 * PX, 91 * PX])
    assert len(marked.notes) == (fill == "black")


def test_of_several_start_lines_the_last_one_counts() -> None:
    marked = interpret(drawing('<path d="M1 1h1" stroke="lime"/><path d="M5 5h1" stroke="green"/>'), RAKE)
    assert marked.start == pytest.approx([6 * PX, 95 * PX])
    assert [note.kind for note in marked.notes] == ["notice"]


def test_without_a_start_line_there_is_no_start() -> None:
    assert interpret(drawing(f"<path {SHAPE}/>"), RAKE).start is None


@pytest.mark.parametrize(
    ("style", "layer"), [('stroke="red"', "#ff0000"), ('stroke="lime"', "#00ff00"), ('fill="blue"', "#0000ff")]
)
def test_where_colors_mean_nothing_they_are_layers(style: str, layer: str) -> None:
    got = mark(style, PEN)
    assert got.layer == layer
    assert not got.start
    assert got.outline == (1 if "stroke" in style else None)


def test_layers_of_the_drawing_come_before_colors() -> None:
    space = 'viewBox="0 0 9 9" xmlns:inkscape="http://www.inkscape.org/namespaces/inkscape"'
    body = f'<g inkscape:groupmode="layer" inkscape:label="Sky"><path {SHAPE} stroke="red"/></g>'
    for tool in (PEN, RAKE):
        assert interpret(drawing(body, space), tool).marks[0].layer == "Sky"


def test_white_is_not_drawn_and_said_to_be_so() -> None:
    for tool in (PEN, RAKE):
        marked = interpret(drawing(f'<path {SHAPE} stroke="white" fill="none"/>'), tool)
        assert not marked.marks[0].drawn
        assert [note.text for note in marked.notes] == ["white stroke: not drawn"]


@pytest.mark.parametrize(
    ("color", "red", "green", "white"),
    [
        ("#ff0000", True, False, False),
        ("#c83c3c", True, False, False),
        ("#c73c3c", False, False, False),
        ("#ff8000", False, False, False),
        ("#00ff00", False, True, False),
        ("#008000", False, True, False),
        ("#80ff80", False, False, False),
        ("#ffffff", False, False, True),
        ("#f0f0f0", False, False, False),
        ("#000000", False, False, False),
    ],
)
def test_colors(color: str, red: bool, green: bool, white: bool) -> None:
    assert (is_red(color), is_green(color), is_white(color)) == (red, green, white)
