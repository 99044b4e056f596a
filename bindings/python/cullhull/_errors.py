"""What can go wrong, as exceptions that are also the built-in ones a Python user expects."""

from __future__ import annotations

import sys
import warnings
from typing import Any


class Error(Exception):
    """Base of all errors the library reports.

    >>> import cullhull
    >>> try:
    ...     cullhull.convex_hull([[0.0, 1.0], [float("nan"), 2.0]])
    ... except cullhull.Error as error:
    ...     type(error).__name__, isinstance(error, ValueError)
    ('NotFinite', True)
    """


class InvalidArgument(Error, ValueError):
    """An argument that makes no sense: a wrong shape, an unknown option, an empty hull.

    >>> import cullhull
    >>> cullhull.generate("ball", -1)
    Traceback (most recent call last):
        ...
    cullhull.InvalidArgument: count must not be negative, and is -1
    """


class NotFinite(Error, ValueError):
    """A NaN, an infinity or a missing value among the coordinates; the message names the first.

    >>> import cullhull
    >>> try:
    ...     cullhull.convex_hull([[0.0, 1.0], [float("inf"), 2.0]])
    ... except ValueError as error:
    ...     print(error)
    point 1, coordinate 0 is infinite; remove or repair such points first
    """


class BadFile(Error, ValueError):
    """A file that cannot be read as what it claims to be, or a format that cannot be written.

    >>> import cullhull
    >>> try:
    ...     cullhull.convex_hull([[0, 0], [1, 0], [0, 1]]).save("hull.docx")
    ... except ValueError as error:
    ...     isinstance(error, cullhull.Error)
    True
    """


class FileError(Error, OSError):
    """The operating system refused: no such folder, no permission, disk full.

    >>> import cullhull
    >>> try:
    ...     cullhull.convex_hull([[0, 0], [1, 0], [0, 1]]).save("/no/such/folder/hull.ply")
    ... except OSError as error:
    ...     isinstance(error, cullhull.FileError)
    True
    """


class OutOfBudget(Error, MemoryError):
    """The result would exceed the memory budget (see ``memory_budget``).

    >>> import cullhull
    >>> try:
    ...     cullhull.convex_hull(cullhull.generate("sphere", 100_000), memory_budget=1000)
    ... except MemoryError as error:
    ...     isinstance(error, cullhull.OutOfBudget)
    True
    """

    def __new__(cls, *words: object) -> OutOfBudget:
        # MemoryError.__new__ refuses a class with a second base; unpickling by tblib calls it.
        return Error.__new__(cls, *words)


class BackendUnavailable(Error, RuntimeError):
    """The backend asked for is not in this build or not on this machine; `cuda_status` says why.

    >>> import cullhull
    >>> if not cullhull.cuda_status()["available"]:
    ...     try:
    ...         cullhull.convex_hull([[0, 0], [1, 0], [0, 1]], backend="cuda")
    ...     except cullhull.BackendUnavailable as error:
    ...         assert str(error)
    """


class Cancelled(Error, RuntimeError):
    """The work was stopped, by other means than an exception of the caller's own.

    Ctrl-C is ``KeyboardInterrupt``, and what a ``progress`` callback raises comes out as it is.

    >>> import cullhull
    >>> issubclass(cullhull.Cancelled, RuntimeError)
    True
    """


class NotCertified(Error, RuntimeError):
    """``certify=True`` found the result wrong: always a bug of ours, please report it.

    >>> import cullhull
    >>> issubclass(cullhull.NotCertified, cullhull.Error)
    True
    """


class InternalError(Error, RuntimeError):
    """A broken invariant: always a bug of ours, please report it.

    >>> import cullhull
    >>> issubclass(cullhull.InternalError, cullhull.Error)
    True
    """


class OptionWarning(UserWarning):
    """A Qhull option that has no effect on an exact hull, where Qhull's own results would differ.

    One for all such options of a call. To silence it:

    >>> import cullhull, warnings
    >>> warnings.simplefilter("ignore", cullhull.OptionWarning)
    >>> cullhull.ConvexHull([[0, 0], [1, 0], [0, 1]], qhull_options="QJ").volume
    0.5
    """


class ShapeWarning(UserWarning):
    """Fewer points than coordinates, and many of these: perhaps the array should be transposed. Or
    what `read` chose or passed over in a file without having been asked to.

    >>> import cullhull, warnings
    >>> with warnings.catch_warnings(record=True) as told:
    ...     warnings.simplefilter("always")
    ...     _ = cullhull.convex_hull(cullhull.generate("ball", 200, 3).T)
    >>> print(told[0].message)
    3 points in 200D: did you mean points.T?
    """


for _kind in [*globals().values()]:
    if isinstance(_kind, type) and issubclass(_kind, Exception):
        _kind.__module__ = "cullhull"  # where they are looked for, and shown in tracebacks


def warn(message: str, category: type[Warning]) -> None:
    """Warns at the line that called the package; Python's filters then show it once a line."""
    frame = sys._getframe(1)
    level = 2
    while frame.f_back is not None and _is_ours(frame.f_globals.get("__name__", "")):
        frame = frame.f_back
        level += 1
    warnings.warn(message, category, stacklevel=level)


def _is_ours(module: str) -> bool:
    return module == "cullhull" or module.startswith("cullhull.")


_qhull_error: type[Exception] | None = None
_QHULL_ERROR = """What SciPy reports with its error of the same name.

Flat input with ``strict=True``, an interior point that is not inside. A subclass of
``scipy.spatial.QhullError`` where SciPy is installed.

>>> import cullhull
>>> try:
...     cullhull.ConvexHull([[0, 0], [1, 1], [2, 2]], strict=True)
... except cullhull.QhullError as error:
...     print(str(error)[:53])
QH6154 Qhull precision error: Initial simplex is flat
"""


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
        named = {"__module__": "cullhull", "__doc__": _QHULL_ERROR}
        _qhull_error = type("QhullError", (Error, base), named)
    return _qhull_error
