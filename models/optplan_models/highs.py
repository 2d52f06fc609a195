"""Linear and mixed-integer Pyomo models, solved by HiGHS in a child process.

In a child because HiGHS may notice a cancel only after many seconds; a process can be ended at once. It streams
incumbents and bounds, so that whatever it knew then is not lost.
"""

from __future__ import annotations

import math
import time
from collections.abc import Callable
from dataclasses import dataclass, replace
from typing import Any

import numpy as np
import numpy.typing as npt

from optplan_models.child import GRACE, Child, ChildError

Floats = npt.NDArray[np.float64]
_ARRAYS = (
    "column_lower",
    "column_upper",
    "row_lower",
    "row_upper",
    "starts",
    "index",
    "values",
    "integer",
)
HighsError = ChildError
"""HiGHS crashed or could not be started; says how."""


class InfeasibleError(ChildError):
    """The model says in a row without variables that there is no solution."""


@dataclass(frozen=True, eq=False)
class Compiled:
    """A model as arrays: min costs x + offset with row and column bounds, matrix (rows, columns) by columns."""

    costs: Floats
    offset: float
    column_lower: Floats
    column_upper: Floats
    integer: npt.NDArray[np.bool_]
    row_lower: Floats
    row_upper: Floats
    starts: npt.NDArray[np.int32]
    index: npt.NDArray[np.int32]
    values: Floats
    columns: tuple[Any, ...] = ()
    """The Pyomo variables, column by column."""

    def relaxed(self) -> Compiled:
        """The same without integrality."""
        return replace(self, integer=np.zeros(len(self.costs), dtype=np.bool_))


@dataclass(frozen=True, eq=False)
class Result:
    """What HiGHS knows.

    status : its own word ("Optimal", "Infeasible", "TimeLimit", ...), or "Cancelled", "Killed" when it was ended
    objective, bound : infinite and minus infinity when nothing is known; an infinite bound: proved infeasible
    values : (columns,) of the best solution, or None
    """

    status: str
    objective: float
    bound: float
    values: Floats | None


def compile_model(model: Any) -> Compiled:
    """Compile a linear or mixed-integer linear Pyomo model (minimisation).

    Raises
    ------
    InfeasibleError : a row without variables says that there is no solution
    """
    from pyomo.common.errors import InfeasibleConstraintException
    from pyomo.repn.plugins.standard_form import LinearStandardFormCompiler

    try:
        form = LinearStandardFormCompiler().write(model, mixed_form=True)
    except InfeasibleConstraintException as error:
        raise InfeasibleError(str(error)) from None
    matrix = form.A.tocsc()
    columns = tuple(form.columns)
    kind = np.array([row.bound_type for row in form.rows], dtype=np.int64)
    rhs = np.asarray(form.rhs, dtype=np.float64)
    lower = [-math.inf if v.lb is None else float(v.lb) for v in columns]
    upper = [math.inf if v.ub is None else float(v.ub) for v in columns]
    return Compiled(
        costs=np.asarray(form.c.todense(), dtype=np.float64).ravel(),
        offset=float(form.c_offset[0]),
        column_lower=np.array(lower),
        column_upper=np.array(upper),
        integer=np.array([v.is_integer() or v.is_binary() for v in columns], dtype=np.bool_),
        row_lower=np.where(kind == 1, -math.inf, rhs),
        row_upper=np.where(kind == -1, math.inf, rhs),
        starts=matrix.indptr.astype(np.int32),
        index=matrix.indices.astype(np.int32),
        values=matrix.data.astype(np.float64),
        columns=columns,
    )


def start_values(compiled: Compiled) -> Floats | None:
    """Values of the variables, when each has one."""
    values = [v.value for v in compiled.columns]
    return None if any(v is None for v in values) else np.array(values, dtype=np.float64)


def load_values(compiled: Compiled, values: Floats) -> None:
    """Give the Pyomo variables these values."""
    for variable, value in zip(compiled.columns, values.tolist(), strict=True):
        variable.set_value(value, skip_validation=True)


def run(
    compiled: Compiled,
    *,
    seconds: float = math.inf,
    start: Floats | None = None,
    seed: int = 0,
    cancelled: Callable[[], bool] | None = None,
    incumbent: Callable[[Floats], None] | None = None,
    bound: Callable[[float], None] | None = None,
    options: dict[str, Any] | None = None,
) -> Result:
    """Solve in a child process. The child never outlives this call.

    Parameters
    ----------
    compiled : the model
    seconds : wall time, s, the start of the child included
    start : (columns,) a feasible point to begin with
    seed : of HiGHS
    cancelled : asked every 0.03 s; True ends the child at once
    incumbent, bound : told about each better point and bound while it runs
    options : more HiGHS options. The gaps are 0 and one thread is used, unless said otherwise here.

    Raises
    ------
    HighsError : the child crashed or could not be started
    """
    # HiGHS's tolerances are absolute: bring costs to a common size, by a power of two so that nothing is rounded
    largest = float(np.abs(compiled.costs).max(initial=0.0))
    scale = 2.0 ** math.floor(math.log2(1000.0 / largest)) if largest > 0 else 1.0
    deadline = time.perf_counter() + seconds
    task = {
        "shape": (len(compiled.row_lower), len(compiled.costs)),
        "costs": compiled.costs * scale,
        "offset": compiled.offset * scale,
        "start": start,
        **{name: getattr(compiled, name) for name in _ARRAYS},
        "options": {
            "threads": 1,
            "random_seed": seed % 2**31,
            "mip_rel_gap": 0.0,
            "mip_abs_gap": 0.0,
            **({"time_limit": seconds} if math.isfinite(seconds) else {}),
            **(options or {}),
        },
    }
    best, proved, point = math.inf, -math.inf, None
    with Child("optplan_models.highs_worker:solve", task) as child:
        while True:
            message = child.receive()
            if message is None:
                if cancelled is not None and cancelled():
                    return Result("Cancelled", best, proved, point)
                if time.perf_counter() > deadline + GRACE:
                    return Result("Killed", best, proved, point)
            elif message[0] == "bound":
                proved = max(proved, message[1] / scale)
                if bound is not None:
                    bound(proved)
            elif message[0] == "incumbent":
                best, point = message[1] / scale, message[3]
                if incumbent is not None:
                    incumbent(message[3])
                # a steady stream of messages must not drown the cancel
                if cancelled is not None and cancelled():
                    return Result("Cancelled", best, proved, point)
            elif message[0] == "done":
                status, objective, final, last = message[1:]
                if last is not None and objective / scale <= best:
                    best, point = objective / scale, last
                return Result(status, best, max(proved, final / scale), point)
            else:
                raise HighsError(f"the solver's process ended unexpectedly ({child.obituary()})")
