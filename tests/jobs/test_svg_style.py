"""The cascade and colours."""

from __future__ import annotations

import pytest

from tests.jobs.svg_texts import drawing, texts

SHAPE = 'd="M0 0h9v9z"'


def fill(body: str) -> str | None:
    (element,) = drawing(body).elements
    return element.fill


@pytest.mark.parametrize(
    ("body", "expected"),
    [
        (f"<path {SHAPE}/>", "#000000"),
        (f'<path {SHAPE} fill="red"/>', "#ff0000"),
        (f'<g fill="red"><path {SHAPE}/></g>', "#ff0000"),
        (f'<g fill="red"><path {SHAPE} fill="lime"/></g>', "#00ff00"),
        (f'<g fill="red"><path {SHAPE} fill="nonsense"/></g>', "#ff0000"),
        (f'<path {SHAPE} fill="red" style="fill:blue"/>', "#0000ff"),
        (f'<style>path{{fill:lime}}</style><path {SHAPE} fill="red"/>', "#00ff00"),
        (f'<style>path{{fill:lime}}</style><path {SHAPE} style="fill:blue"/>', "#0000ff"),
        (f'<style>path{{fill:lime!important}}</style><path {SHAPE} style="fill:blue"/>', "#00ff00"),
        (
            f'<style>path{{fill:lime!important}}</style><path {SHAPE} style="fill:blue !important"/>',
            "#0000ff",
        ),
        (f'<style>.a{{fill:lime}}path{{fill:red}}</style><path class="b a" {SHAPE}/>', "#00ff00"),
        (f'<style>#i{{fill:blue}}.a{{fill:lime}}</style><path id="i" class="a" {SHAPE}/>', "#0000ff"),
        (f"<style>path{{fill:lime}}path{{fill:red}}</style><path {SHAPE}/>", "#ff0000"),
        (f"<style>path{{fill:lime;fill:oops}}</style><path {SHAPE}/>", "#00ff00"),
        (f'<style>.x path{{fill:lime}}</style><g class="x"><g><path {SHAPE}/></g></g>', "#00ff00"),
        (f'<style>.x > path{{fill:lime}}</style><g class="x" fill="red"><g><path {SHAPE}/></g></g>', "#ff0000"),
        (f"<style>g + path{{fill:lime}}</style><g/><path {SHAPE}/>", "#00ff00"),
        (f"<style>g ~ path{{fill:lime}}</style><g/><text/><path {SHAPE}/>", "#00ff00"),
        (f"<style>path:nth-child(3){{fill:lime}}</style><path {SHAPE}/>", "#000000"),
        (f"<style>path:not(.a){{fill:lime}}</style><path {SHAPE}/>", "#00ff00"),
        (f'<style>path[d^="M0"]{{fill:lime}}</style><path {SHAPE}/>', "#00ff00"),
        (f"<style>svg|path{{fill:red}}@namespace svg url(urn:x);</style><path {SHAPE}/>", "#000000"),
        (f"<style>@namespace s url(http://www.w3.org/2000/svg);s|path{{fill:lime}}</style><path {SHAPE}/>", "#00ff00"),
        (
            f"<style>@media screen{{path{{fill:lime}}}}@media print{{path{{fill:red}}}}</style><path {SHAPE}/>",
            "#00ff00",
        ),
        (f"<style><![CDATA[path{{fill:lime}}]]></style><path {SHAPE}/>", "#00ff00"),
        (f'<style type="text/less">path{{fill:lime}}</style><path {SHAPE}/>', "#000000"),
        (
            f'<style>*{{fill:lime}}</style><g fill="red"><path fill="inherit" {SHAPE} style="fill:inherit"/></g>',
            "#00ff00",
        ),
        (f'<g fill="red"><path {SHAPE} style="fill:initial"/></g>', "#000000"),
        (f'<g fill="red"><path {SHAPE} style="fill:unset"/></g>', "#ff0000"),
        (f'<g color="red" fill="currentColor"><path {SHAPE} color="lime"/></g>', "#00ff00"),
        (f'<g color="red"><path {SHAPE} fill="currentcolor"/></g>', "#ff0000"),
        (f"<path {SHAPE} style=\"font-family:'a;b';fill:lime\"/>", "#00ff00"),
        (f'<path {SHAPE} style="/* fill:red; */ FILL : lime ;;"/>', "#00ff00"),
        (f'<path {SHAPE} style="fill:url(#gone) lime"/>', "#00ff00"),
    ],
)
def test_the_cascade(body: str, expected: str) -> None:
    assert fill(body) == expected


