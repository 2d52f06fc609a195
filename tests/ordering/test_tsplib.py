"""Library files: read, written, and refused when malformed."""

from __future__ import annotations

import csv
import math
from pathlib import Path

import numpy as np
import pytest

from optplan.domain.errors import InputError
from optplan.domain.ordering import EuclidCosts, MatrixCosts, OrderingProblem
from optplan.ordering import solve
from optplan.ordering.tsplib import instance_of, read_tour, read_tsplib, write_tour, write_tsplib
from optplan.ordering.tsplib.distances import DISTANCES
from tests.ordering_cases import Case, cases, optimum

LIBRARY = Path(__file__).parents[3] / "shared" / "data" / "ordering"
WRITABLE = [
    c
    for c in cases()
    if not len(c.problem.enforced)
    and c.problem.clusters <= 6
    and not (c.problem.closed and (c.problem.end_costs.any() or len(c.problem.precedence)))
]


def _file(folder: Path, text: str, name: str = "test.tsp") -> Path:
    file = folder / name
    file.write_text(text)
    return file


@pytest.mark.parametrize("case", WRITABLE, ids=lambda c: c.name)
def test_what_is_written_is_read_with_the_same_optimum(tmp_path: Path, case: Case) -> None:
    problem = case.problem
    if problem.closed and problem.start_costs.any():
        with pytest.raises(InputError, match="closed path"):
            instance_of(problem)
        return
    written = instance_of(problem, "case")
    write_tsplib(tmp_path / "case.txt", written)
    scale = float((tmp_path / "case.txt").read_text().split("costs x ")[1].split(";")[0])
    again = read_tsplib(tmp_path / "case.txt")
    assert again.kind == written.kind
    assert again.dimension == written.dimension
    answer = solve(again.problem, "brute")
    if math.isinf(case.optimum):
        assert answer.cost >= 2**20
        return
    # every weight is rounded by at most half
    assert answer.cost / scale == pytest.approx(case.optimum, abs=(problem.clusters + 2) / scale)
    nodes = written.path(again.tour(answer.nodes))
    assert problem.cost_of(nodes) == pytest.approx(case.optimum, rel=1e-4, abs=1e-4)


def test_whole_numbers_are_kept_as_they_are(tmp_path: Path) -> None:
    problem = OrderingProblem(np.arange(3), MatrixCosts(np.array([[0, 7, 2], [3, 0, 4], [5, 1, 0.0]])), closed=True)
    write_tsplib(tmp_path / "a.atsp", instance_of(problem))
    assert np.array_equal(_costs(read_tsplib(tmp_path / "a.atsp").problem), _costs(problem))


def test_ties_and_large_numbers_survive_the_scale(tmp_path: Path) -> None:
    rng = np.random.default_rng(0)
    points = rng.uniform(0, 1e7, (50, 2))
    problem = OrderingProblem(np.arange(50), EuclidCosts(points, points), closed=True)
    write_tsplib(tmp_path / "a.atsp", instance_of(problem))
    weights = _costs(read_tsplib(tmp_path / "a.atsp").problem)
    assert weights.max() * 52 < 2**31
    assert weights.max() > 2**21  # as fine as 32 bits allow
    with pytest.raises(InputError, match="expected at most"):
        write_tsplib(tmp_path / "b.atsp", instance_of(problem), scale=1e6)


def _costs(problem: OrderingProblem) -> np.ndarray[tuple[int, int], np.dtype[np.float64]]:
    assert isinstance(problem.costs, MatrixCosts)
    return problem.costs.matrix


@pytest.mark.parametrize(
    ("shape", "numbers"),
    [
        ("FULL_MATRIX", "0 1 2 1 0 3 2 3 0"),
        ("UPPER_ROW", "1 2 3"),
        ("LOWER_ROW", "1 2 3"),
        ("UPPER_DIAG_ROW", "0 1 2 0 3 0"),
        ("LOWER_DIAG_ROW", "0 1 0 2 3 0"),
        ("UPPER_COL", "1 2 3"),
        ("LOWER_COL", "1 2 3"),
        ("UPPER_DIAG_COL", "0 1 0 2 3 0"),
        ("LOWER_DIAG_COL", "0 1 2 0 3 0"),
    ],
)
def test_arrangements_of_a_matrix(tmp_path: Path, shape: str, numbers: str) -> None:
    text = f"TYPE: TSP\nDIMENSION: 3\nEDGE_WEIGHT_TYPE: EXPLICIT\nEDGE_WEIGHT_FORMAT: {shape}\n"
    problem = read_tsplib(_file(tmp_path, f"{text}EDGE_WEIGHT_SECTION\n{numbers}\nEOF\n")).problem
    assert _costs(problem).tolist() == [[0, 1, 2], [1, 0, 3], [2, 3, 0]]


