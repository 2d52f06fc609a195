"""The presets, and robots of the user's own."""

from __future__ import annotations

import json
import math
import tomllib
from pathlib import Path

import pytest

from optplan import robots
from optplan.domain.errors import InputError
from optplan.domain.options import TimeOptions
from optplan.domain.robot import DiffDrive, Robot
from optplan.jobs.fields import template
from optplan.robots import load_robot, robot_names

FOLDER = Path(robots.__file__).parent
NAMES = ("arm-grinder", "beach-rake", "boom-washer", "line-marker", "pen-plotter")


def _text(name: str) -> str:
    return (FOLDER / f"{name}.toml").read_text()


def test_all_presets_load() -> None:
    assert robot_names() == NAMES
    for name in NAMES:
        robot = load_robot(name)
        assert robot.name == name
        assert robot.summary
        assert load_robot(robot) is robot


@pytest.mark.parametrize("name", NAMES)
def test_every_number_has_a_source(name: str) -> None:
    data = tomllib.loads(_text(name))
    sources = data["sources"]
    assert all(sources.values())
    for table in ("tool", "mobility", "canvas", "supplies"):
        for key, value in data.get(table, {}).items():
            if key in ("kind", "name", "fill", "red_is_travel", "green_is_start"):
                continue  # words and syntax, no measurements
            if isinstance(value, bool) and not value and f"{table}.{key}" not in sources:
                continue
            assert f"{table}.{key}" in sources or table in sources, f"{table}.{key} has no source"
    for place in sources:  # and no source speaks of a number that is not there
        table, _, key = place.partition(".")
        assert key in data[table] if key else table in data


def test_a_tank_and_a_charge_of_the_line_marker_last_as_published() -> None:
    marker = load_robot("line-marker")
    assert marker.supplies is not None
    supplies, width = marker.supplies, marker.tool.settings[1].width
    field, pitch = (sum(part.length for part in template(name).segments) for name in ("american-football", "football"))
    # a tank marks one American football field and little more, crossings marked twice included
    assert 0.85 * supplies.tank < supplies.per_area * width * field < 0.98 * supplies.tank
    hours = supplies.battery / supplies.power / 3600
    assert hours == pytest.approx(5.0)
    # a charge marks eleven football fields, though a third of the way is driven between the lines
    assert 11 * 1.5 * pitch / marker.mobility.work_speed < 3600 * hours


def test_line_marker_limits_follow_from_its_wheels() -> None:
    marker = load_robot("line-marker")
    assert isinstance(marker.mobility, DiffDrive)
    assert marker.tool.right == 0.41124
    assert (marker.mobility.work_speed, marker.mobility.transit_speed) == (1.0, 1.4)
    assert marker.mobility.curvature_limits(1.5).curvature == pytest.approx(1.3126, abs=5e-5)
    assert marker.mobility.curvature_limits(1.5).sharpness == pytest.approx(7.0, abs=5e-3)
    assert marker.mobility.curvature_limits(1.556).curvature == pytest.approx(1.1236, abs=5e-5)
    # by hand: half the track is 0.25395 m, the rim runs at 2 m/s and gains 4 m/s^2
    assert marker.mobility.curvature_limits(1.0).curvature == pytest.approx(1 / 0.25395)
    assert marker.mobility.curvature_limits(1.0).sharpness == pytest.approx(4 / 0.25395)
    assert marker.heading_counts


def test_beach_rake() -> None:
    rake = load_robot("beach-rake")
    assert not rake.heading_counts
    assert rake.mobility.work_speed == 0.4
    assert rake.mobility.curvature_limits(0.4).curvature == 2
    assert [setting.name for setting in rake.tool.settings] == ["up", "1 pin", "3 pins", "5 pins", "7 pins"]
    assert [setting.width for setting in rake.tool.settings] == [0, 0.04, 0.16, 0.32, 0.42]
    assert [rake.tool.setting_for(width) for width in (1, 3, 5, 7, 20)] == [1, 2, 3, 4, 4]
    assert rake.tool.fill == 4


