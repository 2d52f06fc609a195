"""Orientation of closed strokes, and entry vertices that the user fixes."""

from __future__ import annotations

import numpy as np
import pytest

import optplan as op
from optplan.coverage.placing import signed_area

RINGS = """<svg xmlns="http://www.w3.org/2000/svg" viewBox="0 0 30 10">
<path id="left" d="M1 1L9 1L9 9L1 9z" fill="none" stroke="black"/>
<path id="right" d="M11 1L11 9L19 9L19 1z" fill="black"/>
<path id="round" d="M25 1A4 4 0 0 1 25 9A4 4 0 0 1 25 1z" fill="none" stroke="black"/>
<path id="open" d="M21 1L22 5L21 9" fill="none" stroke="black"/></svg>"""


def _cover(entry: dict[str, int] | None = None) -> op.Plan:
    job = op.read(RINGS)
    assert isinstance(job, op.Drawing)
    for id, vertex in (entry or {}).items():
        job = job.with_element(id, entry=vertex)
    return op.plan(job, "beach-rake", op.Options(order=op.OrderOptions(solver="search", iterations=5)))


def test_closed_strokes_run_counter_clockwise_and_holes_clockwise() -> None:
    cover = _cover().cover
    assert cover is not None
    assert all(signed_area(stroke.points) > 0 for stroke in cover.strokes if stroke.closed)
    assert all(signed_area(area.rings[0]) > 0 for area in cover.areas)


@pytest.mark.parametrize("vertex", range(4))
def test_a_fixed_entry_is_the_drawn_vertex(vertex: int) -> None:
    plan = _cover({"left": vertex})
    assert plan.cover is not None
    assert plan.visits is not None
    k = next(k for k, stroke in enumerate(plan.cover.strokes) if stroke.id == "left")
    box = plan.cover.strokes[k].points
    corner = {0: (0, 1), 1: (1, 1), 2: (1, 0), 3: (0, 0)}[vertex]  # y points up
    wanted = np.where(corner, box.max(axis=0), box.min(axis=0))
    row = plan.visits.stroke.tolist().index(k)
    np.testing.assert_allclose(plan.visits.entry[row, :2], wanted)


def test_curves_are_entered_at_drawn_vertices_and_lines_at_their_ends() -> None:
    plan = _cover({"round": 0, "open": 2})
    assert plan.cover is not None
    strokes = {stroke.id: stroke for stroke in plan.cover.strokes}
    ring, line = strokes["round"], strokes["open"]
    assert ring.entry is not None
    assert ring.points[ring.entry, 1] == pytest.approx(ring.points[:, 1].max())
    assert line.entry == len(line.points) - 1


@pytest.mark.parametrize(("id", "vertex", "message"), [("left", 7, "0..3"), ("open", 1, "its ends")])
def test_impossible_entries_are_refused(id: str, vertex: int, message: str) -> None:
    with pytest.raises(op.InputError, match=message):
        _cover({id: vertex})
