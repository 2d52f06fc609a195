"""The child process in which HiGHS works. Runs as a file, so it imports nothing of this package.

In: one pickled dict on standard input, which then stays open; when it closes, the parent is gone and so is the child.
Out: frames on standard output, each a length of 8 bytes and a pickled tuple ("bound" | "incumbent" | "done", ...).
"""

from __future__ import annotations

import os
import pickle
import struct
import sys
import threading
import time
from typing import Any, BinaryIO

BOUND_EVERY = 0.05
"""Seconds between two reports of the bound."""


def send(out: BinaryIO, *message: Any) -> None:
    """Write one frame."""
    body = pickle.dumps(message, protocol=5)
    out.write(struct.pack("<Q", len(body)) + body)
    out.flush()


def leave_with_parent() -> None:
    """End the process when standard input closes."""
    sys.stdin.buffer.read()
    os._exit(1)


def solve(task: dict[str, Any], out: BinaryIO) -> None:
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
            send(out, "incumbent", float(found.objective_function_value), bound, np.array(found.mip_solution))
        elif bound > last[1] and time.perf_counter() - last[0] > BOUND_EVERY:
            last[:] = [time.perf_counter(), bound]
            send(out, "bound", bound)

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
    send(out, "done", status.name[1:], objective, bound, point)


def main() -> None:
    """Read the task, solve it."""
    # whatever libraries print must not get between the frames
    out = os.fdopen(os.dup(1), "wb")
    os.dup2(2, 1)
    task = pickle.load(sys.stdin.buffer)
    threading.Thread(target=leave_with_parent, daemon=True).start()
    solve(task, out)
    out.close()
    # the thread that waits for the parent holds standard input: leave without waiting for it
    sys.stderr.flush()
    os._exit(0)


if __name__ == "__main__":
    main()
