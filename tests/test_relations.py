"""Rules between strokes, from the drawing to the judge: inner before outer, enforced connections."""

from __future__ import annotations

from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest

import optplan as op
from optplan.domain.errors import InputError
from optplan.domain.options import CoverOptions, Link, Options, OrderOptions
from optplan.domain.path import Path as Driven
from optplan.domain.report import Check
from optplan.domain.result import Plan
from optplan.domain.robot import DiffDrive
from optplan.judge import verify

NESTED = """<svg xmlns="http://www.w3.org/2000/svg" viewBox="0 0 400 400" fill="none" stroke="#000">
  <path id="outer" d="M20 20H380V380H20Z"/>
  <path id="middle" d="M60 60H340V340H60Z"/>
  <path id="core" d="M180 180L220 180L200 220Z"/>
  <path id="dash" d="M100 100L140 100"/>
  <path id="beside" d="M390 10L395 390"/>
</svg>"""


def _plan(folder: Path, robot: str = "pen-plotter", text: str = NESTED, **cover: object) -> Plan:
    file = folder / "nested.svg"
    file.write_text(text)
    return op.plan(op.read(file), robot, Options(cover=CoverOptions(**cover), order=OrderOptions(seconds=5)))  # type: ignore[arg-type]


def _check(plan: Plan, name: str) -> Check:
    assert plan.report is not None
    return next(check for check in plan.report.checks if check.name == name)


def _order(plan: Plan) -> list[str]:
    assert plan.cover is not None
    assert plan.visits is not None
    return [plan.cover.strokes[k].id for k in plan.visits.stroke]


@pytest.mark.parametrize("robot", ["pen-plotter", "beach-rake"])
def test_inner_before_outer(tmp_path: Path, robot: str) -> None:
    plan = _plan(tmp_path, robot, inner_first=True)
    order = [name.split("~")[0] for name in _order(plan)]
    for inner, outer in (("core", "middle"), ("dash", "middle"), ("middle", "outer")):
        last = max(k for k, name in enumerate(order) if name == inner)
        assert last < order.index(outer)
    assert _check(plan, "precedence").detail.startswith("3 rules")


def test_any_order_by_default(tmp_path: Path) -> None:
    plan = _plan(tmp_path)
    assert plan.cover is not None
    assert plan.cover.precedence == ()
    inner = _plan(tmp_path, inner_first=True)
    assert plan.ordering is not None
    assert inner.ordering is not None
    assert plan.ordering.cost <= inner.ordering.cost


LINKS: list[tuple[Link, ...]] = [
    (("dash", 0, "beside", -1),),
    (("dash", 1, "outer", 2), ("dash", 0, "core", 1)),
    (("beside", 0, "dash", 0), ("dash", 1, "core", 0), ("core", 0, "outer", 1)),
]


@pytest.mark.parametrize("links", LINKS, ids=("pair", "two", "chain"))
@pytest.mark.parametrize("robot", ["pen-plotter", "beach-rake"])
def test_enforced_connections_are_driven(tmp_path: Path, robot: str, links: tuple[Link, ...]) -> None:
    plan = _plan(tmp_path, robot, links=links)
    order = _order(plan)
    for one, _, two, _ in links:
        assert abs(order.index(one) - order.index(two)) == 1
    plural = "s" if len(links) > 1 else ""
    assert _check(plan, "connections").detail == f"{len(links)} enforced connection{plural}, all driven."
    assert plan.report is not None
    assert plan.report.ok


def test_connections_of_strokes_that_are_split(tmp_path: Path) -> None:
    robot = op.load_robot("beach-rake")
    assert isinstance(robot.mobility, DiffDrive)
    car = replace(robot, mobility=replace(robot.mobility, turns_on_spot=False))
    file = tmp_path / "nested.svg"
    file.write_text(NESTED)
    options = Options(cover=CoverOptions(links=(("outer", 0, "dash", 1),)), order=OrderOptions(seconds=2))
    plan = op.plan(op.read(file), car, options)
    assert _check(plan, "connections").verdict == "passed"


def test_the_judge_sees_a_connection_that_is_not_driven(tmp_path: Path) -> None:
    plan = _plan(tmp_path)
    assert plan.cover is not None
    order = _order(plan)
    ids = [stroke.id for stroke in plan.cover.strokes]
    far = (ids.index(order[0]), 0, ids.index(order[-1]), 0)
    wrong = replace(plan, cover=replace(plan.cover, links=(far,)))
    assert isinstance(wrong.path, Driven)
    assert _check(replace(wrong, report=verify(wrong)), "connections").verdict == "failed"


def test_a_plan_keeps_its_rules_in_its_file(tmp_path: Path) -> None:
    plan = _plan(tmp_path, inner_first=True, links=LINKS[0])
    op.save_plan(plan, tmp_path / "plan.json")
    again = op.load_plan(tmp_path / "plan.json")
    assert again.cover is not None
    assert plan.cover is not None
    assert again.cover.links == plan.cover.links
    assert again.options == plan.options


@pytest.mark.parametrize(
    ("links", "words"),
    [
        ((("dsh", 0, "core", 0),), "there is no stroke 'dsh'; expected one of outer"),
        ((("dash", 5, "core", 0),), "has no vertex 5"),
        ((("dash", 0, "core", 9),), "has no vertex 9"),
        ((("dash", 0, "dash", 1),), "two different"),
        ((("dash", 0, "core", 0), ("dash", 0, "outer", 0)), "cannot all be driven"),
        ((("dash", 0, "core", 0), ("dash", 1, "core", 1)), "tied to"),
    ],
)
def test_connections_that_make_no_sense(tmp_path: Path, links: tuple[Link, ...], words: str) -> None:
    with pytest.raises(InputError, match=words):
        _plan(tmp_path, links=links)


def test_inside_vertices_of_open_lines_are_refused(tmp_path: Path) -> None:
    text = NESTED.replace("M100 100L140 100", "M100 100L140 100L140 140")
    with pytest.raises(InputError, match="only at its ends"):
        _plan(tmp_path, text=text, links=(("dash", 1, "core", 0),))


def test_rules_that_contradict_each_other(tmp_path: Path) -> None:
    with pytest.raises(InputError, match="precedence"):
        _plan(tmp_path, inner_first=True, links=(("outer", 0, "core", 0), ("core", 0, "beside", 0)))


def test_enforced_connections_cost_what_they_add(tmp_path: Path) -> None:
    free, tied = _plan(tmp_path), _plan(tmp_path, links=LINKS[0])
    assert free.ordering is not None
    assert tied.ordering is not None
    assert tied.ordering.status == "optimal"
    assert tied.ordering.cost > free.ordering.cost
    assert np.isfinite(tied.ordering.bound)


def test_links_of_curved_rings_are_driven() -> None:
    """A ring made a curve is entered beside its vertex, within the tolerance; the judge holds a link to that."""
    svg = """<svg xmlns="http://www.w3.org/2000/svg" viewBox="0 0 20 20"><g fill="none" stroke="#000">
    <circle id="one" cx="5" cy="5" r="3"/><circle id="two" cx="15" cy="9" r="4"/>
    <path id="line" d="M2 18H18"/></g></svg>"""
    options = Options(cover=CoverOptions(links=(("one", 0, "two", 1),)), order=OrderOptions(iterations=500))
    for robot in ("beach-rake", "line-marker"):
        plan = op.plan(op.read(svg), robot, options)
        assert plan.report is not None
        assert plan.report.ok
