"""What the classes share that wrap a native result."""

from __future__ import annotations

from typing import Any, ClassVar, TypeVar

from . import _core
from ._compared import Compared

Certificate = _core.Certificate
C = TypeVar("C", bound="Certified")


class Native(Compared):
    """Base of results that a function makes and nobody can change: copies share them."""

    __slots__ = ("__weakref__",)

    _made_by: ClassVar[str]

    def __init__(self) -> None:
        raise TypeError(self._made_by)

    def __copy__(self) -> Any:
        raise NotImplementedError

    def __deepcopy__(self, memo: Any) -> Any:
        return self.__copy__()


class Certified(Native):
    """One that may have been checked."""

    __slots__ = ("certificate",)

    _slot: ClassVar[str]  # that of the native result
    #: What ``certify=True`` found, else None.
    certificate: Certificate | None

    @classmethod
    def _of(cls: type[C], native: Any, certificate: Certificate | None = None) -> C:
        result = object.__new__(cls)
        setattr(result, cls._slot, native)
        result.certificate = certificate
        return result

    def __copy__(self) -> Any:
        return self._of(getattr(self, self._slot), self.certificate)
