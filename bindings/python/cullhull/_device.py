"""Arrays in a CUDA device's memory (CuPy, PyTorch, Numba, JAX): read where they lie, and results."""

from __future__ import annotations

import operator
from typing import Any

from . import _core
from ._arguments import wrong_axes
from ._errors import BackendUnavailable, InvalidArgument
from ._native import Made

_DLPACK_CUDA = (2, 13)  # device and managed memory
_DTYPES = {"|b1": "bool", "|i1": "int8", "<i4": "int32", "<i8": "int64", "<f8": "float64"}
_LEGACY_DEFAULT_STREAM, _PER_THREAD_DEFAULT_STREAM = 1, 2  # as both protocols number them


def as_device_points(points: Any, *, sets: bool = False) -> _core.DevicePoints | None:
    """A view of ``points`` if they are in a CUDA device's memory, else None.

    They must be (n, d) float32 or float64, aligned; any strides. ``sets``: or (b, n, d), where the
    sets follow one another at equal steps; the view is then one of all their points.
    """
    if hasattr(points, "__array_interface__"):
        return None
    try:
        interface = getattr(points, "__cuda_array_interface__", None)
    except RuntimeError as error:  # PyTorch's, for a tensor that requires a gradient
        raise InvalidArgument(f"`points`: {error}") from None
    dlpack = (
        hasattr(points, "__dlpack_device__") and points.__dlpack_device__()[0] in _DLPACK_CUDA
    )
    # DLPack orders its maker's work before ours. The interface does so only where it names a stream:
    # else all work of the device would have to be waited for.
    if interface is not None and not (dlpack and _names_no_stream(interface)):
        return _from_interface(_of_sets(interface) if sets else interface, points)
    if dlpack:
        status = _core.cuda_status()
        if not status["available"]:
            raise BackendUnavailable(f"points in a device's memory: {status['reason']}")
        view = _from_dlpack(points)
        if not sets and view.sets >= 0:
            raise wrong_axes("points", 2, 3)
        return view
    return None


def _names_no_stream(interface: Any) -> bool:
    return isinstance(interface, dict) and interface.get("stream") is None


def _of_sets(interface: Any) -> Any:
    """The interface of all points where it is one of sets of them, (b, n, d)."""
    shape = interface.get("shape") if isinstance(interface, dict) else None
    if not isinstance(shape, tuple) or len(shape) != 3:
        return interface
    sets, size, dimension = _integers(shape, "shape")
    folded = {**interface, "shape": (sets * size, dimension)}
    if interface.get("strides") is not None:
        strides = _integers(interface["strides"], "strides")
        if len(strides) != 3:
            raise InvalidArgument(f"3 strides are needed, not {len(strides)}")
        if sets > 1 and size > 0 and strides[0] != size * strides[1]:
            raise InvalidArgument(
                "sets of points on a device must follow one another at equal steps"
            )
        folded["strides"] = strides[1:]
    return folded


def set_shape(points: Any, view: _core.DevicePoints) -> tuple[int, int] | None:
    """How many sets, and the points of each, where an array is (b, n, d); else None."""
    interface = getattr(points, "__cuda_array_interface__", None)
    if interface is not None:
        shape = interface["shape"]
        return (int(shape[0]), int(shape[1])) if len(shape) == 3 else None
    return (view.sets, view.set_size) if view.sets >= 0 else None


def as_device_offsets(offsets: Any) -> tuple[int, int] | None:
    """Address and number of int64 offsets in a device's memory, which are complete; else None."""
    interface = getattr(offsets, "__cuda_array_interface__", None)
    if interface is None:
        return None
    shape, strides = interface["shape"], interface.get("strides")
    if len(shape) != 1 or shape[0] == 0:
        raise InvalidArgument("`offsets` should be a list of at least one integer")
    if interface["typestr"] != "<i8" or strides not in (None, (8,)):
        raise TypeError("offsets on a device must be int64, one after another")
    address = operator.index(interface["data"][0])
    _core.wait_for_cuda_device_of(address)
    return address, operator.index(shape[0])


class DeviceArray(Made):
    """An array in a CUDA device's memory, of a `DeviceHull` or `DeviceHullBatch`, or answers.

    It has no arithmetic of its own: ``torch.as_tensor(a)`` or ``torch.from_dlpack(a)``,
    ``cupy.asarray(a)``, ``numba.cuda.as_cuda_array(a)`` and ``jax.dlpack.from_dlpack(a)`` view it
    without a copy. It is complete when the call returns, so a stream that reads it, whatever
    ``__dlpack__`` is told, need not wait.

    Examples
    --------
    >>> def fetched(array):
    ...     import cupy
    ...     return cupy.asnumpy(cupy.asarray(array))
    """

    __slots__ = ("_items",)

    _items: _core.DeviceItems
    _made_by = "device arrays are made by cullhull.convex_hulls_on_device and hulls"
    _made_of = ("_items",)

    @property
    def shape(self) -> tuple[int, ...]:
        """Its lengths along its axes; items lie row by row."""
        return tuple(self._items.shape)

    @property
    def dtype(self) -> str:
        """'int32' or 'int64'; of answers 'bool', 'int8' or 'float64'."""
        return _DTYPES[self._items.typestr]

    @property
    def device(self) -> int:
        """The number of the CUDA device."""
        return self._items.device

    @property
    def __cuda_array_interface__(self) -> dict[str, Any]:
        empty = 0 in self.shape
        return {
            "shape": self.shape,
            "typestr": self._items.typestr,
            "data": (0 if empty else self._items.data, False),
            "strides": None,
            "stream": None,
            "version": 3,
        }

    def __dlpack__(
        self,
        *,
        stream: Any = None,
        max_version: Any = None,
        dl_device: tuple[int, int] | None = None,
        copy: bool | None = None,
    ) -> Any:
        if dl_device is not None and tuple(dl_device) != self.__dlpack_device__():
            raise BufferError("it stays on its device")
        if copy:
            raise BufferError("it is viewed, not copied")
        return self._items.dlpack()  # a capsule of the first version, which all take

    def __dlpack_device__(self) -> tuple[int, int]:
        return _DLPACK_CUDA[0], self.device

    def __len__(self) -> int:
        return self.shape[0]

    def __repr__(self) -> str:
        return f"<DeviceArray of shape {self.shape}, {self.dtype}, on CUDA device {self.device}>"


