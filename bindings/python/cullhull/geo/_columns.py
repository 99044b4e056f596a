"""Columns of a file side by side, in a type that holds each of their values."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from contextlib import contextmanager
from typing import Any

import numpy as np
import numpy.typing as npt

from .._errors import BadFile, Error

#: Every integer up to it, of either sign, is a double.
_ALL_EXACT = 2**53


@contextmanager
def faults_of_a_package(path: str, faults: Any = None) -> Iterator[None]:
    """Makes a `BadFile` of one line of what a package raises for a file: of `faults`, or of anything
    but our errors, missing packages and missing memory."""
    try:
        yield
    except Exception as error:
        ours = isinstance(error, (Error, ImportError, MemoryError))
        if ours if faults is None else not isinstance(error, faults):
            raise
        raise BadFile(f"{path}: {' '.join(str(error).split())}") from None


def side_by_side(
    columns: Sequence[npt.NDArray[Any]], names: Sequence[str], where: str, first: int = 0
) -> npt.NDArray[Any]:
    """(n, d) rows of d columns; NumPy's own common type would round large integers silently.

    Raises `BadFile` for an integer beside doubles that none of them equals. `where` is said before
    its column and row; the first row is number `first`.
    """
    kind = np.result_type(*columns)
    if kind.kind == "f":
        for column, name in zip(columns, names):
            if column.dtype.kind in "iu" and column.dtype.itemsize == 8:
                _require_exact(column, f"{where}: column {name!r}", first)
    return np.column_stack(columns)


def _require_exact(column: npt.NDArray[Any], what: str, first: int) -> None:
    large = column > _ALL_EXACT
    if column.dtype.kind == "i":
        large |= column < -_ALL_EXACT
    if not large.any():
        return
    doubles = column.astype(np.float64)
    # the largest integers are rounded to a double beyond the type's range
    beyond = doubles >= 2.0 ** (63 if column.dtype.kind == "i" else 64)
    doubles[beyond] = 0
    wrong = np.flatnonzero(beyond | (doubles.astype(column.dtype) != column))
    if wrong.size:
        row = int(wrong[0])
        raise BadFile(
            f"{what}, row {first + row}: {column[row]} is a 64-bit integer that no double equals"
        )
