"""What can go wrong, as exceptions that are also the built-in ones a Python user expects."""

from __future__ import annotations

from typing import Any


class Error(Exception):
    """Base of all errors the library reports."""


class InvalidArgument(Error, ValueError):
    """An argument that makes no sense: a wrong shape, an unknown option, an empty hull."""


class NotFinite(Error, ValueError):
    """A NaN or an infinity among the coordinates; the message names the first bad point."""


class BadFile(Error, ValueError):
    """A file that cannot be read as what it claims to be."""


class FileError(Error, OSError):
    """The operating system refused: no such folder, no permission, disk full."""


class OutOfBudget(Error, MemoryError):
    """The result would exceed the memory budget (see ``memory_budget``)."""


class BackendUnavailable(Error, RuntimeError):
    """The backend asked for is not in this build or not on this machine."""


class Cancelled(Error, RuntimeError):
    """The work was stopped."""


class NotCertified(Error, RuntimeError):
    """``certify=True`` found the result wrong: always a bug of ours, please report it."""


class InternalError(Error, RuntimeError):
    """A broken invariant: always a bug of ours, please report it."""


_qhull_error: type[Exception] | None = None


def qhull_error() -> type[Exception]:
    """``cullhull.QhullError``: a subclass of ``scipy.spatial.QhullError`` where SciPy is installed.

    Made when first asked for, because importing SciPy takes longer than most hulls.
    """
    global _qhull_error
    if _qhull_error is None:
        base: Any = RuntimeError
        try:
            import scipy.spatial

            base = scipy.spatial.QhullError
        except ImportError:
            pass
        _qhull_error = type(
            "QhullError",
            (Error, base),
            {
                "__module__": "cullhull",
                "__doc__": "What SciPy reports with its error of the same name: flat input with "
                "``strict=True``, an interior point that is not inside.",
            },
        )
    return _qhull_error
