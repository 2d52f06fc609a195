"""Errors, arrays, stop rules, strokes, jobs, robots, options: valid from birth."""

from __future__ import annotations

import math
import pickle
from collections.abc import Callable

import numpy as np
import pytest

from optplan.domain.arrays import frozen_bools, frozen_floats, frozen_ints
from optplan.domain.errors import InputError, LimitError, OptplanError, SolverError, located
from optplan.domain.facade import Wall
from optplan.domain.job import Curve, Drawing, Element, Facade, FieldSegment, FillSettings, Surface
from optplan.domain.options import ConnectOptions, CoverOptions, OrderOptions, PageOptions, TimeOptions
from optplan.domain.path import Path, Trajectory
from optplan.domain.result import Cover
from optplan.domain.robot import Arm, Boom, Canvas, DiffDrive, Gantry, Tool, ToolSetting
from optplan.domain.stop import StopReason, StopRule
from optplan.domain.stroke import Stroke, Traversals
from tests.strategies import RAKE, WHEELS, array

LINE = [[0.0, 0.0], [1.0, 0.0]]
BOX = [[0.0, 0.0], [1.0, 0.0], [1.0, 1.0]]


def test_every_error_has_one_root() -> None:
    for kind in (InputError, LimitError, SolverError):
        assert issubclass(kind, OptplanError)


def test_errors_survive_pickling() -> None:
    for error in (InputError("is bad", "a.svg: path"), LimitError("is big"), InputError("", "")):
        copy = pickle.loads(pickle.dumps(error))
        assert (type(copy), copy.problem, copy.where, str(copy)) == (
            type(error),
            error.problem,
            error.where,
            str(error),
        )


def test_places_are_put_in_front_once() -> None:
    with pytest.raises(LimitError) as caught, located("a.svg"), located("path"):
        raise LimitError("is big")
    assert str(caught.value) == "a.svg: path: is big"
    with pytest.raises(InputError) as again, located("a.svg"):
        raise InputError("is bad", "a.svg: path")
    assert str(again.value) == "a.svg: path: is bad"


def test_a_place_that_begins_like_the_file_is_kept() -> None:
    with pytest.raises(InputError) as caught, located("lion"):
        raise InputError("is bad", "lion-head")
    assert str(caught.value) == "lion: lion-head: is bad"


def test_arrays_are_read_only_copies() -> None:
    source = np.array([[1.0, 2.0]])
    frozen = frozen_floats(source, "x", (None, 2))
    source[0, 0] = 9
    assert frozen[0, 0] == 1
    with pytest.raises(ValueError, match="read-only"):
        frozen[0, 0] = 3
    for made in (frozen_ints([1, 2], "x", (2,)), frozen_bools([True], "x", (1,))):
        assert not made.flags.writeable


@pytest.mark.parametrize(
    ("make", "message"),
    [
        (lambda: frozen_floats([1, math.nan], "x", (2,)), r"x\[1\] is nan; expected a finite"),
        (lambda: frozen_floats([[1, 2], [3, math.inf]], "x", (None, 2)), r"x\[1, 1\] is inf"),
        (lambda: frozen_floats([math.nan], "x", (1,), finite=False), "expected a number"),
        (lambda: frozen_floats([[1], [1, 2]], "x", (None, 2)), "not an array of numbers"),
        (lambda: frozen_floats("word", "x", ()), "not an array of numbers"),
        (lambda: frozen_floats([1, 2], "x", (3,)), r"shape \(2,\); expected \(3\)"),
        (lambda: frozen_ints([1.5], "x", (1,)), "whole numbers"),
        (lambda: frozen_ints([10**30], "x", (1,)), "whole numbers"),
        (lambda: frozen_ints([2**63], "x", (1,)), "whole numbers"),
        (lambda: frozen_ints([1, 2], "x", (1,)), "shape"),
        (lambda: frozen_bools([True], "x", (2,)), "shape"),
    ],
)
def test_arrays_that_do_not_fit(make: Callable[[], object], message: str) -> None:
    with pytest.raises(InputError, match=message):
        make()


