"""From what users pass to what the extension module reads: arrays in place, numbers checked."""

from __future__ import annotations

import operator
import os
import sys
from collections.abc import Iterable
from typing import Any

import numpy as np
import numpy.typing as npt

from ._errors import BackendUnavailable, InvalidArgument, NotFinite, ShapeWarning, warn
from .geo._foreign_points import as_foreign, of_geometries

#: Types that are read in place; all their values are doubles. Windows' int32 is C's long.
IN_PLACE = frozenset("?bBhHiIfd" + ("lL" if np.dtype("l").itemsize == 4 else ""))
_DOUBLE = np.dtype(np.float64)
_DLPACK_HOST = (1, 3, 11)  # CPU, and host memory pinned by CUDA or ROCm


def as_points(points: Any, what: str = "points", *, axes: int = 2) -> npt.NDArray[Any]:
    """``points`` as an array the extension reads in place; converted only where it must be.

    Booleans, integers up to 32 bits, float32 and float64 in native byte order are not copied,
    whatever their strides. 64-bit integers and other byte orders are converted to doubles, if that
    is exact; float16 to float32.
    """
    array = points if type(points) is np.ndarray else as_array(points, what)
    if array.ndim != axes and array.dtype == object:
        array = as_array(array, what)  # of geometries, perhaps
    if array.ndim != axes:
        if isinstance(points, (str, os.PathLike)):
            raise InvalidArgument(f"`{what}` is a path; read its points first: cullhull.read(path)")
        if array.ndim == 0 and array.dtype == object:  # no array at all
            kind = type(points).__name__
            raise InvalidArgument(f"`{what}` should be a {axes}D array, not of type {kind}")
        raise wrong_axes(what, axes, array.ndim)
    dtype = array.dtype
    if dtype.char in IN_PLACE and dtype.isnative:
        return array
    return _converted(array, what)


def is_doubles(array: Any) -> bool:
    """Whether it is a plain array of doubles, which needs no conversion."""
    return type(array) is np.ndarray and array.dtype == _DOUBLE


def refuse_mask(array: Any, what: str) -> None:
    """Raises for a masked array, whose mask NumPy's functions would drop."""
    masked = sys.modules.get("numpy.ma")  # not imported: nobody has one, and importing takes 7 ms
    if masked is not None and isinstance(array, masked.MaskedArray):
        raise InvalidArgument(
            f"`{what}` cannot be a masked array: leave masked rows out and pass array.data"
        )


def as_coordinates(points: Any, what: str = "points") -> npt.NDArray[np.float64]:
    """Coordinates of any shape as doubles; converted only where that is exact, as `as_points`."""
    array = as_array(points, what)
    if not (array.dtype.char in IN_PLACE and array.dtype.isnative):
        array = _converted(array, what)
    return np.asarray(array, dtype=np.float64)


def wrong_axes(what: str, axes: int, found: int) -> InvalidArgument:
    """The error for an array of `found` axes, in words that programs match SciPy's by."""
    return InvalidArgument(f"`{what}` should be a {axes}D array; its number of dimensions is {found}")


def as_point_set(points: Any) -> npt.NDArray[Any]:
    """As `as_points`, with a warning where the array looks as if it lay on its side."""
    array = as_points(points)
    n, d = array.shape
    if n < d and n > 1 and d > 8:  # a simplex at most: nobody asks for that on purpose
        warn(f"{n} points in {d}D: did you mean points.T?", ShapeWarning)
    return array


def as_array(points: Any, what: str) -> npt.NDArray[Any]:
    """An array of what users hold numbers in, of any shape and type; a masked one raises."""
    refuse_mask(points, what)
    found = as_foreign(points, what)
    if found is not None:
        points = found
    if isinstance(points, np.ndarray):
        array = points.view(np.ndarray)
        return _without_objects(array, what) if array.dtype == object else array
    if hasattr(points, "__cuda_array_interface__"):
        raise _device_memory(what)
    if hasattr(points, "__dlpack_device__") and not hasattr(points, "__array_interface__"):
        device, _ = points.__dlpack_device__()
        if device not in _DLPACK_HOST:
            raise _device_memory(what)
        return _from_dlpack(points, what)
    columns = _columns(points)
    if columns is not None:
        return _from_columns(columns, what)
    try:
        array = np.asarray(points)
    except ValueError as error:  # rows of different lengths
        raise InvalidArgument(f"`{what}` is no rectangular array: {error}") from None
    return _without_objects(array, what) if array.dtype == object else array


def _from_dlpack(points: Any, what: str) -> npt.NDArray[Any]:
    """An array over the memory of another package's; what cannot be one raises one line."""
    try:
        return np.from_dlpack(points)
    except BufferError as error:  # a tensor that requires a gradient or is sparse, say
        raise InvalidArgument(f"`{what}`: {error}") from None
    except RuntimeError:  # NumPy's: bfloat16, say
        kind = getattr(points, "dtype", type(points).__name__)
        raise TypeError(f"`{what}` of type {kind} is not readable by NumPy; convert it first") from None


