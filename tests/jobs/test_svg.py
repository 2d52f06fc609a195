"""Reading whole drawings: shapes, transforms, units, copies, names, report."""

from __future__ import annotations

import gzip
import subprocess
import sys
from pathlib import Path

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from optplan.domain.errors import InputError
from optplan.domain.job import Drawing
from optplan.jobs.svg import read_svg
from tests.jobs.svg_texts import HEAD, LINE, PX, drawing, svg, texts, user_points


def points(body: str, attributes: str = 'viewBox="0 0 100 100"') -> list[list[float]]:
    (element,) = drawing(body, attributes).elements
    return [[round(float(value), 9) + 0.0 for value in point] for point in user_points(element)]


@pytest.mark.parametrize(
    ("body", "expected"),
    [
        ('<line x1="1" y1="2" x2="3" y2="4" stroke="red"/>', [[1, 2], [3, 4]]),
        ('<line x2="3" stroke="red"/>', [[0, 0], [3, 0]]),
        ('<polyline points="0,0 1,1 2 0" stroke="red" fill="none"/>', [[0, 0], [1, 1], [2, 0]]),
        ('<polygon points="0,0 1,1 2 0"/>', [[0, 0], [1, 1], [2, 0]]),
        ('<rect x="1" y="2" width="3" height="4"/>', [[1, 2], [4, 2], [4, 6], [1, 6]]),
        ('<rect width="10%" height="5mm"/>', [[0, 0], [10, 0], [10, 18.897637795], [0, 18.897637795]]),
        ('<g transform="translate(5)"><rect width="1" height="1"/></g>', [[5, 0], [6, 0], [6, 1], [5, 1]]),
        ('<path d="M0 0H5 5V5" fill="none" stroke="red"/>', [[0, 0], [5, 0], [5, 5]]),
    ],
)
def test_straight_shapes(body: str, expected: list[list[float]]) -> None:
    assert points(body) == expected
    assert all(curve.handles is None for element in drawing(body).elements for curve in element.curves)


@pytest.mark.parametrize(
    ("body", "rx", "ry"),
    [
        ('<circle cx="50" cy="40" r="20"/>', 20, 20),
        ('<ellipse cx="50" cy="40" rx="20" ry="10"/>', 20, 10),
        ('<ellipse cx="50" cy="40" rx="20"/>', 20, 20),
        ('<rect x="30" y="30" width="40" height="20" rx="20" ry="10"/>', 20, 10),
        ('<rect x="30" y="30" width="40" height="20" rx="99" ry="99"/>', 20, 10),
    ],
)
def test_ovals_lie_on_their_ellipse(body: str, rx: float, ry: float) -> None:
    (element,) = drawing(body).elements
    assert element.curves[0].closed
    x, y = (user_points(element) - [50, 40]).T
    assert (x / rx) ** 2 + (y / ry) ** 2 == pytest.approx(1)


def test_rounded_rectangles_keep_their_sides() -> None:
    corners = points('<rect width="30" height="20" rx="5"/>')
    for expected in ([5, 0], [25, 0], [30, 5], [30, 15], [25, 20], [5, 20], [0, 15], [0, 5]):
        assert expected in corners
    assert len(corners) == 12


@pytest.mark.parametrize(
    ("text", "matrix"),
    [
        ("matrix(1 2 3 4 5 6)", [[1, 3, 5], [2, 4, 6]]),
        ("translate(5)", [[1, 0, 5], [0, 1, 0]]),
        ("translate(5,-6)", [[1, 0, 5], [0, 1, -6]]),
        ("scale(2)", [[2, 0, 0], [0, 2, 0]]),
        ("scale(2 3)", [[2, 0, 0], [0, 3, 0]]),
        ("rotate(90)", [[0, -1, 0], [1, 0, 0]]),
        ("rotate(90 10 20)", [[0, -1, 30], [1, 0, 10]]),
        ("skewX(45)", [[1, 1, 0], [0, 1, 0]]),
        ("skewY(45)", [[1, 0, 0], [1, 1, 0]]),
        ("translate(1 2) , scale(2)rotate(90)", [[0, -2, 1], [2, 0, 2]]),
        ("", [[1, 0, 0], [0, 1, 0]]),
    ],
)
def test_transforms(text: str, matrix: list[list[float]]) -> None:
    (element,) = drawing(f'<path transform="{text}" d="M1 2L3 5" stroke="red"/>').elements
    expected = np.array([[1, 2, 1], [3, 5, 1]]) @ np.array(matrix).T
    np.testing.assert_allclose(user_points(element), expected, atol=1e-9)


