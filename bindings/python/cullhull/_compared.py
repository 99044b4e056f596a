"""Equality of results: by what they consist of, not by where they are stored."""

from __future__ import annotations

from collections.abc import Sequence
from typing import Any

import numpy as np


def alike(mine: Sequence[Any], theirs: Sequence[Any]) -> bool:
    """Whether two lists of arrays and other values are equal, one by one."""
    return len(mine) == len(theirs) and all(map(_same, mine, theirs))


def _same(a: Any, b: Any) -> bool:
    if a is b:
        return True
    if isinstance(a, np.ndarray) or isinstance(b, np.ndarray):
        return np.array_equal(a, b)
    if isinstance(a, (list, tuple)) and isinstance(b, (list, tuple)):
        return alike(a, b)
    return bool(a == b)


class Compared:
    """Two results are equal if they are of one class and consist of the same numbers.

    Times, statistics and certificates do not count. Equal results have the same hash.
    """

    __slots__ = ()

    def _parts(self) -> tuple[Any, ...]:
        """Arrays and other values that everything else follows from."""
        raise NotImplementedError

    def __eq__(self, other: object) -> bool:
        if type(other) is not type(self):
            return NotImplemented
        return self is other or alike(self._parts(), other._parts())

    def __hash__(self) -> int:
        return hash((type(self), *map(_key, self._parts())))


def _key(part: Any) -> Any:
    """The shape of an array: the same for equal arrays, and quickly found."""
    if isinstance(part, np.ndarray):
        return part.shape
    return tuple(map(_key, part)) if isinstance(part, (list, tuple)) else part


def tuples_equal(mine: tuple[Any, ...], other: object) -> Any:
    """``==`` of a named tuple with arrays."""
    if not isinstance(other, tuple) or type(other) is not type(mine):
        return NotImplemented
    return alike(mine, other)


def tuples_differ(mine: tuple[Any, ...], other: object) -> Any:
    """``!=`` of a named tuple with arrays."""
    if not isinstance(other, tuple) or type(other) is not type(mine):
        return NotImplemented
    return not alike(mine, other)
