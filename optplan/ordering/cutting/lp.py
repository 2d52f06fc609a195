"""A linear programme that grows: rows (cuts) and columns (pricing) are added between solves, the basis is kept.

A thin layer over highspy. Only for child processes (`optplan.ordering.cutting.child`): HiGHS hears no cancel.
HiGHS's tolerances are absolute (1e-7): bring costs to a size of about 1 to 1000 first.
"""

from __future__ import annotations

import math
from collections.abc import Callable
from dataclasses import dataclass, field
from typing import Any, NamedTuple

import numpy as np
import numpy.typing as npt

from optplan.domain.arrays import FloatArray, IntArray

Bools = npt.NDArray[np.bool_]


class Sparse(NamedTuple):
    """Vectors one after another: vector k has values[starts[k]:starts[k + 1]] at places[...].

    starts (k + 1,), places (z,), values (z,).
    """

    starts: IntArray
    places: IntArray
    values: FloatArray


class Solution(NamedTuple):
    """An optimal point of a programme: primal (columns,), duals (rows,), reduced (columns,) costs, objective."""

    primal: FloatArray
    duals: FloatArray
    reduced: FloatArray
    objective: float


class IntegerResult(NamedTuple):
    """What is known of the integer programme: `bound` is valid whatever the status; infinite: there is no point.

    status : HiGHS's word ("Optimal", "Infeasible", "TimeLimit", "Interrupt", ...); point (columns,) or None
    """

    status: str
    objective: float
    bound: float
    point: FloatArray | None


def _empty() -> Sparse:
    return Sparse(np.zeros(1, dtype=np.int64), np.zeros(0, dtype=np.int64), np.zeros(0))


