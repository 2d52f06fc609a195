"""Run-ins and run-outs, driven as asked or not."""

from __future__ import annotations

import math
from dataclasses import replace

import numpy as np
import pytest

from optplan.domain.options import ConnectOptions
from optplan.domain.report import Check, Verdict
from optplan.domain.result import Cover, Plan
from optplan.domain.stroke import Stroke
from optplan.judge import verify
from tests.judge.hand_made import OPTIONS, RAKE, Pen, plan_of

ASKED = ConnectOptions(pad_before=0.5, pad_after=0.2)
ANGLE = np.linspace(0, 1, 200)
ARC = Stroke("arc", np.stack([2 * np.sin(ANGLE), 2 - 2 * np.cos(ANGLE)], axis=1))
LINE = Stroke("line", np.array([[0.0, 0], [2, 0]]))


def _driven(stroke: Stroke, bend: float, lead: list[tuple[float, float, int]], tail: list[tuple[float, float, int]],
            asked: ConnectOptions) -> Plan:  # fmt: skip
    """A stroke from the origin eastwards, of length 2 and curvature `bend`, with pieces (length, curvature, tool)
    before and after it."""
    pen = Pen(np.zeros(2))
    for length, kappa, _ in reversed(lead):  # backwards from the origin, which then is turned round
        pen.curve(-length, kappa)
    pen.rows.clear()
    for length, kappa, tool in lead:
        pen.curve(length, kappa, tool)
    assert np.hypot(*pen.at) < 1e-12
    pen.curve(2.0, bend, 1, 0)
    for length, kappa, tool in tail:
        pen.curve(length, kappa, tool)
    return replace(plan_of(RAKE, pen.path, Cover((stroke,))), options=replace(OPTIONS, connect=asked))


def _found(plan: Plan) -> tuple[Check, float]:
    report = verify(plan)
    return next(check for check in report.checks if check.name == "padding"), report.figure("padding")


@pytest.mark.parametrize("curved", [False, True])
@pytest.mark.parametrize("bend", [0.0, 0.5])
def test_padding_as_asked_is_accepted_and_measured(bend: float, curved: bool) -> None:
    kappa = bend if curved else 0.0
    asked = replace(ASKED, curved_padding=curved)
    # more may be driven before, and padding may be of several pieces
    lead, tail = [(0.7, -0.3, 0), (0.3, kappa, 0), (0.2, kappa, 0)], [(0.5, kappa, 0)]
    plan = _driven(ARC if bend else LINE, bend, lead, tail, asked)
    check, metres = _found(plan)
    assert check.verdict is Verdict.PASSED, check
    assert metres == pytest.approx(0.7)
    assert "tool" not in {c.name for c in verify(plan).checks if c.verdict is Verdict.FAILED}


FAULTS = {
    "short before": ([(0.4, 0.0, 0)], [(0.2, 0.0, 0)], 0.2, (0.0, 0.0)),
    "none before": ([], [(0.2, 0.0, 0)], 0.2, (0.0, 0.0)),
    "bent before": ([(0.5, 0.01, 0)], [(0.2, 0.0, 0)], 0.2, (0.0, 0.0)),
    "bent at its far end": ([(0.2, 0.5, 0), (0.3, 0.0, 0)], [(0.2, 0.0, 0)], 0.2, (0.0, 0.0)),
    "marking before": ([(0.5, 0.0, 1)], [(0.2, 0.0, 0)], 0.2, (0.0, 0.0)),
    "short behind": ([(0.5, 0.0, 0)], [(0.19, 0.0, 0)], 0.5, (2.0, 0.0)),
    "bent behind": ([(0.5, 0.0, 0)], [(0.2, -0.01, 0)], 0.5, (2.0, 0.0)),
    "none at all": ([], [], 0.0, (0.0, 0.0)),
}


@pytest.mark.parametrize(("lead", "tail", "metres", "place"), FAULTS.values(), ids=list(FAULTS))
def test_padding_that_is_not_as_asked_is_found_with_its_place(
    lead: list[tuple[float, float, int]],
    tail: list[tuple[float, float, int]],
    metres: float,
    place: tuple[float, float],
) -> None:
    check, driven = _found(_driven(LINE, 0.0, lead, tail, ASKED))
    assert check.verdict is Verdict.FAILED
    assert check.value == 1
    assert check.place == pytest.approx(place, abs=1e-9)
    assert driven == pytest.approx(metres)


@pytest.mark.parametrize("curved", [False, True])
def test_straight_and_curved_padding_are_not_mistaken_for_each_other(curved: bool) -> None:
    kappa = 0.0 if curved else 0.5
    plan = _driven(ARC, 0.5, [(0.5, kappa, 0)], [(0.2, kappa, 0)], replace(ASKED, curved_padding=curved))
    assert _found(plan)[0].verdict is Verdict.FAILED


def test_a_turn_between_padding_and_stroke_is_found() -> None:
    pen = Pen(np.array([0.0, -0.5]), math.pi / 2)
    pen.curve(0.5)
    pen.turn(-math.pi / 2)
    pen.curve(2.0, tool=1, stroke=0)
    pen.curve(0.2)
    plan = replace(plan_of(RAKE, pen.path, Cover((LINE,))), options=replace(OPTIONS, connect=ASKED))
    assert _found(plan)[0].verdict is Verdict.FAILED


def test_stops_have_none_and_nothing_asked_is_nothing_measured() -> None:
    pen = Pen(np.zeros(2))
    pen.turn(0.0, dwell=2.0, tool=1, stroke=0)
    pen.curve(1.0)
    stop = Stroke("stop", np.zeros((1, 2)), dwell=2.0)
    plan = replace(plan_of(RAKE, pen.path, Cover((stop,))), options=replace(OPTIONS, connect=ASKED))
    assert _found(plan)[0].verdict is Verdict.PASSED
    report = verify(replace(plan, options=OPTIONS))
    assert "padding" not in {name for name, _, _ in report.figures}
    assert next(c.verdict for c in report.checks if c.name == "padding") is Verdict.NOTED
