"""Plans among forbidden areas: no connector enters them, costs are those of the ways around, bounds hold."""

from __future__ import annotations

import json
import math
import sys
from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest

import optplan as op
from optplan.cli import main
from optplan.domain.report import Verdict
from optplan.domain.result import Plan

POND = ((7.0, 9.0), (11.0, 9.0), (11.0, 11.0), (7.0, 11.0))
DOTS = "".join(f'<path d="M {x} {y} l 3 0" fill="none" stroke="#000"/>' for x in (10, 50, 90) for y in (10, 50, 90))
SVG = f'<svg xmlns="http://www.w3.org/2000/svg" viewBox="0 0 100 100">{DOTS}</svg>'


def planned(metric: str, robot: str = "beach-rake", **connect: object) -> Plan:
    options = op.Options(
        page=op.PageOptions(margin=2.0),  # room to turn
        order=op.OrderOptions(metric=metric, iterations=2000),
        connect=op.ConnectOptions(**connect),  # type: ignore[arg-type]
    )
    return op.plan(op.read(SVG), robot, options)


def failed(plan: Plan) -> list[str]:
    assert plan.report is not None
    return [check.name for check in plan.report.checks if check.verdict is Verdict.FAILED]


@pytest.mark.parametrize("metric", ["euclid", "cc"])
def test_no_connector_enters_an_area(metric: str) -> None:
    free = planned(metric)
    # a pond between the rows: it hides two of the shortest connectors
    pond = tuple((x, y) for x, y in ((3.0, 5.0), (8.5, 5.0), (8.5, 7.0), (3.0, 7.0)))
    plan = planned(metric, keep_out=(pond,), clearance=0.4, on_canvas=True)
    assert plan.report is not None
    assert failed(plan) == []
    areas = next(check for check in plan.report.checks if check.name == "areas")
    assert areas.verdict is Verdict.PASSED
    assert free.ordering is not None
    assert plan.ordering is not None
    assert "forbidden areas" in plan.ordering.message
    assert plan.ordering.cost >= free.ordering.bound - 1e-9
    assert plan.ordering.bound <= plan.ordering.cost * (1 + 1e-9)
    # the same order, judged among the areas, fails: the pond matters
    assert free.path is not None
    blind = replace(free, options=plan.options)
    again = next(check for check in op.verify(blind).checks if check.name == "areas")
    crosses = again.verdict is Verdict.FAILED
    assert crosses == (plan.ordering.cost > free.ordering.cost * (1 + 1e-9))


def test_connectors_stay_on_the_canvas() -> None:
    plan = planned("cc", "line-marker", on_canvas=True)
    assert plan.report is not None
    assert failed(plan) == []


def test_an_area_around_a_stroke_has_no_way() -> None:
    box = ((0.5, 0.5), (5.0, 0.5), (5.0, 5.0), (0.5, 5.0))
    plan = planned("euclid", keep_out=(box,))
    assert plan.report is not None
    assert failed(plan) == ["areas"]


def test_dubins_paths_have_no_ways_around() -> None:
    with pytest.raises(op.InputError, match="'cc'"):
        planned("dubins", "line-marker", keep_out=(POND,))


def test_areas_on_the_command_line(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    def main_code(*arguments: object) -> int:
        with pytest.MonkeyPatch.context() as patch:
            patch.setattr(sys, "argv", ["optplan", *map(str, arguments)])
            try:
                main()
            except SystemExit as stop:
                return int(stop.code or 0)
        return 0

    drawing, areas = tmp_path / "dots.svg", tmp_path / "areas.json"
    drawing.write_text(SVG)
    areas.write_text(json.dumps({"keep_out": [[["2 m", 400 / 100], [7.5, 4], [7.5, 7], [2, 7]]], "clearance": "40 cm"}))
    out = tmp_path / "out"
    assert main_code("plan", drawing, "--areas", areas, "--iterations", 500, "-o", out, "--quiet") == 0
    saved = json.loads((out / "plan.json").read_text())
    assert saved["options"]["connect"]["clearance"] == pytest.approx(0.4)
    again = op.load_plan(out / "plan.json")
    assert len(again.options.connect.keep_out[0]) == 4
    for text, message in (
        ("[", "JSON"),
        ("[]", "keep_out"),
        ('{"hole": 1}', "keep_out"),
        ('{"keep_out": [[[0, 0], [1, 1]]]}', "3 or more"),
        ('{"keep_out": [[[0, 0], [1, 1], [1, "x"]]]}', "keep_out"),
        ('{"keep_out": [[[0, 0], [1, 1], [1, 0], [0, 1]]]}', "no polygon"),
    ):
        areas.write_text(text)
        capsys.readouterr()
        assert main_code("plan", drawing, "--areas", areas, "-o", tmp_path / "none") == 2, text
        assert message in " ".join(capsys.readouterr().err.split()), text
        assert not (tmp_path / "none").exists()


def test_the_judge_measures_how_deep() -> None:
    plan = planned("euclid")
    assert plan.path is not None
    up = plan.path.stroke < 0
    row = int(np.flatnonzero(up & (plan.path.length > 1))[0])
    middle = plan.path.start[row, :2] + plan.path.length[row] / 2 * np.array(
        [math.cos(plan.path.heading[row]), math.sin(plan.path.heading[row])]
    )
    x, y = middle.tolist()
    ring = ((x - 0.2, y - 0.2), (x + 0.2, y - 0.2), (x + 0.2, y + 0.2), (x - 0.2, y + 0.2))
    connect = op.ConnectOptions(keep_out=(ring,), clearance=0.1)
    spoiled = replace(plan, options=replace(plan.options, connect=connect))
    areas = next(check for check in op.verify(spoiled).checks if check.name == "areas")
    assert areas.verdict is Verdict.FAILED
    assert areas.value >= 0.1


def test_a_time_limit_ends_the_solving_again() -> None:
    """What is returned then is measured all the same: its cost is that of the path."""
    pond = tuple((x, y) for x, y in ((3.0, 5.0), (8.5, 5.0), (8.5, 7.0), (3.0, 7.0)))
    options = op.Options(
        page=op.PageOptions(margin=2.0),
        order=op.OrderOptions(metric="euclid", seconds=1e-3),
        connect=op.ConnectOptions(keep_out=(pond,), clearance=0.4),
    )
    plan = op.plan(op.read(SVG), "beach-rake", options)
    assert plan.ordering is not None
    assert plan.path is not None
    assert plan.ordering.cost == pytest.approx(float(plan.path.length[plan.path.stroke < 0].sum()))
    assert plan.ordering.bound <= plan.ordering.cost * (1 + 1e-9)
    assert plan.ordering.seconds < 5
