"""Plans as library files."""

from __future__ import annotations

from pathlib import Path

import pytest

import optplan as op
from optplan.domain.options import CoverOptions, Options, OrderOptions
from optplan.ordering import solve
from optplan.ordering.tsplib import read_tsplib


@pytest.mark.parametrize("inner_first", [False, True])
def test_the_file_has_the_plan_s_optimum(tmp_path: Path, inner_first: bool) -> None:
    options = Options(cover=CoverOptions(inner_first=inner_first), order=OrderOptions(solver="brute"))
    plan = op.plan(op.read(op.instance("logo")), options=options)
    op.export_plan(plan, "tsplib", tmp_path / "logo.gtsp")
    instance = read_tsplib(tmp_path / "logo.gtsp")
    assert instance.kind == ("PCGTSP" if len(instance.problem.precedence) else "GTSP")
    scale = float((tmp_path / "logo.gtsp").read_text().split("costs x ")[1].split(";")[0])
    assert plan.ordering is not None
    assert solve(instance.problem, "brute").cost / scale == pytest.approx(plan.ordering.cost, rel=1e-4)
