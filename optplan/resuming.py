"""The rest of a plan after an interruption."""

from __future__ import annotations

from dataclasses import replace

import numpy as np

from optplan.domain.errors import InputError
from optplan.domain.facade import Facade
from optplan.domain.options import Options
from optplan.domain.progress import ProgressCallback
from optplan.domain.result import Cover, Plan
from optplan.domain.stop import StopRule
from optplan.pipeline import plan_from


def resumed(
    plan: Plan,
    first: int,
    options: Options,
    *,
    reorder: bool = False,
    progress: ProgressCallback | None = None,
    stop: StopRule | None = None,
) -> Plan:
    """The strokes of a plan from the `first`-th on, from where the robot stands now.

    A stroke that was interrupted is done again from its beginning. Areas of which strokes are finished are no longer
    judged: the new plan alone does not cover them.

    Parameters
    ----------
    plan : with an order
    first : strokes that are done, in driving order: 0 is the whole plan
    options : of the rest; their start and heading are where the robot stands
    reorder : find a new order for the rest; else the old one is kept, and there is no bound of it
    progress, stop : of finding the order

    Raises
    ------
    InputError : the plan has no order, or fewer strokes, or is that of a facade
    """
    if plan.cover is None or plan.visits is None:
        raise InputError("the plan has no order yet; run the stage order first")
    if isinstance(plan.job, Facade):
        raise InputError("a facade's stops are not resumed: go on with those that are left (optplan export --to stops)")
    visits = plan.visits
    if not 0 <= first < max(len(visits), 1):
        raise InputError(f"{first} strokes are done, of a plan of {len(visits)}; expected 0..{len(visits) - 1}")
    left = visits.take(np.arange(first, len(visits)))
    number = {old: new for new, old in enumerate(left.stroke.tolist())}
    cover = _rest(plan.cover, number)
    if reorder:
        return plan_from(Plan(plan.job, plan.robot, options, cover), "order", progress, stop)
    left = replace(left, stroke=np.arange(len(left)))
    return plan_from(Plan(plan.job, plan.robot, options, cover, visits=left), "connect", progress, stop)


def _rest(cover: Cover, number: dict[int, int]) -> Cover:
    """The cover of the strokes that are left, with their new numbers."""
    done = {stroke.element for k, stroke in enumerate(cover.strokes) if k not in number}
    before = tuple(stroke for k, stroke in enumerate(cover.strokes) if k not in number)
    return replace(
        cover,
        elsewhere=cover.elsewhere + before,
        strokes=tuple(cover.strokes[old] for old in number),
        areas=tuple(area for area in cover.areas if area.element not in done),
        precedence=tuple((number[a], number[b]) for a, b in cover.precedence if a in number and b in number),
        links=tuple(
            (number[a], at, number[b], there) for a, at, b, there in cover.links if a in number and b in number
        ),
    )
