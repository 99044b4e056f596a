"""Lists of varying length, end to end in one array."""

from __future__ import annotations

import operator
from collections.abc import Iterator, Sequence
from typing import Any, overload

import numpy as np
import numpy.typing as npt


def ids(numbers: npt.NDArray[Any]) -> npt.NDArray[np.int64]:
    """The same memory as NumPy's own int64: buffers say "long long", which prints differently."""
    return numbers.view(np.int64)


class Lists(Sequence[npt.NDArray[Any]]):
    """A sequence of integer arrays: ``lists[i]`` is ``items[offsets[i]:offsets[i + 1]]``, a view.

    Attributes
    ----------
    offsets : (n + 1,) int64 array
    items : (offsets[-1],) integer array
    """

    __slots__ = ("items", "offsets")

    def __init__(self, offsets: npt.NDArray[np.int64], items: npt.NDArray[Any]) -> None:
        self.offsets = offsets
        self.items = items

    def __len__(self) -> int:
        return len(self.offsets) - 1

    @overload
    def __getitem__(self, i: int) -> npt.NDArray[Any]: ...
    @overload
    def __getitem__(self, i: slice) -> list[npt.NDArray[Any]]: ...
    def __getitem__(self, i: int | slice) -> npt.NDArray[Any] | list[npt.NDArray[Any]]:
        if isinstance(i, slice):
            return [self[j] for j in range(*i.indices(len(self)))]
        at = operator.index(i)
        if at < 0:
            at += len(self)
        if not 0 <= at < len(self):
            raise IndexError(f"list {i} of {len(self)}")
        view: npt.NDArray[Any] = self.items[self.offsets[at] : self.offsets[at + 1]]
        return view

    def __iter__(self) -> Iterator[npt.NDArray[Any]]:
        for i in range(len(self)):
            yield self.items[self.offsets[i] : self.offsets[i + 1]]

    def lengths(self) -> npt.NDArray[np.int64]:
        """The length of every list, (n,) int64."""
        return np.diff(self.offsets)

    def tolist(self) -> list[list[int]]:
        """Plain Python lists."""
        return [part.tolist() for part in self]

    def __repr__(self) -> str:
        return f"<Lists: {len(self)} lists, {len(self.items)} items>"
