"""Messages, maps, time tables and job sheets."""

from __future__ import annotations

import csv
import io
import json
import math
from dataclasses import replace
from itertools import pairwise
from pathlib import Path

import numpy as np
import pytest

import optplan as op
from optplan.domain.errors import InputError
from optplan.domain.job import Field, FieldSegment
from optplan.exports.geojson import on_earth
from optplan.exports.messages import message_of
from optplan.exports.schedule import schedule_of
from optplan.jobs.fields.placing import anchored

ARC = FieldSegment("ring", np.array([3.0, 0.0]), np.array([3.0, 0.0]), np.zeros(2), 2 * math.pi)
SPOT = FieldSegment("spot", np.zeros(2), np.zeros(2), spot=0.22)
LINE = FieldSegment("line", np.array([-8.0, 5.0]), np.array([8.0, 5.0]), label="north")
FIELD = anchored(Field("small", (LINE, ARC, SPOT)), 52.5, 13.4, 30.0)


@pytest.fixture(scope="module")
def plan() -> op.Plan:
    return op.plan(FIELD, "line-marker")


def test_a_plan_with_spots_is_read_back(plan: op.Plan, tmp_path: Path) -> None:
    op.save_plan(plan, tmp_path / "plan.json")
    again = op.load_plan(tmp_path / "plan.json")
    assert op.verify(again).ok
    assert again.cover is not None
    assert [stroke.headings for stroke in again.cover.strokes] == [1, 1, 8]


def _driven(plan: op.Plan) -> np.ndarray:
    """Points every 2 mm along the path, by a fine sum."""
    path = plan.path
    assert path is not None
    made = []
    for k in np.flatnonzero(path.length > 0).tolist():
        count = max(2, math.ceil(path.length[k] / 0.002))
        u = (np.arange(count) + 0.5) * path.length[k] / count
        angle = path.heading[k] + u * (path.curvature[k] + u * path.sharpness[k] / 2)
        step = path.length[k] / count * np.column_stack([np.cos(angle), np.sin(angle)])
        made.append(path.start[k, :2] + np.concatenate([np.zeros((1, 2)), np.cumsum(step, axis=0)]))
    return np.concatenate(made)


@pytest.mark.parametrize("style", ["arcs", "lines"])
def test_messages_follow_the_path_within_their_tolerance_without_gaps(plan: op.Plan, style: str) -> None:
    from scipy.spatial import cKDTree

    tree = cKDTree(_driven(plan))
    segments = message_of(plan, style, 1e-3).path.segments
    before: tuple[float, float] | None = None
    places = []
    for segment in segments:
        curve = segment.curve
        assert [len(curve.line), len(curve.arc)] == [curve.type.value == 1, curve.type.value == 2]
        if curve.line:
            a, b = np.array(curve.line[0].start), np.array(curve.line[0].end)
            points = a + np.linspace(0, 1, 5)[:, None] * (b - a)
        else:
            arc = curve.arc[0]
            start, center = np.array(arc.start), np.array(arc.center)
            angle = np.linspace(0, arc.sweep_angle, 9)
            c, s = np.cos(angle), np.sin(angle)
            dx, dy = start - center
            points = center + np.column_stack([c * dx - s * dy, s * dx + c * dy])
        if before is not None:
            assert points[0] == pytest.approx(before, abs=1e-6)
        before = (float(points[-1][0]), float(points[-1][1]))
        places.append(points)
    assert np.max(tree.query(np.concatenate(places))[0]) < 1e-3 + 2e-3


