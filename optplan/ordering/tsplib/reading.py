"""Reading library files: one clear error with its place for whatever is malformed."""

from __future__ import annotations

from dataclasses import dataclass, field
from pathlib import Path

import numpy as np

from optplan.domain.arrays import FloatArray, IntArray
from optplan.domain.errors import InputError, LimitError, located
from optplan.domain.ordering import MatrixCosts, OrderingProblem
from optplan.ordering.tsplib.distances import DISTANCES
from optplan.ordering.tsplib.instance import Instance
from optplan.schema.files import read_text

SUFFIXES = (".tsp", ".atsp", ".sop", ".gtsp", ".pcgtsp", ".pcglns")
"""Of the files that are read."""
MAX_NODES = 5000
"""Costs are written out: 200 MB."""
FORBIDDEN = -1.0
"""In a matrix with precedence: the column's node comes before the row's."""


@dataclass
class Sections:
    """A file taken apart: keywords with their values, sections with their numbers and the line each begins at."""

    header: dict[str, str] = field(default_factory=dict)
    numbers: dict[str, list[str]] = field(default_factory=dict)
    line: dict[str, int] = field(default_factory=dict)

    def whole(self, key: str) -> int:
        """A keyword's value, a positive whole number."""
        text = self.header.get(key, "")
        if not text.isdecimal() or int(text) < 1:
            raise InputError(f"{key} is {text or 'missing'!r}; expected a whole number of at least 1")
        return int(text)

    def floats(self, section: str) -> FloatArray:
        """The numbers of a section."""
        try:
            values = np.array(self.numbers[section], dtype=np.float64)
        except ValueError:
            bad = next(token for token in self.numbers[section] if not _is_number(token))
            raise InputError(f"{bad!r:.40} is no number", self._place(section)) from None
        if (wrong := np.isnan(values) | np.isneginf(values)).any():
            name = "NaN" if np.isnan(values[wrong][0]) else "minus infinity"
            raise InputError(f"holds {name}; expected numbers", self._place(section))
        return values

    def whole_rows(self, section: str) -> list[list[int]]:
        """Lists of whole numbers, each ended by -1."""
        values = self.floats(section)
        if len(values) and values[-1] != -1:
            raise InputError("the last list is not ended by -1", self._place(section))
        if (values != np.round(values)).any():
            raise InputError("holds fractions; expected whole numbers", self._place(section))
        rows: list[list[int]] = [[]]
        for value in values.astype(np.int64).tolist():
            if value == -1:
                rows.append([])
            else:
                rows[-1].append(value)
        return rows[:-1]

    def _place(self, section: str) -> str:
        return f"{section} (line {self.line[section]})"


def read_tsplib(file: str | Path) -> Instance:
    """Read an instance of any of the classes; TSP, ATSP and GTSP ask for closed tours, SOP for a path.

    Parameters
    ----------
    file : .tsp, .atsp, .sop (also as SOPLIB writes them), .gtsp or .pcglns/.pcgtsp

    Raises
    ------
    InputError : the file is malformed; says where
    LimitError : it has more nodes than fit
    """
    path = Path(file)
    text = read_text(path)
    with located(str(path)):
        first = text.split("\n", 1)[0].split()
        if len(first) == 1 and first[0].isdecimal():
            return _bare_matrix(text, path.stem)
        if first and first[0] in ("N:", "N") and "M:" in text:
            return _short_generalised(text, path.stem)
        return _instance(_sections(text), path.stem, path.suffix.lower())