def test_transforms_as_style() -> None:
    body = (
        '<path style="transform: translate(5px, 1px) rotate(0.25turn)" transform="scale(9)" d="M1 2L3 5" stroke="red"/>'
    )
    assert points(body) == [[3, 2], [0, 4]]


def test_a_transform_that_cannot_be_understood_is_reported() -> None:
    read = drawing('<path d="M1 2L3 5" stroke="red" transform="turn(3)"/>')
    assert "transform that cannot be understood" in texts(read)


STEP = st.one_of(
    st.tuples(st.just("translate"), st.lists(st.floats(-50, 50), min_size=2, max_size=2)),
    st.tuples(st.just("scale"), st.lists(st.floats(0.5, 2), min_size=2, max_size=2)),
    st.tuples(st.just("rotate"), st.lists(st.floats(-360, 360), min_size=1, max_size=1)),
    st.tuples(st.just("matrix"), st.lists(st.floats(0.1, 2), min_size=6, max_size=6)),
)


def reference_matrix(name: str, v: list[float]) -> np.ndarray[tuple[int, int], np.dtype[np.float64]]:
    if name == "translate":
        return np.array([[1, 0, v[0]], [0, 1, v[1]], [0, 0, 1]])
    if name == "scale":
        return np.diag([v[0], v[1], 1.0])
    if name == "rotate":
        c, s = np.cos(np.radians(v[0])), np.sin(np.radians(v[0]))
        return np.array([[c, -s, 0], [s, c, 0], [0, 0, 1]])
    return np.array([[v[0], v[2], v[4]], [v[1], v[3], v[5]], [0, 0, 1]])


@given(st.lists(STEP, max_size=8))
@settings(max_examples=60, deadline=None)
def test_nested_transforms_are_the_product_of_their_matrices(steps: list[tuple[str, list[float]]]) -> None:
    groups = "".join(f'<g transform="{name}({" ".join(map(repr, v))})">' for name, v in steps)
    (element,) = drawing(groups + '<path d="M1 2C3 9 20 5 8 8" stroke="red"/>' + "</g>" * len(steps)).elements
    product = np.eye(3)
    for name, v in steps:
        product = product @ reference_matrix(name, v)
    assert element.curves[0].handles is not None
    got = np.concatenate([element.curves[0].points, element.curves[0].handles[0]]) / PX
    expected = (np.array([[1, 2, 1], [8, 8, 1], [3, 9, 1], [20, 5, 1]]) @ product.T)[:, :2]
    scale = np.abs(expected).max() + 100
    np.testing.assert_allclose(np.column_stack([got[:, 0], 100 - got[:, 1]]), expected, atol=1e-9 * scale)
    assert element.stroke_width == pytest.approx(np.sqrt(abs(np.linalg.det(product[:2, :2]))), abs=1e-5)


