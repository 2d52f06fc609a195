"""Bad drawings: one clear error each, in bounded time and memory."""

from __future__ import annotations

import contextlib
import gzip
import os
from pathlib import Path

import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from optplan.domain.errors import InputError, LimitError
from optplan.jobs.svg import limits, read_svg
from tests.jobs.svg_texts import HEAD, LINE, svg

OPEN = HEAD + ">"
NESTED = "".join(f'<!ENTITY l{k} "{f"&l{k - 1};" * 10}">' for k in range(1, 10))


def bomb(inner: str) -> str:
    levels = "".join(_level(k) for k in range(1, 12))
    return svg(f'<defs><g id="a0">{inner}</g>{levels}</defs><use href="#a11"/>')


def _level(k: int) -> str:
    return f'<g id="a{k}">' + f'<use href="#a{k - 1}"/>' * 10 + "</g>"


LIMITED: dict[str, tuple[str | bytes, int]] = {
    "nested groups": ((OPEN + "<g>" * 1_000_000).encode(), limits.MAX_DEPTH),
    "nested and closed groups": ((OPEN + "<g>" * 300 + "</g>" * 300 + "</svg>").encode(), limits.MAX_DEPTH),
    "many elements": ((OPEN + "<g/>" * 1_000_000 + "</svg>").encode(), limits.MAX_NODES),
    "many attributes": (
        OPEN + "<g " + " ".join(f'a{k}=""' for k in range(5000)) + "/></svg>",
        limits.MAX_OWN_ATTRIBUTES,
    ),
    "many quotes": (OPEN + "<g>" + '""' * 1_000_001 + "</g></svg>", limits.MAX_ATTRIBUTES),
    "copies of copies": (bomb(""), limits.MAX_ELEMENTS),
    "chain of copies": (
        svg("".join(f'<g id="a{k}"><use href="#a{k + 1}"/></g>' for k in range(1000))),
        limits.MAX_DEPTH,
    ),
    "long path": (svg(f'<path stroke="red" d="M0 0h{" 1" * 3_000_000}"/>'), limits.MAX_SEGMENTS),
    "long list of points": (svg(f'<polyline stroke="red" points="{"1 1 " * 1_100_000}"/>'), limits.MAX_SEGMENTS),
    "long transform": (svg(f'<g transform="{"scale(1)" * 10_000}"/>'), limits.MAX_TRANSFORM_CHARS),
    "long style": (svg(f'<g style="{"{" * 200_000}"/>'), limits.MAX_INLINE_CHARS),
    "large style sheet": (svg(f"<style>{' ' * 1_000_001}</style>"), limits.MAX_STYLE_CHARS),
    "many rules": (svg(f"<style>{'g{}' * 2001}</style>"), limits.MAX_STYLE_RULES),
    "slow rules": (
        svg("<style>" + "g:nth-last-of-type(2n){fill:red}" * 9 + "</style>" + "<g/>" * 9000),
        limits.MAX_STYLE_STEPS,
    ),
    "backtracking rules": (
        svg("<style>x " + "g " * 9 + "path{fill:red}</style>" + "<g>" * 60 + LINE + "</g>" * 60),
        limits.MAX_STYLE_STEPS,
    ),
    "large file": (b"<svg>" + b" " * limits.MAX_BYTES, limits.MAX_BYTES),
    "compressed bomb": (gzip.compress(b" " * (limits.MAX_BYTES + 1), 1), limits.MAX_BYTES),
    "many entities": (
        "<!DOCTYPE svg [" + "".join(f'<!ENTITY e{k} "x">' for k in range(101)) + "]>" + svg(LINE),
        limits.MAX_ENTITIES,
    ),
    "long entity": (f'<!DOCTYPE svg [<!ENTITY e "{"x" * 1001}">]>' + svg(LINE), limits.MAX_ENTITY_CHARS),
}


@pytest.mark.parametrize("name", LIMITED)
def test_limits_are_stated(name: str) -> None:
    source, limit = LIMITED[name]
    with pytest.raises(LimitError, match=str(limit)):
        read_svg(source)


