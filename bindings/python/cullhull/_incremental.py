"""What the classes share that stand in for SciPy's: attributes made when asked for, close()."""

from __future__ import annotations

from collections.abc import Callable, Iterable
from typing import Any, Generic, TypeVar, overload

import numpy as np
import numpy.typing as npt

from ._arguments import as_point_set, as_points
from ._errors import InvalidArgument

T = TypeVar("T")


class Lazy(Generic[T]):
    """An attribute made when first asked for and then the object's own, to be read and replaced.

    As functools.cached_property, without its lock, which takes longer than many of these.
    """

    def __init__(self, make: Callable[[Any], T]) -> None:
        self._make = make
        self._name = make.__name__
        self.__doc__ = make.__doc__

    @overload
    def __get__(self, owner: None, kind: Any = None) -> Lazy[T]: ...
    @overload
    def __get__(self, owner: object, kind: Any = None) -> T: ...
    def __get__(self, owner: Any, kind: Any = None) -> Any:
        if owner is None:
            return self
        value = owner.__dict__[self._name] = self._make(owner)
        return value


def lazy_names(kind: type) -> frozenset[str]:
    return frozenset(name for name, value in vars(kind).items() if isinstance(value, Lazy))


class Incremental:
    """Of a class that something may be added to until close()."""

    _open: bool

    def close(self) -> None:
        """Ends incremental use; nothing can be added any more.

        >>> import cullhull
        >>> with cullhull.ConvexHull([[0, 0], [1, 0], [0, 1]], incremental=True) as hull:
        ...     hull.add_points([[1, 1]])
        >>> hull.volume
        1.0
        """
        self._open = False

    def _require_open(self) -> None:
        if not self._open:
            raise RuntimeError("incremental mode not enabled or already closed")

    def __enter__(self) -> Any:
        return self

    def __exit__(self, *exception: object) -> None:
        self.close()


class IncrementalPoints(Incremental):
    """Of one that points may be added to."""

    _array: npt.NDArray[Any]
    _choices: tuple[Any, ...]  # of the call; the last one is ``progress``
    ndim: int
    #: What points are added to, in the message for ones of another dimension.
    _added_to = "ones"

    def add_points(self, points: Any, restart: bool = False) -> None:
        """Adds points; only with ``incremental=True``.

        The result is that of all points at once.

        Parameters
        ----------
        points : (m, d) array
        restart : bool
            Compute it anew; the result is the same.

        Raises
        ------
        RuntimeError
            Not incremental, or closed.
        InvalidArgument, NotFinite (ValueErrors), QhullError
            As for the first points; nothing is added then.

        Examples
        --------
        >>> import cullhull
        >>> hull = cullhull.ConvexHull([[0, 0], [1, 0], [0, 1]], incremental=True)
        >>> hull.add_points([[1, 1]])
        >>> hull.volume, hull.npoints
        (1.0, 4)
        """
        self._require_open()
        array = as_points(points)
        if array.shape[1] != self.ndim:
            there = f"{self._added_to} of dimension {self.ndim}"
            raise InvalidArgument(f"Adding points of dimension {array.shape[1]} to {there}")
        self._extend(np.concatenate([self._array, array], dtype=np.float64), restart)

    def _first(self, points: Any) -> npt.NDArray[Any]:
        """The points of the constructor, and their dimension."""
        array = as_point_set(points)
        count, self.ndim = array.shape
        if self.ndim < 2:
            raise InvalidArgument("Need at least 2-D data")
        if count == 0:
            raise InvalidArgument("No points given")
        return array

    def _extend(self, everything: npt.NDArray[Any], restart: bool) -> None:
        """Computes the result of the points there are and of others behind them."""
        raise NotImplementedError

    def _state_without(self, names: Iterable[str]) -> dict[str, Any]:
        """What a pickle holds: all but these attributes, and no function of this process."""
        state = {k: v for k, v in self.__dict__.items() if k not in names}
        if callable(self._choices[-1]):
            state["_choices"] = (*self._choices[:-1], None)
        return state