@pytest.mark.parametrize(
    ("color", "expected"),
    [
        ("red", "#ff0000"),
        ("RebeccaPurple", "#663399"),
        ("#AbC", "#aabbcc"),
        ("#A1b2C3", "#a1b2c3"),
        ("#abcf", "#aabbcc"),
        ("#a1b2c3ff", "#a1b2c3"),
        ("#a1b2c380", "#a1b2c3"),
        ("rgb(1,2,3)", "#010203"),
        ("rgb( 100% , 0% , 50% )", "#ff0080"),
        ("rgb(300,-5,0)", "#ff0000"),
        ("rgb(1 2 3 / 50%)", "#010203"),
        ("rgba(1,2,3,.5)", "#010203"),
        ("hsl(120,100%,25%)", "#008000"),
        ("hsla(0,100%,50%,1)", "#ff0000"),
        ("#CD853F icc-color(acmecmyk, 0.11, 0.48, 0.83, 0.00)", "#cd853f"),
        ("context-fill", "#808080"),
    ],
)
def test_colors(color: str, expected: str) -> None:
    assert fill(f'<path {SHAPE} fill="{color}"/>') == expected


@pytest.mark.parametrize("color", ["none", "transparent", "#0000", "#00000000", "rgba(1,2,3,0)", "hsla(1,1%,1%,0)"])
def test_no_color(color: str) -> None:
    assert fill(f'<path {SHAPE} fill="{color}" stroke="red"/>') is None


@pytest.mark.parametrize(
    "color", ["nonsense", "#12", "#1234567", "rgb(1,2)", "lab(1 2 3)", "", "red lime", "url(", "1"]
)
def test_what_is_no_color_leaves_the_inherited_one_and_is_reported(color: str) -> None:
    read = drawing(f'<g fill="#123456"><path {SHAPE} fill="{color}"/></g>')
    assert read.elements[0].fill == "#123456"
    assert "value of fill that cannot be understood" in texts(read)


def test_opacity_takes_strokes_and_fills_away() -> None:
    (element,) = drawing(f'<path {SHAPE} stroke="red" fill-opacity="0"/>').elements
    assert (element.fill, element.stroke) == (None, "#ff0000")
    (element,) = drawing(f'<path {SHAPE} stroke="red" style="stroke-opacity:0%"/>').elements
    assert (element.fill, element.stroke) == ("#000000", None)


@pytest.mark.parametrize(
    ("text", "width"),
    [("3", 3), ("3px", 3), ("1in", 96), ("10%", 10), ("0.5e1", 5), ("-1", 1), ("wide", 1), ("inherit", 2), ("1em", 16)],
)
def test_stroke_widths(text: str, width: float) -> None:
    parent = 2 if text == "inherit" else 1
    body = f'<g stroke-width="{parent}"><path {SHAPE} stroke="red" stroke-width="{text}"/></g>'
    assert drawing(body).elements[0].stroke_width == pytest.approx(width)


def test_a_stroke_without_width_is_none() -> None:
    (element,) = drawing(f'<path {SHAPE} stroke="red" stroke-width="0"/>').elements
    assert element.stroke is None


def test_strokes_that_do_not_scale() -> None:
    (element,) = drawing(
        f'<path {SHAPE} transform="scale(3)" stroke="red" vector-effect="non-scaling-stroke"/>'
    ).elements
    assert element.stroke_width == 1


def test_visibility_is_inherited_but_may_be_taken_back() -> None:
    body = f'<g visibility="hidden"><path {SHAPE}/><path id="b" visibility="visible" {SHAPE}/></g>'
    assert [element.id for element in drawing(body).elements] == ["b"]


def test_style_sheets_set_geometry() -> None:
    (element,) = drawing('<style>rect{width:7px}</style><rect width="1" height="2"/>').elements
    assert element.curves[0].points[:, 0].max() == pytest.approx(7 * 0.0254 / 96)


def test_a_named_color_kept_as_a_gradient_is_that_color() -> None:
    body = (
        '<linearGradient id="a"><stop style="stop-color:#12ab34"/></linearGradient>'
        f'<linearGradient id="b" xlink:href="#a"/><path {SHAPE} fill="url(#b)"/>'
    )
    read = drawing(body)
    assert read.elements[0].fill == "#12ab34"
    assert read.notes == ()
