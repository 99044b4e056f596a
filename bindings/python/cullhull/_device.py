"""Arrays in a CUDA device's memory (CuPy, PyTorch, Numba, JAX): culled where they lie."""

from __future__ import annotations

from typing import Any

from . import _core
from ._errors import InvalidArgument

_DLPACK_CUDA = (2, 13)  # device and managed memory


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
            from ._errors import BackendUnavailable

            raise BackendUnavailable(f"points in a device's memory: {status['reason']}")
        return _core.DevicePoints.from_dlpack(points)
    return None


def _from_interface(interface: dict[str, Any], owner: Any) -> _core.DevicePoints:
    if interface.get("mask") is not None:
        raise InvalidArgument("`points` cannot be a masked array")
    shape = interface["shape"]
    if len(shape) != 2:
        raise InvalidArgument(f"`points` should be a 2D array, not {len(shape)}D")
    kind = interface["typestr"]
    if kind not in ("<f4", "<f8"):
        raise TypeError(f"points on a device must be float32 or float64, not {kind!r}")
    size = int(kind[2])
    count, dimension = shape
    strides = interface.get("strides") or (dimension * size, size)
    # None: nothing to wait for. 1 and 2 name the legacy default stream and the thread's own.
    stream = interface.get("stream") or 0
    return _core.DevicePoints.from_interface(
        interface["data"][0] or 0,
        count,
        dimension,
        strides[0],
        strides[1],
        kind == "<f8",
        stream,
        owner,
    )


def cuda_status() -> dict[str, Any]:
    """What the CUDA backend can do here: whether it is compiled in and available, and if not why,
    the device's name, compute capability, driver and runtime versions, memory in bytes."""
    return _core.cuda_status()