def test_infinity_is_allowed_where_asked() -> None:
    assert frozen_floats([math.inf], "x", (1,), finite=False)[0] == math.inf


def test_empty_whole_numbers_take_the_shape() -> None:
    assert frozen_ints([], "x", (None, 2)).shape == (0, 2)


def test_stop_reasons_come_in_order() -> None:
    assert StopRule().start().reason(10**9, -1e300) is None
    assert StopRule(iterations=3).start().reason(2) is None
    assert StopRule(iterations=3).start().reason(3) is StopReason.ITERATIONS
    assert StopRule(target=5.0).start().reason(0, 5.0) is StopReason.TARGET
    assert StopRule(target=5.0).start().reason(0, 5.1) is None
    assert StopRule(seconds=1e-9).start().reason() is StopReason.TIME
    assert StopRule(iterations=0, target=9.0, cancelled=lambda: True).start().reason(0, 1) is StopReason.CANCELLED
    assert StopRule(seconds=1e-9).start().remaining == 0.0
    assert StopRule().start().remaining == math.inf


def test_stroke_lengths() -> None:
    square = Stroke("s", [[0, 0], [3, 0], [3, 4], [0, 4]], closed=True)  # type: ignore[arg-type]
    assert square.length == 14
    assert square.closed_points.shape == (5, 2)
    assert Stroke("s", array([[0, 0], [3, 4]])).length == 5
    assert Stroke("s", array([[0, 0, 0], [1, 2, 2]])).length == 3
    stop = Stroke("s", array([[1, 2]]), dwell=3)
    assert stop.is_stop
    assert stop.length == 0


def test_traversals_are_taken_by_row() -> None:
    ways = Traversals(
        np.array([0, 0, 1]),
        np.array([0, 1, 0]),
        np.array([False, True, False]),
        np.arange(15.0).reshape(3, 5),
        np.zeros((3, 5)),
        array([1, 1, 2]),
        array([3, 3, 4]),
    )
    swapped = ways.take([2, 1])
    assert len(swapped) == 2
    assert swapped[0].length == 2
    assert swapped[1].reverse
    assert swapped[1].entry.tolist() == [5, 6, 7, 8, 9]
    assert len(ways.take([])) == 0


def _path(**columns: object) -> Path:
    usual: dict[str, object] = {name: [0.0] for name in ("heading", "elevation", "curvature", "sharpness", "turn")}
    usual |= {"start": [[0, 0, 0]], "length": [1.0], "dwell": [0.0], "tool": [1], "stroke": [0]}
    return Path(**(usual | columns))  # type: ignore[arg-type]