@pytest.mark.parametrize(
    ("attributes", "unit", "page"),
    [
        ("", PX, None),
        ('width="96" height="192"', PX, (0.0254, 0.0508)),
        ('width="1in" height="2.54cm"', PX, (0.0254, 0.0254)),
        ('width="72pt" height="6pc"', PX, (0.0254, 0.0254)),
        ('width="40q" height="10mm"', PX, (0.01, 0.01)),
        ('viewBox="0 0 96 48"', PX, (0.0254, 0.0127)),
        ('width="210mm" height="297mm" viewBox="0 0 210 297"', 1e-3, (0.21, 0.297)),
        ('width="210mm" viewBox="0 0 420 594"', 5e-4, (0.21, 0.297)),
        ('height="297mm" viewBox="0 0 420 594"', 5e-4, (0.21, 0.297)),
        ('width="100%" height="100%" viewBox="0 0 96 48"', PX, (0.0254, 0.0127)),
        ('width="100mm" height="100mm" viewBox="0 0 100 50"', 1e-3, (0.1, 0.1)),
        ('width="100mm" height="100mm" viewBox="0 0 100 50" preserveAspectRatio="xMidYMid slice"', 2e-3, (0.1, 0.1)),
        ('width="40mm" height="10mm" viewBox="0 0 10 10" preserveAspectRatio="none"', 2e-3, (0.04, 0.01)),
    ],
)
def test_units_and_pages(attributes: str, unit: float, page: tuple[float, float] | None) -> None:
    read = drawing(LINE, attributes)
    assert read.unit == pytest.approx(unit)
    assert read.page == (None if page is None else pytest.approx(page))
    assert read.elements[0].stroke_width == 1


@pytest.mark.parametrize(
    ("aspect", "lower_left"),
    [
        ("xMinYMin", [0, 0.05]),
        ("xMidYMid", [0, 0.025]),
        ("xMaxYMax meet", [0, 0]),
        ("none", [0, 0]),
        ("xMinYMid slice", [0, 0]),
        ("xMidYMid slice", [-0.05, 0]),
        ("xMaxYMid slice", [-0.1, 0]),
        ("", [0, 0.025]),
    ],
)
def test_the_view_box_is_placed_in_the_page(aspect: str, lower_left: list[float]) -> None:
    body = '<path d="M-5 25L95 25" stroke="red"/>'
    attributes = f'width="100mm" height="100mm" viewBox="-5 -25 100 50" preserveAspectRatio="{aspect}"'
    (element,) = drawing(body, attributes).elements
    np.testing.assert_allclose(element.curves[0].points[0], lower_left, atol=1e-12)


def test_y_points_up_and_without_a_page_down_is_negative() -> None:
    assert drawing(LINE, 'height="50px"').elements[0].curves[0].points[0] == pytest.approx([PX, 48 * PX])
    assert drawing(LINE, "").elements[0].curves[0].points[0] == pytest.approx([PX, -2 * PX])


@pytest.mark.parametrize(
    ("body", "expected"),
    [
        ('<defs><line id="a" x2="3" stroke="red"/></defs><use href="#a" x="5" y="6"/>', [[5, 6], [8, 6]]),
        (
            '<defs><line id="a" x2="3" stroke="red"/></defs><use xlink:href="#a" transform="scale(2)" x="5"/>',
            [[10, 0], [16, 0]],
        ),
        (
            '<symbol id="a" viewBox="0 0 10 10"><line x2="10" stroke="red"/></symbol>'
            '<use href="#a" x="5" width="20" height="20"/>',
            [[5, 0], [25, 0]],
        ),
        (
            '<defs><g id="b"><line x2="1" stroke="red"/></g><use id="a" href="#b" y="1"/></defs><use href="#a" x="5"/>',
            [[5, 1], [6, 1]],
        ),
        ('<svg x="10" y="20"><line x2="1" stroke="red"/></svg>', [[10, 20], [11, 20]]),
        (
            '<svg x="10" width="50" height="100" viewBox="0 0 10 10"><line x2="100%" stroke="red"/></svg>',
            [[10, 25], [60, 25]],
        ),
        (
            '<switch><g requiredExtensions="x"><path d="M9 9h1"/></g><line x2="1" stroke="red"/>'
            '<path d="M9 9h1"/></switch>',
            [[0, 0], [1, 0]],
        ),
        ('<a href="x"><line x2="1" stroke="red"/></a>', [[0, 0], [1, 0]]),
    ],
)
def test_copies_and_containers(body: str, expected: list[list[float]]) -> None:
    assert points(body) == expected


