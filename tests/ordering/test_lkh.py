"""The adapter for LKH, against a program that speaks its files."""

from __future__ import annotations

import json
import math
import re
import sys
from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest

from optplan.domain.errors import SolverError
from optplan.domain.ordering import MatrixCosts, OrderingProblem, Status
from optplan.domain.stop import StopReason, StopRule
from optplan.ordering import SOLVERS, solve
from tests.ordering_cases import random_problem, strokes

HEAD = """
import itertools, math, sys, time
parameters = dict(line.split(" = ") for line in open(sys.argv[1]).read().splitlines() if " = " in line)
lines = open(parameters["PROBLEM_FILE"]).read().splitlines()
size = int(next(line for line in lines if line.startswith("DIMENSION")).split(":")[1])
kind = next(line for line in lines if line.startswith("TYPE")).split(":")[1].strip()
begin = lines.index("EDGE_WEIGHT_SECTION") + (2 if kind == "SOP" else 1)
weight = [[int(w) for w in line.split()] for line in lines[begin : begin + size]]

def cost(tour):
    place = {city: p for p, city in enumerate(tour)}
    if kind == "SOP" and any(weight[i][j] == -1 and place[j] > place[i] for i in tour for j in tour if i != j):
        return math.inf
    return sum(weight[a][b] for a, b in zip(tour, tour[1:] + (() if kind == "SOP" else tour[:1])))

def write(tour):
    numbers = "".join(f"{city + 1}\\n" for city in tour)
    open(parameters["TOUR_FILE"], "w").write(f"NAME : x\\nTOUR_SECTION\\n{numbers}-1\\nEOF\\n")
"""
SOLVES = """
middle = range(1, size - 1) if kind == "SOP" else range(1, size)
ends = (size - 1,) if kind == "SOP" else ()
write(min(((0, *order, *ends) for order in itertools.permutations(middle)), key=cost))
"""
HANGS = SOLVES + "\ntime.sleep(600)"


@pytest.fixture
def fake(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Path:
    """The file of a program that `OPTPLAN_LKH` names."""
    file = tmp_path / "lkh-like"
    monkeypatch.setenv("OPTPLAN_LKH", str(file))
    return file


def program(file: Path, body: str) -> None:
    file.write_text(f"#!{sys.executable}\n{HEAD}{body}\n")
    file.chmod(0o755)


def test_without_the_program_it_says_what_to_do(fake: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    with pytest.raises(SolverError, match=r"not installed; put it on PATH.*OPTPLAN_LKH.*research use only"):
        solve(strokes(3), "lkh")
    monkeypatch.delenv("OPTPLAN_LKH")
    monkeypatch.setenv("PATH", str(fake.parent))
    assert SOLVERS["lkh"].refusal(strokes(3))
    program(fake.with_name("LKH"), SOLVES)
    assert SOLVERS["lkh"].refusal(strokes(3)) is None


@pytest.mark.parametrize("closed", [False, True])
@pytest.mark.parametrize("kind", ["single", "ordered", "strokes"])
def test_its_tours_are_read(fake: Path, kind: str, closed: bool) -> None:
    program(fake, SOLVES)
    rng = np.random.default_rng(3)
    if kind == "strokes":
        problem = replace(strokes(3), closed=closed, node_costs=rng.uniform(size=6))
    else:
        problem = OrderingProblem(
            np.arange(5),
            MatrixCosts(rng.uniform(1, 9, (5, 5))),
            rng.uniform(size=5) if kind == "single" and not closed else np.zeros(0),
            precedence=np.array([[3, 1], [2, 4]]) if kind == "ordered" else np.zeros((0, 2), dtype=np.int64),
            closed=closed,
        )
    answer = solve(problem, "lkh", seed=4)
    # weights are rounded to whole numbers
    assert answer.cost == pytest.approx(solve(problem, "brute").cost, rel=1e-4)
    assert answer.status is Status.FEASIBLE
    assert answer.bound == -math.inf
    assert answer.stopped is StopReason.FINISHED


def test_what_it_is_asked(fake: Path, tmp_path: Path) -> None:
    program(fake, SOLVES + f"\nopen({str(tmp_path / 'seen')!r}, 'w').write(__import__('json').dumps(parameters))")
    answer = solve(strokes(2), "lkh", StopRule(seconds=20, iterations=3), seed=7)
    seen = json.loads((tmp_path / "seen").read_text())
    assert (seen["RUNS"], seen["SEED"], seen["TRACE_LEVEL"]) == ("3", "8", "0")
    assert 0 < float(seen["TIME_LIMIT"]) < 20
    assert answer.iterations == 3


def test_cancel_and_time_kill_it_and_keep_its_tour(fake: Path) -> None:
    program(fake, HANGS)
    problem = strokes(3)
    best = solve(problem, "brute").cost
    asked = 0

    def cancelled() -> bool:
        nonlocal asked
        asked += 1
        return asked > 60

    for rule, reason in (
        (StopRule(cancelled=cancelled), StopReason.CANCELLED),
        (StopRule(seconds=2.0), StopReason.TIME),
    ):
        answer = solve(problem, "lkh", rule)
        assert answer.stopped is reason
        assert answer.seconds < 60
        assert answer.cost == pytest.approx(best, rel=1e-4) or answer.status is Status.UNKNOWN
    at_once = solve(problem, "lkh", StopRule(cancelled=lambda: True))
    assert at_once.stopped is StopReason.CANCELLED


@pytest.mark.parametrize(
    ("body", "words"),
    [
        ("print('*** Error ***'); sys.exit(1)", r"exit code 1: \*\*\* Error \*\*\*"),
        ("pass", "wrote no tour"),
        ("write((0, 0, 1))", "cannot be used"),
        ("write((0, 1, 3, 2, 4, 5, 6))", "is no solution"),
        ("open(parameters['TOUR_FILE'], 'w').write('nonsense')", "TOUR_SECTION is missing"),
    ],
)
def test_its_failures_are_results(fake: Path, body: str, words: str) -> None:
    program(fake, body)
    answer = solve(strokes(3), "lkh")
    assert len(answer.nodes) == 0
    assert answer.status is Status.UNKNOWN
    assert re.search(words, answer.message), answer.message


def test_a_broken_program_is_a_result(fake: Path) -> None:
    fake.write_text("#!/does/not/exist\n")
    fake.chmod(0o755)
    answer = solve(strokes(3), "lkh")
    assert (answer.stopped, answer.status) == (StopReason.FAILED, Status.UNKNOWN)
    assert "cannot be started" in answer.message


def test_what_it_does_not_know_is_refused(fake: Path) -> None:
    program(fake, SOLVES)
    problem = random_problem("euclid", 5, 3, precedence=True, start=False, end=False)
    with pytest.raises(SolverError, match="single traversal"):
        solve(problem, "lkh")
