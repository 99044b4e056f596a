"""Lists of varying length, end to end in one array."""

from __future__ import annotations

import contextlib
import gc
from collections.abc import Iterator, Sequence
from typing import Any, overload

import numpy as np
import numpy.typing as npt

from . import _core
from ._arguments import as_position
from ._compared import Compared


@contextlib.contextmanager
def collector_paused() -> Iterator[None]:
    """For making many lists, none of them in a cycle: while they come, the garbage collector would
    look through all of them again and again, three quarters of the time for 300,000."""
    if not gc.isenabled():
        yield
        return
    gc.disable()
    try:
        yield
    finally:
        gc.enable()


def first_places(numbers: npt.NDArray[Any], count: int) -> npt.NDArray[np.intp]:
    """Where each number below `count` comes first in an array; -1 for one that does not."""
    first = np.full(count, -1, dtype=np.intp)
    first[numbers[::-1]] = np.arange(len(numbers))[::-1]  # of several NumPy keeps the last
    return first


class Lists(Compared, Sequence[npt.NDArray[Any]]):
    """A sequence of integer arrays: ``lists[i]`` is ``items[offsets[i]:offsets[i + 1]]``, a view.

    Parameters
    ----------
    offsets : (n + 1,) int64 array
        Ascending from 0: where each list begins, and where the last ends. An attribute.
    items : (offsets[-1],) integer array
        The lists, end to end. An attribute.

    Raises
    ------
    IndexError
        For a list that is not there.

    Examples
    --------
    >>> import cullhull, numpy as np
    >>> lists = cullhull.Lists(np.array([0, 2, 5]), np.array([7, 8, 1, 2, 3]))
    >>> lists[1], len(lists), lists.lengths()
    (array([1, 2, 3]), 2, array([2, 3]))
    """

    __slots__ = ("items", "offsets")

    def __init__(self, offsets: npt.NDArray[np.int64], items: npt.NDArray[Any]) -> None:
        self.offsets = offsets
        self.items = items

    def _parts(self) -> tuple[Any, ...]:
        return self.offsets, self.items

    def __len__(self) -> int:
        return len(self.offsets) - 1

    @overload
    def __getitem__(self, i: int) -> npt.NDArray[Any]: ...
    @overload
    def __getitem__(self, i: slice) -> list[npt.NDArray[Any]]: ...
    def __getitem__(self, i: int | slice) -> npt.NDArray[Any] | list[npt.NDArray[Any]]:
        if isinstance(i, slice):
            return [self[j] for j in range(*i.indices(len(self)))]
        at = as_position(i, len(self), "list")
        return self.items[self.offsets[at] : self.offsets[at + 1]]

    def __iter__(self) -> Iterator[npt.NDArray[Any]]:
        for i in range(len(self)):
            yield self.items[self.offsets[i] : self.offsets[i + 1]]

    def lengths(self) -> npt.NDArray[np.int64]:
        """The length of every list.

        Returns
        -------
        (n,) int64 array

        >>> import cullhull, numpy as np
        >>> cullhull.Lists(np.array([0, 2, 5]), np.arange(5)).lengths()
        array([2, 3])
        """
        return np.diff(self.offsets)

    def tolist(self) -> list[list[int]]:
        """Plain Python lists of int.

        >>> import cullhull, numpy as np
        >>> cullhull.Lists(np.array([0, 2, 5]), np.arange(5)).tolist()
        [[0, 1], [2, 3, 4]]
        """
        if self.items.dtype == np.int32 and len(self) > 0:
            # The lists share the integers, which otherwise take a third of their memory.
            numbers = list(range(min(len(self.items), int(self.items.max(initial=-1)) + 1)))
            offsets = np.ascontiguousarray(self.offsets, dtype=np.int64)
            with collector_paused():
                return _core.nested_lists(offsets, np.ascontiguousarray(self.items), numbers)
        items: list[int] = self.items.tolist()
        ends: list[int] = self.offsets.tolist()
        with collector_paused():
            return [items[begin:end] for begin, end in zip(ends, ends[1:])]

    def __repr__(self) -> str:
        return f"<Lists: {len(self)} lists, {len(self.items)} items>"
