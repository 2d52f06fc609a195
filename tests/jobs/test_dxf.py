"""DXF files in space, with blocks, with hidden layers, without units."""

from __future__ import annotations

from pathlib import Path
from typing import Any

import numpy as np
import pytest

import optplan as op
from optplan.domain.errors import InputError
from optplan.domain.facade import Facade
from tests.facades import planned

ezdxf = pytest.importorskip("ezdxf")

OUTLINE = [(0, 0), (6, 0), (6, 4), (0, 4)]


def _document(units: int = 6) -> Any:
    return ezdxf.new(units=units)


def _read(document: Any, file: Path) -> Facade:
    document.saveas(file)
    job = op.read(file)
    assert isinstance(job, Facade)
    return job


def _areas(job: Facade) -> list[float]:
    import shapely

    return [shapely.Polygon(ring).area for ring in (job.walls[0].outline, *job.walls[0].no_go)]


def test_a_leaning_outline_is_as_large_as_it_is(tmp_path: Path) -> None:
    """2 m back over 4 m of height: 26.8 m2, not the 12 m2 of its shadow."""
    document = _document()
    space = document.modelspace()
    space.add_polyline3d([(0, 0, 0), (6, 0, 0), (6, 2, 4), (0, 2, 4)], close=True)
    space.add_polyline3d([(1, 0.5, 1), (2, 0.5, 1), (2, 1, 2), (1, 1, 2)], close=True)
    job = _read(document, tmp_path / "leaning.dxf")
    assert _areas(job) == pytest.approx([6 * np.hypot(2, 4), np.hypot(0.5, 1)])
    wall = job.walls[0]
    assert wall.origin == pytest.approx([0, 0, 0])
    assert np.cross(wall.across, wall.up) == pytest.approx(np.array([0, -2, 1]) / np.sqrt(5))
    assert "against the clock" in job.notes[-1].text
    plan = planned(job, fewest="minimal", pattern="hexagon")
    assert plan.report is not None
    assert plan.report.ok


def test_an_upright_outline_is_a_wall_where_it_stands(tmp_path: Path) -> None:
    document = _document()
    document.modelspace().add_polyline3d([(3, 1, 2), (3, 7, 2), (3, 7, 6), (3, 1, 6)], close=True)
    wall = _read(document, tmp_path / "upright.dxf").walls[0]
    assert wall.outline.max(axis=0) == pytest.approx([6, 4])
    assert wall.origin == pytest.approx([3, 1, 2])
    assert np.cross(wall.across, wall.up) == pytest.approx([1, 0, 0])


@pytest.mark.parametrize(
    ("corners", "words"),
    [
        ([(0, 0, 0), (6, 0, 0), (6, 2, 4), (0, 0, 4)], "POLYLINE.*own plane; expected one flat wall"),
        ([(0, 0, 0), (6, 0, 0.1), (6, 4, 0.1), (0, 4, 0)], "nearly level"),
    ],
)
def test_what_is_no_flat_wall_is_refused(tmp_path: Path, corners: list[tuple[float, float, float]], words: str) -> None:
    document = _document()
    document.modelspace().add_polyline3d(corners, close=True)
    with pytest.raises(InputError, match=words) as error:
        _read(document, tmp_path / "bad.dxf")
    assert str(error.value).startswith(str(tmp_path / "bad.dxf"))


def test_a_window_off_the_wall_is_refused(tmp_path: Path) -> None:
    document = _document()
    document.modelspace().add_polyline3d([(0, 0, 0), (6, 0, 0), (6, 0, 4), (0, 0, 4)], close=True)
    document.modelspace().add_polyline3d([(1, 1, 1), (2, 1, 1), (2, 1, 2), (1, 1, 2)], close=True)
    with pytest.raises(InputError, match="1 m off the plane of POLYLINE"):
        _read(document, tmp_path / "bad.dxf")


def test_windows_may_be_blocks(tmp_path: Path) -> None:
    """Inserted twice, one of them a block in a block; hidden ones are told and left out."""
    document = _document()
    document.layers.add("off").off()
    document.layers.add("frozen").freeze()
    window = document.blocks.new("window")
    window.add_lwpolyline([(0, 0), (1, 0), (1, 1), (0, 1)], close=True)
    document.blocks.new("pair").add_blockref("window", (0, 0))
    space = document.modelspace()
    space.add_lwpolyline(OUTLINE, close=True)
    space.add_blockref("window", (1, 1))
    space.add_blockref("pair", (3, 1), dxfattribs={"xscale": 2})
    space.add_blockref("window", (1, 2.5), dxfattribs={"layer": "off"})
    space.add_lwpolyline([(3, 3), (4, 3), (4, 3.5), (3, 3.5)], close=True, dxfattribs={"layer": "frozen"})
    job = _read(document, tmp_path / "blocks.dxf")
    assert _areas(job) == pytest.approx([24, 1, 2])
    assert [note.text for note in job.notes if note.kind == "ignored"] == [
        "LWPOLYLINE: hidden, on layer frozen",
        "LWPOLYLINE: hidden, on layer off",
    ]


def test_what_was_ignored_is_said_where_nothing_is_left(tmp_path: Path) -> None:
    document = _document()
    for a, b in zip(OUTLINE, OUTLINE[1:] + OUTLINE[:1], strict=True):
        document.modelspace().add_line(a, b)
    with pytest.raises(InputError, match=r"no closed outline \(ignored: 4 LINE"):
        _read(document, tmp_path / "lines.dxf")


def test_millimetres_without_a_unit(tmp_path: Path) -> None:
    document = _document(0)
    document.modelspace().add_lwpolyline([(1000 * x, 1000 * y) for x, y in OUTLINE], close=True)
    with pytest.raises(InputError, match=r"6000 x 4000 m in metres, .*--unit 1mm"):
        _read(document, tmp_path / "mm.dxf")
    job = op.read(tmp_path / "mm.dxf", unit=0.001)
    assert isinstance(job, Facade)
    assert _areas(job) == pytest.approx([24])
    svg = '<svg xmlns="http://www.w3.org/2000/svg"><path d="M0 0H6000V4000H0Z"/></svg>'
    with pytest.raises(InputError, match="--unit"):
        op.read(svg, kind="facade")


def test_no_number_is_said(tmp_path: Path) -> None:
    document = _document()
    document.modelspace().add_lwpolyline(OUTLINE, close=True)
    document.saveas(tmp_path / "nan.dxf")
    text = (tmp_path / "nan.dxf").read_text().replace("\n6.0\n", "\nnan\n")
    (tmp_path / "nan.dxf").write_text(text)
    with pytest.raises(InputError, match=r"LWPOLYLINE.*no finite number"):
        op.read(tmp_path / "nan.dxf")