def test_messages_hold_every_profile_in_order(plan: op.Plan) -> None:
    message = message_of(plan)
    assert plan.path is not None
    assert plan.trajectory is not None
    codes = [entry.actuation.value for entry in message.actuation_profile.parameters]
    assert codes == [7, 0, 7, 0, 7, 0]
    places = [entry.arc_length for entry in message.actuation_profile.parameters]
    down = sum(b - a for a, b in zip(places[::2], places[1::2], strict=True))
    assert down == pytest.approx(float(plan.path.length[plan.path.tool > 0].sum()), abs=1e-3)
    speeds = message.velocity_profile.parameters
    assert np.all(np.diff([entry.arc_length for entry in speeds]) >= 0)
    assert speeds[0].velocity.value == speeds[-1].velocity.value == 0
    assert max(entry.velocity.value for entry in speeds) == pytest.approx(plan.trajectory.v.max())
    kinds = {segment.curve.type.value for segment in message_of(plan, "clothoids").path.segments}
    assert kinds == {1, 2, 3}


def test_places_on_earth_are_as_far_apart_as_on_the_field() -> None:
    from pyproj import Geod

    assert FIELD.anchor is not None
    points = np.array([[0.0, 0.0], [0.0, 100.0], [60.0, 0.0]])
    degrees = on_earth(points, FIELD.anchor)
    assert degrees[0] == pytest.approx([13.4, 52.5], abs=1e-9)
    earth = Geod(ellps="WGS84")
    azimuth, _, distance = earth.inv(*degrees[0], *degrees[1])
    # nine decimals of a degree are a tenth of a millimetre
    assert distance == pytest.approx(100, abs=3e-4)
    assert azimuth == pytest.approx(30, abs=1e-3)
    azimuth, _, distance = earth.inv(*degrees[0], *degrees[2])
    assert distance == pytest.approx(60, abs=3e-4)
    assert azimuth == pytest.approx(120, abs=1e-3)


def test_geojson_holds_every_mark_and_needs_an_anchor(plan: op.Plan, tmp_path: Path) -> None:
    op.export_plan(plan, "geojson", tmp_path / "a.geojson")
    found = json.loads((tmp_path / "a.geojson").read_text())
    marks = [f["properties"]["stroke"] for f in found["features"] if f["properties"]["kind"] == "mark"]
    assert sorted(marks) == ["line", "ring", "spot"]
    assert isinstance(plan.job, Field)
    with pytest.raises(InputError, match="anchor"):
        op.export_plan(replace(plan, job=replace(plan.job, anchor=None)), "geojson", tmp_path / "b.geojson")
    assert not (tmp_path / "b.geojson").exists()


def test_marks_on_the_map_leave_their_curves_by_a_millimetre(plan: op.Plan, tmp_path: Path) -> None:
    from pyproj import Geod

    op.export_plan(plan, "geojson", tmp_path / "a.geojson")
    features = json.loads((tmp_path / "a.geojson").read_text())["features"]
    (ring,) = [np.array(f["geometry"]["coordinates"]) for f in features if f["properties"]["stroke"] == "ring"]
    middles = (ring[1:] + ring[:-1]) / 2
    _, _, away = Geod(ellps="WGS84").inv(*np.tile([13.4, 52.5], (len(middles), 1)).T, *middles.T)
    assert np.abs(away - 3).max() < 1.5e-3


def test_the_time_table_adds_up(plan: op.Plan, tmp_path: Path) -> None:
    entries = schedule_of(plan)
    assert plan.trajectory is not None
    assert entries[0].begin == 0
    assert entries[-1].end == pytest.approx(plan.trajectory.duration)
    assert all(a.end == pytest.approx(b.begin) for a, b in pairwise(entries))
    op.export_plan(plan, "schedule", tmp_path / "a.csv")
    rows = list(csv.DictReader(io.StringIO((tmp_path / "a.csv").read_text())))
    assert plan.cover is not None
    strokes = [plan.cover.strokes[entry.stroke].id for entry in entries if entry.stroke >= 0]
    assert [row["stroke"] for row in rows if row["what"] == "mark"] == strokes


def test_a_job_sheet_is_one_page(plan: op.Plan, tmp_path: Path) -> None:
    op.export_plan(plan, "pdf", tmp_path / "a.pdf")
    data = (tmp_path / "a.pdf").read_bytes()
    assert data.startswith(b"%PDF")
    assert data.count(b"/Type /Page\n") + data.count(b"/Type /Page ") == 1