@pytest.mark.parametrize(
    ("kind", "points", "distance"),
    [
        ("EUC_2D", [[0, 0], [1, 1.2]], 2),
        ("CEIL_2D", [[0, 0], [1, 0.2]], 2),
        ("MAN_2D", [[0, 0], [1.2, 1.2]], 2),
        ("MAX_2D", [[0, 0], [1.2, 2.6]], 3),
        ("ATT", [[0, 0], [10, 0]], 4),
        ("EUC_3D", [[0, 0, 0], [2, 3, 6]], 7),
        # one degree along a meridian of the format's earth
        ("GEO", [[10.0, 0.0], [11.0, 0.0]], int(6378.388 * 3.141592 / 180 + 1.0)),
    ],
)
def test_distance_functions(kind: str, points: list[list[float]], distance: int) -> None:
    assert DISTANCES[kind][1](np.array(points))[0, 1] == distance


def test_sequential_ordering(tmp_path: Path) -> None:
    text = "4\n0 1 2 9\n-1 0 5 1\n-1 -1 0 4\n-1 -1 -1 0\n"
    problem = read_tsplib(_file(tmp_path, text, "small.sop")).problem
    assert optimum(problem) == 1 + 5 + 4
    assert problem.precedence.tolist() == [[1, 2]]


def test_both_short_forms_of_sets(tmp_path: Path) -> None:
    matrix = "0 1 2 3\n1 0 4 5\n2 4 0 6\n3 5 6 0\n"
    by_number = read_tsplib(_file(tmp_path, f"N: 4\nM: 2\n1 1 3\n2 2 4\n{matrix}", "a.gtsp"))
    by_size = read_tsplib(_file(tmp_path, f"N: 4\nM: 2\n3 1 2 3\n1 4\n{matrix}", "b.gtsp"))
    assert by_number.numbers.tolist() == [1, 3, 2, 4]
    assert by_number.problem.cluster.tolist() == [0, 0, 1, 1]
    assert by_size.problem.cluster.tolist() == [0, 0, 0, 1]


ORDERED = "GTSP_SET_SECTION\n1 1 -1\n2 2 3 -1\nGTSP_SET_ORDERING\n2 5 -1\n"
GOOD = "NAME: a\nTYPE: GTSP\nDIMENSION: 3\nGTSP_SETS: 2\nEDGE_WEIGHT_TYPE: EXPLICIT\nEDGE_WEIGHT_FORMAT: FULL_MATRIX\n"
ROWS = "EDGE_WEIGHT_SECTION\n0 1 2\n1 0 3\n2 3 0\n"


