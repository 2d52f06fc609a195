"""Solver comparison: instances x solvers x seeds x budgets."""

from __future__ import annotations

from optplan.compare.cases import Case, load_case
from optplan.compare.runs import Result, compare_solvers
from optplan.compare.tables import csv_text, summary_rows

__all__ = ["Case", "Result", "compare_solvers", "csv_text", "load_case", "summary_rows"]
