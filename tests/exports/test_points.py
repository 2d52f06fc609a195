"""Plans as points."""

from __future__ import annotations

import csv
import io
import math
from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from optplan.connectors.driving import connect
from optplan.domain.errors import InputError, LimitError
from optplan.domain.job import Drawing
from optplan.domain.options import Options
from optplan.domain.result import Cover, Plan
from optplan.domain.robot import Canvas
from optplan.domain.stroke import Stroke
from optplan.exports import FORMATS, export_plan, usual_spacing
from optplan.exports import points as module
from optplan.exports.points import COLUMNS, ToolPoints, csv_text, format_points, parse_points, points_text, tool_points
from optplan.problem import traversals
from optplan.timing.fastest import profile
from tests.strategies import RAKE, array, box


def _plan() -> Plan:
    strokes = (Stroke("l", array([[1, 1], [4, 1]])), Stroke("box", box(6, 2, 2, 2), 2, closed=True))
    cover = Cover(strokes, start=(1.0, 1.0), canvas=Canvas(20.0, 10.0, 0.5))
    visits = traversals(strokes, RAKE).take([0, 2])
    path = connect(visits, cover, RAKE)
    trajectory = profile(path, RAKE)
    return Plan(Drawing("d", ()), RAKE, Options(), cover, visits=visits, path=path, trajectory=trajectory)


def _rows(text: str) -> list[dict[str, str]]:
    return list(csv.DictReader(io.StringIO(text)))


@pytest.mark.parametrize("spacing", [0.03, 0.5, 50.0])
def test_csv_columns(spacing: float) -> None:
    plan = _plan()
    text = csv_text(plan, spacing)
    assert text.splitlines()[0] == ",".join(COLUMNS)
    rows = _rows(text)
    column = {name: array([row[name] for row in rows]) for name in ("s", "t", "x", "y", "z", "speed", "heading")}
    assert (column["s"][0], column["t"][0], column["x"][0], column["y"][0]) == (0, 0, 1, 1)
    assert plan.path is not None
    assert plan.trajectory is not None
    assert column["s"][-1] == pytest.approx(plan.path.offsets[-1], abs=1e-6)
    assert column["t"][-1] == pytest.approx(plan.trajectory.duration, abs=1e-4)
    assert (column["x"][-1], column["y"][-1]) == (6, 2)
    gaps = np.diff(column["s"])
    assert gaps.min() >= 0
    assert gaps.max() <= spacing + 1e-6
    assert (np.hypot(np.diff(column["x"]), np.diff(column["y"])) <= gaps + 3e-6).all()
    assert (np.diff(column["t"]) >= 0).all()
    assert (column["speed"] >= 0).all()
    assert column["speed"].max() <= 0.6
    stops = [row["stop"] for row in rows]
    assert stops.count("1") == plan.path.is_stop.sum()
    names = {(row["tool"], row["code"], row["stroke"]) for row in rows}
    assert names == {("narrow", "1", "l"), ("wide", "3", "box"), ("up", "0", "box"), ("up", "0", "")} | (
        {("up", "0", "box")}
    )
    assert rows[-1]["tool"] == "up"


def test_csv_without_speeds_or_strokes() -> None:
    rows = _rows(csv_text(replace(_plan(), trajectory=None, cover=None)))
    assert {row["t"] for row in rows} == {row["speed"] for row in rows} == {row["stroke"] for row in rows} == {""}