def test_copies_take_the_style_around_the_copy() -> None:
    body = (
        '<defs><path id="a" d="M0 0h9v9z"/></defs><g fill="lime"><use href="#a"/></g><use href="#a" style="fill:red"/>'
    )
    assert [element.fill for element in drawing(body).elements] == ["#00ff00", "#ff0000"]


def test_ids_are_kept_made_and_unique() -> None:
    body = (
        '<path id="path2" d="M0 0h1v1z"/><path d="M0 0h1v1z"/><path id="x" d="M0 0h1v1z"/><path id="x" d="M0 0h1v1z"/>'
        '<rect width="1" height="1"/><use href="#x"/><use id="u" href="#x"/>'
    )
    ids = [element.id for element in drawing(body).elements]
    assert ids == ["path2", "path2-2", "x", "x-2", "rect1", "x@use1", "x@u"]
    assert ids == [element.id for element in drawing(body).elements]


def test_layers_of_drawing_programs_are_kept() -> None:
    space = 'viewBox="0 0 9 9" xmlns:inkscape="http://www.inkscape.org/namespaces/inkscape"'
    body = f'<g inkscape:groupmode="layer" inkscape:label="Sky"><g>{LINE}</g></g><path d="M0 0h1v1z"/>'
    assert [element.layer for element in drawing(body, space).elements] == ["Sky", ""]


@pytest.mark.parametrize(
    ("body", "kind", "text"),
    [
        ('<image href="data:image/png;base64,AAAA"/>', "ignored", "image (inside the file, 26 characters)"),
        ('<image xlink:href="x.png"/>', "ignored", "image (in another file)"),
        ("<text>hello</text>", "ignored", "text: only paths are drawn"),
        ("<script>1</script>", "ignored", "script"),
        ('<rect width="1" height="1" onclick="x()"/>', "ignored", "script in an attribute"),
        ("<g><animate/></g>", "ignored", "animation: drawn as it is without"),
        ("<title>t</title>", "ignored", "title, description or metadata"),
        ("<blob/>", "ignored", "element <blob>"),
        ('<g clip-path="url(#c)"/>', "changed", "clip-path not applied: drawn as it is without"),
        ('<g style="mask:url(#c);filter:blur(1px)"/>', "changed", "filter not applied: drawn as it is without"),
        ('<rect width="1" height="1" fill="url(#none)"/>', "ignored", "paint that is not in the file"),
        (
            '<linearGradient id="l"/><rect width="1" height="1" fill="url(#l)"/>',
            "changed",
            "gradient or pattern drawn in #808080",
        ),
        ('<path d="M0 0h9" stroke="red" marker-end="url(#m)"/>', "ignored", "markers such as arrow heads"),
        ('<path d="M0 0h9" stroke="red" stroke-dasharray="3 1"/>', "changed", "dashed stroke drawn solid"),
        ('<path d="M0 0h9" stroke="red" opacity=".5"/>', "changed", "half-transparent: drawn opaque"),
        (
            '<path d="M0 0h9" stroke="red" stroke-width="2vw"/>',
            "ignored",
            "value of stroke-width that cannot be understood",
        ),
        ('<path d="M0 0h9" fill="none"/>', "ignored", "neither stroke nor fill"),
        ('<path d="M0 0h0" stroke="red"/>', "ignored", "stroke of zero length"),
        ('<path d="M0 0h9" stroke="red" display="none"/>', "ignored", "hidden (display: none), with all it holds"),
        ('<path d="M0 0h9" stroke="red" visibility="hidden"/>', "ignored", "hidden (visibility or opacity)"),
        ('<rect width="-1" height="1"/>', "ignored", "negative width: not drawn"),
        ('<rect width="1xx" height="1"/>', "ignored", "width that is no length or has a unit not known here"),
        ('<rect width="1em" height="1"/>', "changed", "lengths in units of a font: taken for a font of 16 px"),
        ('<path d="M0 0h9v9"/>', "notice", "open path with a fill: the fill closes it with a straight line"),
        ('<use href="#gone"/>', "ignored", "copy of something that is not in the file"),
        ('<use href="x.svg#gone"/>', "ignored", "copy of something outside the file (never fetched)"),
        ("<style>@import 'x.css';</style>", "ignored", "style rule @import"),
        ("<style>!! {fill:red}</style>", "ignored", "style rule whose selector cannot be understood"),
        ('<polygon points="0 0 1 1 2"/>', "changed", "odd number of coordinates, the last one left out"),
    ],
)
def test_nothing_is_dropped_silently(body: str, kind: str, text: str) -> None:
    notes = drawing(LINE + body).notes
    assert (kind, text) in [(note.kind, note.text) for note in notes]


