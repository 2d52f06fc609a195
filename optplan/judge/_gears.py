"""Driving backwards: whether the robot may, and whether it stands where its gear changes."""

from __future__ import annotations

import numpy as np

from optplan.domain.arrays import IntArray
from optplan.domain.path import Path
from optplan.domain.report import Check
from optplan.domain.robot import Robot
from optplan.judge._findings import count_of, held, noted, place_of
from optplan.judge._speeds import Speeds

_STILL = 1e-6  # m/s that count as standing


def backwards(path: Path, robot: Robot) -> Check:
    """Metres driven backwards: none by a robot that does not reverse."""
    rows = np.flatnonzero((path.gear < 0) & (path.length > 0))
    metres = float(path.length[rows].sum())
    if robot.mobility.reverses:
        return noted("backwards", metres, "m", "The robot may drive backwards.")
    detail = "Nothing is driven backwards." if not len(rows) else f"The robot cannot drive piece {rows[0]} backwards."
    return held("backwards", metres, 0.0, "m", place_of(path.start[rows[0]]) if len(rows) else None, detail)


def changes(path: Path, profile: Speeds | None) -> Check:
    """Fastest speed at which the gear changes, m/s: the robot has to stand."""
    rows = gear_changes(path)
    if profile is None:
        return noted("gear changes", 0.0, "m/s", f"{count_of(len(rows), 'gear change')}; there are no speeds yet.")
    if not len(rows):
        return held("gear changes", 0.0, _STILL, "m/s", detail="The gear never changes.")
    # with stops between the pieces, standing at any of these joints is enough
    before = gear_changes(path, last=True)
    speed = np.array(
        [profile.joints[first + 1 : row + 1].min() for first, row in zip(before.tolist(), rows.tolist(), strict=True)]
    )
    worst = int(np.argmax(speed))
    wrong = int((speed > _STILL).sum())
    detail = f"The robot stands at {count_of(len(rows), 'gear change')}."
    if wrong:
        detail = (
            f"The robot moves at {count_of(wrong, 'gear change')}, first at piece {rows[np.argmax(speed > _STILL)]}."
        )
    return held("gear changes", float(speed[worst]), _STILL, "m/s", place_of(path.start[rows[worst]]), detail)


def figures(path: Path) -> list[tuple[str, float, str]]:
    """The figures `gear changes` and `backwards`."""
    driven = float(path.length[path.gear < 0].sum())
    return [("gear changes", float(len(gear_changes(path))), ""), ("backwards", driven, "m")]


def gear_changes(path: Path, *, last: bool = False) -> IntArray:
    """(c,) moving pieces driven in another gear than the moving piece before them; `last`: these pieces before."""
    moving = np.flatnonzero(path.length > 0)
    changed = np.diff(path.gear[moving]) != 0
    rows: IntArray = moving[:-1][changed] if last else moving[1:][changed]
    return rows
