"""What a plan uses up, by what the robot is known to use."""

from __future__ import annotations

import math

from optplan.domain.report import Check
from optplan.domain.robot import Robot
from optplan.judge._findings import noted

NAME = "supplies"
Figures = list[tuple[str, float, str]]


def supplies(robot: Robot, area: float, work_time: float, duration: float) -> tuple[Check, Figures]:
    """Estimates from the area that is marked (m^2, marked twice counts twice), the time the tool works and the whole
    time (s): litres and tanks, watt-hours and charges."""
    used = robot.supplies
    if used is None:
        return noted(NAME, 0.0, "", "Nobody said what this robot uses up."), []
    figures: Figures = []
    words: list[str] = []
    worst = 0.0
    if used.name:
        litres = 1000 * (used.per_area * area + used.flow * work_time)
        figures.append((used.name, litres, "L"))
        words.append(f"{litres:.3g} L of {used.name}")
        if math.isfinite(used.tank):
            tanks = litres / (1000 * used.tank)
            worst = max(worst, tanks)
            words[-1] += f" from a tank of {1000 * used.tank:g} L" + (
                ": it has to be filled again" if tanks > 1 else ""
            )
    if used.power > 0:
        energy = used.power * duration / 3600
        figures.append(("energy", energy, "Wh"))
        words.append(f"{energy:.3g} Wh")
        if math.isfinite(used.battery):
            charges = used.power * duration / used.battery
            worst = max(worst, charges)
            words[-1] += f" of {used.battery / 3600:g} Wh" + (": it has to be charged again" if charges > 1 else "")
    return noted(NAME, worst, "", f"Estimated: {'; '.join(words)}."), figures