def test_plotter_speaks_millimetres() -> None:
    plotter = load_robot("pen-plotter")
    assert plotter.canvas is not None
    assert (plotter.canvas.width, plotter.canvas.height) == (0.297, 0.21)
    assert plotter.tool.settings[1].width == 0.0005
    assert math.isinf(plotter.mobility.turn_rate)


def test_files_of_the_user(tmp_path: Path) -> None:
    own = tmp_path / "own.toml"
    own.write_text(_text("beach-rake").replace('"0.4 m/s"', '"40 cm/s"'))
    assert load_robot(own) == load_robot("beach-rake")
    data = tomllib.loads(_text("line-marker"))
    other = tmp_path / "own.json"
    other.write_text(json.dumps(data))
    assert load_robot(str(other)) == load_robot("line-marker")


@pytest.mark.parametrize(
    ("change", "expected"),
    [
        (("version = ", "#"), "has no version"),
        (('"1.0"', '"2.0"'), "format version 2.0"),
        (('"1.0"', '"1.9"'), "Update optplan"),
        (('"0.4 m/s"', '"0.4 parsec"'), r"mobility.diff-drive.work_speed: .*parsec"),
        (('"0.4 m/s"', '"9 m/s"'), "mobility: work_speed is 9.0 m/s; the wheels reach only 0.6"),
        (("track", "trak"), r"track: Field required.*trak"),
        (("wheel_radius = ", "wheel_radius = nan #"), "wheel_radius: .*finite"),
        (('"7 pins"\nred', '"9 pins"\nred'), "tool: fill names '9 pins'; expected one of 1 pin"),
        (("up_to = 4", ""), "tool: settings: every marking setting but the last needs an up_to"),
        (('margin = "0.5 m"', 'margin = "10 m"'), "canvas: a canvas of 20 x 20 m is smaller than its margin"),
        (("[tool]", "[tool"), "is not TOML"),
        (("0x7f", "0x80"), "settings.4..code: .*127"),
        (("diff-drive", "hover"), "mobility: .*hover"),
    ],
)
def test_bad_files_give_one_clear_error(tmp_path: Path, change: tuple[str, str], expected: str) -> None:
    own = tmp_path / "own.toml"
    own.write_text(_text("beach-rake").replace(*change))
    with pytest.raises(InputError, match=expected) as caught:
        load_robot(own)
    assert str(caught.value).startswith(str(own))


def test_what_is_no_robot(tmp_path: Path) -> None:
    for name in ("nobody", "", "beach_rake", "x.svg"):
        with pytest.raises(InputError, match="expected one of arm-grinder, beach-rake"):
            load_robot(name)
    with pytest.raises(InputError, match="does not exist"):
        load_robot(tmp_path / "none.toml")
    (tmp_path / "a.toml").mkdir()
    with pytest.raises(InputError, match="folder"):
        load_robot(tmp_path / "a.toml")
    (tmp_path / "b.toml").write_bytes(b"\xff\xfe\x00")
    with pytest.raises(InputError, match="UTF-8"):
        load_robot(tmp_path / "b.toml")
    (tmp_path / "c.json").write_text("[1]")
    with pytest.raises(InputError, match="holds a list"):
        load_robot(tmp_path / "c.json")


def test_loaded_robots_are_robots() -> None:
    assert all(isinstance(load_robot(name), Robot) for name in NAMES)


def test_a_speed_whose_square_is_lost_is_refused() -> None:
    with pytest.raises(InputError, match=r"work_speed is 1e-308; expected at least 1e-30"):
        DiffDrive(0.5, 0.1, 20, 40, 1e-308, 1)
    with pytest.raises(InputError, match=r"transit_speed is 1e-308; expected at least 1e-30"):
        TimeOptions(transit_speed=1e-308)
