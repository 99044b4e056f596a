"""From what users pass to what the extension module reads: arrays in place, settings checked."""

from __future__ import annotations

import operator
from collections.abc import Callable
from typing import Any, Union

import numpy as np
import numpy.typing as npt

from . import _core
from ._errors import BackendUnavailable, InvalidArgument

#: ``progress=``: False or None for none, True for a tqdm bar, or a function of (phase, share).
Progress = Union[bool, None, Callable[[str, float], object]]

#: Scalar types that are read where they lie; every value of each is exactly a double.
IN_PLACE = frozenset("?bBhHiIfd")
_DLPACK_HOST = (1, 3, 11)  # CPU, and host memory pinned by CUDA or ROCm


def as_points(points: Any, what: str = "points", *, axes: int = 2) -> npt.NDArray[Any]:
    """``points`` as an array the extension reads in place; converted only where it must be.

    Booleans, integers up to 32 bits, float32 and float64 in native byte order are not copied,
    whatever their strides. 64-bit integers and other byte orders are converted to doubles, if that
    is exact; float16 to float32.
    """
    array = points if type(points) is np.ndarray else _from_anything(points, what)
    if array.ndim != axes:
        raise InvalidArgument(f"`{what}` should be a {axes}D array, not {array.ndim}D")
    dtype = array.dtype
    if dtype.char in IN_PLACE and dtype.isnative:
        return array
    return _converted(array, what)


def _from_anything(points: Any, what: str) -> npt.NDArray[Any]:
    if isinstance(points, np.ma.MaskedArray):
        raise InvalidArgument(f"`{what}` cannot be a masked array; pass array.compressed() or so")
    if isinstance(points, np.ndarray):
        return points.view(np.ndarray)
    if hasattr(points, "__cuda_array_interface__"):
        raise _device_memory(what)
    if hasattr(points, "__dlpack_device__") and not hasattr(points, "__array_interface__"):
        device, _ = points.__dlpack_device__()
        if device not in _DLPACK_HOST:
            raise _device_memory(what)
        return np.from_dlpack(points)
    try:
        return np.asarray(points)
    except ValueError as error:  # rows of different lengths
        raise InvalidArgument(f"`{what}` is no rectangular array: {error}") from None


def _device_memory(what: str) -> BackendUnavailable:
    return BackendUnavailable(
        f"`{what}` is in a device's memory, which only convex_hull and cull read; "
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


def as_questions(points: Any, dimension: int, what: str) -> tuple[npt.NDArray[Any], bool]:
    """Rows to ask about, and whether it was a single one: shape (d,) instead of (m, d)."""
    array = points if type(points) is np.ndarray else _from_anything(points, what)
    single = array.ndim == 1
    if single:
        array = array[np.newaxis, :]
    array = as_points(array, what)
    if array.shape[1] != dimension:
        raise InvalidArgument(
            f"the hull has dimension {dimension}, `{what}` has {array.shape[1]} coordinates"
        )
    return array, single


def settings(
    *,
    backend: str = "auto",
    cull: str = "auto",
    threads: int | None = None,
    memory_budget: int | None = None,
    progress: Progress = None,
) -> _core.Settings:
    """Checks the options every long function takes."""
    for name, value in (("backend", backend), ("cull", cull)):
        if not isinstance(value, str):
            raise TypeError(f"{name} must be a string, not {type(value).__name__}")
    return _core.Settings(
        backend,
        cull,
        _count(threads, "threads", 1024),
        _count(memory_budget, "memory_budget", 2**63 - 1),
        as_callback(progress),
    )


def _count(value: int | None, name: str, limit: int) -> int:
    if value is None:
        return 0
    number = operator.index(value)
    if not 0 <= number <= limit:
        raise InvalidArgument(f"{name} must be between 0 and {limit}, not {number}")
    return number


def as_callback(progress: Progress) -> Callable[[str, float], object] | None:
    if progress is None or progress is False:
        return None
    if progress is True:
        return _bar()
    if not callable(progress):
        raise TypeError("progress must be True, False, None or a function of (phase, share)")
    return progress


def _bar() -> Callable[[str, float], object]:
    try:
        from tqdm.auto import tqdm
    except ImportError:
        raise ImportError(
            "progress=True draws its bar with tqdm, which is not installed; "
            "pip install tqdm, or pass a function of (phase, share)"
        ) from None
    bar = tqdm(total=1.0, bar_format="{desc}: {percentage:3.0f}%|{bar}| {elapsed}")

    def show(phase: str, share: float) -> None:
        bar.set_description_str(phase, refresh=False)
        bar.n = min(max(share, 0.0), 1.0)
        bar.refresh()

    return show  # the bar closes when the call lets go of this
