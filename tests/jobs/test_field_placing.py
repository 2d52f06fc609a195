"""Fields moved, aligned, joined; logos; obstacle maps."""

from __future__ import annotations

import math
from pathlib import Path

import numpy as np
import pytest
import shapely
from hypothesis import given
from hypothesis import strategies as st
from PIL import Image

import optplan as op
from optplan.coverage.field import primitive_of
from optplan.domain.errors import InputError, LimitError
from optplan.domain.job import Field, FieldSegment
from optplan.jobs.fields import template
from optplan.jobs.fields.drawn import with_logo
from optplan.jobs.fields.maps import obstacles
from optplan.jobs.fields.placing import aligned, anchored, joined, placed

FIELD = template("basketball")


def _points(field: Field) -> np.ndarray:
    parts = [primitive_of(segment) for segment in field.segments if segment.spot == 0]
    return np.concatenate([part.at(np.linspace(0, part.length, 7)) for part in parts])


@given(
    st.tuples(st.floats(-50, 50), st.floats(-50, 50)),
    st.floats(-math.pi, math.pi),
    st.floats(0.1, 10),
    st.booleans(),
)
def test_placing_is_the_similarity_of_every_point(
    at: tuple[float, float], turn: float, scale: float, mirrored: bool
) -> None:
    before, after = _points(FIELD), _points(placed(FIELD, at, turn, scale, mirrored))
    z = before[:, 0] * (-1 if mirrored else 1) + 1j * before[:, 1]
    wanted = z * scale * np.exp(1j * turn) + complex(*at)
    assert after[:, 0] == pytest.approx(wanted.real, abs=1e-9 * (1 + scale) * 100)
    assert after[:, 1] == pytest.approx(wanted.imag, abs=1e-9 * (1 + scale) * 100)


def test_alignment_puts_two_points_where_they_were_measured() -> None:
    made = aligned(FIELD, ((0, 0), (28, 0)), ((5, 5), (5, 33)))
    first = next(s for s in made.segments if s.id == "boundary 1")
    assert first.start == pytest.approx([5, 5])
    assert first.end == pytest.approx([5, 33])
    assert not made.notes
    off = aligned(FIELD, ((0, 0), (28, 0)), ((5, 5), (5, 33.2)))
    assert "misses by 0.100 m" in off.notes[-1].text
    stretched = aligned(FIELD, ((0, 0), (28, 0)), ((5, 5), (5, 33.2)), scaled=True)
    first = next(s for s in stretched.segments if s.id == "boundary 1")
    assert first.end == pytest.approx([5, 33.2])
    with pytest.raises(InputError, match="coincide"):
        aligned(FIELD, ((0, 0), (0, 0)), ((5, 5), (5, 33)))


def test_bad_places_are_refused() -> None:
    for scale in (0.0, -1.0, math.nan):
        with pytest.raises(InputError, match="scale"):
            placed(FIELD, scale=scale)
    with pytest.raises(InputError, match="no place"):
        anchored(FIELD, 95, 0)


def test_joined_fields_are_one_job() -> None:
    both = joined("two", FIELD, placed(template("tennis"), (40, 0)))
    assert len(both.segments) == len(FIELD.segments) + len(template("tennis").segments)
    assert both.line_width is None
    widths = sorted({segment.width or 0.0 for segment in both.segments})
    assert widths == pytest.approx([0.05, 0.0508])


def test_a_logo_is_lines_and_arcs_close_to_the_drawing(tmp_path: Path) -> None:
    svg = tmp_path / "logo.svg"
    svg.write_text(
        '<svg xmlns="http://www.w3.org/2000/svg" width="200" height="100"><circle cx="50" cy="50" r="50"/>'
        '<path d="M100 0 H200 V100 Z" fill="none" stroke="black"/></svg>'
    )
    made = with_logo(Field("x", (FieldSegment("a", np.zeros(2), np.array([1.0, 0])),)), svg, (10, 20), 8.0)
    logo = [s for s in made.segments if s.id != "a"]
    points = _points(Field("logo", tuple(logo)))
    assert points.min(axis=0) == pytest.approx([6, 18], abs=0.02)
    assert points.max(axis=0) == pytest.approx([14, 22], abs=0.02)
    arcs = [s for s in logo if s.center is not None]
    assert arcs
    assert len(logo) < 12
    assert all(s.radius == pytest.approx(2, abs=0.05) for s in arcs)
    # the circle is closed by its arcs
    assert sum(abs(s.sweep) for s in arcs) == pytest.approx(2 * math.pi, abs=0.1)
    plan = op.plan(made, "line-marker", op.Options(order=op.OrderOptions(metric="cc")))
    assert plan.report is not None
    assert plan.report.ok
    with pytest.raises(InputError, match="width"):
        with_logo(made, svg, (0, 0), 0.0)


