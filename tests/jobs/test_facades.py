"""Facades from drawings, DXF files and measured points."""

from __future__ import annotations

import json
import math
from pathlib import Path
from typing import Any

import numpy as np
import pytest

import optplan as op
from optplan.domain.errors import InputError
from optplan.domain.facade import Facade

OUTLINE = [(0, 0), (10, 0), (10, 6), (0, 6)]
WINDOW = [(2, 2), (4, 2), (4, 4), (2, 4)]
SVG = (
    '<svg xmlns="http://www.w3.org/2000/svg" viewBox="0 0 20 20">'
    '<path d="M1 1 H11 V7 H1 Z"/><rect x="3" y="3" width="2" height="2"/><circle cx="8" cy="4" r="1"/></svg>'
)


def _areas(job: object) -> list[float]:
    import shapely

    assert isinstance(job, Facade)
    return [shapely.Polygon(ring).area for ring in (job.walls[0].outline, *job.walls[0].no_go)]


def test_svg_is_a_wall_with_windows() -> None:
    job = op.read(SVG, kind="facade", unit=0.5)
    assert isinstance(job, Facade)
    assert _areas(job) == pytest.approx([15, 1, math.pi / 4], rel=5e-3)
    assert job.walls[0].outline.min(axis=0) == pytest.approx([0, 0])
    # y runs up: the window is 4 units below the top, which is 6 units high
    assert job.walls[0].no_go[0].min(axis=0) == pytest.approx([1, 1])


def test_same_svg_is_a_drawing_too() -> None:
    assert isinstance(op.read(SVG), op.Drawing)


@pytest.mark.parametrize(
    ("svg", "words"),
    [
        (SVG.replace("Z", ""), "open"),
        (SVG.replace("V7 H1", "L1 7 L11 7"), "crosses itself"),
        (SVG.replace('x="3" y', 'x="10" y'), "crosses the outline"),
        (SVG.replace('x="3" y', 'x="13" y'), "beside the largest"),
        ('<svg xmlns="http://www.w3.org/2000/svg"/>', "nothing"),
    ],
)
def test_bad_drawings(svg: str, words: str) -> None:
    with pytest.raises(InputError, match=words):
        op.read(svg, kind="facade", close_gap=0.0)


def test_dxf(tmp_path: Path) -> None:
    ezdxf = pytest.importorskip("ezdxf")
    document = ezdxf.new(units=ezdxf.units.CM)
    space = document.modelspace()
    space.add_lwpolyline([(100 * x, 100 * y) for x, y in OUTLINE], close=True)
    space.add_lwpolyline([(100 * x, 100 * y) for x, y in WINDOW], close=True)
    space.add_circle((700, 300), 100)
    space.add_text("elevation")
    file = tmp_path / "wall.dxf"
    document.saveas(file)
    job = op.read(file)
    assert _areas(job) == pytest.approx([60, 4, math.pi], rel=5e-3)
    assert isinstance(job, Facade)
    assert [note.kind for note in job.notes] == ["ignored"]
    space.add_lwpolyline([(0, 0), (50, 50), (10, 90)])
    document.saveas(file)
    with pytest.raises(InputError, match="open"):
        op.read(file)


@pytest.mark.parametrize("text", ["", "0\nSECTION\n", "no dxf at all", "999\n" * 50])
def test_no_dxf(tmp_path: Path, text: str) -> None:
    pytest.importorskip("ezdxf")
    file = tmp_path / "bad.dxf"
    file.write_text(text)
    with pytest.raises(InputError):
        op.read(file)
    with pytest.raises(InputError, match="does not exist"):
        op.read(tmp_path / "none.dxf")


def _measured(
    noise: float = 0.002, seed: int = 0, lean: float = 0.0
) -> tuple[list[tuple[str, np.ndarray, str]], np.ndarray]:
    """Corners of a wall turned by 30 degrees, 20 m from the station, and its outward normal."""
    random = np.random.default_rng(seed)
    angle = math.radians(30)
    across = np.array([math.cos(angle), math.sin(angle), 0.0])
    normal = np.array([math.sin(angle), -math.cos(angle), 0.0])
    up = math.cos(lean) * np.array([0, 0, 1.0]) - math.sin(lean) * normal
    normal = np.cross(across, up)
    origin = -20 * normal
    rows: list[tuple[str, np.ndarray, str]] = []
    for code, ring in (("outline", OUTLINE), ("window", WINDOW)):
        for x, y in ring:
            rows.append((f"p{len(rows)}", origin + x * across + y * up + noise * random.standard_normal(3), code))
    return rows, normal