def _instance(parts: Sections, name: str, suffix: str) -> Instance:
    """What the sections of a file ask for."""
    kind = (parts.header.get("TYPE", "").split() or [""])[0].upper() or suffix[1:].upper()
    kind = {"PCGLNS": "PCGTSP", "AGTSP": "GTSP"}.get(kind, kind)
    if kind not in ("TSP", "ATSP", "SOP", "GTSP", "PCGTSP"):
        raise InputError(f"TYPE is {kind!r}; expected TSP, ATSP, SOP, GTSP or PCGTSP")
    matrix = _matrix(parts)
    if kind == "SOP":
        return _sequential(name, matrix)
    if kind in ("TSP", "ATSP"):
        problem = OrderingProblem(np.arange(len(matrix)), MatrixCosts(matrix), closed=True)
        return Instance(name, kind, problem, np.arange(1, len(matrix) + 1))
    return _generalised(name, kind, matrix, parts)


def _sequential(name: str, matrix: FloatArray) -> Instance:
    """A sequential ordering problem: from the first node to the last, -1 says that the column comes before the row."""
    count = len(matrix)
    if count < 2:
        raise InputError(f"a sequential ordering problem has {count} nodes; expected 2 or more")
    later, earlier = np.nonzero(matrix == FORBIDDEN)
    pairs = np.column_stack([earlier, later])
    start, end = np.full(count, np.inf), np.full(count, np.inf)
    start[0], end[-1] = 0.0, 0.0
    # the ends are fixed: what precedence says of them adds nothing, but a contradiction must be found
    if (pairs[:, 1] == 0).any() or (pairs[:, 0] == count - 1).any():
        raise InputError("precedence asks for a node before the first or behind the last")
    pairs = pairs[(pairs[:, 0] != 0) & (pairs[:, 1] != count - 1)]
    costs = MatrixCosts(np.where(matrix == FORBIDDEN, np.inf, matrix))
    problem = OrderingProblem(np.arange(count), costs, start, end, precedence=pairs)
    return Instance(name, "SOP", problem, np.arange(1, count + 1))


def _generalised(name: str, kind: str, matrix: FloatArray, parts: Sections) -> Instance:
    """One node of every set; with precedence between sets, the tour begins with the start group."""
    count = len(matrix)
    sets = parts.whole("GTSP_SETS") if "GTSP_SETS" in parts.header else None
    if "GTSP_SET_SECTION" not in parts.numbers:
        raise InputError("GTSP_SET_SECTION is missing; expected the sets of nodes")
    rows = parts.whole_rows("GTSP_SET_SECTION")
    groups: dict[int, list[int]] = {}
    for row in rows:
        if len(row) < 2 or row[0] in groups:
            raise InputError(f"GTSP_SET_SECTION: set {row[:1]} is empty or comes twice; expected its number and nodes")
        groups[row[0]] = row[1:]
    if sorted(groups) != list(range(1, (sets or len(groups)) + 1)):
        raise InputError(f"GTSP_SET_SECTION has {len(groups)} sets; expected numbers 1..{sets or len(groups)}")
    order = _one_set_each([groups[k] for k in sorted(groups)], count)
    cluster = np.repeat(np.arange(len(groups)), [len(groups[k]) for k in sorted(groups)])
    matrix = matrix[np.ix_(order, order)]
    pairs = np.zeros((0, 2), dtype=np.int64)
    start = np.zeros(0)
    if kind == "PCGTSP":
        pairs, start = _set_order(parts, cluster, len(groups))
        matrix = np.where(matrix == FORBIDDEN, np.inf, matrix)
    problem = OrderingProblem(cluster, MatrixCosts(matrix), start, precedence=pairs, closed=True)
    return Instance(name, kind, problem, order + 1)


def _one_set_each(groups: list[list[int]], count: int) -> IntArray:
    """(n,) nodes from 0, set by set; every node is in one set."""
    order = np.array([node for group in groups for node in group], dtype=np.int64) - 1
    seen = np.bincount(order[(order >= 0) & (order < count)], minlength=count)
    if len(order) != count or (seen != 1).any():
        bad = int(np.flatnonzero(seen != 1)[0]) + 1 if (seen != 1).any() else int(order.max()) + 1
        raise InputError(f"GTSP_SET_SECTION: node {bad} is not in just one set; expected each of 1..{count} in one")
    return order


