"""The error tree.

OptplanError
├── InputError          something the user gave is wrong: file, place, value, expectation
│   └── LimitError      it is well formed but larger than a stated limit
└── SolverError         a solver cannot take this problem, or failed; says why

"No plan found" is a result, never an exception.
"""

from __future__ import annotations

from collections.abc import Iterator
from contextlib import contextmanager


class OptplanError(Exception):
    """Root of every error that optplan raises on purpose."""


class InputError(OptplanError):
    """Wrong input.

    Parameters
    ----------
    problem : what is wrong and what was expected, one sentence
    where : file and place in it, e.g. ``"lion.svg: path#mane"``; may be empty
    """

    def __init__(self, problem: str, where: str = "") -> None:
        super().__init__(f"{where}: {problem}" if where else problem)
        self.problem = problem
        self.where = where

    def __reduce__(self) -> tuple[type[InputError], tuple[str, str]]:
        return type(self), (self.problem, self.where)


class LimitError(InputError):
    """Input beyond a stated limit of size; the message names the limit and its value."""


class SolverError(OptplanError):
    """A solver refuses a problem or failed on it."""


@contextmanager
def located(where: str) -> Iterator[None]:
    """Put a file or place in front of every `InputError` raised inside."""
    try:
        yield
    except InputError as error:
        if error.where == where or error.where.startswith(f"{where}: "):
            raise
        place = f"{where}: {error.where}" if error.where else where
        raise type(error)(error.problem, place) from error.__cause__