@pytest.mark.parametrize(
    ("text", "words"),
    [
        ("", "TYPE"),
        ("TYPE: CVRP\nDIMENSION: 2\n", "TYPE is 'CVRP'"),
        ("TYPE: TSP\nDIMENSION: x\n", "DIMENSION is 'x'"),
        ("TYPE: TSP\nDIMENSION: 999999999\nEDGE_WEIGHT_TYPE: EUC_2D\n", "at most"),
        ("TYPE: TSP\nDIMENSION: 2\nEDGE_WEIGHT_TYPE: XRAY1\n", "EDGE_WEIGHT_TYPE is 'XRAY1'"),
        ("TYPE: TSP\nDIMENSION: 2\nEDGE_WEIGHT_TYPE: EUC_2D\n", "NODE_COORD_SECTION is missing"),
        ("TYPE: TSP\nDIMENSION: 2\nEDGE_WEIGHT_TYPE: EUC_2D\nNODE_COORD_SECTION\n1 0 0\n", "expected 2 lines of 3"),
        ("TYPE: TSP\nDIMENSION: 2\nEDGE_WEIGHT_TYPE: EUC_2D\nNODE_COORD_SECTION\n1 0 0\n1 0 0\n", "number its nodes"),
        ("TYPE: TSP\nDIMENSION: 2\nEDGE_WEIGHT_TYPE: EUC_2D\nNODE_COORD_SECTION\n1 0 0\n2 0 x\n", "'x' is no number"),
        ("TYPE: TSP\n%%%\n", "line 2"),
        ("TYPE: TSP\n1 2 3\n", "belongs to no section"),
        (GOOD, "EDGE_WEIGHT_SECTION is missing"),
        (GOOD + "EDGE_WEIGHT_SECTION\n0 1 2\n", "has 3 numbers; expected 3 x 3"),
        (GOOD + "EDGE_WEIGHT_SECTION\n0 1 nan 1 0 3 2 3 0\n", "NaN"),
        (GOOD + "EDGE_WEIGHT_SECTION\n0 1 -inf 1 0 3 2 3 0\n", "minus infinity"),
        (GOOD + ROWS, "GTSP_SET_SECTION is missing"),
        (GOOD + ROWS + "GTSP_SET_SECTION\n1 1 2 -1\n2 2 3 -1\n", "node 2 is not in just one set"),
        (GOOD + ROWS + "GTSP_SET_SECTION\n1 1 2 -1\n2 4 -1\n", "not in just one set"),
        (GOOD + ROWS + "GTSP_SET_SECTION\n1 1 2 -1\n2 3\n", "not ended by -1"),
        (GOOD + ROWS + "GTSP_SET_SECTION\n1 1 2 3 -1\n", "has 1 sets; expected numbers 1..2"),
        (GOOD.replace("GTSP\n", "PCGTSP\n", 1) + ROWS + ORDERED, "beyond"),
        ("2\n0 1\n1 0 7\n", "expected 2 x 2"),
        ("3\n0 1 -1\n-1 0 -1\n-1 -1 0\n", "behind the last"),
        ("4\n0 1 1 1\n-1 0 -1 1\n-1 -1 0 1\n-1 -1 -1 0\n", "cycle: 1 before 2 before 1"),
    ],
)  # fmt: skip
def test_malformed_files_are_refused_with_their_place(tmp_path: Path, text: str, words: str) -> None:
    file = _file(tmp_path, text, "broken.txt")
    with pytest.raises(InputError, match=words) as caught:
        read_tsplib(file)
    assert str(file) in str(caught.value)


def test_tours(tmp_path: Path) -> None:
    file = tmp_path / "a.tour"
    write_tour(file, [3, 1, 2], "a", 12.5)
    assert read_tour(file) == [3, 1, 2]
    with pytest.raises(InputError, match="exists"):
        write_tour(file, [1], "a")
    problem = OrderingProblem(np.arange(3), MatrixCosts(np.ones((3, 3))))
    instance = instance_of(problem)
    assert instance.tour(np.array([2, 0, 1])) == [1, 4, 2, 3]
    assert instance.path([4, 2, 1, 3]).tolist() == [1, 2, 0]
    for wrong in ([1, 2, 3], [1, 2, 3, 3], [2, 3, 4], [1, 2, 3, 9]):
        with pytest.raises(InputError, match="tour"):
            instance.path(wrong)
    with pytest.raises(InputError, match="no node"):
        read_tour(_file(tmp_path, "TOUR_SECTION\n1\nx\n-1\n"))
    with pytest.raises(InputError, match="TOUR_SECTION is missing"):
        read_tour(_file(tmp_path, "1 2 3"))


@pytest.mark.skipif(not LIBRARY.is_dir(), reason="the public libraries are not at hand")
def test_small_library_instances_have_their_known_optimum() -> None:
    with (LIBRARY / "best_known.csv").open() as stream:
        known = {(row["class"], row["instance"]): float(row["best_known"]) for row in csv.DictReader(stream)}
    for kind, name, suffix in (("sop", "ESC07", "sop"), ("gtsp", "4br17", "gtsp"), ("gtsp", "10ry48p", "gtsp")):
        problem = read_tsplib(LIBRARY / kind / f"{name}.{suffix}").problem
        assert solve(problem, "brute").cost == known[kind, name]
    assert solve(read_tsplib(LIBRARY / "gtsp" / "11berlin52.gtsp").problem, "brute").cost == known["gtsp", "11berlin52"]
    assert solve(read_tsplib(LIBRARY / "pcgtsp" / "ESC07.pcglns").problem, "brute").cost == known["pcgtsp", "ESC07"]
