"""The base classes of those in SciPy's place: lazy attributes, incremental use, pickles."""

from __future__ import annotations

from collections.abc import Callable, Mapping
from typing import Any, ClassVar, Generic, TypeVar, overload

import numpy as np
import numpy.typing as npt

from .. import _core
from .._arguments import as_point_set, as_points
from .._errors import InvalidArgument

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


class Incremental:
    """The base class of those in SciPy's place: lazy attributes, incremental use, pickles."""

    ndim: int
    #: The names of the class's lazy attributes, which new rows invalidate and pickles leave out.
    _lazy: ClassVar[frozenset[str]]
    _open: bool
    _array: npt.NDArray[Any]
    #: The options of the computation.
    _choices: Mapping[str, Any]

    def __init_subclass__(cls, **options: Any) -> None:
        super().__init_subclass__(**options)
        cls._lazy = frozenset(
            name
            for kind in cls.__mro__
            for name, value in vars(kind).items()
            if isinstance(value, Lazy)
        )

    def _forget(self) -> None:
        """Discards the lazy attributes made so far."""
        for name in self._lazy:
            self.__dict__.pop(name, None)

    def __getstate__(self) -> dict[str, Any]:
        state = {k: v for k, v in self.__dict__.items() if k not in self._lazy}
        if callable(self._choices.get("progress")):  # a callback belongs to this process
            state["_choices"] = {**self._choices, "progress": None}
        return state

    def close(self) -> None:
        """Ends incremental use: nothing can be added afterwards. Leaving a ``with`` block does it.

        Examples
        --------
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
    """An `Incremental` whose rows are points."""

    #: What points are added to, in the error for points of another dimension.
    _target: ClassVar[str]

    def _take(self, points: Any, incremental: bool) -> npt.NDArray[Any]:
        """Checks the first points, sets `ndim` and returns the array to compute with."""
        array = as_point_set(points)
        count, self.ndim = array.shape
        if self.ndim < 2:
            raise InvalidArgument("Need at least 2-D data")
        if count == 0:
            raise InvalidArgument("No points given")
        self._open = bool(incremental)
        # The caller must not change points to which others will be added.
        return np.array(array, dtype=np.float64) if incremental else array

    def _compute(self, everything: npt.NDArray[Any], added: npt.NDArray[Any]) -> None:
        """Sets the result for `everything`, of which the rows `added`, the last ones, are new."""
        raise NotImplementedError

    def add_points(self, points: Any, restart: bool = False) -> None:
        """Adds points; only with ``incremental=True``.

        The result is that of all points at once, in whatever order they came.

        Parameters
        ----------
        points : (m, d) array
        restart : bool
            Compute a hull from all points instead of from its vertices and the new points; the
            result is the same. Triangulations and diagrams are always computed from all points.

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
            raise InvalidArgument(
                f"Adding points of dimension {array.shape[1]} to {self._target} of dimension "
                f"{self.ndim}"
            )
        everything = np.concatenate([self._array, array], dtype=np.float64)
        self._compute(everything, everything if restart else everything[len(self._array) :])

    @property
    def npoints(self) -> int:
        """Number of points."""
        return len(self._array)

    @Lazy
    def points(self) -> npt.NDArray[np.float64]:
        """(n, d) float64: the points."""
        return np.ascontiguousarray(self._array, dtype=np.float64)

    def _extreme(self) -> npt.NDArray[np.float64]:
        """Points of which some have the least and the largest coordinates."""
        return self.points

    @Lazy
    def _bounds(self) -> npt.NDArray[np.float64]:
        return _core.bounds(self._extreme())

    @Lazy
    def min_bound(self) -> npt.NDArray[np.float64]:
        """(d,) float64: the least coordinates."""
        bound: npt.NDArray[np.float64] = self._bounds[0]
        return bound

    @Lazy
    def max_bound(self) -> npt.NDArray[np.float64]:
        """(d,) float64: the largest coordinates."""
        bound: npt.NDArray[np.float64] = self._bounds[1]
        return bound
