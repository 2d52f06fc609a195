"""Commands to the tool as CSV."""

from __future__ import annotations

import csv
import io

from optplan.domain.errors import InputError
from optplan.domain.result import Plan
from optplan.timing.actuation import tool_commands

COLUMNS = ("t", "s", "tool", "code", "reached")


def tool_text(plan: Plan) -> str:
    """One command a line: when (s) and where (m) it is given, its setting and code, and where (m) it holds.

    Raises
    ------
    InputError : the plan has no speeds yet
    """
    if plan.trajectory is None:
        raise InputError("the plan has no speeds yet; run the stage time first")
    out = io.StringIO()
    writer = csv.writer(out, lineterminator="\n")
    writer.writerow(COLUMNS)
    settings = plan.robot.tool.settings
    commands = tool_commands(plan.trajectory, plan.robot.tool)
    for time, s, setting, at in zip(*(column.tolist() for column in commands), strict=True):
        chosen = settings[setting]
        writer.writerow([f"{time:.6f}", f"{s:.6f}", chosen.name, chosen.code, f"{at:.6f}"])
    return out.getvalue()