BROKEN: list[Callable[[], object]] = [
    lambda: Stroke("s", array([])),
    lambda: Stroke("s", array(np.zeros((0, 2)))),
    lambda: Stroke("s", array([[1.0]])),
    lambda: Stroke("s", [[0, 0], [1]]),  # type: ignore[arg-type]
    lambda: Stroke("s", "points"),  # type: ignore[arg-type]
    lambda: Stroke("s", array([[0, 0], [0, 0]])),
    lambda: Stroke("s", array(BOX + BOX[:1]), closed=True),
    lambda: Stroke("s", array(LINE), closed=True),
    lambda: Stroke("s", array([[0, math.nan], [1, 1]])),
    lambda: Stroke("s", array(LINE), tool=-1),
    lambda: Stroke("s", array(LINE), dwell=-1),
    lambda: Stroke("s", array(LINE), dwell=math.nan),
    lambda: Stroke("s", array([*LINE, [2, 0]]), entry=1),
    lambda: Stroke("s", array(BOX), closed=True, entry=3),
    lambda: Stroke("s", array(LINE), normals=array([[0, 0, 1], [0, 0, 2]])),
    lambda: Stroke("s", array(LINE), normals=array([[0, 0, 1]])),
    lambda: Cover((Stroke("s", array(LINE)), Stroke("s", array(BOX)))),
    lambda: _path(length=[-1.0]),
    lambda: _path(turn=[1.0]),
    lambda: _path(dwell=[1.0]),
    lambda: _path(dwell=[-1.0], length=[0.0]),
    lambda: _path(elevation=[0.1], curvature=[1.0]),
    lambda: _path(tool=[-1]),
    lambda: _path(stroke=[-2]),
    lambda: _path(stroke=[0, 1]),
    lambda: Trajectory(_path(), array([0, 1]), array([1, 0]), array([0, 0])),
    lambda: Trajectory(_path(), array([1, 0]), array([0, 1]), array([0, 0])),
    lambda: Trajectory(_path(), array([0, 1]), array([0, 1]), array([0, -1])),
    lambda: Curve(array([[0, 0]])),
    lambda: Curve(array(LINE), handles=np.zeros((2, 2, 2))),
    lambda: Curve(array(LINE), handles=np.zeros((1, 2, 2)), closed=True),
    lambda: Element("e", (), None, None, stroke_width=-1),
    lambda: Element("e", (), None, None, stroke_width=math.nan),
    lambda: Drawing("d", (Element("e", (), None, None), Element("e", (), None, None))),
    lambda: Drawing("d", (), unit=0),
    lambda: Drawing("d", ()).with_element("e"),
    lambda: FillSettings(direction=math.inf),
    lambda: FillSettings(spacing=0),
    lambda: FillSettings(inset=-1),
    lambda: FieldSegment("f", array([0, 0]), array([1, 0]), sweep=1.0),
    lambda: FieldSegment("f", array([0, 0]), array([1, 0]), center=array([0.2, 0]), sweep=1.0),
    lambda: FieldSegment("f", array([1, 0]), array([0, 1]), center=array([0, 0])),
    lambda: FieldSegment("f", array([1, 0]), array([0, 1]), center=array([0, 0]), sweep=math.nan),
    lambda: Facade("f", (Wall("w", array(BOX)),), radius=0),
    lambda: Facade("f", (Wall("w", array(BOX)),), tau=math.nan),
    lambda: Facade("f", (Wall("w", array(BOX)),), width=math.inf),
    lambda: Facade("f", ()),
    lambda: Facade("f", (Wall("w", array(BOX)), Wall("w", array(BOX)))),
    lambda: Facade("f", (Wall("a", array(BOX)), Wall("b", array(BOX), up=array([0, 1, 0])))),
    lambda: Wall("w", array(BOX)[:2]),
    lambda: Wall("w", array([[0, 0], [1, 1], [1, 0], [0, 1]])),
    lambda: Wall("w", array(BOX), (array(BOX) + 0.5,)),
    lambda: Wall("w", array(BOX), stops=array([[0, math.nan]])),
    lambda: Wall("w", array(BOX), across=array([1, 1, 0])),
    lambda: Wall("w", array(BOX), plan=array([[0, 0], [1, 0], [1, -1]])),
    lambda: Wall("w", array(BOX), plan=array([[0, 0], [0.1, 0]])),
    lambda: Surface("s", np.zeros((3, 3)), disc_radius=0),
    lambda: Surface("s", np.zeros((3, 3)), tool_axes=np.zeros((2, 3))),
    lambda: Surface("s", np.zeros((3, 3)), tool_axes=np.full((3, 3), 2.0)),
    lambda: Tool((ToolSetting("up", 0),)),
    lambda: Tool((ToolSetting("up", 1), ToolSetting("down", 1))),
    lambda: Tool((ToolSetting("up", 0), ToolSetting("down", 0))),
    lambda: Tool((ToolSetting("up", 0), ToolSetting("up", 1))),
    lambda: Tool((ToolSetting("up", 0), ToolSetting("a", 1), ToolSetting("b", 1)), stroke_widths=(1.0, 2.0)),
    lambda: Tool((ToolSetting("up", 0), ToolSetting("a", 1), ToolSetting("b", 1)), stroke_widths=(0.0,)),
    lambda: Tool((ToolSetting("up", 0), ToolSetting("a", 1)), fill=2),
    lambda: Tool((ToolSetting("up", 0), ToolSetting("a", 1)), fill=0),
    lambda: Tool((ToolSetting("up", 0), ToolSetting("a", 1)), right=math.nan),
    lambda: ToolSetting("a", -1),
    lambda: ToolSetting("a", math.nan),
    lambda: ToolSetting("a", 1, code=128),
    lambda: DiffDrive(0.5, 0.1, 20, 40, 2.1, 1),
    lambda: DiffDrive(0.5, 0.1, 20, 40, 1, 2.1),
    lambda: DiffDrive(0.5, 0.1, 20, 40, 1, 1, turn_rate=9),
    lambda: DiffDrive(0, 0.1, 20, 40, 1, 1),
    lambda: DiffDrive(0.5, 0.1, 20, 40, 1, 1, radius=-1),
    lambda: DiffDrive(0.5, 0.1, 20, 40, 1, 1, sharpness=0),
    lambda: Gantry(1, 1, math.inf),
    lambda: Boom((1, 1, 0), 1, 1, 1),
    lambda: Boom((1, 1, 1), 1, 1, -1),
    lambda: Boom((1, 1, 1), 1, 1, 1, standoff=1),
    lambda: Arm(1, 1, 1, 0),
    lambda: Canvas(1, 2, 0.5),
    lambda: Canvas(1, math.inf),
    lambda: Canvas(1, 1, -0.1),
    lambda: PageOptions(width=0),
    lambda: PageOptions(margin=math.nan),
    lambda: PageOptions(tolerance=-1),
    lambda: CoverOptions(direction=math.nan),
    lambda: CoverOptions(spacing=-1),
    lambda: OrderOptions(metric="manhattan"),
    lambda: OrderOptions(seconds=0),
    lambda: OrderOptions(iterations=-1),
    lambda: OrderOptions(seed=-1),
    lambda: OrderOptions(seed=2**31),
    lambda: OrderOptions(start=(0, math.nan)),
    lambda: OrderOptions(entries=0),
    lambda: ConnectOptions(corner=0),
    lambda: ConnectOptions(corner=math.nan),
    lambda: ConnectOptions(corner=3.2),
    lambda: TimeOptions(work_speed=0),
    lambda: TimeOptions(transit_speed=math.inf),
    lambda: StopRule(seconds=0),
    lambda: StopRule(seconds=math.nan),
    lambda: StopRule(iterations=-1),
    lambda: StopRule(target=math.nan),
]


