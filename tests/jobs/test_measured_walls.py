"""Several walls measured by a total station: which side of each is outside, and what is wrong in the files."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest

import optplan as op
from optplan.domain.errors import InputError
from optplan.domain.facade import Facade
from tests.facades import planned

CORNERS = [(0, 0), (8, 0), (8, 6), (0, 6)]
NAMES = ["front", "right", "back", "left"]
OUTSIDE = {"front": (0, -1), "right": (1, 0), "back": (0, 1), "left": (-1, 0)}
SEEN_FROM = {"front": "4,-10,1", "right": "20,3,1", "back": "4,20,1", "left": "-10,3,1"}


def _walls(*names: str, noise: float = 0.0) -> list[str]:
    rows, random = [], np.random.default_rng(0)
    for name in names:
        k = NAMES.index(name)
        (a, b), (c, d) = CORNERS[k], CORNERS[(k + 1) % 4]
        places = np.array([(a, b, 0), (c, d, 0), (c, d, 4), (a, b, 4)]) + random.normal(0, noise, (4, 3))
        rows += [f"{name}{n},{x},{y},{z},,{name}" for n, (x, y, z) in enumerate(places.tolist())]
    return rows


def _read(file: Path, rows: list[str]) -> Facade:
    file.write_text("\n".join(rows) + "\n")
    job = op.read(file)
    assert isinstance(job, Facade)
    return job


def _faces_outside(job: Facade) -> bool:
    return all(np.allclose(np.cross(wall.across, wall.up)[:2], OUTSIDE[wall.name], atol=5e-3) for wall in job.walls)


def test_every_wall_has_its_station(tmp_path: Path) -> None:
    stations = [f"s{name},{SEEN_FROM[name]},station,{name}" for name in ("front", "back")]
    job = _read(tmp_path / "two.csv", [*_walls("front", "back"), *stations])
    assert _faces_outside(job)
    plan = planned(job, fewest="minimal", pattern="hexagon")
    assert plan.report is not None
    assert plan.report.ok


@pytest.mark.parametrize("named", [True, False])
def test_a_building_measured_all_around(tmp_path: Path, named: bool) -> None:
    """Walls that close tell what is inside, whatever their stations say; measured corners are off by some mm."""
    stations = [f"s{name},{place},station,{name if named else ''}" for name, place in SEEN_FROM.items()]
    job = _read(tmp_path / "around.csv", [*_walls(*NAMES, noise=0.004), *stations])
    assert _faces_outside(job)
    assert job.building is not None
    plan = planned(job, fewest="minimal", pattern="hexagon", seconds=1.0)
    assert plan.report is not None
    assert plan.report.ok
    # no station at all does as well: (0, 0, 0) is none of a building that closes
    assert _faces_outside(_read(tmp_path / "none.csv", _walls(*NAMES)))


def test_the_ground_plan_says_what_is_outside(tmp_path: Path) -> None:
    ground = [f"g{k},{x},{y},0,building," for k, (x, y) in enumerate(CORNERS)]
    job = _read(tmp_path / "ground.csv", [*_walls("front", "back"), *ground, "s,4,-10,1,station,"])
    assert _faces_outside(job)
    assert job.building is not None
    assert np.allclose(job.building, CORNERS)


@pytest.mark.parametrize(
    ("rows", "words"),
    [
        ([*_walls("front", "back"), "s,4,-10,1,station,", "t,4,20,1,station,"], "lines 9 and 10 see wall 'front'"),
        ([*_walls("front"), "s,4,-10,1,station,rear"], "line 5: is a station of wall 'rear'"),
        ([*_walls("front"), "s,3,0,1,station,"], "station of line 5 lies in the plane"),
        (_walls("front"), "no station is given"),
        ([*_walls("front"), "g,0,0,0,building,", "h,1,0,0,building,"], "building has 2 points"),
        (["id,x,y,z,typ", "1,0,5,0,a"], "line 1: has a column 'typ'"),
        (["1,0,5,0,,front,remark"], "line 1: has 7 cells"),
        (["id,x,y,z,code,wall", "1,0,5,0,,", "2,12,5,10,6,,"], "line 3: has 7 cells.*commas"),
        (["1,0,5,0,outlin", "2,8,5,0,outlin", "3,8,5,4,outlin"], "0 outlines among its codes 'outlin'"),
    ],
)
def test_bad_files_are_one_clear_error(tmp_path: Path, rows: list[str], words: str) -> None:
    with pytest.raises(InputError, match=words) as error:
        _read(tmp_path / "bad.csv", rows)
    assert str(error.value).startswith(str(tmp_path / "bad.csv"))


def test_commas_between_semicolons_are_decimal(tmp_path: Path) -> None:
    job = _read(tmp_path / "comma.csv", ["id;x;y;z", "1;0,0;5,0;0,0", "2;8,5;5;0", "3;8,5;5;4", "4;0;5;4"])
    assert np.ptp(job.walls[0].outline, axis=0) == pytest.approx([8.5, 4])


def _outlier(ring: list[tuple[float, float, float]], code: str) -> list[str]:
    """A wall of ten points at y = 10, and other ones."""
    outline = [(0, 0), (4, 0), (8, 0), (12, 0), (12, 3), (12, 6), (9, 6), (6, 6), (3, 6), (0, 6)]
    rows = [f"p{k},{x},10,{z},outline" for k, (x, z) in enumerate(outline) if code != "outline" or k != 3]
    return [*rows[:3], *(f"q{k},{x},{y},{z},{code}" for k, (x, y, z) in enumerate(ring)), *rows[3:]]


def test_a_corner_off_the_plane_is_not_just_dropped(tmp_path: Path) -> None:
    """Without it the outline loses 6 m2, or the window half of its 4 m2."""
    with pytest.raises(InputError, match=r"line 4: point q0 is off.*the outline has 66 m2 instead of 72 m2"):
        _read(tmp_path / "a.csv", _outlier([(12, 13, 0)], "outline"))
    window: list[tuple[float, float, float]] = [(2, 10.5, 2), (4, 10, 2), (4, 10, 4), (2, 10, 4)]
    with pytest.raises(InputError, match=r"line 4: point q0 is off.*area 'win' has 2 m2 instead of 4 m2"):
        _read(tmp_path / "b.csv", _outlier(window, "win"))


def test_what_is_left_out_says_what_it_does_to_the_area(tmp_path: Path) -> None:
    job = _read(tmp_path / "c.csv", _outlier([(12, 10, 0), (12, 13, 1)], "outline"))
    assert [note.text for note in job.notes if note.kind == "ignored"] == [
        "is 3.000 m off the plane of wall 'wall': left out; without it the outline has 72 m2, with it 72 m2"
    ]