def test_a_clean_drawing_has_an_empty_report() -> None:
    assert drawing(LINE + '<circle r="3"/>').notes == ()


def test_other_namespaces_are_counted_each_on_its_line() -> None:
    space = 'viewBox="0 0 9 9" xmlns:a="urn:a" xmlns:b="urn:b"'
    notes = drawing(f'<a:x><a:y b:z="1"/></a:x><g a:z="1">{LINE}</g>', space).notes
    assert [(note.text[-5:], note.times) for note in notes] == [("urn:a", 3), ("urn:b", 1)]


def test_the_report_groups_and_names_places() -> None:
    (note,) = drawing(LINE + "".join(f'\n<text id="t{k}">x</text>' for k in range(8))).notes
    assert note.times == 8
    assert note.place.startswith("text#t0 (line 2), text#t1 (line 3)")
    assert note.place.endswith("...")


def test_broken_path_data_is_drawn_up_to_the_break() -> None:
    read = drawing('<path id="q" d="M0 0L5 5L6" stroke="red" fill="none"/>')
    assert len(read.elements[0].curves[0].points) == 2
    assert any("up to the break" in note.text and "path#q" in note.place for note in read.notes)


def test_compound_paths_stay_together() -> None:
    (element,) = drawing('<path d="M0 0h9v9h-9zM2 2h3v3h-3z" fill-rule="evenodd"/>').elements
    assert len(element.curves) == 2
    assert element.fill_rule == "evenodd"


def test_closing_vertices_and_duplicates_vanish() -> None:
    assert points('<path d="M0 0h9h0v9L0 0z"/>') == [[0, 0], [9, 0], [9, 9]]
    assert points('<path d="M0 0h.1h.1h.1v.1h-.3v-.1z"/>')[0] == [0, 0]
    assert len(points('<path d="m0 0h.1h.1h.1v.1h-.3v-.1z"/>')) == 6


def test_a_loop_that_ends_where_it_begins_is_a_closed_curve() -> None:
    (element,) = drawing('<path d="M5 5C15 -5 15 15 5 5"/>').elements
    (curve,) = element.curves
    assert curve.closed
    assert len(curve.points) == 2
    assert user_points(element)[1] == pytest.approx([12.5, 5])


def test_lines_beside_curves_have_handles_at_thirds() -> None:
    (element,) = drawing('<path d="M0 0L30 0Q30 30 0 30z"/>').elements
    handles = element.curves[0].handles
    assert handles is not None
    np.testing.assert_allclose(handles[0, :, 0] / PX, [10, 20])
    np.testing.assert_allclose(100 - handles[2, :, 1] / PX, [20, 10])


@pytest.mark.parametrize(
    ("gap", "width", "close_gap", "closed"),
    [
        (2.7, 11.66, None, True),
        (2.7, 5.0, None, False),
        (0.01, 5.0, None, True),
        (2.7, 1.0, 3.0, True),
        (2.7, 11.66, 0.0, False),
        (9.0, 40.0, None, False),
    ],
)
def test_ends_that_nearly_meet_are_joined(gap: float, width: float, close_gap: float | None, closed: bool) -> None:
    body = f'<path fill="none" stroke="red" stroke-width="{width}" d="M0 0h30v30h-30V{gap}"/>'
    read = read_svg(svg(body), close_gap=close_gap)
    assert read.elements[0].curves[0].closed is closed
    assert ("ends that nearly meet were joined" in texts(read)) is closed