def test_text_points_run_down_from_the_top() -> None:
    plan = _plan()
    made = tool_points(plan, 0.25)
    assert len(made.points) == len(made.codes) == len(made.turns)
    assert made.points[0].tolist() == [1, 9]
    assert made.points[-1] == pytest.approx([6, 8])
    assert set(made.codes.tolist()) == {0, 1, 3}
    assert made.codes[-1] == 0
    assert np.hypot(*np.diff(made.points, axis=0).T).max() <= 0.25 + 1e-9
    assert plan.path is not None
    corners = plan.path.start[plan.path.is_stop][:, :2]
    assert made.points[made.turns] == pytest.approx(np.column_stack([corners[:, 0], 10 - corners[:, 1]]))
    # the mark's length follows from the codes
    steps = np.hypot(*np.diff(made.points, axis=0).T)
    assert steps[made.codes[:-1] == 1].sum() == pytest.approx(3)
    assert steps[made.codes[:-1] == 3].sum() == pytest.approx(8)
    text = points_text(plan, 0.25)
    assert text.splitlines().count("") == made.turns.sum()
    assert all(0 <= int(line.split()[2]) <= 127 for line in text.splitlines() if line)
    free = tool_points(replace(plan, cover=None), 0.25)
    assert free.points[:, 1].min() == pytest.approx(0)


@given(
    st.lists(
        st.tuples(
            st.integers(-(10**9), 10**9), st.integers(-(10**9), 10**9), st.integers(0, 127), st.booleans()
        ),
        max_size=30,
    )
)  # fmt: skip
def test_points_survive_text(rows: list[tuple[int, int, int, bool]]) -> None:
    points = ToolPoints(
        array([[x / 1e6, y / 1e6] for x, y, _, _ in rows]).reshape(-1, 2),
        np.array([code for _, _, code, _ in rows], dtype=np.int64),
        np.array([turn for _, _, _, turn in rows], dtype=np.bool_),
    )
    again = parse_points(format_points(points))
    for one, other in zip(points, again, strict=True):
        assert one.dtype == other.dtype
        assert one.tolist() == other.tolist()


@pytest.mark.parametrize(
    "line",
    ["1 2", "1 2 3 4", "a 2 3", "1 2 3.5", "nan 2 3", "1 inf 3", "1 2 128", "1 2 -1", "1,2,3", "1_0 2 3", "1 2 1_0"],
)
def test_malformed_lines_are_named(line: str) -> None:
    with pytest.raises(InputError, match=r"way\.txt: line 3: is '.*expected 'x y tool'"):
        parse_points(f"0 0 0\n\n{line}\n1 1 1\n", "way.txt")


@pytest.mark.parametrize("spacing", [0.0, -1.0, math.nan, math.inf])
@pytest.mark.parametrize("form", ["csv", "txt"])
def test_bad_spacings(form: str, spacing: float) -> None:
    with pytest.raises(InputError, match="spacing"):
        FORMATS[form].write(_plan(), spacing, "m")


def test_too_many_points(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(module, "MAX_POINTS", 100)
    with pytest.raises(LimitError, match="at most 100"):
        csv_text(_plan(), 0.01)


def test_files(tmp_path: Path) -> None:
    plan = _plan()
    assert usual_spacing(plan) == 0.05
    assert usual_spacing(replace(plan, cover=Cover((), canvas=Canvas(0.3, 0.2)))) == pytest.approx(0.002)
    for name, form in FORMATS.items():
        if name in ("geojson", "pdf"):  # of fields with an anchor only, and no text
            continue
        file = tmp_path / f"plan{form.suffix}"
        if name.startswith("stops"):
            with pytest.raises(InputError, match="those of a facade"):
                export_plan(plan, name, file)
            continue
        export_plan(plan, name, file)
        assert file.read_text() == form.write(plan, 0.05, "m")
        with pytest.raises(InputError, match="exists already"):
            export_plan(plan, name, file)
        export_plan(plan, name, file, spacing=1.0, overwrite=True)
        assert file.read_text() == form.write(plan, 1.0, "m")
    with pytest.raises(InputError, match="no format 'poem'; expected one of csv, txt"):
        export_plan(plan, "poem", tmp_path / "x")
    with pytest.raises(InputError, match="no path yet"):
        export_plan(replace(plan, path=None), "csv", tmp_path / "x")
    assert not (tmp_path / "x").exists()
