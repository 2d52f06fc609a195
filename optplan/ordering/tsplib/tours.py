"""Tour files."""

from __future__ import annotations

import math
from collections.abc import Sequence
from pathlib import Path

from optplan.domain.errors import InputError, located
from optplan.schema.files import read_text, write_atomically


def read_tour(file: str | Path) -> list[int]:
    """The node numbers of a tour file (.tour, .opt.tour, and what LKH writes); -1 ends it.

    Raises
    ------
    InputError : the file is malformed; says where
    """
    path = Path(file)
    with located(str(path)):
        lines = read_text(path).upper().split("TOUR_SECTION", 1)
        if len(lines) < 2:
            raise InputError("TOUR_SECTION is missing; expected the numbers of the nodes")
        numbers: list[int] = []
        for token in lines[1].split():
            if token in ("-1", "EOF"):
                break
            if not token.isdecimal():
                raise InputError(f"{token!r:.40} in TOUR_SECTION is no node; expected whole numbers, then -1")
            numbers.append(int(token))
        return numbers


def tour_text(tour: Sequence[int], name: str, cost: float = math.inf) -> str:
    """A tour file."""
    comment = f"COMMENT : Length = {cost:.15g}\n" if math.isfinite(cost) else ""
    numbers = "\n".join(map(str, tour))
    return f"NAME : {name}\n{comment}TYPE : TOUR\nDIMENSION : {len(tour)}\nTOUR_SECTION\n{numbers}\n-1\nEOF\n"


def write_tour(
    file: str | Path, tour: Sequence[int], name: str, cost: float = math.inf, *, overwrite: bool = False
) -> None:
    """Write a tour file.

    Raises
    ------
    InputError : the file exists and may not be replaced
    """
    write_atomically(Path(file), tour_text(tour, name, cost), overwrite=overwrite)
