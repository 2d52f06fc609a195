"""Drawings that once could not be planned, or took for ever."""

from __future__ import annotations

import math

import pytest

import optplan as op

OPEN = '<svg xmlns="http://www.w3.org/2000/svg" viewBox="0 0 100 100" width="100" height="100">'
CURL = "".join(f"l{1e-5 * math.cos(k)} {1e-5 * math.sin(k)}" for k in range(1000))
DRAWINGS = {
    "area far narrower than the tool": (
        '<path fill="black" fill-rule="evenodd" d="M10 10H90V90H10Z M10.001 10.001H89.999V89.999H10.001Z"/>'
    ),
    "tiny area": '<path d="M10 10L90 90" stroke="black"/><circle cx="50" cy="60" r="0.02" fill="black"/>',
    "curl within the mark": f'<path d="M50 50{CURL}L60 60" stroke="black" fill="none"/>',
}


@pytest.mark.parametrize("robot", ["beach-rake", "pen-plotter"])
@pytest.mark.parametrize("drawing", list(DRAWINGS.values()), ids=list(DRAWINGS))
def test_it_is_planned_and_verified(drawing: str, robot: str) -> None:
    plan = op.plan(op.read(f"{OPEN}{drawing}</svg>"), robot)
    assert plan.report is not None
    assert plan.report.ok


def test_a_path_in_place_of_a_job_is_an_input_error() -> None:
    with pytest.raises(op.InputError, match=r"optplan\.read"):
        op.plan("lion.svg")  # type: ignore[arg-type]
