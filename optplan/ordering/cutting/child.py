"""A proof at work in a child process, heard by a run."""

from __future__ import annotations

import time
from typing import Any

from optplan.domain.stop import StopReason
from optplan.ordering.method import Run


def prove_in_child(run: Run, function: str, *arguments: Any) -> StopReason:
    """Let a function of ours work in a child process; its bounds and paths go to the run as they come.

    Parameters
    ----------
    run : hears what is found; its time limit and cancel end the child at once
    function : "module:function", called as function(send, *arguments). It sends ("bound", value),
        ("incumbent", nodes (m,)), and last ("done", finished): whether it had nothing left to do
    arguments : anything that can be pickled; a time limit of the function's own is worth having, because a child that
        is ended in the middle of a step loses that step

    Returns
    -------
    why it stopped; `FAILED` (and the run's message says how) when the child ended without "done"
    """
    from optplan_models.child import GRACE, Child, ChildError

    late: float | None = None
    try:
        with Child(function, *arguments) as child:
            while True:
                message = child.receive()
                match message:
                    case ("bound", bound):
                        run.prove(bound)
                    case ("incumbent", nodes):
                        run.offer(nodes)
                    case ("done", finished):
                        return StopReason.FINISHED if finished else run.stop() or StopReason.TIME
                    case ("end",):
                        run.message = f"the solver's process ended unexpectedly ({child.obituary()})"
                        return StopReason.FAILED
                # the child keeps the time itself and says its last word; steps of its own are not counted
                stop = run.stop()
                if stop in (StopReason.CANCELLED, StopReason.TARGET):
                    return stop
                if stop is StopReason.TIME:
                    late = late or time.perf_counter()
                    if time.perf_counter() - late > GRACE:
                        return stop
    except ChildError as error:
        run.message = str(error)
        return StopReason.FAILED
