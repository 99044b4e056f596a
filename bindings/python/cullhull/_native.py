"""What the classes share that wrap a native result."""

from __future__ import annotations

from typing import Any, ClassVar, TypeVar

from . import _core
from ._compared import Compared

Certificate = _core.Certificate
M = TypeVar("M", bound="Made")
C = TypeVar("C", bound="Certified")


class Made:
    """Base of what functions make, and nobody by a call of the class."""

    __slots__ = ()

    _made_by: ClassVar[str]
    _made_of: ClassVar[tuple[str, ...]]  # the slots that `_of` fills

    def __init__(self) -> None:
        raise TypeError(self._made_by)

    @classmethod
    def _of(cls: type[M], *parts: Any) -> M:
        result = object.__new__(cls)
        for slot, part in zip(cls._made_of, parts):
            setattr(result, slot, part)
        return result


class Native(Made, Compared):
    """Base of results that nobody can change: copies share what they are made of."""

    __slots__ = ("__weakref__",)

    def __copy__(self) -> Any:
        return self._of(*(getattr(self, slot) for slot in self._made_of))

    def __deepcopy__(self, memo: Any) -> Any:
        return self.__copy__()


class Certified(Native):
    """One that may have been checked."""

    __slots__ = ("certificate",)

    #: What ``certify=True`` found, else None.
    certificate: Certificate | None

    @classmethod
    def _of(cls: type[C], native: Any, certificate: Certificate | None = None) -> C:
        result = object.__new__(cls)
        setattr(result, cls._made_of[0], native)
        result.certificate = certificate
        return result