def test_a_filled_open_path_stays_open() -> None:
    (element,) = drawing('<path d="M0 0h9v9"/>').elements
    assert not element.curves[0].closed


def test_a_line_has_no_area() -> None:
    (element,) = drawing('<line x2="9" stroke="red" fill="blue"/>').elements
    assert element.fill is None


def test_files_of_drawing_programs_load(tmp_path: Path) -> None:
    text = """<?xml version="1.0" encoding="utf-8"?>
<!DOCTYPE svg PUBLIC "-//W3C//DTD SVG 1.1//EN" "http://www.w3.org/Graphics/SVG/1.1/DTD/svg11.dtd" [
    <!ENTITY ns_svg "http://www.w3.org/2000/svg">
    <!ENTITY ns_ai "http://ns.adobe.com/AdobeIllustrator/10.0/">
]>
<svg xmlns="&ns_svg;" xmlns:i="&ns_ai;" width="841.89" height="595.28" viewBox="0 0 841.89 595.28">
<switch><foreignObject requiredExtensions="&ns_ai;" x="0" width="1" height="1"/>
<g i:extraneous="self"><path fill="#FFF" stroke="#000" d="M0,0l3,4c1,1,2,2,3,0z"/></g></switch></svg>"""
    file = tmp_path / "logo.svg"
    file.write_text(text)
    read = read_svg(file)
    assert read.name == "logo"
    assert (read.elements[0].fill, read.elements[0].stroke) == ("#ffffff", "#000000")
    packed = tmp_path / "logo.svgz"
    packed.write_bytes(gzip.compress(text.encode()))
    assert len(read_svg(str(packed)).elements) == 1


def same(a: Drawing, b: Drawing) -> bool:
    return all(
        np.array_equal(x.points, y.points)
        for one, two in zip(a.elements, b.elements, strict=True)
        for x, y in zip(one.curves, two.curves, strict=True)
    )


def test_bytes_text_and_other_encodings_read_the_same() -> None:
    text = svg(LINE + "<desc>é</desc>")
    read = read_svg(text)
    assert same(read, read_svg(text.encode()))
    assert same(read, read_svg('<?xml version="1.0" encoding="iso-8859-1"?>' + text))
    assert same(read, read_svg(('<?xml version="1.0" encoding="iso-8859-1"?>' + text).encode("latin-1")))
    assert same(read, read_svg(text.encode("utf-16")))
    assert same(read, read_svg("\ufeff" + text))
    assert read_svg(text, name="mine").name == "mine"
    assert read.name == "drawing"


@given(st.floats(-100, 100), st.floats(-100, 100), st.floats(0.1, 10))
@settings(max_examples=40, deadline=None)
def test_moving_and_scaling_commute_with_reading(x: float, y: float, k: float) -> None:
    shape = (
        '<path fill="none" stroke="red" d="M1 2C3 9 20 5 8 8L3 3A5 4 20 1 0 9 9"/><rect width="5" height="4" rx="1"/>'
    )
    plain = drawing(shape)
    moved = drawing(f'<g transform="translate({x!r} {y!r}) scale({k!r})">{shape}</g>')
    for one, two in zip(plain.elements, moved.elements, strict=True):
        np.testing.assert_allclose(user_points(two), user_points(one) * k + [x, y], atol=1e-7)
        assert two.stroke_width == pytest.approx(k * one.stroke_width)


def test_reading_leaves_the_domain_light() -> None:
    code = (
        "import sys, optplan.domain, optplan.domain.job; sys.exit('lxml' in sys.modules or 'tinycss2' in sys.modules)"
    )
    assert subprocess.run([sys.executable, "-c", code], check=False).returncode == 0


def test_a_negative_close_gap_is_refused() -> None:
    with pytest.raises(InputError, match="close_gap"):
        read_svg(HEAD + "/>", close_gap=-1.0)