def _set_order(parts: Sections, cluster: IntArray, sets: int) -> tuple[IntArray, FloatArray]:
    """Precedence (k, 2) between sets, and the start costs that make the tour begin with the start group."""
    rows = parts.whole_rows("GTSP_SET_ORDERING") if parts.numbers.get("GTSP_SET_ORDERING") else []
    pairs = np.array([(row[0] - 1, other - 1) for row in rows for other in row[1:]], dtype=np.int64).reshape(-1, 2)
    if len(pairs) and not ((pairs >= 0) & (pairs < sets)).all():
        raise InputError(f"GTSP_SET_ORDERING names a set beyond 1..{sets}")
    group = 1
    if parts.numbers.get("START_GROUP_SECTION"):
        values = parts.floats("START_GROUP_SECTION")
        group = int(values[0])
        if not 1 <= values[0] <= sets or group != values[0]:
            raise InputError(f"START_GROUP_SECTION is {values[0]:g}; expected a set 1..{sets}")
    pairs = pairs[pairs[:, 0] != group - 1]
    if (pairs[:, 1] == group - 1).any():
        raise InputError(f"GTSP_SET_ORDERING asks for a set before the start group {group}")
    return pairs, np.where(cluster == group - 1, 0.0, np.inf)


def _matrix(parts: Sections) -> FloatArray:
    """The costs (n, n) that a file gives or says how to compute."""
    count = _allowed(parts.whole("DIMENSION"))
    kind = parts.header.get("EDGE_WEIGHT_TYPE", "").upper()
    if kind == "EXPLICIT":
        if "EDGE_WEIGHT_SECTION" not in parts.numbers:
            raise InputError("EDGE_WEIGHT_SECTION is missing; expected the costs")
        values = parts.floats("EDGE_WEIGHT_SECTION")
        shape = parts.header.get("EDGE_WEIGHT_FORMAT", "").upper()
        if shape == "FULL_MATRIX" and len(values) == count**2 + 1 and values[0] == count:
            values = values[1:]  # sequential ordering files repeat the dimension
        return _arranged(values, shape, count)
    if kind not in DISTANCES:
        raise InputError(f"EDGE_WEIGHT_TYPE is {kind!r}; expected EXPLICIT or one of {', '.join(DISTANCES)}")
    if "NODE_COORD_SECTION" not in parts.numbers:
        raise InputError("NODE_COORD_SECTION is missing; expected the coordinates")
    size, distance = DISTANCES[kind]
    values = parts.floats("NODE_COORD_SECTION")
    if len(values) != count * (size + 1):
        raise InputError(f"NODE_COORD_SECTION has {len(values)} numbers; expected {count} lines of {size + 1}")
    rows = values.reshape(count, size + 1)
    if not np.array_equal(np.sort(rows[:, 0]), np.arange(1, count + 1)):
        raise InputError(f"NODE_COORD_SECTION does not number its nodes 1..{count}")
    if not (np.abs(rows) < 1e12).all():
        raise InputError("NODE_COORD_SECTION holds coordinates beyond 1e12")
    return distance(rows[np.argsort(rows[:, 0]), 1:])


def _arranged(values: FloatArray, shape: str, count: int) -> FloatArray:
    """A matrix from its numbers in one of the format's arrangements."""
    if shape == "FULL_MATRIX":
        if len(values) != count**2:
            raise InputError(f"EDGE_WEIGHT_SECTION has {len(values)} numbers; expected {count} x {count}")
        return values.reshape(count, count)
    # the columns of one triangle are the rows of the other
    upper = shape in ("UPPER_ROW", "UPPER_DIAG_ROW", "LOWER_COL", "LOWER_DIAG_COL")
    if not upper and shape not in ("LOWER_ROW", "LOWER_DIAG_ROW", "UPPER_COL", "UPPER_DIAG_COL"):
        raise InputError(f"EDGE_WEIGHT_FORMAT is {shape!r}; expected FULL_MATRIX or a triangle such as UPPER_ROW")
    apart = 0 if "DIAG" in shape else 1
    places = np.triu_indices(count, apart) if upper else np.tril_indices(count, -apart)
    if len(values) != len(places[0]):
        raise InputError(f"EDGE_WEIGHT_SECTION has {len(values)} numbers; expected {len(places[0])} for {shape}")
    matrix = np.zeros((count, count))
    matrix[places] = values
    matrix.T[places] = values
    return matrix