def _from_dlpack(points: Any) -> _core.DevicePoints:
    """Names the stream that reads, one of the library's: the default stream would wait for others."""
    stream = _core.DeviceStream(operator.index(points.__dlpack_device__()[1]))
    try:
        capsule = points.__dlpack__(stream=stream.handle)
    except BufferError as error:
        raise InvalidArgument(f"`points`: {error}") from None
    except TypeError:  # no stream can be named: wait for all work of the device
        view = _core.DevicePoints.from_dlpack(points.__dlpack__(), points)
        _core.wait_for_cuda_device_of(view.data)
        return view
    return _core.DevicePoints.from_dlpack(capsule, points, stream)


def _ordered_stream(interface: dict[str, Any], address: int) -> int:
    """The stream behind which the points are to be read; what cannot be named is waited for."""
    stream = operator.index(interface.get("stream") or 0)
    if stream == 0:  # its maker (PyTorch, say) does not tell on which stream it works
        if address != 0:
            _core.wait_for_cuda_device_of(address)
        return _LEGACY_DEFAULT_STREAM
    if not 0 < stream < 2**64:
        raise InvalidArgument("a stream cannot be negative or beyond 64 bits")
    if stream == _PER_THREAD_DEFAULT_STREAM:  # this thread's; the work is done on another
        _core.wait_for_cuda_stream(stream)
        return _LEGACY_DEFAULT_STREAM
    return stream


def _from_interface(interface: Any, owner: Any) -> _core.DevicePoints:
    """Checks what the producer says, because a wrong address cannot be checked later."""
    if not isinstance(interface, dict):
        raise TypeError(
            f"__cuda_array_interface__ must be a dict, not {type(interface).__name__}"
        )
    for field in ("shape", "typestr", "data"):
        if field not in interface:
            raise InvalidArgument(f"__cuda_array_interface__ has no {field!r}")
    if interface.get("mask") is not None:
        raise InvalidArgument("`points` cannot be a masked array")
    shape = _integers(interface["shape"], "shape")
    if len(shape) != 2:
        raise wrong_axes("points", 2, len(shape))
    kind = interface["typestr"]
    if kind not in ("<f4", "<f8"):
        raise TypeError(f"points on a device must be float32 or float64, not {kind!r}")
    size = int(kind[2])
    count, dimension = shape
    if not (0 <= count < 2**63 and 0 <= dimension < 2**32):
        raise InvalidArgument(f"`points` cannot have the shape {shape}")
    strides: tuple[int, ...] = (dimension * size, size)
    if interface.get("strides") is not None:
        strides = _integers(interface["strides"], "strides")
    if len(strides) != 2:
        raise InvalidArgument(f"2 strides are needed, not {len(strides)}")
    data = interface["data"]
    if not isinstance(data, tuple) or len(data) != 2:
        raise TypeError("data in __cuda_array_interface__ must be (address, read only)")
    address = operator.index(data[0] or 0)
    if not 0 <= address < 2**64:
        raise InvalidArgument("an address cannot be negative or beyond 64 bits")
    if address == 0 and count * dimension > 0:
        raise InvalidArgument("`points` is at address 0")
    if any(v % size for v in (address, *strides)):
        raise InvalidArgument(f"address and strides must be multiples of {size} bytes")
    stream = _ordered_stream(interface, address if count * dimension > 0 else 0)
    return _core.DevicePoints.from_interface(
        address, count, dimension, strides[0], strides[1], kind == "<f8", stream, owner
    )


def _integers(values: Any, field: str) -> tuple[int, ...]:
    if not isinstance(values, tuple):
        raise TypeError(
            f"{field} in __cuda_array_interface__ must be a tuple, not {type(values).__name__}"
        )
    return tuple(map(operator.index, values))


def cuda_status() -> dict[str, Any]:
    """What the CUDA backend can do here.

    Returns
    -------
    dict
        ``compiled`` and ``available``, bool; ``reason`` it is not, ``device`` and
        ``compute_capability``, str; ``driver_version``, ``runtime_version`` and ``memory_bytes``.

    Examples
    --------
    >>> import cullhull
    >>> status = cullhull.cuda_status()
    >>> status["available"] or bool(status["reason"])
    True
    """
    return _core.cuda_status()
