"""A drive as a table that other programs read."""

from __future__ import annotations

import io

import numpy as np

from optplan.domain.drive import Drive
from optplan.domain.robot import Robot

_FORMATS = {
    "t": "%.2f",
    "x": "%.6f",
    "y": "%.6f",
    "heading": "%.8f",
    "speed": "%.6f",
    "turn_rate": "%.6f",
    "wheel_left": "%.6f",
    "wheel_right": "%.6f",
    "acceleration_left": "%.6f",
    "acceleration_right": "%.6f",
    "tool": "%d",
    "code": "%d",
    "tool_x": "%.6f",
    "tool_y": "%.6f",
    "cross_track": "%.7f",
    "lag": "%.7f",
}
COLUMNS = tuple(_FORMATS)
"""s, m, rad, m/s, rad/s, rad/s^2; `tool` is the index of the setting, `code` what a controller knows it by."""


def trace_text(drive: Drive, robot: Robot) -> str:
    """A drive as CSV, one header line, one line a control step."""
    codes = np.array([setting.code for setting in robot.tool.settings])
    table = np.column_stack(
        [
            drive.time,
            drive.x,
            drive.y,
            drive.heading,
            drive.speed,
            drive.turn_rate,
            drive.wheel_speed,
            drive.wheel_acceleration,
            drive.tool,
            codes[drive.tool],
            drive.tool_x,
            drive.tool_y,
            drive.cross_track,
            drive.lag,
        ]
    )
    text = io.StringIO()
    header = ",".join(COLUMNS)
    np.savetxt(text, table, fmt=",".join(_FORMATS.values()), header=header, comments="")
    return text.getvalue()
