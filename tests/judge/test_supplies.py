"""What a plan uses up."""

from __future__ import annotations

import math
from dataclasses import replace

import numpy as np
import pytest

import optplan as op
from optplan.domain.errors import InputError
from optplan.domain.job import Field, FieldSegment
from optplan.domain.robot import Robot, Supplies
from optplan.judge import verify

MARKER = op.load_robot("line-marker")
FIELD = Field("x", (FieldSegment("a", np.zeros(2), np.array([50.0, 0])),))


def _told(robot: Robot) -> tuple[str, op.Plan]:
    plan = op.plan(FIELD, robot)
    assert plan.report is not None
    return next(check.detail for check in plan.report.checks if check.name == "supplies"), plan


def test_paint_goes_by_area_and_energy_by_time() -> None:
    detail, plan = _told(MARKER)
    assert plan.report is not None
    assert plan.trajectory is not None
    area = 50 * 0.12 + math.pi * 0.06**2
    assert plan.report.figure("paint") == pytest.approx(0.09 * area, rel=1e-3)
    assert plan.report.figure("energy") == pytest.approx(136 * plan.trajectory.duration / 3600)
    assert "again" not in detail
    assert "20 L" in detail


def test_what_does_not_suffice_is_said_but_is_no_fault() -> None:
    small = replace(MARKER, supplies=Supplies("paint", 1.3e-4, tank=1e-4, power=136, battery=100))
    detail, plan = _told(small)
    assert "filled again" in detail
    assert "charged again" in detail
    assert plan.report is not None
    assert plan.report.ok


def test_nothing_known_is_nothing_claimed() -> None:
    detail, plan = _told(replace(MARKER, supplies=None))
    assert detail == "Nobody said what this robot uses up."
    assert plan.report is not None
    assert not any(name in ("paint", "energy") for name, _, _ in plan.report.figures)
    assert verify(plan).ok


@pytest.mark.parametrize("wrong", [{"per_area": -1.0}, {"tank": 0.0}, {"power": math.nan}, {"flow": 1.0, "name": ""}])
def test_bad_supplies_are_refused(wrong: dict[str, object]) -> None:
    with pytest.raises(InputError):
        Supplies(**{"name": "paint", **wrong})  # type: ignore[arg-type]