def _without_objects(array: npt.NDArray[Any], what: str) -> npt.NDArray[Any]:
    """The coordinates of an array of Shapely's points; other objects are refused later."""
    found = of_geometries(array, what)
    return array if found is None else found


def _columns(frame: Any) -> list[tuple[Any, Any]] | None:
    """Names and columns of a data frame whose columns are not plain NumPy arrays of one type."""
    if hasattr(frame, "iloc") and hasattr(frame, "columns"):  # pandas
        dtypes = list(frame.dtypes)
        if dtypes and isinstance(dtypes[0], np.dtype) and all(t == dtypes[0] for t in dtypes):
            return None
        return [(name, frame.iloc[:, i]) for i, name in enumerate(frame.columns)]
    if hasattr(frame, "get_columns"):  # Polars
        return [(column.name, column) for column in frame.get_columns()]
    if hasattr(frame, "itercolumns") and hasattr(frame, "column_names"):  # a table of Arrow's
        return list(zip(frame.column_names, frame.itercolumns()))
    return None


def _from_columns(columns: Iterable[tuple[Any, Any]], what: str) -> npt.NDArray[Any]:
    """Each column by itself, so that no common type rounds one; a missing value raises."""
    parts = []
    for name, column in columns:
        absent = np.asarray(column.isna() if hasattr(column, "isna") else column.is_null())
        if absent.any():
            raise NotFinite(f"`{what}`: row {int(absent.argmax())} of column {name!r} is missing")
        values = np.asarray(column)
        if values.dtype.kind == "O":  # what pandas keeps numbers with a mask as
            values = np.asarray(values.tolist())
        if not (values.dtype.char in IN_PLACE and values.dtype.isnative):
            values = _converted(values, f"{what}[{name!r}]")
        parts.append(values)
    if not parts:
        raise InvalidArgument(f"`{what}` has no columns")
    return np.column_stack(parts)  # a type that holds each: none has more bits than a double


def _device_memory(what: str) -> BackendUnavailable:
    return BackendUnavailable(
        f"`{what}` is in a device's memory, which this function does not read; "
        "copy it to the host first (cupy.asnumpy(x), x.cpu())"
    )


def _converted(array: npt.NDArray[Any], what: str) -> npt.NDArray[Any]:
    dtype = array.dtype
    if dtype.kind == "f" and dtype.itemsize == 2:
        return array.astype(np.float32)
    if dtype.kind not in "iuf":
        raise TypeError(
            f"`{what}` must be real numbers (booleans, integers, floats), not {dtype}"
            + ("; convert it with array.astype(float)" if dtype.kind == "O" else "")
        )
    with np.errstate(over="ignore"):
        doubles = array.astype(np.float64)
    if dtype.itemsize > 4 and dtype.newbyteorder("=") != np.float64:
        _require_exact(array, doubles, what)
    return doubles


def _require_exact(array: npt.NDArray[Any], doubles: npt.NDArray[Any], what: str) -> None:
    """Raises unless every value survived: only integers beyond 2**53 and long doubles may not."""
    if array.size == 0:
        return
    if array.dtype.kind in "iu":
        if -(2**53) <= int(array.min()) and int(array.max()) <= 2**53:
            return
        back = [int(x) for x in doubles.flat]
        exact = back == array.ravel().tolist()
    else:
        exact = bool(np.array_equal(array, doubles.astype(array.dtype), equal_nan=True))
    if not exact:
        raise InvalidArgument(
            f"`{what}` of type {array.dtype} has values that no double holds exactly; "
            "round them with array.astype(float) if that is what you want"
        )


def as_questions(
    points: Any, dimension: int, what: str, whose: str = "hull"
) -> tuple[npt.NDArray[Any], bool]:
    """Rows to ask about, and whether it was a single one: shape (d,) instead of (m, d)."""
    array = points
    if type(points) is not np.ndarray or points.dtype.hasobject:
        array = as_array(points, what)
    single = array.ndim == 1
    if single:
        array = array[np.newaxis, :]
    array = as_points(array, what)
    if array.shape[1] != dimension:
        raise InvalidArgument(
            f"the {whose} has dimension {dimension}, `{what}` has {array.shape[1]} coordinates"
        )
    return array, single


def as_count(value: Any, name: str, *, least: int = 0, most: int = 2**63 - 1) -> int:
    """An integer that the extension takes, or one line that says what is wrong with it."""
    number = operator.index(value)
    if number < 0:
        raise InvalidArgument(f"{name} must not be negative, and is {number}")
    if not least <= number <= most:
        raise InvalidArgument(f"{name} must be between {least} and {most}, not {number}")
    return number


def as_position(i: Any, length: int, what: str) -> int:
    """A sequence's index, counted from its end where negative, in [0, length)."""
    at = operator.index(i)
    if at < 0:
        at += length
    if not 0 <= at < length:
        raise IndexError(f"{what} {i} of {length}")
    return at
