"""What the classes share that stand in for SciPy's: attributes made when asked for, close()."""

from __future__ import annotations

from collections.abc import Callable
from typing import Any, Generic, TypeVar, overload

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
    """What both classes share: points may be added until close()."""

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
