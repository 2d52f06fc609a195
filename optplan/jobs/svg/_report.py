"""The load report while it is being written: equal remarks are one line with a count."""

from __future__ import annotations

from typing import Literal

from lxml import etree

from optplan.domain.job import Note

Kind = Literal["ignored", "changed", "notice"]
PLACES = 5
"""places named in one line; the others are only counted"""


def local_name(element: etree._Element) -> str:
    """The tag without its namespace."""
    return str(element.tag).rpartition("}")[2]


def place_of(element: etree._Element, id: str | None = None) -> str:
    """Where an element stands: "path#mane (line 12)"."""
    name = id or element.get("id")
    mark = f"#{name}" if name else ""
    return f"{local_name(element)}{mark} (line {element.sourceline})"


class Report:
    """Collects remarks; `notes()` groups them by what they say, in the order in which they came up."""

    def __init__(self) -> None:
        self._lines: dict[tuple[Kind, str], tuple[list[str], int]] = {}

    def add(self, kind: Kind, text: str, place: str = "", times: int = 1) -> None:
        """Remark `text` about `place`, `times` times."""
        places, count = self._lines.setdefault((kind, text), ([], 0))
        if place and len(places) < PLACES and place not in places:
            places.append(place)
        self._lines[kind, text] = (places, count + times)

    def notes(self) -> tuple[Note, ...]:
        """The report's lines."""
        return tuple(
            Note(kind, ", ".join(places) + (", ..." if places and count > len(places) else ""), text, count)
            for (kind, text), (places, count) in self._lines.items()
        )
