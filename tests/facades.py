"""Small facades for tests."""

from __future__ import annotations

import math

import numpy as np

import optplan as op
from optplan.domain.facade import Facade, Wall
from optplan.domain.options import Options, OrderOptions
from optplan.domain.result import Plan
from optplan.domain.washing import WashOptions
from tests.strategies import array

WINDOW = array([[1.6, 1.2], [3.2, 1.2], [3.2, 3.2], [1.6, 3.2]])


def flat(width: float = 5.0, height: float = 4.5, windows: bool = True) -> Facade:
    """One flat wall."""
    outline = array([[0, 0], [width, 0], [width, height], [0, height]])
    return Facade("flat", (Wall("wall", outline, (WINDOW,) if windows else ()),))


def leaning() -> Facade:
    """A wall somewhere in space that leans."""
    across, up = array([0.6, 0.8, 0]), array([0.8 * math.sin(0.3), -0.6 * math.sin(0.3), math.cos(0.3)])
    return Facade("leaning", (Wall("wall", flat().walls[0].outline, (WINDOW,), None, array([3, -2, 1]), across, up),))


def round_wall(radius: float = 6.0, sides: int = 12, hollow: bool = False) -> Wall:
    """A quarter of a round tower, seen from outside; hollow: from within."""
    angle = np.linspace(0, math.pi / 2, sides + 1)
    plan = radius * np.column_stack([np.sin(angle), (np.cos(angle) - 1) * (-1 if hollow else 1)])
    length = math.floor(1e6 * float(np.hypot(*np.diff(plan, axis=0).T).sum())) / 1e6
    outline = array([[0, 0], [length, 0], [length, 3], [0, 3]])
    return Wall("round", outline, (array([[3, 1], [4, 1], [4, 2], [3, 2]]),), plan=plan)


def corner() -> Facade:
    """Two walls of a building that meet at a right angle."""
    outline = array([[0, 0], [4, 0], [4, 3], [0, 3]])
    front = Wall("front", outline)
    side = Wall("side", outline, (array([[1, 1], [2, 1], [2, 2], [1, 2]]),), None, array([4, 0, 0]), array([0, 1, 0]))
    return Facade("corner", (front, side), building=array([[0, 0], [4, 0], [4, 4], [0, 4]]))


JOBS = {
    "flat": flat(),
    "leaning": leaning(),
    "round": Facade("tower", (round_wall(),)),
    "hollow": Facade("apse", (round_wall(hollow=True),)),
    "corner": corner(),
}


def planned(job: Facade, metric: str = "auto", seconds: float = 2.0, solver: str = "search", **wash: object) -> Plan:
    """A plan by the boom washer; wash: settings of `WashOptions`."""
    order = OrderOptions(solver, metric, seconds, 300)
    return op.plan(job, "boom-washer", Options(order=order, wash=WashOptions(**{"effort": 3.0, **wash})))  # type: ignore[arg-type]