def test_what_a_logo_leaves_out_is_told_once(tmp_path: Path) -> None:
    svg = tmp_path / "logo.svg"
    svg.write_text(
        '<svg xmlns="http://www.w3.org/2000/svg" width="9" height="9"><text x="1" y="1">Hi</text>'
        '<rect width="4" height="4" fill="none" stroke="black"/></svg>'
    )
    made = with_logo(with_logo(FIELD, svg, (7, 7), 2.0), svg, (20, 7), 2.0)
    assert sum("text" in note.place or "text" in note.text for note in made.notes) == 1
    for width in (1e-6, 1e9):
        with pytest.raises(InputError, match="logo"):
            with_logo(FIELD, svg, (7, 7), width)


def test_obstacles_of_a_map_lie_where_it_says(tmp_path: Path) -> None:
    grid = np.full((40, 60), 254, dtype=np.uint8)
    grid[10:14, 20:30] = 0  # rows count from the top
    grid[30:32, 5:7] = 205  # unknown
    Image.fromarray(grid).save(tmp_path / "map.pgm")
    text = "image: map.pgm\nresolution: 0.5\norigin: [-3.0, 2.0, 0.0]\n"
    text += "negate: 0\noccupied_thresh: 0.65\nfree_thresh: 0.2\n"
    (tmp_path / "map.yaml").write_text(text)
    (ring,) = obstacles(tmp_path / "map.yaml")
    # half a pixel wider all around
    assert ring.min(axis=0) == pytest.approx([-3 + 9.75, 2 + 12.75])
    assert ring.max(axis=0) == pytest.approx([-3 + 15.25, 2 + 15.25])


def _map(folder: Path, grid: np.ndarray, more: str = "", name: str = "map.png") -> Path:
    Image.fromarray(grid).save(folder / name)
    file = folder / "map.yaml"
    file.write_text(f"image: {name}\nresolution: 0.5\norigin: [0, 0, 0]\n{more}")
    return file


def test_the_inside_of_a_fence_is_free(tmp_path: Path) -> None:
    grid = np.full((60, 80), 254, dtype=np.uint8)
    grid[[2, 57], 2:78] = 0
    grid[2:58, [2, 77]] = 0
    grid[20:30, 20:30] = 0
    grid[24:26, 24:26] = 254  # a yard within a building
    rings = obstacles(_map(tmp_path, grid))
    shapes = [shapely.Polygon(ring) for ring in rings]
    assert all(shape.is_valid for shape in shapes)
    rows, columns = np.mgrid[:60, :80]
    middles = shapely.points((columns + 0.5) / 2, (60 - rows - 0.5) / 2)
    assert ((grid == 0) == shapely.intersects(shapely.union_all(shapes).buffer(-0.2), middles)).all()
    near = shapely.union_all(shapes)
    assert sum(shape.area for shape in shapes) == pytest.approx(near.area)


def test_maps_of_noise_are_refused_at_once(tmp_path: Path) -> None:
    noise = (np.random.default_rng(0).random((2000, 2000)) * 255).astype(np.uint8)
    with pytest.raises(LimitError, match="runs"):
        obstacles(_map(tmp_path, noise))


@pytest.mark.parametrize("dtype", [np.uint8, np.uint16])
def test_dark_pixels_are_occupied_in_eight_and_in_sixteen_bits(dtype: type, tmp_path: Path) -> None:
    top = np.iinfo(dtype).max
    grid: np.ndarray = np.full((20, 20), top, dtype=dtype)
    grid[5:9, 5:9] = top // 10
    assert len(obstacles(_map(tmp_path, grid))) == 1
    assert len(obstacles(_map(tmp_path, grid, "occupied_thresh: 0.95\n"))) == 0


def test_pixels_that_are_no_shades_are_refused(tmp_path: Path) -> None:
    with pytest.raises(InputError, match="real numbers"):
        obstacles(_map(tmp_path, np.ones((4, 4), dtype=np.float32), name="map.tiff"))


@pytest.mark.parametrize("value", ["5", "-1", ".nan"])
def test_thresholds_are_shares(value: str, tmp_path: Path) -> None:
    with pytest.raises(InputError, match=r"occupied_thresh.*0\.\.1"):
        obstacles(_map(tmp_path, np.zeros((4, 4), dtype=np.uint8), f"occupied_thresh: {value}\n"))


def test_a_map_with_many_images_is_refused_in_a_few_words(tmp_path: Path) -> None:
    (tmp_path / "map.yaml").write_text(f"image: [{', '.join(['x'] * 1000)}]\nresolution: 1\norigin: [0, 0, 0]")
    with pytest.raises(InputError, match="name of a file") as caught:
        obstacles(tmp_path / "map.yaml")
    assert len(str(caught.value)) < 300


@pytest.mark.parametrize(
    "text",
    ["", "image: [", "image: none.pgm\nresolution: 0.5\norigin: [0, 0, 0]", "image: a\nresolution: -1\norigin: [0, 0]",
     "image: a\nresolution: x\norigin: [0, 0]", "resolution: 1"],
)  # fmt: skip
def test_bad_maps_are_refused(text: str, tmp_path: Path) -> None:
    (tmp_path / "map.yaml").write_text(text)
    with pytest.raises(InputError):
        obstacles(tmp_path / "map.yaml")
