"""Solver comparison."""

from __future__ import annotations

import csv
import io
import math
from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest

from optplan.compare import Case, Result, compare_solvers, csv_text, load_case, summary_rows
from optplan.compare.runs import verified
from optplan.domain.errors import InputError
from optplan.domain.ordering import Status
from optplan.instances import instance_names
from optplan.ordering import SOLVERS, solve
from tests.ordering_cases import cases, strokes

CASE = Case("nine", strokes(9))


def test_every_combination_is_run_and_verified() -> None:
    results = list(compare_solvers([CASE], ["nn", "brute"], seeds=(0, 3), budgets=(1.0, 2.0)))
    assert [(r.solver, r.budget, r.seed) for r in results] == [
        (solver, budget, seed) for solver in ("nn", "brute") for budget in (1.0, 2.0) for seed in (0, 3)
    ]
    assert all(r.verified and r.cpu >= 0 and r.bound <= r.cost for r in results)
    assert {r.status for r in results if r.solver == "brute"} == {"optimal"}


def test_tables_know_the_best() -> None:
    results = list(compare_solvers([CASE], ["nn", "brute"], budgets=(5.0,)))
    rows = list(csv.DictReader(io.StringIO(csv_text(results))))
    assert float(rows[1]["excess"]) == 0
    assert float(rows[0]["best"]) == pytest.approx(results[1].cost)
    assert rows[0]["bound"] == ""  # nearest neighbours prove nothing
    summary = summary_rows(results)
    assert summary[1][4] == "0.00 %"
    assert summary[1][-1] == "optimal"


def test_what_was_known_before_counts() -> None:
    best = solve(CASE.problem, "brute").cost
    known = replace(CASE, best_known=0.5 * best)
    (result,) = compare_solvers([known], ["brute"], budgets=(5.0,))
    assert "100.00 %" in summary_rows([result])[0]


def test_refusals_are_results() -> None:
    (result,) = compare_solvers([Case("large", strokes(200))], ["brute"])
    assert result.status == "refused"
    assert "at most" in result.message
    assert math.isinf(result.cost)


def test_a_cancel_keeps_what_was_measured() -> None:
    results: list[Result] = []
    for result in compare_solvers([CASE], list(SOLVERS), cancelled=lambda: len(results) >= 2):
        results.append(result)
    assert len(results) == 2


@pytest.mark.parametrize("arguments", [{"solvers": ["x"]}, {"seeds": [-1]}, {"budgets": [0.0]}])
def test_bad_questions_are_refused_at_once(arguments: dict[str, list[object]]) -> None:
    with pytest.raises(InputError):
        compare_solvers(**({"cases": [CASE], "solvers": ["nn"]} | arguments))  # type: ignore[arg-type]


def test_answers_are_checked_independently() -> None:
    for case in list(cases())[::7]:
        answer = solve(case.problem, "brute")
        assert verified(case.problem, answer)
        if len(answer.nodes) > 1:
            assert not verified(case.problem, replace(answer, nodes=answer.nodes[:-1]))
            assert not verified(case.problem, replace(answer, cost=answer.cost + 1, status=Status.FEASIBLE))
            doubled = np.concatenate([answer.nodes[:-1], answer.nodes[:1]])
            assert not verified(case.problem, replace(answer, nodes=doubled))


def test_cases_come_from_many_files(tmp_path: Path) -> None:
    assert load_case("lion").problem.clusters == 13
    circles = load_case("washing/case1")
    assert circles.problem.clusters == 132
    assert circles.best_known == pytest.approx(228.167)
    file = tmp_path / "three.atsp"
    file.write_text("TYPE: ATSP\nDIMENSION: 3\nEDGE_WEIGHT_TYPE: EXPLICIT\nEDGE_WEIGHT_FORMAT: FULL_MATRIX\n")
    with pytest.raises(InputError, match="EDGE_WEIGHT_SECTION"):
        load_case(file)
    file.write_text(file.read_text() + "EDGE_WEIGHT_SECTION\n0 1 2\n3 0 4\n5 6 0\n")
    (tmp_path / "best_known.csv").write_text("instance,best_known\nthree,10\n")
    assert load_case(file).best_known == 10
    for name, text in (("no.txt", ""), ("list.json", "[]"), ("broken.json", "{"), ("c.json", '{"circles": [[0, 0]]}')):
        (tmp_path / name).write_text(text)
        with pytest.raises(InputError, match=name):
            load_case(tmp_path / name)
    with pytest.raises(InputError, match="nowhere"):
        load_case("nowhere")


@pytest.mark.parametrize("name", [name for name in instance_names() if name.startswith("ordering/")])
def test_shipped_values_are_optimal(name: str) -> None:
    case = load_case(name)
    answer = solve(case.problem, "cuts")
    assert answer.status is Status.OPTIMAL
    assert answer.cost == pytest.approx(case.best_known, abs=1e-9)
