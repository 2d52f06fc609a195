"""HiGHS at work in the child process of `optplan_models.highs`; sends ("bound" | "incumbent" | "done", ...)."""

from __future__ import annotations

import time
from collections.abc import Callable
from typing import Any

BOUND_EVERY = 0.05
"""Seconds between two reports of the bound."""


def solve(send: Callable[..., None], task: dict[str, Any]) -> None:
    """Hand the arrays to HiGHS, stream what it finds."""
    import highspy
    import numpy as np

    highs: Any = highspy.Highs()  # type: ignore[no-untyped-call]
    highs.silent()
    for name, value in task["options"].items():
        if highs.setOptionValue(name, value) != highspy.HighsStatus.kOk:
            raise ValueError(f"HiGHS knows no option {name} = {value!r}")
    lp = highspy.HighsLp()
    rows, columns = task["shape"]
    lp.num_row_, lp.num_col_ = rows, columns
    lp.col_cost_, lp.offset_ = task["costs"], task["offset"]
    lp.col_lower_, lp.col_upper_ = task["column_lower"], task["column_upper"]
    lp.row_lower_, lp.row_upper_ = task["row_lower"], task["row_upper"]
    lp.a_matrix_.format_ = highspy.MatrixFormat.kColwise
    lp.a_matrix_.start_, lp.a_matrix_.index_, lp.a_matrix_.value_ = task["starts"], task["index"], task["values"]
    integer = bool(task["integer"].any())
    if integer:
        kinds = (highspy.HighsVarType.kContinuous, highspy.HighsVarType.kInteger)
        lp.integrality_ = [kinds[int(k)] for k in task["integer"]]
    if highs.passModel(lp) == highspy.HighsStatus.kError:
        raise ValueError("HiGHS refuses the model")
    if task["start"] is not None:
        solution = highspy.HighsSolution()
        solution.col_value = task["start"].tolist()
        highs.setSolution(solution)

    last = [0.0, -np.inf]

    def told(kind: Any, _: str, found: Any, *__: Any) -> None:
        bound = float(found.mip_dual_bound)
        if kind == highspy.cb.HighsCallbackType.kCallbackMipImprovingSolution:
            send("incumbent", float(found.objective_function_value), bound, np.array(found.mip_solution))
        elif bound > last[1] and time.perf_counter() - last[0] > BOUND_EVERY:
            last[:] = [time.perf_counter(), bound]
            send("bound", bound)

    if integer:
        highs.setCallback(told, None)
        highs.startCallback(highspy.cb.HighsCallbackType.kCallbackMipImprovingSolution)
        highs.startCallback(highspy.cb.HighsCallbackType.kCallbackMipInterrupt)
    highs.run()
    status = highs.getModelStatus()
    info = highs.getInfo()
    has_point = info.primal_solution_status == highspy.SolutionStatus.kSolutionStatusFeasible
    optimal = status == highspy.HighsModelStatus.kOptimal
    objective = float(info.objective_function_value) if has_point else np.inf
    if integer:
        bound = float(info.mip_dual_bound)
    else:
        bound = objective if optimal else -np.inf
    if status == highspy.HighsModelStatus.kInfeasible:
        bound = np.inf
    point = np.array(highs.getSolution().col_value) if has_point else None
    send("done", status.name[1:], objective, bound, point)