@dataclass
class Programme:
    """min costs x over lower <= x <= upper and the rows added so far.

    costs, lower, upper (columns,); seed : of HiGHS
    """

    costs: FloatArray
    lower: FloatArray
    upper: FloatArray
    seed: int = 0
    _highs: Any = field(init=False, repr=False)

    def __post_init__(self) -> None:
        import highspy

        self._highs = highspy.Highs()  # type: ignore[no-untyped-call]
        self._highs.silent()
        # presolve would throw the basis away
        self._set(threads=1, random_seed=self.seed % 2**31, presolve="off", solver="simplex")
        self._columns_into_highs(self.costs, self.lower, self.upper, _empty())

    @property
    def columns(self) -> int:
        """Number of columns."""
        return int(self._highs.getNumCol())

    @property
    def rows(self) -> int:
        """Number of rows."""
        return int(self._highs.getNumRow())

    def add_rows(self, lower: FloatArray, upper: FloatArray, rows: Sparse) -> None:
        """Add rows lower <= row . x <= upper."""
        if len(lower):
            self._check(self._highs.addRows(len(lower), lower, upper, len(rows.places), *_as_int32(rows)))

    def add_columns(self, costs: FloatArray, lower: FloatArray, upper: FloatArray, columns: Sparse) -> None:
        """Add columns with these entries in the present rows."""
        self.costs, self.lower, self.upper = (
            np.concatenate([old, new]) for old, new in ((self.costs, costs), (self.lower, lower), (self.upper, upper))
        )
        self._columns_into_highs(costs, lower, upper, columns)

    def drop_rows(self, rows: IntArray) -> None:
        """Drop rows by number; only slack ones (`slack`) leave the basis as it is."""
        if len(rows):
            self._check(self._highs.deleteRows(len(rows), rows.astype(np.int32)))

    def drop_columns(self, columns: IntArray) -> None:
        """Drop columns by number; only nonbasic ones leave the basis as it is."""
        if len(columns):
            self.costs, self.lower, self.upper = (
                np.delete(values, columns) for values in (self.costs, self.lower, self.upper)
            )
            self._check(self._highs.deleteCols(len(columns), columns.astype(np.int32)))

    def set_bounds(self, columns: IntArray, lower: FloatArray, upper: FloatArray) -> None:
        """Change the bounds of some columns (fix them, or free them again)."""
        if len(columns):
            self.lower[columns], self.upper[columns] = lower, upper
            self._check(self._highs.changeColsBounds(len(columns), columns.astype(np.int32), lower, upper))

    def solve(self, seconds: float = math.inf) -> Solution | str:
        """The optimal point by the dual simplex from the last basis, else HiGHS's word ("Infeasible", "TimeLimit")."""
        self._limit(seconds)
        self._highs.run()
        status = str(self._highs.getModelStatus().name[1:])
        if status != "Optimal":
            return status
        solution = self._highs.getSolution()
        return Solution(
            np.array(solution.col_value),
            np.array(solution.row_dual),
            np.array(solution.col_dual),
            float(self._highs.getInfo().objective_function_value),
        )

    def probe(self, iterations: int) -> float:
        """The objective after so many iterations of the dual simplex, infinite when infeasible: an estimate."""
        self._set(simplex_iteration_limit=self._highs.getInfo().simplex_iteration_count + iterations)
        self._limit(math.inf)
        self._highs.run()
        self._set(simplex_iteration_limit=2**31 - 1)
        if self._highs.getModelStatus().name == "kInfeasible":
            return math.inf
        return float(self._highs.getInfo().objective_function_value)

    def slack(self) -> Bools:
        """(rows,) which rows are basic: dropping them changes nothing."""
        import highspy

        basic = highspy.HighsBasisStatus.kBasic
        return np.array([status == basic for status in self._highs.getBasis().row_status], dtype=np.bool_)

    def basis(self) -> Any:
        """The basis, for `set_basis`."""
        return self._highs.getBasis()

    def set_basis(self, basis: Any) -> None:
        """Go on from this basis, of the same rows and columns."""
        self._check(self._highs.setBasis(basis))

    def solve_integer(
        self,
        integer: Bools,
        start: FloatArray | None = None,
        seconds: float = math.inf,
        found: Callable[[FloatArray], bool] | None = None,
        proved: Callable[[float], None] | None = None,
    ) -> IntegerResult:
        """The same programme with integer columns, by branch and bound with gap 0; this programme stays as it is.

        Parameters
        ----------
        integer : (columns,) which must be integer
        start : (columns,) a feasible point
        seconds : time limit
        found : told each better point (columns,); True ends the run
        proved : told the bound as it rises
        """
        import highspy

        highs: Any = highspy.Highs()  # type: ignore[no-untyped-call]
        highs.silent()
        _set(highs, threads=1, random_seed=self.seed % 2**31, mip_rel_gap=0.0, mip_abs_gap=0.0)
        if math.isfinite(seconds):
            _set(highs, time_limit=max(seconds, 0.0))
        self._check(highs.passModel(self._highs.getLp()))
        kinds = np.where(integer, int(highspy.HighsVarType.kInteger), int(highspy.HighsVarType.kContinuous))
        columns = np.arange(len(kinds), dtype=np.int32)
        self._check(highs.changeColsIntegrality(len(kinds), columns, kinds.astype(np.uint8)))
        if start is not None:
            point = highspy.HighsSolution()
            point.col_value = start.tolist()
            highs.setSolution(point)
        best = [-math.inf]
        ended = [False]

        def told(kind: Any, _: str, now: Any, back: Any, __: Any) -> None:
            improving = kind == highspy.cb.HighsCallbackType.kCallbackMipImprovingSolution
            if improving and found is not None:
                ended[0] = ended[0] or found(np.array(now.mip_solution))
            elif not improving:
                if proved is not None and now.mip_dual_bound > best[0]:
                    best[0] = float(now.mip_dual_bound)
                    proved(best[0])
                back.user_interrupt = ended[0]

        highs.setCallback(told, None)
        highs.startCallback(highspy.cb.HighsCallbackType.kCallbackMipImprovingSolution)
        highs.startCallback(highspy.cb.HighsCallbackType.kCallbackMipInterrupt)
        highs.run()
        status = str(highs.getModelStatus().name[1:])
        info = highs.getInfo()
        feasible = info.primal_solution_status == highspy.SolutionStatus.kSolutionStatusFeasible
        return IntegerResult(
            status,
            float(info.objective_function_value) if feasible else math.inf,
            math.inf if status == "Infeasible" else float(info.mip_dual_bound),
            np.array(highs.getSolution().col_value) if feasible else None,
        )

    def _columns_into_highs(self, costs: FloatArray, lower: FloatArray, upper: FloatArray, columns: Sparse) -> None:
        if len(costs):
            starts = columns.starts if len(columns.places) else np.zeros(len(costs) + 1, dtype=np.int64)
            columns = Sparse(starts, columns.places, columns.values)
            self._check(self._highs.addCols(len(costs), costs, lower, upper, len(columns.places), *_as_int32(columns)))

    def _limit(self, seconds: float) -> None:
        # HiGHS counts from the first run on
        limit = self._highs.getRunTime() + max(seconds, 0.0) if math.isfinite(seconds) else math.inf
        self._set(time_limit=limit)

    def _set(self, **options: Any) -> None:
        _set(self._highs, **options)

    @staticmethod
    def _check(status: Any) -> None:
        import highspy

        if status == highspy.HighsStatus.kError:
            raise ValueError("HiGHS refuses a change of the programme")


def _set(highs: Any, **options: Any) -> None:
    import highspy

    for name, value in options.items():
        if highs.setOptionValue(name, value) != highspy.HighsStatus.kOk:
            raise ValueError(f"HiGHS knows no option {name} = {value!r}")


def _as_int32(vectors: Sparse) -> tuple[npt.NDArray[np.int32], npt.NDArray[np.int32], FloatArray]:
    # HiGHS wants no end of the last vector
    return vectors.starts[:-1].astype(np.int32), vectors.places.astype(np.int32), vectors.values
