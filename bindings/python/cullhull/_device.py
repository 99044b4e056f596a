"""Arrays in a CUDA device's memory (CuPy, PyTorch, Numba, JAX): culled where they lie."""

from __future__ import annotations

import operator
from typing import Any

from . import _core
from ._errors import BackendUnavailable, InvalidArgument

_DLPACK_CUDA = (2, 13)  # device and managed memory
_LEGACY_DEFAULT_STREAM, _PER_THREAD_DEFAULT_STREAM = 1, 2  # as both protocols number them


def as_device_points(points: Any) -> _core.DevicePoints | None:
    """A view of ``points`` if they are in a CUDA device's memory, else None.

    They must be (n, d) float32 or float64, aligned; any strides.
    """
    if hasattr(points, "__array_interface__"):
        return None
    interface = getattr(points, "__cuda_array_interface__", None)
    if interface is not None:
        return _from_interface(interface, points)
    if hasattr(points, "__dlpack_device__") and points.__dlpack_device__()[0] in _DLPACK_CUDA:
        status = _core.cuda_status()
        if not status["available"]:
            raise BackendUnavailable(f"points in a device's memory: {status['reason']}")
        return _from_dlpack(points)
    return None


def _from_dlpack(points: Any) -> _core.DevicePoints:
    """Names the stream that reads: without it a library may order nothing."""
    try:
        capsule = points.__dlpack__(stream=_LEGACY_DEFAULT_STREAM)
    except TypeError:  # no stream can be named: wait for all work of the device
        view = _core.DevicePoints.from_dlpack(points.__dlpack__(), points)
        _core.wait_for_cuda_device_of(view.data)
        return view
    return _core.DevicePoints.from_dlpack(capsule, points)


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
        raise InvalidArgument(f"`points` should be a 2D array, not {len(shape)}D")
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
