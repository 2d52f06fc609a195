"""A plan and jobs with every field filled in."""

from __future__ import annotations

import math

import numpy as np

from optplan.domain.facade import Wall
from optplan.domain.job import (
    Anchor,
    Curve,
    Drawing,
    Element,
    Facade,
    Field,
    FieldSegment,
    FillRule,
    FillSettings,
    Job,
    Note,
    Surface,
)
from optplan.domain.options import ConnectOptions, CoverOptions, Options, OrderOptions, PageOptions, TimeOptions
from optplan.domain.ordering import Ordering, Status, TracePoint
from optplan.domain.path import Path, Trajectory
from optplan.domain.report import Check, Report, Verdict
from optplan.domain.result import Area, Cover, Plan
from optplan.domain.robot import Canvas
from optplan.domain.stop import StopReason
from optplan.domain.stroke import Stroke, Traversals
from optplan.domain.washing import WashOptions
from tests.strategies import RAKE, array, box

NOTES = (Note("ignored", "path#a", "text", 3), Note("notice", "", "äöü"))
THIRD = 1 / 3


def jobs() -> dict[str, Job]:
    """One of each kind."""
    curve = Curve(array([[0, THIRD], [1, 0], [2, 0]]), np.arange(8.0).reshape(2, 2, 2) / 7)
    ring = Curve(box(0, 0, 1, 2), closed=True)
    own = FillSettings(direction=0.1 + 0.2, spacing=THIRD, inset=0.0)
    elements = (
        Element("a", (curve, ring), "#ff00aa", None, 0.7, FillRule.EVENODD, own, 2, "sky"),
        Element("b", (ring,), None, "#000000"),
    )
    segments = (
        FieldSegment("l", array([0, 0]), array([5, THIRD]), actuation="NONE", width=THIRD, passes=2, label="side"),
        FieldSegment("s", array([1, THIRD]), array([1, THIRD]), spot=0.22, directed=True),
        FieldSegment("c", array([1, 0]), array([math.cos(2.1), math.sin(2.1)]), array([0, 0]), 2.1),
    )
    stops = array([[3, 3], [4, THIRD]])
    front = Wall("a", box(0, 0, 9, 9), (box(1, 1, 1, 1),), stops, array([1, THIRD, 0]), array([0.6, 0.8, 0]))
    tower = Wall("b", box(0, 0, 1.2, 3), plan=array([[0, 0], [THIRD, 0], [1, -0.5], [1.3, -1]]))
    up = np.tile([0.6, 0.0, 0.8], (3, 1))
    return {
        "drawing": Drawing("d", elements, 0.001, (0.21, 0.297), NOTES),
        "field": Field(
            "f",
            segments,
            box(-9, -9, 18, 18),
            (box(0, 0, 1, 1), box(2, 2, 1, 1)),
            NOTES,
            (1.0, THIRD),
            0.1,
            Anchor(52.5, 13.25, THIRD),
        ),
        "facade": Facade("w", (front, tower), 0.9, 0.7, 1.9, box(-9, 0, 20, 20), NOTES),
        "bare field": Field("f", segments[:1]),
        "bare facade": Facade("w", (Wall("wall", box(0, 0, 9, 9)),)),
        "surface": Surface("s", np.arange(9.0).reshape(3, 3) / 7, up, 0.03, NOTES),
        "bare surface": Surface("s", np.arange(9.0).reshape(3, 3)),
    }


OPTIONS = Options(
    PageOptions(30.0, 20.0, THIRD, 0.01),
    CoverOptions(
        0.1 + 0.2,
        0.3,
        0.2,
        False,
        (("a", FillSettings(THIRD, None, 0.1)), ("b", FillSettings())),
        cut=False,
        headings=5,
    ),
    OrderOptions("search", "euclid", 2.5, 100, 7, (1.5, -THIRD), 12, heading=THIRD, drying=2.5, keep="order"),
    ConnectOptions(math.radians(33.3), reversing=True),
    TimeOptions(0.3, THIRD, 2.5, THIRD),
    WashOptions("brick", "minimal", True, 2.5, THIRD, "rows", "down", THIRD, 1.9, 1.5, "lift", 0.7),
)


def plan() -> Plan:
    """Every section there, made up but consistent."""
    strokes = (
        Stroke("s1", array([[0, 0], [1, THIRD]]), 2, directed=True, entry=0, element="a", layer="sky"),
        Stroke("s2", box(3, 3, 1, 1), 1, closed=True, dwell=0.5, bends=array([0, THIRD, 0, -0.1])),
        Stroke("s3", array([[0, 0, 1], [1, 0, THIRD]]), 1, normals=array([[0, 0, 1], [0.6, 0, 0.8]])),
    )
    areas = (Area("a", (box(0, 0, 5, 5), box(1, 1, 1, THIRD)), 2),)
    cover = Cover(
        strokes, areas, ((0, 1), (0, 2)), (0.5, THIRD), Canvas(20.0, 10.0, 0.5), NOTES, radii=(1.0, THIRD, 2.0)
    )
    trace = (TracePoint(0.1, math.inf, -math.inf), TracePoint(0.2, 9.0, 3.0))
    ordering = Ordering(
        np.array([0, 3]), 9.0, 3.0, Status.FEASIBLE, StopReason.TIME, "search", 7, 2.5, 100, "because", trace, "s"
    )
    states = np.arange(15.0).reshape(3, 5) / 7
    visits = Traversals(
        np.array([0, 1, 2]), np.array([0, 3, 1]), np.array([False, False, True]), states, states + 1,
        array([1, 2, 3]), array([4, 5, THIRD]),
    )  # fmt: skip
    quaternions = np.tile([0.6, 0.0, 0.8, 0.0], (3, 2, 1))
    zero = np.zeros(3)
    path = Path(
        np.arange(9.0).reshape(3, 3) / 7, array([0, THIRD, 2]), zero, array([0, 1, 0]), array([0, -1, 0]),
        array([1, 2, 0]), array([0, 0, -0.3]), array([0, 0, 2]), np.array([1, 0, 2]), np.array([0, -1, 2]), quaternions,
        np.array([1, -1, 1]),
    )  # fmt: skip
    trajectory = Trajectory(path, array([0, 1, 3, 3]), array([0, THIRD, 3, 5]), array([0, 1, 0, 0]))
    checks = (
        Check("gaps", Verdict.PASSED, THIRD, 1.0, "m", (1.0, 2.0), "fine"),
        Check("curvature", Verdict.NOTED, math.inf),
        Check("bound", Verdict.FAILED, 3.0),
    )
    report = Report(checks, (("tool-down", THIRD, "m"), ("gap", math.inf, "")))
    return Plan(jobs()["drawing"], RAKE, OPTIONS, cover, ordering, visits, path, trajectory, report)
