"""Facades as JSON."""

from __future__ import annotations

from typing import Literal

import numpy as np
from pydantic import Field as Entry

from optplan.domain.arrays import FloatArray
from optplan.domain.errors import InputError
from optplan.domain.facade import Facade, Wall
from optplan.schema.base import VERSION, Length, Model, Point3
from optplan.schema.notes import NoteModel, note_models, notes_from

Place = tuple[Length, Length]


class WallModel(Model):
    """A wall: x along it, y along `up`, in metres; seen from outside x runs to the right."""

    name: str = Entry("wall", min_length=1)
    outline: list[Place] = Entry(min_length=3)
    no_go: list[list[Place]] = Entry(default_factory=list, description="windows, balconies: not to be washed")
    stops: list[Place] | None = Entry(None, description="centres of circles; found when they are not given")
    origin: tuple[Length, Length, Length] = Entry((0.0, 0.0, 0.0), description="where (0, 0) of the wall is")
    across: Point3 = Entry((1.0, 0.0, 0.0), description="unit vector along the wall, to the right from outside")
    up: Point3 = Entry((0.0, 0.0, 1.0), description="unit vector up the wall")
    plan: list[Place] | None = Entry(
        None, description="of a curved wall: polyline from (0, 0), along `across` and away from the building"
    )


class FacadeModel(Model):
    """Walls of a building to wash, in metres: `walls`, or the properties of the only one."""

    version: str = VERSION
    kind: Literal["facade"] = "facade"
    name: str
    walls: list[WallModel] | None = Entry(None, min_length=1)
    outline: list[Place] | None = Entry(None, min_length=3)
    no_go: list[list[Place]] = Entry(default_factory=list)
    stops: list[Place] | None = None
    radius: Length | None = Entry(None, gt=0, description="of a circle; default: what the robot reaches")
    tau: float = 0.75
    width: float = 2.0
    building: list[Place] | None = Entry(None, description="ground plan; default: the walls' own, joined in order")
    ground: Length | None = Entry(None, description="height below which no stop is; default: the walls' lowest corner")
    notes: list[NoteModel] = Entry(default_factory=list)


def facade_from(model: FacadeModel) -> Facade:
    """The facade that a record describes. Raises InputError with the part that is wrong."""
    alone = model.outline is not None
    if alone == (model.walls is not None) or (not alone and (model.no_go or model.stops is not None)):
        raise InputError("expected either walls, or the outline, no_go and stops of the only wall")
    if model.outline is not None:
        walls: tuple[Wall, ...] = (
            Wall("wall", _array(model.outline), tuple(map(_array, model.no_go)), _maybe(model.stops)),
        )
    else:
        walls = tuple(map(_wall_from, model.walls or []))
    return Facade(
        model.name,
        walls,
        model.radius,
        model.tau,
        model.width,
        _maybe(model.building),
        notes_from(model.notes),
        model.ground,
    )


def _wall_from(model: WallModel) -> Wall:
    return Wall(
        model.name,
        _array(model.outline),
        tuple(map(_array, model.no_go)),
        _maybe(model.stops),
        _array(model.origin),
        _array(model.across),
        _array(model.up),
        _maybe(model.plan),
    )


def facade_model(job: Facade) -> FacadeModel:
    """The record that describes a facade."""
    walls = [
        {
            "name": wall.name,
            "outline": wall.outline.tolist(),
            "no_go": [ring.tolist() for ring in wall.no_go],
            "stops": None if wall.stops is None else wall.stops.tolist(),
            "origin": wall.origin.tolist(),
            "across": wall.across.tolist(),
            "up": wall.up.tolist(),
            "plan": None if wall.plan is None else wall.plan.tolist(),
        }
        for wall in job.walls
    ]
    return FacadeModel.model_validate(
        {
            "name": job.name,
            "walls": walls,
            "radius": job.radius,
            "tau": job.tau,
            "width": job.width,
            "building": None if job.building is None else job.building.tolist(),
            "ground": job.ground,
            "notes": note_models(job.notes),
        }
    )


def _array(values: object) -> FloatArray:
    return np.array(values, dtype=np.float64)


def _maybe(values: object | None) -> FloatArray | None:
    return None if values is None else _array(values)
