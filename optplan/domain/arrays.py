"""Read-only arrays: checked once, then safe to share."""

from __future__ import annotations

from collections.abc import Sequence
from typing import Any

import numpy as np
import numpy.typing as npt

from optplan.domain.errors import InputError

FloatArray = npt.NDArray[np.float64]
IntArray = npt.NDArray[np.int64]
BoolArray = npt.NDArray[np.bool_]

MAX_NUMBER = 1e30
"""Largest finite number in SI units: beyond, squares and sums of lengths overflow."""


def frozen_floats(values: Any, what: str, shape: Sequence[int | None], *, finite: bool = True) -> FloatArray:
    """A read-only float64 copy of `values`.

    Parameters
    ----------
    values : anything NumPy can turn into numbers
    what : name used in error messages
    shape : expected shape; None leaves a dimension free
    finite : refuse NaN, infinity and whatever is beyond `MAX_NUMBER` (else only NaN)

    Raises
    ------
    InputError : wrong shape, or a value that is not a (finite) number
    """
    try:
        array: FloatArray = np.array(values, dtype=np.float64, order="C")
    except (TypeError, ValueError, OverflowError) as error:
        raise InputError(f"{what} is not an array of numbers ({error})") from None
    _check_shape(array.shape, what, shape)
    bad = ~np.isfinite(array) if finite else np.isnan(array)
    if bad.any():
        place = tuple(int(k) for k in np.argwhere(bad)[0])
        at = "" if not place else str(list(place))
        raise InputError(f"{what}{at} is {array[place]}; expected a {'finite ' if finite else ''}number")
    if finite and (large := np.abs(array) > MAX_NUMBER).any():
        value = array[large].flat[0]
        raise InputError(f"{what} holds {value:.3g}, which is absurdly large; expected at most {MAX_NUMBER:g}")
    array.setflags(write=False)
    return array


def frozen_ints(values: Any, what: str, shape: Sequence[int | None]) -> IntArray:
    """A read-only int64 copy of `values`; see `frozen_floats`."""
    try:
        given = np.asarray(values)
    except (TypeError, ValueError) as error:
        raise InputError(f"{what} is not an array of whole numbers ({error})") from None
    if given.size and (given.dtype.kind not in "iub" or given.dtype == np.uint64):
        raise InputError(f"{what} holds {given.dtype} values; expected whole numbers")
    array: IntArray = np.array(given, dtype=np.int64, order="C")
    if array.size == 0:
        array = array.reshape([0 if n is None else n for n in shape])
    _check_shape(array.shape, what, shape)
    array.setflags(write=False)
    return array


def frozen_bools(values: Any, what: str, shape: Sequence[int | None]) -> BoolArray:
    """A read-only bool copy of `values`; see `frozen_floats`."""
    array: BoolArray = np.array(values, dtype=np.bool_, order="C")
    _check_shape(array.shape, what, shape)
    array.setflags(write=False)
    return array


def _check_shape(got: tuple[int, ...], what: str, shape: Sequence[int | None]) -> None:
    fits = len(got) == len(shape) and all(want is None or want == have for want, have in zip(shape, got, strict=True))
    if not fits:
        wanted = ", ".join("n" if want is None else str(want) for want in shape)
        raise InputError(f"{what} has shape {got}; expected ({wanted})")