WRONG: dict[str, tuple[str | bytes, str]] = {
    "empty": (b"", "empty"),
    "blank": (b" \n", "empty"),
    "text": (b"hello", "not XML"),
    "picture": (b"\x89PNG\r\n\x1a\n\0\0", "not XML"),
    "page": ("<html/>", "root element is <html>"),
    "other svg": ('<svg xmlns="urn:x"/>', "expected <svg>"),
    "cut off": (OPEN + "<g>", "not well-formed XML"),
    "garbage inside": (svg("<g <g/>"), "not well-formed XML"),
    "nul": ("<svg>\0</svg>", "not well-formed"),
    "surrogate": ("<svg>\ud800</svg>", "not valid text"),
    "wrong encoding": (b'<?xml version="1.0" encoding="utf-8"?><svg>\xff</svg>', "encoding"),
    "unknown encoding": (b'<?xml version="1.0" encoding="foo-8"?><svg/>', "encoding"),
    "broken compression": (gzip.compress(svg(LINE).encode())[:-9], "compression"),
    "billion laughs": (f'<!DOCTYPE svg [<!ENTITY l0 "x">{NESTED}]>{svg("<text>&l9;</text>")}', "'l1' is nested"),
    "many short entities": (
        f'<!DOCTYPE svg [<!ENTITY e "{"x" * 900}">]>' + svg("<desc>" + "&e;" * 100_000 + "</desc>"),
        "not well-formed XML: Maximum entity",
    ),
    "external entity": ('<!DOCTYPE svg [<!ENTITY e SYSTEM "file:///etc/passwd">]>' + svg("&e;"), "'e' is external"),
    "parameter entity": ('<!DOCTYPE svg [<!ENTITY % e "x">]>' + svg(LINE), "'e' is a parameter entity"),
    "undeclared entity": (svg("&nbsp;"), "nbsp"),
    "nothing": (svg(""), "nothing to draw"),
    "only text": (svg("<text/>"), "nothing to draw; left out: text"),
    "only zero length": (svg('<path d="M1 1h0" stroke="red"/>'), "zero length"),
    "view box without size": (f'{HEAD} viewBox="0 0 0 9">{LINE}</svg>', r"svg \(line 1\): the viewBox is 0 x 9"),
    "negative view box": (f'{HEAD} viewBox="0 0 9 -9">{LINE}</svg>', "viewBox is 9 x -9"),
    "infinite view box": (f'{HEAD} viewBox="0 0 9 inf">{LINE}</svg>', "finite"),
    "page without size": (f'{HEAD} width="0">{LINE}</svg>', "width of the page is 0"),
    "infinite page": (f'{HEAD} width="1e999">{LINE}</svg>', "finite"),
    "inner view box": (svg(f'<svg id="s" viewBox="0 0 0 0">{LINE}</svg>'), "svg#s"),
    "nan in a path": (svg('\n<path id="p" d="M0 0L nan 1" stroke="red"/>'), r"path#p \(line 2\): 'nan'"),
    "infinity in a path": (svg('<path id="p" d="M0 0L1e999 1" stroke="red"/>'), r"path#p .*1e999"),
    "nan in a shape": (svg('<circle id="c" r="NaN"/>'), "circle#c .*'NaN'"),
    "nan in points": (svg('<polygon id="c" points="1 2 nan 4"/>'), "polygon#c .*'nan'"),
    "infinity in a transform": (svg('<g id="c" transform="scale(inf)"/>'), "g#c .*'inf'"),
    "infinity in a style": (svg('<g id="c" style="stroke-width:inf"/>'), "g#c .*'inf'"),
    "infinity by transforms": (svg('<g transform="scale(1e30)">' * 20 + LINE + "</g>" * 20), "infinite"),
    "copy of itself": (svg('<use id="a" href="#a"/>'), "holds itself .*a -> a"),
    "copy of its parent": (svg('<g id="a"><use href="#a"/></g>'), "holds itself"),
    "circle of copies": (svg('<g id="a"><use href="#b"/></g><g id="b"><use href="#a"/></g>'), "holds itself .*b -> a"),
}


@pytest.mark.parametrize("name", WRONG)
def test_wrong_input_is_one_error_that_names_the_place(name: str) -> None:
    source, message = WRONG[name]
    with pytest.raises(InputError, match=message) as caught:
        read_svg(source)
    assert str(caught.value).startswith("<text>: " if isinstance(source, str) else "<bytes>: ")
    assert "\n" not in str(caught.value)


def test_wrong_files_name_the_file(tmp_path: Path) -> None:
    with pytest.raises(InputError, match=r"gone\.svg: there is no such file"):
        read_svg(tmp_path / "gone.svg")
    with pytest.raises(InputError, match="is a folder"):
        read_svg(tmp_path)
    with pytest.raises(InputError, match="cannot be read"):
        read_svg("a\0b")
    with pytest.raises(InputError, match="not an ordinary file"):
        read_svg("/dev/zero")
    bad = tmp_path / "bad.svg"
    bad.write_text(svg('<circle id="c" r="nan"/>'))
    with pytest.raises(InputError, match=r"bad\.svg: circle#c \(line 1\)"):
        read_svg(bad)


def test_a_huge_file_is_refused_by_its_size(tmp_path: Path) -> None:
    file = tmp_path / "huge.svg"
    with file.open("wb") as out:
        os.truncate(out.fileno(), 200_000_000)
    with pytest.raises(LimitError, match=rf"huge\.svg: has 200000000 bytes; the limit is {limits.MAX_BYTES}"):
        read_svg(file)


def test_nothing_is_fetched() -> None:
    text = '<!DOCTYPE svg SYSTEM "http://127.0.0.1:9/x.dtd">' + svg(LINE + '<use href="http://127.0.0.1:9/x.svg#a"/>')
    assert len(read_svg(text).elements) == 1


@given(st.binary(max_size=200))
def test_garbage_is_an_input_error(data: bytes) -> None:
    with pytest.raises(InputError):
        read_svg(data)


@given(st.binary(max_size=60), st.integers(0, 400))
@settings(max_examples=200, deadline=None)
def test_a_damaged_file_is_read_or_an_input_error(damage: bytes, at: int) -> None:
    whole = svg(
        '<style>.a{fill:red}</style><g transform="scale(2)"><path class="a" d="M1 2C3 4 5 6 7 8z"/></g>'
        '<use href="#x"/><rect id="x" width="3mm" height="4" rx="1"/>'
    ).encode()
    with contextlib.suppress(InputError):
        read_svg(whole[:at] + damage + whole[at + len(damage) :])


@given(st.text(st.characters(exclude_characters='<&"', exclude_categories=["C"]), max_size=40))
@settings(max_examples=200, deadline=None)
def test_odd_values_are_read_or_an_input_error(text: str) -> None:
    names = ("style", "transform", "fill", "stroke-width", "d", "class", "opacity", "stroke-dasharray", "marker")
    body = "".join(f'<path d="M0 0h9v9z" {name}="{text}"/>' for name in names if name != "d") + f'<path d="{text}"/>'
    with contextlib.suppress(InputError):
        read_svg(svg(f"<style>{text.replace('>', '')}</style>{body}{LINE}"))
