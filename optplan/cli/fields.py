"""Fields by their rules: `optplan field`."""

from __future__ import annotations

from pathlib import Path
from typing import Annotated, Any

import typer

from optplan.cli import output
from optplan.domain.errors import InputError, located


def field_command(
    name: Annotated[str | None, typer.Argument(help="A template; without it, all are listed.")] = None,
    out: Annotated[Path | None, typer.Option("--output", "-o", help="File; default: NAME.json.")] = None,
    measure: Annotated[
        list[str] | None, typer.Option("--set", help="A measure: 'length=100m', 'rules=nfl'. Repeatable.")
    ] = None,
    at: Annotated[str | None, typer.Option(help="Where its origin goes: X,Y.")] = None,
    rotate: Annotated[str | None, typer.Option(help="Turn it, degrees counter-clockwise.")] = None,
    scale: Annotated[float | None, typer.Option(help="Scale it.")] = None,
    mirror: Annotated[bool, typer.Option("--mirror", help="Mirror it.")] = False,
    align: Annotated[
        str | None, typer.Option(help="Two of its points and where they were measured: 'X,Y X,Y = X,Y X,Y'.")
    ] = None,
    anchor: Annotated[str | None, typer.Option(help="On earth: LATITUDE,LONGITUDE or with BEARING, degrees.")] = None,
    start: Annotated[str | None, typer.Option(help="Where the robot stands: X,Y.")] = None,
    logo: Annotated[
        list[str] | None, typer.Option(help="Put the outlines of a drawing on it: 'FILE.svg,X,Y,WIDTH[,DEGREES]'.")
    ] = None,
    obstacle_map: Annotated[
        Path | None,
        typer.Option("--map", help="Occupancy map (.yaml with its image) of what to keep out of."),
    ] = None,
    force: Annotated[bool, typer.Option("--force", "-f", help="Replace files that exist.")] = False,
    json: Annotated[bool, typer.Option("--json", help="Print JSON for machines.")] = False,
) -> None:
    """Write a sports field by its published rules as a job."""
    from dataclasses import replace

    from optplan.domain.units import angle
    from optplan.jobs.fields import TEMPLATES, placing, template
    from optplan.schema.jobs import save_job

    if name is None:
        known = TEMPLATES.values()
        if json:
            output.print_json([{"name": t.name, "summary": t.summary, "measures": t.parameters} for t in known])
        else:
            rows = [(t.name, t.summary, ", ".join(f"{k}={_shown(v)}" for k, v in t.parameters.items())) for t in known]
            output.print_table(("field", "", "measures (--set), metres"), rows)
        return
    measures: dict[str, str] = {}
    for text in measure or ():
        key, equals, value = text.partition("=")
        if not (equals and key.strip() and value.strip()):
            raise InputError(f"{text!r} is no measure; expected NAME=VALUE", "--set")
        measures[key.strip()] = value.strip()
    field = template(name, **measures)
    if logo:
        from optplan.jobs.fields.drawn import with_logo

        for text in logo:
            field = with_logo(field, *_logo(text))
    if align is not None:
        own, equals, measured = align.partition("=")
        pairs = [[_place(part, "--align") for part in side.split()] for side in (own, measured)]
        if not equals or any(len(pair) != 2 for pair in pairs):
            raise InputError(f"{align!r} is no alignment; expected 'X,Y X,Y = X,Y X,Y'", "--align")
        field = placing.aligned(field, *((pair[0], pair[1]) for pair in pairs))
    if at is not None or rotate is not None or scale is not None or mirror:
        with located("--rotate"):
            turn = angle(rotate) if rotate is not None else 0.0
        field = placing.placed(
            field,
            (0.0, 0.0) if at is None else _place(at, "--at"),
            turn,
            1.0 if scale is None else scale,
            mirror,
        )
    if anchor is not None:
        numbers = _numbers(anchor, "--anchor", (2, 3))
        field = placing.anchored(field, *numbers)
    if start is not None:
        field = replace(field, start=_place(start, "--start"))
    if obstacle_map is not None:
        from optplan.jobs.fields.maps import obstacles

        field = replace(field, keep_out=(*field.keep_out, *obstacles(obstacle_map)))
    target = out or Path(f"{name}.json")
    save_job(field, target, overwrite=force)
    metres = sum(segment.length for segment in field.segments)
    facts: dict[str, Any] = {"name": field.name, "segments": len(field.segments), "metres": metres, "file": str(target)}
    facts["notes"] = [{"kind": note.kind, "place": note.place, "text": note.text} for note in field.notes]
    if json:
        output.print_json(facts)
    else:
        output.print_job_notes(field.name, field.notes)
        print(f"{field.name}: {len(field.segments)} segments, {metres:.1f} m of lines; written: {target}")


def _shown(value: float | str | bool) -> str:
    if isinstance(value, bool):
        return "yes" if value else "no"
    return value if isinstance(value, str) else f"{value:.4g}"


def _numbers(text: str, flag: str, counts: tuple[int, ...]) -> list[float]:
    try:
        numbers = [float(part) for part in text.split(",")]
    except ValueError:
        numbers = []
    if len(numbers) not in counts:
        raise InputError(f"{text!r}: expected {' or '.join(map(str, counts))} numbers with commas between", flag)
    return numbers


def _place(text: str, flag: str) -> tuple[float, float]:
    from optplan.domain.units import length

    parts = text.split(",")
    if len(parts) != 2:
        raise InputError(f"{text!r} is no place; expected X,Y", flag)
    with located(flag):
        return length(parts[0]), length(parts[1])


def _logo(text: str) -> tuple[Path, tuple[float, float], float, float]:
    from optplan.domain.units import angle, length

    parts = text.split(",")
    if len(parts) not in (4, 5):
        raise InputError(f"{text!r} is no logo; expected FILE.svg,X,Y,WIDTH[,DEGREES]", "--logo")
    with located("--logo"):
        turn = angle(parts[4]) if len(parts) == 5 else 0.0
        return Path(parts[0]), (length(parts[1]), length(parts[2])), length(parts[3]), turn