def _bare_matrix(text: str, stem: str) -> Instance:
    """A SOPLIB file: the number of nodes, then the matrix."""
    tokens = text.split()
    count = _allowed(int(tokens[0]))
    parts = Sections(numbers={"the matrix": [t for t in tokens[1:] if t != "EOF"]}, line={"the matrix": 2})
    values = parts.floats("the matrix")
    if len(values) != count**2:
        raise InputError(f"has {len(values)} numbers behind the first line; expected {count} x {count}")
    return _sequential(stem, values.reshape(count, count))


def _short_generalised(text: str, stem: str) -> Instance:
    """The short form of a generalised file: N: nodes, M: sets, a line a set, then the matrix.

    A set's line begins with its size in some files, with its number in others.
    """
    lines = text.split("\n")
    header = {line.split(":")[0].strip(): line.split(":")[1].strip() for line in lines[:2] if ":" in line}
    parts = Sections({"DIMENSION": header.get("N", ""), "GTSP_SETS": header.get("M", "")})
    count, sets = _allowed(parts.whole("DIMENSION")), parts.whole("GTSP_SETS")
    body = [line.split() for line in lines[2:] if line.split()]
    rows, weights = body[:sets], [token for line in body[sets:] for token in line]
    for k, row in enumerate(rows, start=1):
        if len(row) < 2 or not all(token.isdecimal() for token in row):
            raise InputError(f"line {k + 2}: expected the size or number of set {k}, then its nodes")
    sized = all(len(row) == int(row[0]) + 1 for row in rows)
    if not sized and [int(row[0]) for row in rows] != list(range(1, sets + 1)):
        raise InputError(f"lines 3 to {sets + 2} begin neither with the sizes of the sets nor with their numbers")
    listed = [token for k, row in enumerate(rows, start=1) for token in (str(k), *row[1:], "-1")]
    parts.numbers = {"GTSP_SET_SECTION": listed, "EDGE_WEIGHT_SECTION": weights}
    parts.line = {"GTSP_SET_SECTION": 3, "EDGE_WEIGHT_SECTION": 3 + sets}
    matrix = _arranged(parts.floats("EDGE_WEIGHT_SECTION"), "FULL_MATRIX", count)
    return _generalised(stem, "GTSP", matrix, parts)


def _sections(text: str) -> Sections:
    """Keywords and sections of a file."""
    parts = Sections()
    current = ""
    for number, line in enumerate(text.split("\n"), start=1):
        stripped = line.strip()
        head = stripped.split(":", 1)[0].strip().upper()
        if not stripped:
            continue
        if stripped.upper() == "EOF":
            break
        if head[:1].isalpha() and not _is_number(stripped.split()[0]):
            current = ""
            if ":" in stripped:
                parts.header[head] = stripped.split(":", 1)[1].strip()
                current = head if head.endswith("_SECTION") else ""
            elif head.replace("_", "").isalpha():
                current = head
            else:
                raise InputError(f"{stripped!r:.60} is neither a keyword nor a number", f"line {number}")
            if current:
                parts.numbers[current], parts.line[current] = [], number
        elif current:
            parts.numbers[current] += stripped.split()
        else:
            raise InputError(f"{stripped!r:.60} belongs to no section", f"line {number}")
    return parts


def _allowed(count: int) -> int:
    if count > MAX_NODES:
        raise LimitError(f"has {count} nodes; at most {MAX_NODES} are read")
    return count


def _is_number(token: str) -> bool:
    try:
        float(token)
    except ValueError:
        return False
    return True
