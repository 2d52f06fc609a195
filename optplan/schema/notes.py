"""The load report as JSON."""

from __future__ import annotations

from optplan.domain.job import Note
from optplan.schema.base import Model, Whole


class NoteModel(Model):
    """A line of the load report."""

    kind: str
    place: str
    text: str
    times: Whole = 1


def note_models(notes: tuple[Note, ...]) -> list[NoteModel]:
    """Records of a load report."""
    return [NoteModel(kind=n.kind, place=n.place, text=n.text, times=n.times) for n in notes]


def notes_from(models: list[NoteModel]) -> tuple[Note, ...]:
    """The load report that records describe."""
    return tuple(Note(m.kind, m.place, m.text, m.times) for m in models)