def _write(file: Path, rows: list[tuple[str, np.ndarray, str]], head: str = "") -> Path:
    lines = [f"{id},{p[0]:.4f},{p[1]:.4f},{p[2]:.4f},{code}" for id, p, code in rows]
    file.write_text(head + "\n".join(lines) + "\n")
    return file


@pytest.mark.parametrize("lean", [0.0, 0.01, 0.3])
def test_measured_points(tmp_path: Path, lean: float) -> None:
    rows, normal = _measured(lean=lean)
    job = op.read(_write(tmp_path / "wall.csv", rows, "# measured\nid,x,y,z,code\n"))
    assert _areas(job) == pytest.approx([60, 4], rel=5e-3)
    assert isinstance(job, Facade)
    wall = job.walls[0]
    found = np.cross(wall.across, wall.up)
    assert found @ normal > math.cos(0.011 if lean == 0.01 else 2e-3)
    if lean == 0.01:
        assert wall.up == pytest.approx([0, 0, 1])
    # seen from outside x runs to the right: the window is near the left end
    assert wall.no_go[0].mean(axis=0) == pytest.approx([3, 3], abs=0.02)
    assert any("rms" in note.text for note in job.notes)


def test_outliers_are_named(tmp_path: Path) -> None:
    rows, normal = _measured()
    rows.insert(2, ("wrong", rows[1][1] + 0.8 * normal + np.array([0, 0, 2.0]), "outline"))
    job = op.read(_write(tmp_path / "wall.csv", rows))
    assert isinstance(job, Facade)
    assert [note.place for note in job.notes if note.kind == "ignored"] == ["point wrong (line 3)"]
    assert _areas(job) == pytest.approx([60, 4], rel=5e-3)


def test_points_in_no_plane(tmp_path: Path) -> None:
    random = np.random.default_rng(1)
    rows = [(f"p{k}", random.uniform(-9, 9, 3), "") for k in range(9)]
    with pytest.raises(InputError, match="no plane"):
        op.read(_write(tmp_path / "wall.csv", rows))


@pytest.mark.parametrize(
    ("text", "words"),
    [
        ("1,2,3\n", "line 1"),
        ("1,2,3,4\n2,a,3,4\n", "line 2"),
        ("1,2,3,nan\n", "line 1"),
        ("1,0,9,0\n2,1,9,0\n", "3 or more"),
        ("1,0,9,0\n2,1,9,0\n3,2,9,0\n", "no plane"),
        ("1,0,9,0\n2,4,9,0\n3,0,9,4\n4,4,9,4\n", "crosses itself"),
        ("1,0,0,9\n2,4,0,9\n3,4,4,9\n4,0,4,9\n", "level"),
        ("", "no points"),
    ],
)
def test_bad_points(tmp_path: Path, text: str, words: str) -> None:
    file = tmp_path / "wall.csv"
    file.write_text(text)
    with pytest.raises(InputError, match=words):
        op.read(file)


def test_json_is_either_one_wall_or_several(tmp_path: Path) -> None:
    file = tmp_path / "f.json"
    head: dict[str, object] = {"version": "1.5", "kind": "facade", "name": "f"}
    file.write_text(json.dumps({**head, "outline": OUTLINE, "no_go": [WINDOW]}))
    assert _areas(op.read(file)) == pytest.approx([60, 4])
    wrong: list[dict[str, Any]] = [{}, {"outline": OUTLINE, "walls": [{"outline": OUTLINE}]}, {"walls": []}]
    for bad in [*wrong, {"no_go": [WINDOW]}]:
        file.write_text(json.dumps({**head, **bad}))
        with pytest.raises(InputError):
            op.read(file)


def test_washing_cases_are_jobs() -> None:
    job = op.read(op.instance("washing/case2"))
    assert isinstance(job, Facade)
    assert job.walls[0].stops is not None
    assert len(job.walls[0].stops) == 111
    assert job.radius == 1.0