@pytest.mark.parametrize("make", BROKEN, ids=range(len(BROKEN)))
def test_nothing_wrong_is_born(make: Callable[[], object]) -> None:
    with pytest.raises(InputError):
        make()


def test_a_usual_path_is_born() -> None:
    assert _path().offsets.tolist() == [0, 1]


def test_elements_get_other_settings() -> None:
    curve = Curve(array(LINE))
    job = Drawing("d", (Element("a", (curve,), None, None), Element("b", (curve,), None, None)))
    changed = job.with_element("b", fill_settings=FillSettings(spacing=2), entry=1)
    assert changed.elements[0] is job.elements[0]
    assert changed.elements[1].fill_settings.spacing == 2
    assert changed.elements[1].entry == 1


def test_stroke_widths_pick_settings() -> None:
    names = ("up", "a", "b", "c")
    tool = Tool(tuple(ToolSetting(n, float(k)) for k, n in enumerate(names)), stroke_widths=(2.0, 4.0))
    assert [tool.setting_for(width) for width in (0, 1, 2, 2.1, 4, 4.1, 99)] == [1, 1, 1, 2, 2, 3, 3]
    assert RAKE.tool.setting_for(99) == 1


def test_wheels_limit_curvature() -> None:
    free = DiffDrive(0.5, 0.1, 20, 40, 0.4, 0.6)
    for speed in (0.3, 1.0, 1.9):
        limits = free.curvature_limits(speed)
        outer = speed * (1 + limits.curvature * 0.25)
        assert outer == pytest.approx(2.0)  # the rim's limit
        assert speed**2 * limits.sharpness * 0.25 == pytest.approx(4.0)
        assert WHEELS.curvature_limits(speed).curvature == min(2.0, limits.curvature)
    assert free.curvature_limits(5.0).curvature == 0
    assert free.turn_acceleration == pytest.approx(16)
